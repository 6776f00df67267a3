/* FMI 3.0: values of variables of all types, scalars and arrays; their derivatives and dependencies. */
#include <stdlib.h>

#include "fmi3.h"
#include "sensitivity.h"
#include "variables.h"

#define SETTABLE (INSTANTIATED | INITIALIZATION | STEP | EVENT | CONTINUOUS_TIME | INTERMEDIATE | ACTIVATION)

/* How many values a value reference names: the elements of an array, 1 for a scalar; references that are none, or name
 * what is inside an array, are refused where they are looked up. */
static size_t span(fmi3ValueReference reference)
{
    const unsigned *spans = brunovsky_description.spans;
    int index;
    return spans && variable_locate(reference, &index) != UNKNOWN ? spans[reference] : 1;
}

/* Whether so many values do not belong to these variables, with a message. */
static int miscounted(const Fmu *fmu, const char *function, const fmi3ValueReference references[], size_t count,
                      size_t values)
{
    size_t expected = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t elements = span(references[i]);
        if (!elements) {
            fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError",
                    "%s: there is no variable with value reference %u, which is an element of an array", function,
                    (unsigned)references[i]);
            return 1;
        }
        expected += elements;
    }
    if (expected == values)
        return 0;
    fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError", "%s: %lu values were given or asked for, but the variables have %lu",
            function, (unsigned long)values, (unsigned long)expected);
    return 1;
}

#define GET(VALUE, TYPES)                                                                                              \
    const Fmu *fmu = instance;                                                                                        \
    size_t next = 0;                                                                                                  \
    if (fmu_refused(fmu, __func__, READABLE) ||                                                                       \
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, values) ||                                      \
        miscounted(fmu, __func__, valueReferences, nValueReferences, nValues))                                        \
        return fmi3Error;                                                                                             \
    lock(fmu);                                                                                                        \
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++) {                                                     \
            double number;                                                                                            \
            const Result result = instance_get(fmu->instance, TYPES, valueReferences[i] + k, &number);                \
            if (result != DONE)                                                                                       \
                return unlock(fmu, status_of(fmu, __func__, result));                                                 \
            values[next++] = (VALUE)number;                                                                           \
        }                                                                                                             \
    return unlock(fmu, fmi3OK)

/* All values are checked before the first one is set. */
#define SET(TYPES)                                                                                                    \
    const Fmu *fmu = instance;                                                                                        \
    size_t next = 0;                                                                                                  \
    if (fmu_refused(fmu, __func__, SETTABLE) ||                                                                       \
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, values) ||                                      \
        miscounted(fmu, __func__, valueReferences, nValueReferences, nValues))                                        \
        return fmi3Error;                                                                                             \
    lock(fmu);                                                                                                        \
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++) {                                                     \
            const Result result =                                                                                     \
                instance_admits(fmu->instance, TYPES, valueReferences[i] + k, (double)values[next++]);                \
            if (result != DONE)                                                                                       \
                return unlock(fmu, status_of(fmu, __func__, result));                                                 \
        }                                                                                                             \
    next = 0;                                                                                                         \
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++)                                                       \
            instance_set(fmu->instance, valueReferences[i] + k, (double)values[next++]);                              \
    return unlock(fmu, fmi3OK)

#define GETTER(NAME, VALUE)                                                                                            \
    fmi3Status fmi3Get##NAME(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                             VALUE values[], size_t nValues)
#define SETTER(NAME, VALUE)                                                                                            \
    fmi3Status fmi3Set##NAME(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                             const VALUE values[], size_t nValues)

GETTER(Float64, fmi3Float64)
{
    GET(fmi3Float64, REAL);
}

GETTER(Int32, fmi3Int32)
{
    GET(fmi3Int32, INTEGER);
}

GETTER(Int64, fmi3Int64)
{
    GET(fmi3Int64, ENUMERATION);
}

