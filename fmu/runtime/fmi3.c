/* FMI 3.0 for co-simulation, model exchange and, of blocks with clocks, scheduled execution: an instance behind the
 * functions of the standard.
 *
 * Decisions that the standard leaves open:
 * - An error leaves the instance as it was before the call, so that it can be corrected, reset or freed. A step that
 *   fails is fmi3Discard; a communication step of zero length is an error.
 * - Outputs belong to the inputs set last. With event mode, relations, samples and transitions change in event mode
 *   alone; between steps they are frozen. Without it they are handled within the step, as in FMI 2.
 * - With event mode and early return a step ends at its first event; without early return events within a step are
 *   handled there and only one at its end is left to the master.
 * - Samples of a clock follow its ticks in event mode and scheduled execution. Where co-simulation has no event mode they
 *   fall at their period, as if the block had no clock.
 * - While a clock ticks, outputs show the samples that belong to the inputs set last; fmi3UpdateDiscreteStates makes them
 *   final. Clocked variables may be read at any time and keep their values between ticks.
 * - In event and continuous-time mode of model exchange fmi3SetFloat64 sets continuous states too, for masters that know
 *   no other way.
 * - Errors are logged whatever the settings, everything else only if it is switched on.
 */
#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_OVERRIDE_FUNCTION_PREFIX
#endif
#include "fmi3Functions.h"

#include <math.h>
#include <string.h>

#include "fmu.h"

#define SETTABLE (INSTANTIATED | INITIALIZATION | STEP | EVENT | CONTINUOUS_TIME | INTERMEDIATE | ACTIVATION)
#define ONLY(INTERFACE) (1 << INTERFACE)

const char *const TYPE_NAMES[] = {"Float64", "Int32", "Boolean", "Enumeration", "Clock"};

static void write_log(void *callback, void *environment, const char *name, int status, const char *category,
                      const char *text)
{
    const Logger *logger = callback;
    (void)name;
    ((fmi3LogMessageCallback)logger->callback)(environment, (fmi3Status)status, category, text);
}

static fmi3Status fail(const Fmu *fmu, const char *function, const char *problem)
{
    return (fmi3Status)fmu_fail(fmu, function, problem);
}

