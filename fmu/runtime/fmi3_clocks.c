/* FMI 3.0: clocks and scheduled execution. */
#include "fmi3.h"

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Clock values[])
{
    const Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, EVENT) || fmu_missing(fmu, __func__, nValueReferences, valueReferences, values))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++) {
        int active = 0;
        const Result result = instance_ticks(fmu->instance, valueReferences[i], &active);
        if (result != DONE)
            return status_of(fmu, __func__, result);
        values[i] = active != 0;
    }
    return fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Clock values[])
{
    const Fmu *fmu = instance;
    int active;
    if (fmu_refused(fmu, __func__, EVENT) || fmu_missing(fmu, __func__, nValueReferences, valueReferences, values))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++) { /* all are checked before the first one is set */
        const Result result = instance_ticks(fmu->instance, valueReferences[i], &active);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
    for (size_t i = 0; i < nValueReferences; i++)
        instance_tick(fmu->instance, valueReferences[i], values[i]);
    return fmi3OK;
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    const Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, INITIALIZATION | EVENT | STEP | ACTIVATION) ||
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, intervals) ||
        fmu_missing(fmu, __func__, nValueReferences, qualifiers, qualifiers))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++) {
        const Result result = instance_period(fmu->instance, valueReferences[i], &intervals[i]);
        if (result != DONE)
            return status_of(fmu, __func__, result);
        qualifiers[i] = fmi3IntervalUnchanged;
    }
    return fmi3OK;
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, const fmi3Float64 intervals[])
{
    const Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, INSTANTIATED | INITIALIZATION) ||
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, intervals))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++) { /* all are checked before the first one is set */
        const Result result = instance_admits_period(fmu->instance, valueReferences[i], intervals[i]);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
    for (size_t i = 0; i < nValueReferences; i++)
        instance_set_period(fmu->instance, valueReferences[i], intervals[i]);
    return fmi3OK;
}

/* Clocks tick first at the start time. */
fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                               fmi3Float64 shifts[])
{
    const Fmu *fmu = instance;
    double period;
    if (fmu_refused(fmu, __func__, INITIALIZATION | EVENT | STEP | ACTIVATION) ||
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, shifts))
        return fmi3Error;
    for (size_t i = 0; i < nValueReferences; i++) {
        const Result result = instance_period(fmu->instance, valueReferences[i], &period);
        if (result != DONE)
            return status_of(fmu, __func__, result);
        shifts[i] = 0;
    }
    return fmi3OK;
}

static fmi3Status no_fraction(const Fmu *fmu, const char *function)
{
    if (fmu_refused(fmu, function, ANY_PHASE))
        return fmi3Error;
    return fail(fmu, function, "intervals of clocks are decimal (supportsFraction is false)");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                               const fmi3Float64 shifts[])
{
    (void)valueReferences, (void)nValueReferences, (void)shifts;
    return instance ? fail(instance, __func__, "clocks have no shift: they tick first at the start time") : fmi3Error;
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions, (void)qualifiers;
    return no_fraction(instance, __func__);
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return no_fraction(instance, __func__);
}

fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                                fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return no_fraction(instance, __func__);
}

fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                                const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)valueReferences, (void)nValueReferences, (void)counters, (void)resolutions;
    return no_fraction(instance, __func__);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clockReference, fmi3Float64 activationTime)
{
    const Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, ACTIVATION))
        return fmi3Error;
    lock(fmu);
    return unlock(fmu, status_of(fmu, __func__, instance_activate(fmu->instance, clockReference, activationTime)));
}
