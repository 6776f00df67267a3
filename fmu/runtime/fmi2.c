/* FMI 2.0 for co-simulation and model exchange: an instance behind the functions of the standard.
 *
 * Decisions that the standard leaves open:
 * - An error leaves the instance as it was before the call, so that it can be corrected, reset or freed; there is no
 *   error state. A failed step is fmi2Error, not fmi2Discard, which makes some masters try again for ever.
 * - Outputs belong to the inputs set last. At a communication point and in event mode relations are evaluated with
 *   them; samples and transitions wait for the step or the event. In continuous-time mode relations are frozen.
 * - A communication step of zero length does nothing and is fmi2OK with a warning in the log.
 * - In event and continuous-time mode fmi2SetReal sets continuous states too, for masters that know no other way.
 * - fmi2SetupExperiment may be left out; the experiment then starts at 0 and has no end.
 * - Messages of warnings and errors are logged whatever the settings; the other categories only if they are switched on.
 */
#include "fmi2Functions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fmu.h"
#include "sensitivity.h"

const char *const TYPE_NAMES[] = {"Real", "Integer", "Boolean", "Enumeration", "Clock"};


/* The logger takes a format, so per cent signs are doubled. */
static void write_log(void *callback, void *environment, const char *name, int status, const char *category,
                      const char *text)
{
    const Logger *logger = callback;
    const fmi2CallbackLogger write = (fmi2CallbackLogger)logger->callback;
    char escaped[2048], *end = escaped;
    for (const char *one = text; *one; one++) {
        if (*one == '%')
            *end++ = '%';
        *end++ = *one;
    }
    *end = 0;
    write(environment, name, (fmi2Status)status, category, escaped);
}

static fmi2Status fail(const Fmu *fmu, const char *function, const char *problem)
{
    return (fmi2Status)fmu_fail(fmu, function, problem);
}

static fmi2Status status_of(const Fmu *fmu, const char *function, Result result)
{
    return (fmi2Status)fmu_status(fmu, function, result);
}

static int refused(const Fmu *fmu, const char *function, int phases)
{
    return fmu_refused(fmu, function, phases);
}

/* The same for a function that only model exchange has, in phases that co-simulation has too. */
static int refused_exchange(const Fmu *fmu, const char *function, int phases)
{
    return fmu_refused_to(fmu, function, 1 << MODEL_EXCHANGE, phases);
}

/* The same for a function that only co-simulation has. */
static int refused_simulation(const Fmu *fmu, const char *function, int phases)
{
    return fmu_refused_to(fmu, function, 1 << CO_SIMULATION, phases);
}

static int missing(const Fmu *fmu, const char *function, size_t count, const void *first, const void *second)
{
    return fmu_missing(fmu, function, count, first, second);
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[])
{
    return (fmi2Status)fmu_set_logging(c, __func__, loggingOn != fmi2False, nCategories, categories);
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    Logger logger = {write_log, NULL, NULL, instanceName};
    (void)fmuResourceLocation;
    (void)visible;
    if (!functions)
        return NULL;
    logger.callback = (void (*)(void))functions->logger;
    logger.environment = functions->componentEnvironment;
    if (fmuType != fmi2CoSimulation && fmuType != fmi2ModelExchange) {
        fmu_log(&logger, STATUS_ERROR, "logStatusError", "%s: the type is neither fmi2CoSimulation nor fmi2ModelExchange",
                __func__);
        return NULL;
    }
    return fmu_new(__func__, logger, fmuType == fmi2ModelExchange ? MODEL_EXCHANGE : CO_SIMULATION, fmuGUID,
                   loggingOn != fmi2False, LOG_WARNING | LOG_DISCARD);
}

void fmi2FreeInstance(fmi2Component c)
{
    fmu_free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, INSTANTIATED))
        return fmi2Error;
    return status_of(fmu, __func__, instance_set_up(fmu->instance, startTime, stopTimeDefined ? stopTime : HUGE_VAL,
                                               toleranceDefined ? tolerance : DEFAULT_TOLERANCE));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, INSTANTIATED))
        return fmi2Error;
    instance_enter_initialization(fmu->instance);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, INITIALIZATION))
        return fmi2Error;
    return status_of(fmu, __func__, instance_exit_initialization(fmu->instance));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return (fmi2Status)fmu_terminate(c, __func__);
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return (fmi2Status)fmu_reset(c, __func__);
}