static fmi3Status status_of(const Fmu *fmu, const char *function, Result result)
{
    return (fmi3Status)fmu_status(fmu, function, result);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    return (fmi3Status)fmu_set_logging(instance, __func__, loggingOn, nCategories, categories);
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

static Fmu *instantiate(const char *function, Interface interface, fmi3String name, fmi3String token, fmi3Boolean logging,
                        fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    const Logger logger = {write_log, (void (*)(void))log, environment, name};
    return fmu_new(function, logger, interface, token, logging, 0);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                          fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    (void)resourcePath;
    (void)visible;
    return instantiate(__func__, MODEL_EXCHANGE, instanceName, instantiationToken, loggingOn, instanceEnvironment,
                       logMessage);
}

/* The master is called with the instance in phase INTERMEDIATE. */
static int ask(void *master, double time, double *end)
{
    const Fmu *fmu = master;
    fmi3Boolean early = false;
    fmi3Float64 early_time = time;
    ((fmi3IntermediateUpdateCallback)fmu->update)(fmu->logger.environment, time, true, true, true,
                                                  fmu->instance->early_return != 0, &early, &early_time);
    *end = early_time;
    return early && fmu->instance->early_return && !isnan(early_time);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                         fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
                                         fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    Fmu *fmu;
    (void)resourcePath;
    (void)visible;
    (void)requiredIntermediateVariables; /* all of them are there */
    (void)nRequiredIntermediateVariables;
    fmu = instantiate(__func__, CO_SIMULATION, instanceName, instantiationToken, loggingOn, instanceEnvironment, logMessage);
    if (!fmu)
        return NULL;
    fmu->instance->event_mode = eventModeUsed;
    fmu->instance->early_return = earlyReturnAllowed;
    if (intermediateUpdate) {
        Listener listener = fmu->instance->listener;
        fmu->update = (void (*)(void))intermediateUpdate;
        listener.ask = ask;
        instance_listen(fmu->instance, listener);
    }
    return fmu;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption)
{
    const Logger logger = {write_log, (void (*)(void))logMessage, instanceEnvironment, instanceName ? instanceName : "?"};
    (void)resourcePath;
    (void)visible;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    if (!brunovsky_model.nk || brunovsky_model.nx) {
        fmu_log(&logger, STATUS_ERROR, "logStatusError",
                "%s: scheduled execution is for blocks with clocks and without continuous states", __func__);
        return NULL;
    }
    return instantiate(__func__, SCHEDULED_EXECUTION, instanceName, instantiationToken, loggingOn, instanceEnvironment,
                       logMessage);
}

void fmi3FreeInstance(fmi3Instance instance)
{
    fmu_free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    Fmu *fmu = instance;
    Result result;
    if (fmu_refused(fmu, __func__, INSTANTIATED))
        return fmi3Error;
    result = instance_set_up(fmu->instance, startTime, stopTimeDefined ? stopTime : HUGE_VAL,
                             toleranceDefined ? tolerance : DEFAULT_TOLERANCE);
    if (result == DONE)
        instance_enter_initialization(fmu->instance);
    return status_of(fmu, __func__, result);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, INITIALIZATION))
        return fmi3Error;
    return status_of(fmu, __func__, instance_exit_initialization(fmu->instance));
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    return (fmi3Status)fmu_terminate(instance, __func__);
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    return (fmi3Status)fmu_reset(instance, __func__);
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    return instance ? fail(instance, __func__, "there are no structural parameters to configure") : fmi3Error;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    return instance ? fail(instance, __func__, "is not allowed: there is no configuration mode") : fmi3Error;
}

/* Variables ------------------------------------------------------------------------------------------------------- */

/* How many values a value reference names: the elements of an array, 1 for a scalar; references that are none, or name
 * what is inside an array, are refused where they are looked up. */
static size_t span(fmi3ValueReference reference)
{
    const Model *model = &brunovsky_model;
    const unsigned known = 3 + (unsigned)(model->np + model->nu + model->ny + 2 * model->nx + model->nq + model->nm +
                                          model->nz + model->nk);
    return brunovsky_description.spans && reference < known ? brunovsky_description.spans[reference] : 1;
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
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++) {                                                     \
            double number;                                                                                            \
            const Result result = instance_get(fmu->instance, TYPES, valueReferences[i] + k, &number);                \
            if (result != DONE)                                                                                       \
                return status_of(fmu, __func__, result);                                                              \
            values[next++] = (VALUE)number;                                                                           \
        }                                                                                                             \
    return fmi3OK

/* All values are checked before the first one is set. */
#define SET(TYPES)                                                                                                    \
    const Fmu *fmu = instance;                                                                                        \
    size_t next = 0;                                                                                                  \
    if (fmu_refused(fmu, __func__, SETTABLE) ||                                                                       \
        fmu_missing(fmu, __func__, nValueReferences, valueReferences, values) ||                                      \
        miscounted(fmu, __func__, valueReferences, nValueReferences, nValues))                                        \
        return fmi3Error;                                                                                             \
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++) {                                                     \
            const Result result =                                                                                     \
                instance_admits(fmu->instance, TYPES, valueReferences[i] + k, (double)values[next++]);                \
            if (result != DONE)                                                                                       \
                return status_of(fmu, __func__, result);                                                              \
        }                                                                                                             \
    next = 0;                                                                                                         \
    for (size_t i = 0; i < nValueReferences; i++)                                                                     \
        for (unsigned k = 0; k < span(valueReferences[i]); k++)                                                       \
            instance_set(fmu->instance, valueReferences[i] + k, (double)values[next++]);                              \
    return fmi3OK

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

