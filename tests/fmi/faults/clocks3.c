/* Random calls of the FMI 3.0 functions for clocks, dependencies and what is not provided. */
#include <math.h>

#include "calls3.h"

enum { MOST = 3 };

/* Clocks, now and then something else. */
static size_t clocks(unsigned *references)
{
    const size_t count = draw(MOST + 1);
    for (size_t i = 0; i < count; i++) {
        references[i] = chance(95) && brunovsky_model.nk ? FIRST_CLOCK + draw((unsigned)brunovsky_model.nk) : draw(BEYOND);
        must_fail |= references[i] < FIRST_CLOCK || references[i] >= VARIABLES;
    }
    return count;
}

static int null_for(size_t count)
{
    const int null = count && chance(2);
    must_fail |= null;
    return null;
}

int get_clock(Subject *subject)
{
    unsigned references[MOST];
    fmi3Clock values[MOST];
    const size_t count = clocks(references);
    return (int)fmi3GetClock(subject->component, references, count, null_for(count) ? NULL : values);
}

int set_clock(Subject *subject)
{
    unsigned references[MOST];
    const fmi3Clock values[MOST] = {chance(80), chance(50), chance(50)};
    const size_t count = clocks(references);
    return (int)fmi3SetClock(subject->component, references, count, null_for(count) ? NULL : values);
}

int get_interval(Subject *subject)
{
    unsigned references[MOST];
    double values[MOST] = {NAN, NAN, NAN};
    fmi3IntervalQualifier qualifiers[MOST];
    const size_t count = clocks(references);
    const int status =
        (int)fmi3GetIntervalDecimal(subject->component, references, count, values, null_for(count) ? NULL : qualifiers);
    for (size_t i = 0; status == OK && i < count; i++)
        EXPECT(isfinite(values[i]), "an interval of %g", values[i]);
    return status;
}

int set_interval(Subject *subject)
{
    unsigned references[MOST];
    double values[MOST];
    const size_t count = clocks(references);
    for (size_t i = 0; i < count; i++) {
        values[i] = chance(90) ? uniform(0.005, 0.02) : odd_number();
        must_fail |= !isfinite(values[i]);
    }
    return (int)fmi3SetIntervalDecimal(subject->component, references, count, null_for(count) ? NULL : values);
}

int get_shift(Subject *subject)
{
    unsigned references[MOST];
    double values[MOST] = {NAN, NAN, NAN};
    const size_t count = clocks(references);
    const int status = (int)fmi3GetShiftDecimal(subject->component, references, count, null_for(count) ? NULL : values);
    for (size_t i = 0; status == OK && i < count; i++)
        EXPECT(values[i] == 0, "a shift of %g", values[i]);
    return status;
}

int activate_partition(Subject *subject)
{
    const double now = real(subject, TIME), time = chance(90) ? now + uniform(0, 0.02) : odd_number();
    const unsigned clock = chance(95) ? FIRST_CLOCK + draw((unsigned)brunovsky_model.nk + 1) : draw(BEYOND);
    must_fail = !isfinite(time) || clock < FIRST_CLOCK || clock >= VARIABLES;
    return (int)fmi3ActivateModelPartition(subject->component, clock, time);
}

int dependencies(Subject *subject)
{
    const unsigned reference = chance(90) ? draw(VARIABLES) : draw(BEYOND);
    size_t count = 0, *elements, *others;
    fmi3DependencyKind *kinds;
    unsigned *independents;
    int status;
    must_fail = reference >= FIRST_CLOCK + (unsigned)brunovsky_model.nk || !span(reference);
    status = (int)fmi3GetNumberOfVariableDependencies(subject->component, reference, chance(98) ? &count : NULL);
    if (status != OK || !count)
        return status;
    const size_t given = chance(95) ? count : count - 1;
    must_fail = given != count;
    elements = own(given * sizeof *elements);
    others = own(given * sizeof *others);
    kinds = own(given * sizeof *kinds);
    independents = own(given * sizeof *independents);
    status = (int)fmi3GetVariableDependencies(subject->component, reference, elements, independents, others, kinds, given);
    for (size_t i = 0; status == OK && i < given; i++)
        EXPECT(span(independents[i]) >= others[i] && others[i] && elements[i] <= span(reference) && elements[i],
               "element %d depends on element %d of value reference %u", (int)elements[i], (int)others[i], independents[i]);
    disown(elements);
    disown(others);
    disown(kinds);
    disown(independents);
    return status;
}

int not_provided(Subject *subject)
{
    must_fail = 1;
    switch (draw(7)) {
    case 0: return (int)fmi3EnterConfigurationMode(subject->component);
    case 1: return (int)fmi3ExitConfigurationMode(subject->component);
    case 2: return (int)fmi3SetShiftDecimal(subject->component, NULL, 0, NULL);
    case 3: return (int)fmi3GetIntervalFraction(subject->component, NULL, 0, NULL, NULL, NULL);
    case 4: return (int)fmi3SetIntervalFraction(subject->component, NULL, 0, NULL, NULL);
    case 5: return (int)fmi3GetShiftFraction(subject->component, NULL, 0, NULL, NULL);
    default: return (int)fmi3SetShiftFraction(subject->component, NULL, 0, NULL, NULL);
    }
}

#define TYPES(ACTION)                                                                                                 \
    const unsigned reference = draw(VARIABLES);                                                                       \
    const size_t count = draw(2);                                                                                     \
    must_fail = count > 0;                                                                                            \
    switch (draw(9)) {                                                                                                \
    case 0: return (int)fmi3##ACTION##Float32(subject->component, &reference, count, NULL, count);                    \
    case 1: return (int)fmi3##ACTION##Int8(subject->component, &reference, count, NULL, count);                       \
    case 2: return (int)fmi3##ACTION##UInt8(subject->component, &reference, count, NULL, count);                      \
    case 3: return (int)fmi3##ACTION##Int16(subject->component, &reference, count, NULL, count);                      \
    case 4: return (int)fmi3##ACTION##UInt16(subject->component, &reference, count, NULL, count);                     \
    case 5: return (int)fmi3##ACTION##UInt32(subject->component, &reference, count, NULL, count);                     \
    case 6: return (int)fmi3##ACTION##UInt64(subject->component, &reference, count, NULL, count);                     \
    case 7: return (int)fmi3##ACTION##String(subject->component, &reference, count, NULL, count);                     \
    default: return (int)fmi3##ACTION##Binary(subject->component, &reference, count, NULL, NULL, count);              \
    }

int read_other_types(Subject *subject)
{
    TYPES(Get)
}

int write_other_types(Subject *subject)
{
    TYPES(Set)
}