/* Variables ------------------------------------------------------------------------------------------------------- */

#define GET(VALUE, TYPE)                                                                                              \
    Fmu *fmu = c;                                                                                                     \
    if (refused(fmu, __func__, READABLE) || missing(fmu, __func__, nvr, vr, value))                                   \
        return fmi2Error;                                                                                             \
    for (size_t i = 0; i < nvr; i++) {                                                                                \
        double number;                                                                                                \
        const Result result = instance_get(fmu->instance, TYPE, vr[i], &number);                                      \
        if (result != DONE)                                                                                           \
            return status_of(fmu, __func__, result);                                                                  \
        value[i] = (VALUE)number;                                                                                     \
    }                                                                                                                 \
    return fmi2OK

/* All values are checked before the first one is set. */
#define SET(TYPE, PHASES)                                                                                             \
    Fmu *fmu = c;                                                                                                     \
    if (refused(fmu, __func__, PHASES) || missing(fmu, __func__, nvr, vr, value))                                     \
        return fmi2Error;                                                                                             \
    for (size_t i = 0; i < nvr; i++) {                                                                                \
        const Result result = instance_admits(fmu->instance, TYPE, vr[i], value[i]);                                  \
        if (result != DONE)                                                                                           \
            return status_of(fmu, __func__, result);                                                                  \
    }                                                                                                                 \
    for (size_t i = 0; i < nvr; i++)                                                                                  \
        instance_set(fmu->instance, vr[i], value[i]);                                                                 \
    return fmi2OK

#define SETTABLE (INSTANTIATED | INITIALIZATION | STEP | EVENT)

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    GET(fmi2Real, REAL);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[])
{
    GET(fmi2Integer, INTEGER | ENUMERATION);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    GET(fmi2Boolean, BOOLEAN);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    const Fmu *fmu = c;
    (void)vr;
    (void)value;
    if (refused(fmu, __func__, READABLE))
        return fmi2Error;
    return nvr ? fail(fmu, __func__, "there are no variables of type String") : fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    SET(REAL, SETTABLE | CONTINUOUS_TIME);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[])
{
    SET(INTEGER | ENUMERATION, SETTABLE);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[])
{
    SET(BOOLEAN, SETTABLE);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    const Fmu *fmu = c;
    (void)vr;
    (void)value;
    if (refused(fmu, __func__, SETTABLE))
        return fmi2Error;
    return nvr ? fail(fmu, __func__, "there are no variables of type String") : fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
                                        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, READABLE) || missing(fmu, __func__, nUnknown, vUnknown_ref, dvUnknown) ||
        missing(fmu, __func__, nKnown, vKnown_ref, dvKnown))
        return fmi2Error;
    return status_of(fmu, __func__,
                     instance_directional(fmu->instance, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown));
}