GETTER(Boolean, fmi3Boolean)
{
    GET(fmi3Boolean, BOOLEAN);
}

SETTER(Float64, fmi3Float64)
{
    SET(REAL);
}

SETTER(Int32, fmi3Int32)
{
    SET(INTEGER);
}

SETTER(Int64, fmi3Int64)
{
    SET(ENUMERATION);
}

SETTER(Boolean, fmi3Boolean)
{
    SET(BOOLEAN);
}

/* Of types that no variable has: nothing may be asked for. */
static fmi3Status no_such_type(const Fmu *fmu, const char *function, const char *type, int phases, size_t count)
{
    if (fmu_refused(fmu, function, phases))
        return fmi3Error;
    if (!count)
        return fmi3OK;
    fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError", "%s: there are no variables of type %s", function, type);
    return fmi3Error;
}

#define ABSENT(NAME, VALUE)                                                                                            \
    GETTER(NAME, VALUE)                                                                                               \
    {                                                                                                                 \
        (void)valueReferences, (void)values, (void)nValues;                                                           \
        return no_such_type(instance, __func__, #NAME, READABLE, nValueReferences);                                   \
    }                                                                                                                 \
    SETTER(NAME, VALUE)                                                                                               \
    {                                                                                                                 \
        (void)valueReferences, (void)values, (void)nValues;                                                           \
        return no_such_type(instance, __func__, #NAME, SETTABLE, nValueReferences);                                   \
    }

ABSENT(Float32, fmi3Float32)
ABSENT(Int8, fmi3Int8)
ABSENT(UInt8, fmi3UInt8)
ABSENT(Int16, fmi3Int16)
ABSENT(UInt16, fmi3UInt16)
ABSENT(UInt32, fmi3UInt32)
ABSENT(UInt64, fmi3UInt64)
ABSENT(String, fmi3String)

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         size_t valueSizes[], fmi3Binary values[], size_t nValues)
{
    (void)valueReferences, (void)valueSizes, (void)values, (void)nValues;
    return no_such_type(instance, __func__, "Binary", READABLE, nValueReferences);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
{
    (void)valueReferences, (void)valueSizes, (void)values, (void)nValues;
    return no_such_type(instance, __func__, "Binary", SETTABLE, nValueReferences);
}

/* Derivatives ------------------------------------------------------------------------------------------------------ */

/* Value references of the scalars that these variables consist of: the list itself where all are scalars, otherwise one
 * that has to be freed; NULL if out of memory. */
static const unsigned *scalars(const fmi3ValueReference references[], size_t count, size_t total)
{
    unsigned *list, *next;
    if (!brunovsky_description.spans || !count)
        return references;
    list = next = malloc((total + 1) * sizeof *list);
    for (size_t i = 0; list && i < count; i++)
        for (unsigned k = 0; k < span(references[i]); k++)
            *next++ = references[i] + k;
    return list;
}

static void release(const unsigned *list, const fmi3ValueReference references[])
{
    if (list != references)
        free((void *)list);
}

typedef Result Product(Instance *instance, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                       size_t n_knowns, const double *seed, double *result);

static fmi3Status multiply(const Fmu *fmu, const char *function, Product *product, const fmi3ValueReference unknowns[],
                           size_t nUnknowns, size_t unknown_values, const fmi3ValueReference knowns[], size_t nKnowns,
                           size_t known_values, const fmi3Float64 seed[], fmi3Float64 sensitivity[])
{
    const int adjoint = product == instance_adjoint;
    const unsigned *rows, *columns;
    fmi3Status status;
    if (fmu_refused(fmu, function, READABLE & ~INTERMEDIATE) || fmu_missing(fmu, function, nUnknowns, unknowns, unknowns) ||
        fmu_missing(fmu, function, nKnowns, knowns, knowns) ||
        fmu_missing(fmu, function, adjoint ? unknown_values : known_values, seed, seed) ||
        fmu_missing(fmu, function, adjoint ? known_values : unknown_values, sensitivity, sensitivity) ||
        miscounted(fmu, function, unknowns, nUnknowns, unknown_values) ||
        miscounted(fmu, function, knowns, nKnowns, known_values))
        return fmi3Error;
    lock(fmu);
    rows = scalars(unknowns, nUnknowns, unknown_values);
    columns = scalars(knowns, nKnowns, known_values);
    if ((!rows && nUnknowns) || (!columns && nKnowns))
        status = fail(fmu, function, "out of memory");
    else
        status = status_of(fmu, function, product(fmu->instance, rows, unknown_values, columns, known_values, seed,
                                                  sensitivity));
    release(rows, unknowns);
    release(columns, knowns);
    return unlock(fmu, status);
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    return multiply(instance, __func__, instance_directional, unknowns, nUnknowns, nSensitivity, knowns, nKnowns, nSeed,
                    seed, sensitivity);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                    size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    return multiply(instance, __func__, instance_adjoint, unknowns, nUnknowns, nSeed, knowns, nKnowns, nSensitivity, seed,
                    sensitivity);
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                    size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)
{
    const Fmu *fmu = instance;
    size_t next = 0;
    if (fmu_refused_to(fmu, __func__, ONLY(CO_SIMULATION), STEP | INTERMEDIATE | TERMINATED) ||
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, values) ||
        fmu_missing(fmu, __func__, nValueReferences, orders, orders) ||
        miscounted(fmu, __func__, valueReferences, nValueReferences, nValues))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++)
        for (unsigned k = 0; k < span(valueReferences[i]); k++) {
            const Result result =
                instance_get_output_derivative(fmu->instance, valueReferences[i] + k, orders[i], &values[next++]);
            if (result != DONE)
                return status_of(fmu, __func__, result);
        }
    return fmi3OK;
}

