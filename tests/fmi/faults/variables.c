/* Random calls of the functions for variables and derivatives. */
#include <limits.h>
#include <math.h>

#include "interface.h"

unsigned span(unsigned reference)
{
    return brunovsky_description.spans && reference < VARIABLES ? brunovsky_description.spans[reference] : 1;
}

static Type type_of(unsigned reference)
{
    if (reference >= FIRST_OUTPUT && reference < FIRST_STATE)
        return brunovsky_description.y_types[reference - FIRST_OUTPUT];
    if (reference >= FIRST_CLOCK)
        return CLOCK;
    if (reference >= FIRST_MODE && reference < FIRST_DERIVATIVE)
        return INTEGER;
    return reference == SOLVER ? SOLVER_TYPE : REAL;
}

static unsigned any_of(Type type)
{
    for (int tries = 0; tries < 100; tries++) {
        const unsigned reference = draw(VARIABLES);
        if (type_of(reference) == type && span(reference))
            return reference;
    }
    return draw(VARIABLES);
}

static unsigned one_of(unsigned first, int count)
{
    unsigned reference = count ? first + draw((unsigned)count) : BEYOND;
    while (!span(reference))
        reference--;
    return reference;
}

/* Variables of a call, their values one after the other, and how many these are. What is wrong with them is noted. */
typedef struct {
    size_t count, n;
    unsigned *references;
    double *values;
} Arguments;

static void choose(Arguments *a)
{
    a->count = chance(4) ? 0 : 1 + draw(4);
    a->references = own(a->count * sizeof *a->references);
}

static void allow_values(Arguments *a)
{
    a->n = 0;
    for (size_t i = 0; i < a->count; i++) {
        a->n += span(a->references[i]);
        must_fail |= a->references[i] >= VARIABLES || !span(a->references[i]);
    }
    a->values = own(a->n * sizeof *a->values);
    for (size_t i = 0; i < a->n; i++)
        a->values[i] = NAN;
}

static void release(const Arguments *a)
{
    disown(a->references);
    disown(a->values);
}

/* References of one type, now and then of another one or of nothing. */
static void refer(Arguments *a, Type type, int set)
{
    choose(a);
    for (size_t i = 0; i < a->count; i++) {
        a->references[i] = any_of(type);
        if (set && type == REAL && chance(80) && brunovsky_model.nu)
            a->references[i] = one_of(FIRST_INPUT, brunovsky_model.nu);
        else if (set && type == REAL && chance(80) && brunovsky_model.np)
            a->references[i] = one_of(FIRST_PARAMETER, brunovsky_model.np);
        if (chance(2))
            a->references[i] = draw(VARIABLES);
        if (chance(2))
            a->references[i] = chance(50) ? BEYOND + draw(1000) : UINT_MAX - draw(3);
        must_fail |= a->references[i] >= VARIABLES || type_of(a->references[i]) != type;
    }
    allow_values(a);
}

/* Sometimes a null pointer, or, where the version counts values, another count. */
static void spoil(Arguments *a)
{
    if (!a->n || !chance(3))
        return;
    must_fail = 1;
    if (FMI == 3 && chance(40)) {
        a->n--;
    } else if (chance(50)) {
        disown(a->references);
        a->references = NULL;
    } else {
        disown(a->values);
        a->values = NULL;
    }
}

static void check_finite(const Arguments *a, int status)
{
    for (size_t i = 0; status <= WARNING && i < a->n; i++)
        EXPECT(isfinite(a->values[i]), "value %d, from value reference %u on, is %g", (int)i, a->references[0],
               a->values[i]);
}

static int get(Subject *subject, Type type)
{
    Arguments a;
    int status;
    refer(&a, type, 0);
    spoil(&a);
    status = get_values(subject, type, a.references, a.count, a.values, a.n);
    check_finite(&a, status);
    for (size_t i = 0; status <= WARNING && type == BOOLEAN && i < a.n; i++)
        EXPECT(a.values[i] == 0 || a.values[i] == 1, "a Boolean of %g", a.values[i]);
    release(&a);
    return status;
}

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

/* Value of a type that is not real: the solver's number, anything for what is calculated. */
static double number_for(unsigned reference)
{
    const double value = chance(90) ? 1 + (double)draw(2) : (double)draw(9) - 4;
    must_fail |= reference != SOLVER || value < 1 || value > 2;
    return value;
}

static int set(Subject *subject, Type type)
{
    Arguments a;
    size_t next = 0;
    int status;
    refer(&a, type, 1);
    for (size_t i = 0; i < a.count; i++)
        for (unsigned k = 0; k < span(a.references[i]); k++)
            a.values[next++] = type == REAL ? value_for(a.references[i] + k) : number_for(a.references[i] + k);
    spoil(&a);
    status = set_values(subject, type, a.references, a.count, a.values, a.n);
    release(&a);
    return status;
}

#define BOTH(NAME, TYPE)                                                                                              \
    int get_##NAME(Subject *subject)                                                                                  \
    {                                                                                                                 \
        return get(subject, TYPE);                                                                                    \
    }                                                                                                                 \
    int set_##NAME(Subject *subject)                                                                                  \
    {                                                                                                                 \
        return set(subject, TYPE);                                                                                    \
    }
BOTH(real, REAL)
BOTH(integer, INTEGER)
BOTH(boolean, BOOLEAN)
BOTH(enumeration, ENUMERATION)

/* Derivatives ------------------------------------------------------------------------------------------------------ */

static int sensitivity(Subject *subject, int is_adjoint)
{
    Arguments unknowns, knowns, *seed = is_adjoint ? &unknowns : &knowns, *result = is_adjoint ? &knowns : &unknowns;
    int status;
    choose(&unknowns);
    choose(&knowns);
    for (size_t i = 0; i < unknowns.count; i++)
        unknowns.references[i] =
            chance(50) ? one_of(FIRST_OUTPUT, brunovsky_model.ny) : one_of(FIRST_DERIVATIVE, brunovsky_model.nx);
    for (size_t i = 0; i < knowns.count; i++)
        knowns.references[i] = chance(80) ? one_of(FIRST_INPUT, brunovsky_model.nu) : draw(VARIABLES);
    allow_values(&unknowns);
    allow_values(&knowns);
    for (size_t i = 0; i < seed->n; i++)
        seed->values[i] = chance(98) ? uniform(-1, 1) : odd_number();
    if (knowns.count && unknowns.count)
        spoil(chance(50) ? &knowns : &unknowns);
    status = directional_derivative(subject, is_adjoint, unknowns.references, unknowns.count, knowns.references, knowns.count,
                                    seed->values, seed->n, result->values, result->n);
    check_finite(result, status);
    release(&unknowns);
    release(&knowns);
    return status;
}

int directional(Subject *subject)
{
    return sensitivity(subject, 0);
}

int adjoint(Subject *subject)
{
    return sensitivity(subject, 1);
}

int get_output_derivatives(Subject *subject)
{
    Arguments a;
    int orders[4], status;
    choose(&a);
    for (size_t i = 0; i < a.count; i++) {
        a.references[i] = chance(95) ? one_of(FIRST_OUTPUT, brunovsky_model.ny) : draw(FIRST_OUTPUT);
        orders[i] = chance(95) ? 1 : (int)draw(5) - 2;
        must_fail |= a.references[i] < FIRST_OUTPUT || orders[i] < 1;
    }
    allow_values(&a);
    spoil(&a);
    status = output_derivatives(subject, a.references, a.count, orders, a.values, a.n);
    check_finite(&a, status);
    release(&a);
    return status;
}