/* State of the FMU ------------------------------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return (fmi2Status)fmu_get_state(c, __func__, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return (fmi2Status)fmu_set_state(c, __func__, FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return (fmi2Status)fmu_free_state(c, __func__, FMUstate);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    return (fmi2Status)fmu_state_size(c, __func__, FMUstate, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    return (fmi2Status)fmu_serialize(c, __func__, FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    return (fmi2Status)fmu_deserialize(c, __func__, serializedState, size, FMUstate);
}

/* Model exchange -------------------------------------------------------------------------------------------------- */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, EVENT | CONTINUOUS_TIME))
        return fmi2Error;
    instance_enter_event(fmu->instance);
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    Fmu *fmu = c;
    Event event;
    int status;
    if (refused(fmu, __func__, EVENT) || missing(fmu, __func__, 1, info, info))
        return fmi2Error;
    status = fmu_event(fmu, __func__, &event);
    if (status != STATUS_OK)
        return (fmi2Status)status;
    info->newDiscreteStatesNeeded = fmi2False;
    info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = event.states_changed ? fmi2True : fmi2False;
    info->nextEventTimeDefined = event.next < HUGE_VAL ? fmi2True : fmi2False;
    info->nextEventTime = event.next < HUGE_VAL ? event.next : 0;
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, EVENT))
        return fmi2Error;
    return status_of(fmu, __func__, instance_enter_continuous_time(fmu->instance));
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
    Fmu *fmu = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused(fmu, __func__, CONTINUOUS_TIME) || missing(fmu, __func__, 1, enterEventMode, terminateSimulation))
        return fmi2Error;
    *enterEventMode = instance_complete_step(fmu->instance) ? fmi2True : fmi2False;
    *terminateSimulation = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, EVENT | CONTINUOUS_TIME))
        return fmi2Error;
    return status_of(fmu, __func__, instance_set_time(fmu->instance, time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, CONTINUOUS_TIME) || missing(fmu, __func__, nx, x, x))
        return fmi2Error;
    return status_of(fmu, __func__, instance_set_states(fmu->instance, x, nx));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx)
{
    Fmu *fmu = c;
    if (refused_exchange(fmu, __func__, READABLE) || missing(fmu, __func__, nx, derivatives, derivatives))
        return fmi2Error;
    return status_of(fmu, __func__, instance_get_derivatives(fmu->instance, derivatives, nx));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni)
{
    Fmu *fmu = c;
    if (refused_exchange(fmu, __func__, READABLE) || missing(fmu, __func__, ni, eventIndicators, eventIndicators))
        return fmi2Error;
    return status_of(fmu, __func__, instance_get_indicators(fmu->instance, eventIndicators, ni));
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx)
{
    Fmu *fmu = c;
    if (refused_exchange(fmu, __func__, READABLE) || missing(fmu, __func__, nx, x, x))
        return fmi2Error;
    return status_of(fmu, __func__, instance_get_states(fmu->instance, x, nx));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx)
{
    Fmu *fmu = c;
    if (refused_exchange(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, nx, x_nominal, x_nominal))
        return fmi2Error;
    return status_of(fmu, __func__, instance_get_nominals(fmu->instance, x_nominal, nx));
}

/* Co-simulation --------------------------------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    Fmu *fmu = c;
    Result result;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused(fmu, __func__, STEP))
        return fmi2Error;
    result = instance_step(fmu->instance, currentCommunicationPoint, communicationStepSize);
    fmu->last_step = fmu_status(fmu, __func__, result == DISCARDED ? FAILED : result);
    return (fmi2Status)fmu->last_step;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, STEP))
        return fmi2Error;
    return fail(fmu, __func__, "there is no step to cancel: steps are never asynchronous");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, INSTANTIATED | INITIALIZATION | STEP) || missing(fmu, __func__, nvr, vr, value) ||
        missing(fmu, __func__, nvr, order, order))
        return fmi2Error;
    for (size_t i = 0; i < nvr; i++) {
        const Result result = instance_admits_input_derivative(fmu->instance, vr[i], order[i], value[i]);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
    for (size_t i = 0; i < nvr; i++)
        instance_set_input_derivative(fmu->instance, vr[i], order[i], value[i]);
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                        fmi2Real value[])
{
    Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, STEP | TERMINATED) ||
        missing(fmu, __func__, nvr, vr, value) || missing(fmu, __func__, nvr, order, order))
        return fmi2Error;
    for (size_t i = 0; i < nvr; i++) {
        const Result result = instance_get_output_derivative(fmu->instance, vr[i], order[i], &value[i]);
        if (result != DONE)
            return status_of(fmu, __func__, result);
    }
    return fmi2OK;
}

#define STATUS_PHASES (STEP | TERMINATED)

/* A status that there is none of is discarded, so says the standard. */
static fmi2Status unavailable(const Fmu *fmu, const char *function, const char *problem)
{
    return status_of(fmu, function, instance_report(fmu->instance, DISCARDED, "%s", problem));
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    const Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2DoStepStatus)
        return unavailable(fmu, __func__, "only fmi2DoStepStatus is a status");
    *value = (fmi2Status)fmu->last_step;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    const Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2LastSuccessfulTime)
        return unavailable(fmu, __func__, "only fmi2LastSuccessfulTime is a Real status");
    *value = fmu->instance->engine->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    const Fmu *fmu = c;
    (void)s;
    (void)value;
    if (refused_simulation(fmu, __func__, STATUS_PHASES))
        return fmi2Error;
    return unavailable(fmu, __func__, "there is no Integer status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    const Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2Terminated)
        return unavailable(fmu, __func__, "only fmi2Terminated is a Boolean status");
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    const Fmu *fmu = c;
    if (refused_simulation(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2PendingStatus)
        return unavailable(fmu, __func__, "only fmi2PendingStatus is a String status");
    *value = "";
    return fmi2OK;
}
