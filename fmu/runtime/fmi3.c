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
 *   final. Clocked variables may be read and set at any time: samples keep their values between ticks, outputs made of
 *   inputs follow these.
 * - In event and continuous-time mode of model exchange fmi3SetFloat64 sets continuous states too, for masters that know
 *   no other way.
 * - Errors are logged whatever the settings, everything else only if it is switched on.
 */
#include "fmi3.h"

#include <math.h>

const char *const TYPE_NAMES[] = {"Float64", "Int32", "Boolean", "Enumeration", "Clock"};

static void write_log(void *callback, void *environment, const char *name, int status, const char *category,
                      const char *text)
{
    const Logger *logger = callback;
    (void)name;
    ((fmi3LogMessageCallback)logger->callback)(environment, (fmi3Status)status, category, text);
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
    instance_use_events(fmu->instance, eventModeUsed, earlyReturnAllowed);
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
    Fmu *fmu;
    (void)resourcePath;
    (void)visible;
    (void)clockUpdate;
    fmu = instantiate(__func__, SCHEDULED_EXECUTION, instanceName, instantiationToken, loggingOn, instanceEnvironment,
                      logMessage);
    if (fmu && lockPreemption && unlockPreemption) {
        fmu->lock = lockPreemption;
        fmu->unlock = unlockPreemption;
    }
    return fmu;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    const Fmu *fmu = instance;
    if (fmu && !fmu_refused(fmu, __func__, ANY_PHASE & ~INTERMEDIATE)) /* the step under way needs it */
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
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused_exchange(fmu, __func__, CONTINUOUS_TIME) ||
        fmu_missing(fmu, __func__, 1, enterEventMode, terminateSimulation))
        return fmi3Error;
    *enterEventMode = instance_complete_step(fmu->instance) != 0;
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