/* Clocks ----------------------------------------------------------------------------------------------------------- */

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
    for (size_t i = 0; i < nValueReferences; i++) {
        const Result result = instance_set_period(fmu->instance, valueReferences[i], intervals[i]);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
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
    return status_of(fmu, __func__, instance_activate(fmu->instance, clockReference, activationTime));
}

/* State of the FMU ------------------------------------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return (fmi3Status)fmu_get_state(instance, __func__, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    return (fmi3Status)fmu_set_state(instance, __func__, FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return (fmi3Status)fmu_free_state(instance, __func__, FMUState);
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    return (fmi3Status)fmu_state_size(instance, __func__, FMUState, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    return (fmi3Status)fmu_serialize(instance, __func__, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    return (fmi3Status)fmu_deserialize(instance, __func__, serializedState, size, FMUState);
}

/* Events ----------------------------------------------------------------------------------------------------------- */

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    const Fmu *fmu = instance;
    const int phases = fmu && fmu->instance->event_mode ? STEP : CONTINUOUS_TIME;
    if (fmu_refused(fmu, __func__, phases))
        return fmi3Error;
    instance_enter_event(fmu->instance);
    return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    const Fmu *fmu = instance;
    if (fmu_refused(fmu, __func__, EVENT))
        return fmi3Error;
    return status_of(fmu, __func__, instance_refresh(fmu->instance));
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime)
{
    const Fmu *fmu = instance;
    Event event;
    int status;
    if (fmu_refused(fmu, __func__, EVENT) ||
        fmu_missing(fmu, __func__, 1, discreteStatesNeedUpdate, terminateSimulation) ||
        fmu_missing(fmu, __func__, 1, nominalsOfContinuousStatesChanged, valuesOfContinuousStatesChanged) ||
        fmu_missing(fmu, __func__, 1, nextEventTimeDefined, nextEventTime))
        return fmi3Error;
    status = fmu_event(fmu, __func__, &event);
    if (status != STATUS_OK)
        return (fmi3Status)status;
    *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = false;
    *valuesOfContinuousStatesChanged = event.states_changed != 0;
    *nextEventTimeDefined = event.next < HUGE_VAL;
    *nextEventTime = event.next < HUGE_VAL ? event.next : 0;
    return fmi3OK;
}

/* Model exchange --------------------------------------------------------------------------------------------------- */

static int refused_exchange(const Fmu *fmu, const char *function, int phases)
{
    return fmu_refused_to(fmu, function, ONLY(MODEL_EXCHANGE), phases);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    const Fmu *fmu = instance;
    if (refused_exchange(fmu, __func__, EVENT))
        return fmi3Error;
    return status_of(fmu, __func__, instance_enter_continuous_time(fmu->instance));
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    const Fmu *fmu = instance;
    int needed = 0;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused_exchange(fmu, __func__, CONTINUOUS_TIME) ||
        fmu_missing(fmu, __func__, 1, enterEventMode, terminateSimulation))
        return fmi3Error;
    instance_complete_step(fmu->instance, &needed);
    *enterEventMode = needed != 0;
    *terminateSimulation = false;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    const Fmu *fmu = instance;
    if (refused_exchange(fmu, __func__, EVENT | CONTINUOUS_TIME))
        return fmi3Error;
    return status_of(fmu, __func__, instance_set_time(fmu->instance, time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    const Fmu *fmu = instance;
    if (refused_exchange(fmu, __func__, CONTINUOUS_TIME) ||
        fmu_missing(fmu, __func__, nContinuousStates, continuousStates, continuousStates))
        return fmi3Error;
    return status_of(fmu, __func__, instance_set_states(fmu->instance, continuousStates, nContinuousStates));
}

#define GET_VECTOR(FUNCTION, PHASES, VALUES, COUNT)                                                                    \
    const Fmu *fmu = instance;                                                                                        \
    if (refused_exchange(fmu, __func__, PHASES) || fmu_missing(fmu, __func__, COUNT, VALUES, VALUES))                 \
        return fmi3Error;                                                                                             \
    return status_of(fmu, __func__, FUNCTION(fmu->instance, VALUES, COUNT))

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], size_t nContinuousStates)
{
    GET_VECTOR(instance_get_derivatives, READABLE, derivatives, nContinuousStates);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators)
{
    GET_VECTOR(instance_get_indicators, READABLE, eventIndicators, nEventIndicators);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    GET_VECTOR(instance_get_states, READABLE, continuousStates, nContinuousStates);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates)
{
    GET_VECTOR(instance_get_nominals, ANY_PHASE, nominals, nContinuousStates);
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *nEventIndicators)
{
    const Fmu *fmu = instance;
    if (refused_exchange(fmu, __func__, ANY_PHASE) || fmu_missing(fmu, __func__, 1, nEventIndicators, nEventIndicators))
        return fmi3Error;
    *nEventIndicators = (size_t)brunovsky_model.nz;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *nContinuousStates)
{
    const Fmu *fmu = instance;
    if (refused_exchange(fmu, __func__, ANY_PHASE) || fmu_missing(fmu, __func__, 1, nContinuousStates, nContinuousStates))
        return fmi3Error;
    *nContinuousStates = (size_t)brunovsky_model.nx;
    return fmi3OK;
}