/* Dependencies ----------------------------------------------------------------------------------------------------- */

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference valueReference,
                                               size_t *nDependencies)
{
    const Fmu *fmu = instance;
    size_t total = 0, one = 0;
    if (fmu_refused(fmu, __func__, ANY_PHASE & ~INTERMEDIATE) || fmu_missing(fmu, __func__, 1, nDependencies, nDependencies))
        return fmi3Error;
    if (!span(valueReference))
        return fail(fmu, __func__, "there is no variable with this value reference, which is an element of an array");
    for (unsigned k = 0; k < span(valueReference); k++, total += one) {
        const Result result = instance_count_dependencies(fmu->instance, valueReference + k, &one);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
    *nDependencies = total;
    return fmi3OK;
}

/* Variable that an element belongs to, and the element's index in it, from 1. */
static fmi3ValueReference variable_of(unsigned element, size_t *index)
{
    fmi3ValueReference variable = element;
    while (!span(variable))
        variable--;
    *index = element - variable + 1;
    return variable;
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
                                       size_t nDependencies)
{
    const Fmu *fmu = instance;
    size_t next = 0, expected = 0;
    if (fmi3GetNumberOfVariableDependencies(instance, dependent, &expected) != fmi3OK ||
        fmu_missing(fmu, __func__, nDependencies, elementIndicesOfDependent, independents) ||
        fmu_missing(fmu, __func__, nDependencies, elementIndicesOfIndependents, dependencyKinds))
        return fmi3Error;
    if (nDependencies != expected)
        return fail(fmu, __func__, "the number of dependencies is not that of fmi3GetNumberOfVariableDependencies");
    for (unsigned k = 0; next < expected; k++) {
        size_t count;
        const Dependency *found = instance_dependencies(fmu->instance, dependent + k, &count);
        for (size_t i = 0; i < count; i++, next++) {
            elementIndicesOfDependent[next] = k + 1;
            independents[next] = variable_of(found[i].known, &elementIndicesOfIndependents[next]);
            dependencyKinds[next] = (fmi3DependencyKind)found[i].kind;
        }
    }
    return fmi3OK;
}
