/* Random calls of the FMI 2.0 functions for variables and their derivatives. */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "interface2.h"

/* Variables -------------------------------------------------------------------------------------------------------- */

static Type type_of(unsigned reference)
{
    if (reference >= FIRST_OUTPUT && reference < FIRST_STATE)
        return brunovsky_description.y_types[reference - FIRST_OUTPUT];
    return reference == SOLVER || (reference >= FIRST_MODE && reference < FIRST_DERIVATIVE) ? INTEGER : REAL;
}

static unsigned any_of(Type type)
{
    for (int tries = 0; tries < 100; tries++) {
        const unsigned reference = draw(VARIABLES);
        if (type_of(reference) == type)
            return reference;
    }
    return draw(VARIABLES);
}

/* Number and memory of the arguments of a call; what is wrong with them is noted. */
typedef struct {
    size_t count;
    fmi2ValueReference *references;
    void *values;
} Arguments;

static Arguments arguments(size_t value_size)
{
    Arguments result = {chance(4) ? 0 : 1 + draw(4), NULL, NULL};
    result.references = own(result.count * sizeof *result.references);
    result.values = own(result.count * value_size);
    return result;
}

static void release(const Arguments *a)
{
    disown(a->references);
    disown(a->values);
}

/* References of one type, now and then of another one or of nothing. */
static void refer(Arguments *a, Type type, int set)
{
    for (size_t i = 0; i < a->count; i++) {
        a->references[i] = any_of(type);
        if (set && type == REAL && chance(80) && brunovsky_model.nu)
            a->references[i] = FIRST_INPUT + draw((unsigned)brunovsky_model.nu);
        else if (set && type == REAL && chance(80) && brunovsky_model.np)
            a->references[i] = FIRST_PARAMETER + draw((unsigned)brunovsky_model.np);
        if (chance(2))
            a->references[i] = draw(VARIABLES);
        if (chance(2))
            a->references[i] = chance(50) ? BEYOND + draw(1000) : UINT_MAX - draw(3);
        if (a->references[i] >= VARIABLES || type_of(a->references[i]) != type)
            must_fail = 1;
    }
}

static int refusable(Arguments *a)
{
    if (!chance(2) || !a->count)
        return 0;
    must_fail = 1;
    if (chance(50)) {
        disown(a->references);
        a->references = NULL;
    } else {
        disown(a->values);
        a->values = NULL;
    }
    return 1;
}

#define GET(NAME, VALUE, TYPE, SENTINEL, FINE)                                                                        \
    int get_##TYPE(Subject *subject)                                                                                  \
    {                                                                                                                 \
        Arguments a = arguments(sizeof(VALUE));                                                                       \
        VALUE *values = a.values;                                                                                     \
        int status;                                                                                                   \
        refer(&a, TYPE, 0);                                                                                           \
        for (size_t i = 0; i < a.count; i++)                                                                          \
            values[i] = SENTINEL;                                                                                     \
        refusable(&a);                                                                                                \
        status = (int)NAME(subject->component, a.references, a.count, a.values);                                      \
        for (size_t i = 0; status <= WARNING && i < a.count; i++)                                                     \
            EXPECT(FINE, "value reference %u is %g", a.references[i], (double)values[i]);                             \
        release(&a);                                                                                                  \
        return status;                                                                                                \
    }

GET(fmi2GetReal, fmi2Real, REAL, NAN, isfinite(values[i]))
GET(fmi2GetInteger, fmi2Integer, INTEGER, INT_MIN, values[i] != INT_MIN)
GET(fmi2GetBoolean, fmi2Boolean, BOOLEAN, 7, values[i] == 0 || values[i] == 1)

static double value_for(unsigned reference)
{
    const Model *model = &brunovsky_model;
    double value = uniform(-2, 2);
    if (reference == STEP_SIZE)
        value = uniform(2e-4, 4e-3);
    if (reference >= FIRST_PARAMETER && reference < FIRST_INPUT)
        value = model->p_default[reference - FIRST_PARAMETER] * (chance(50) ? 1 : uniform(0.8, 1.2)) * !chance(5);
    else if (chance(5))
        value *= pow(10, draw(9));
    if (chance(3))
        value = odd_number();
    if (!isfinite(value) || reference == TIME || (reference == STEP_SIZE && value < 1e-9))
        must_fail = 1;
    if (reference >= FIRST_PARAMETER && reference < FIRST_INPUT &&
        !(value >= model->p_min[reference - FIRST_PARAMETER] && value <= model->p_max[reference - FIRST_PARAMETER]))
        must_fail = 1;
    return value;
}

int set_real(Subject *subject)
{
    Arguments a = arguments(sizeof(fmi2Real));
    int status;
    refer(&a, REAL, 1);
    for (size_t i = 0; i < a.count; i++)
        ((fmi2Real *)a.values)[i] = value_for(a.references[i]);
    refusable(&a);
    status = (int)fmi2SetReal(subject->component, a.references, a.count, a.values);
    release(&a);
    return status;
}