/* Co-simulation ---------------------------------------------------------------------------------------------------- */

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    const Fmu *fmu = instance;
    if (fmu_refused_to(fmu, __func__, ONLY(CO_SIMULATION), EVENT))
        return fmi3Error;
    return status_of(fmu, __func__, instance_enter_step(fmu->instance));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    const Fmu *fmu = instance;
    Result result;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (fmu_refused_to(fmu, __func__, ONLY(CO_SIMULATION), STEP) ||
        fmu_missing(fmu, __func__, 1, eventHandlingNeeded, terminateSimulation) ||
        fmu_missing(fmu, __func__, 1, earlyReturn, lastSuccessfulTime))
        return fmi3Error;
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = false;
    result = instance_step(fmu->instance, currentCommunicationPoint, communicationStepSize);
    *lastSuccessfulTime = fmu->instance->engine->time;
    if (result == WARNED)
        return fail(fmu, __func__, fmu->instance->message);
    *eventHandlingNeeded = result == DONE && fmu->instance->engine->event_due;
    *earlyReturn = result == DONE && fmu->instance->engine->time < currentCommunicationPoint + communicationStepSize;
    return status_of(fmu, __func__, result);
}

/* Derivatives ------------------------------------------------------------------------------------------------------ */

#define STUB { return fmi3Error; }
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance i, fmi3ValueReference v, size_t *n) { (void)i;(void)v;(void)n; return fmi3Error; }
fmi3Status fmi3GetVariableDependencies(fmi3Instance i, fmi3ValueReference d, size_t e[], fmi3ValueReference v[], size_t f[], fmi3DependencyKind k[], size_t n) { (void)i;(void)d;(void)e;(void)v;(void)f;(void)k;(void)n; return fmi3Error; }
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance i, const fmi3ValueReference u[], size_t nu, const fmi3ValueReference k[], size_t nk, const fmi3Float64 s[], size_t ns, fmi3Float64 r[], size_t nr) { (void)i;(void)u;(void)nu;(void)k;(void)nk;(void)s;(void)ns;(void)r;(void)nr; return fmi3Error; }
fmi3Status fmi3GetAdjointDerivative(fmi3Instance i, const fmi3ValueReference u[], size_t nu, const fmi3ValueReference k[], size_t nk, const fmi3Float64 s[], size_t ns, fmi3Float64 r[], size_t nr) { (void)i;(void)u;(void)nu;(void)k;(void)nk;(void)s;(void)ns;(void)r;(void)nr; return fmi3Error; }
fmi3Status fmi3GetOutputDerivatives(fmi3Instance i, const fmi3ValueReference v[], size_t nv, const fmi3Int32 o[], fmi3Float64 r[], size_t n) { (void)i;(void)v;(void)nv;(void)o;(void)r;(void)n; return fmi3Error; }