int set_integer(Subject *subject)
{
    Arguments a = arguments(sizeof(fmi2Integer));
    int status;
    refer(&a, INTEGER, 1);
    for (size_t i = 0; i < a.count; i++) {
        const int value = chance(90) ? 1 + (int)draw(2) : (int)draw(9) - 4;
        ((fmi2Integer *)a.values)[i] = value;
        if (a.references[i] != SOLVER || value < 1 || value > 2)
            must_fail = 1;
    }
    refusable(&a);
    status = (int)fmi2SetInteger(subject->component, a.references, a.count, a.values);
    release(&a);
    return status;
}

int set_boolean(Subject *subject)
{
    Arguments a = arguments(sizeof(fmi2Boolean));
    int status;
    refer(&a, BOOLEAN, 1);
    for (size_t i = 0; i < a.count; i++)
        ((fmi2Boolean *)a.values)[i] = (fmi2Boolean)draw(3);
    must_fail |= a.count > 0; /* all of them are calculated */
    status = (int)fmi2SetBoolean(subject->component, a.references, a.count, a.values);
    release(&a);
    return status;
}

int get_string(Subject *subject)
{
    const fmi2ValueReference reference = draw(VARIABLES);
    fmi2String value = NULL;
    const size_t count = draw(2);
    must_fail = count > 0;
    return (int)fmi2GetString(subject->component, &reference, count, &value);
}

int set_string(Subject *subject)
{
    const fmi2ValueReference reference = draw(VARIABLES);
    const fmi2String value = "text";
    const size_t count = draw(2);
    must_fail = count > 0;
    return (int)fmi2SetString(subject->component, &reference, count, &value);
}

/* Derivatives ------------------------------------------------------------------------------------------------------ */

static unsigned one_of(unsigned first, int count)
{
    return count ? first + draw((unsigned)count) : BEYOND;
}

int directional(Subject *subject)
{
    Arguments unknowns = arguments(sizeof(fmi2Real)), knowns = arguments(sizeof(fmi2Real));
    fmi2Real *values = unknowns.values;
    int status;
    for (size_t i = 0; i < unknowns.count; i++) {
        unknowns.references[i] = chance(50) ? one_of(FIRST_OUTPUT, brunovsky_model.ny)
                                            : one_of(FIRST_DERIVATIVE, brunovsky_model.nx);
        must_fail |= unknowns.references[i] >= VARIABLES;
        values[i] = NAN;
    }
    for (size_t i = 0; i < knowns.count; i++) {
        knowns.references[i] = chance(50) ? one_of(FIRST_INPUT, brunovsky_model.nu) : draw(VARIABLES);
        must_fail |= knowns.references[i] >= VARIABLES;
        ((fmi2Real *)knowns.values)[i] = chance(98) ? uniform(-1, 1) : odd_number();
    }
    refusable(&knowns);
    status = (int)fmi2GetDirectionalDerivative(subject->component, unknowns.references, unknowns.count, knowns.references,
                                               knowns.count, knowns.values, unknowns.values);
    for (size_t i = 0; status <= WARNING && i < unknowns.count; i++)
        EXPECT(isfinite(values[i]), "derivative of value reference %u is %g", unknowns.references[i], values[i]);
    release(&unknowns);
    release(&knowns);
    return status;
}

int set_input_derivatives(Subject *subject)
{
    Arguments a = arguments(sizeof(fmi2Real));
    fmi2Integer orders[4];
    int status;
    for (size_t i = 0; i < a.count; i++) {
        const double value = chance(95) ? uniform(-1, 1) : odd_number();
        a.references[i] = chance(95) ? one_of(FIRST_INPUT, brunovsky_model.nu) : draw(FIRST_INPUT);
        orders[i] = chance(95) ? 1 : (int)draw(5) - 2;
        ((fmi2Real *)a.values)[i] = value;
        must_fail |= a.references[i] < FIRST_INPUT || a.references[i] >= VARIABLES || orders[i] < 1 || !isfinite(value);
    }
    refusable(&a);
    status = (int)fmi2SetRealInputDerivatives(subject->component, a.references, a.count, orders, a.values);
    release(&a);
    return status;
}

int get_output_derivatives(Subject *subject)
{
    Arguments a = arguments(sizeof(fmi2Real));
    fmi2Real *values = a.values;
    fmi2Integer orders[4];
    int status;
    for (size_t i = 0; i < a.count; i++) {
        a.references[i] = chance(95) ? one_of(FIRST_OUTPUT, brunovsky_model.ny) : draw(FIRST_OUTPUT);
        orders[i] = chance(95) ? 1 : (int)draw(5) - 2;
        values[i] = NAN;
        must_fail |= a.references[i] < FIRST_OUTPUT || a.references[i] >= VARIABLES || orders[i] < 1;
    }
    refusable(&a);
    status = (int)fmi2GetRealOutputDerivatives(subject->component, a.references, a.count, orders, a.values);
    for (size_t i = 0; status <= WARNING && i < a.count; i++)
        EXPECT(isfinite(values[i]), "derivative of value reference %u is %g", a.references[i], values[i]);
    release(&a);
    return status;
}
