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
 * - Messages of warnings and errors are logged whatever the settings; "logEvents" only if it is switched on.
 */
#include "fmi2Functions.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"
#include "sensitivity.h"

typedef struct {
    Instance *instance;
    char *name;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    int log_events;
    fmi2Status last_step;
} Fmu;

static const char *const CATEGORIES[] = {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError", "logAll"};

/* Log ------------------------------------------------------------------------------------------------------------- */

/* The logger takes a format, so per cent signs are doubled. */
static void write_log(fmi2CallbackLogger logger, fmi2ComponentEnvironment environment, const char *name, fmi2Status status,
                      const char *category, const char *format, ...)
{
    char text[1024], escaped[2048], *end = escaped;
    va_list arguments;
    if (!logger)
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (const char *one = text; *one; one++) {
        if (*one == '%')
            *end++ = '%';
        *end++ = *one;
    }
    *end = 0;
    logger(environment, name, status, category, escaped);
}

static fmi2Status fail(const Fmu *fmu, const char *function, const char *problem)
{
    write_log(fmu->logger, fmu->environment, fmu->name, fmi2Error, "logStatusError", "%s: %s", function, problem);
    return fmi2Error;
}

/* Status of a result, its message logged. */
static fmi2Status status_of(const Fmu *fmu, const char *function, Result result)
{
    const char *message = fmu->instance->message;
    switch (result) {
    case DONE: return fmi2OK;
    case WARNED:
        write_log(fmu->logger, fmu->environment, fmu->name, fmi2Warning, "logStatusWarning", "%s: %s", function, message);
        return fmi2OK;
    case DISCARDED:
        write_log(fmu->logger, fmu->environment, fmu->name, fmi2Discard, "logStatusDiscard", "%s: %s", function, message);
        return fmi2Discard;
    default: return fail(fmu, function, message);
    }
}

/* Whether a call is refused in the present phase; a message that names the function and the phase is logged. */
static int refused(const Fmu *fmu, const char *function, int phases)
{
    Result result;
    if (!fmu)
        return 1;
    result = instance_permits(fmu->instance, phases);
    if (result != DONE)
        write_log(fmu->logger, fmu->environment, fmu->name, fmi2Error, "logStatusError", "%s %s", function,
                  fmu->instance->message);
    return result != DONE;
}

/* The same for a function that only model exchange has, in phases that co-simulation has too. */
static int refused_exchange(const Fmu *fmu, const char *function, int phases)
{
    if (fmu && !fmu->instance->model_exchange)
        phases = 0;
    return refused(fmu, function, phases);
}

static int missing(const Fmu *fmu, const char *function, size_t count, const void *first, const void *second)
{
    if (!count || (first && second))
        return 0;
    fail(fmu, function, "an argument is a null pointer");
    return 1;
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
    const size_t known = sizeof CATEGORIES / sizeof *CATEGORIES;
    Fmu *fmu = c;
    int events = nCategories == 0;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, nCategories, categories, categories))
        return fmi2Error;
    for (size_t i = 0; i < nCategories; i++) {
        size_t k = 0;
        while (k < known && categories[i] && strcmp(categories[i], CATEGORIES[k]) != 0)
            k++;
        if (k == known || !categories[i]) {
            write_log(fmu->logger, fmu->environment, fmu->name, fmi2Error, "logStatusError",
                      "%s: there is no log category '%s'", __func__, categories[i] ? categories[i] : "NULL");
            return fmi2Error;
        }
        events = events || k == 0 || k == known - 1;
    }
    if (events)
        fmu->log_events = loggingOn != fmi2False;
    return fmi2OK;
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

static void release(Fmu *fmu)
{
    if (!fmu)
        return;
    instance_free(fmu->instance);
    free(fmu->name);
    free(fmu);
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    const fmi2CallbackLogger logger = functions ? functions->logger : NULL;
    const fmi2ComponentEnvironment environment = functions ? functions->componentEnvironment : NULL;
    const char *problem = NULL, *name = instanceName && *instanceName ? instanceName : "?";
    Fmu *fmu;
    (void)fmuResourceLocation;
    (void)visible;
    if (!functions)
        problem = "the callback functions are a null pointer";
    else if (!instanceName || !*instanceName)
        problem = "the instance has no name";
    else if (fmuType != fmi2CoSimulation && fmuType != fmi2ModelExchange)
        problem = "the type is neither fmi2CoSimulation nor fmi2ModelExchange";
    if (problem) {
        write_log(logger, environment, name, fmi2Error, "logStatusError", "%s: %s", __func__, problem);
        return NULL;
    }
    if (!fmuGUID || strcmp(fmuGUID, brunovsky_description.token) != 0) {
        write_log(logger, environment, name, fmi2Error, "logStatusError",
                  "%s: the guid is %s, but this binary has %s; do not mix files of different FMUs", __func__,
                  fmuGUID ? fmuGUID : "a null pointer", brunovsky_description.token);
        return NULL;
    }
    fmu = calloc(1, sizeof *fmu);
    if (fmu) {
        fmu->name = malloc(strlen(instanceName) + 1);
        fmu->instance = instance_new(fmuType == fmi2ModelExchange);
    }
    if (!fmu || !fmu->name || !fmu->instance) {
        release(fmu);
        write_log(logger, environment, name, fmi2Error, "logStatusError", "%s: out of memory", __func__);
        return NULL;
    }
    strcpy(fmu->name, instanceName);
    fmu->logger = logger;
    fmu->environment = environment;
    fmu->log_events = loggingOn != fmi2False;
    return fmu;
}

void fmi2FreeInstance(fmi2Component c)
{
    release(c);
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
    Fmu *fmu = c;
    if (refused(fmu, __func__, STEP | EVENT | CONTINUOUS_TIME))
        return fmi2Error;
    fmu->instance->phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE))
        return fmi2Error;
    instance_reset(fmu->instance);
    fmu->last_step = fmi2OK;
    return fmi2OK;
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
    GET(fmi2Integer, INTEGER);
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
    SET(INTEGER, SETTABLE);
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
    const Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, 1, FMUstate, FMUstate))
        return fmi2Error;
    if (!*FMUstate)
        *FMUstate = malloc(instance_state_size(fmu->instance));
    if (!*FMUstate)
        return fail(fmu, __func__, "out of memory");
    instance_save(fmu->instance, *FMUstate);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, 1, FMUstate, FMUstate))
        return fmi2Error;
    return status_of(fmu, __func__, instance_restore(fmu->instance, FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE))
        return fmi2Error;
    if (FMUstate) {
        free(*FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, 1, FMUstate, size))
        return fmi2Error;
    *size = instance_state_size(fmu->instance);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    Fmu *fmu = c;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, 1, FMUstate, serializedState))
        return fmi2Error;
    if (size < instance_state_size(fmu->instance))
        return fail(fmu, __func__, "the buffer is smaller than fmi2SerializedFMUstateSize says");
    memcpy(serializedState, FMUstate, instance_state_size(fmu->instance));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    Fmu *fmu = c;
    Result result;
    if (refused(fmu, __func__, ANY_PHASE) || missing(fmu, __func__, 1, serializedState, FMUstate))
        return fmi2Error;
    result = instance_recognizes(fmu->instance, serializedState, size);
    if (result != DONE)
        return status_of(fmu, __func__, result);
    if (!*FMUstate)
        *FMUstate = malloc(size);
    if (!*FMUstate)
        return fail(fmu, __func__, "out of memory");
    memcpy(*FMUstate, serializedState, size);
    return fmi2OK;
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
    Result result;
    if (refused(fmu, __func__, EVENT) || missing(fmu, __func__, 1, info, info))
        return fmi2Error;
    result = instance_event(fmu->instance, &event);
    if (result != DONE)
        return status_of(fmu, __func__, result);
    if (fmu->log_events && (event.states_changed || event.discrete_changed))
        write_log(fmu->logger, fmu->environment, fmu->name, fmi2OK, "logEvents", "event at t = %.9g s changed%s%s",
                  fmu->instance->engine->time, event.states_changed ? " continuous states" : "",
                  event.discrete_changed ? " samples or modes" : "");
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
    int needed = 0;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused(fmu, __func__, CONTINUOUS_TIME) || missing(fmu, __func__, 1, enterEventMode, terminateSimulation))
        return fmi2Error;
    instance_complete_step(fmu->instance, &needed);
    *enterEventMode = needed ? fmi2True : fmi2False;
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
    if (nx != (size_t)fmu->instance->engine->model->nx)
        return fail(fmu, __func__, "the number of continuous states is another one");
    for (size_t i = 0; i < nx; i++)
        x_nominal[i] = fmu->instance->engine->model->x_nominal[i];
    return fmi2OK;
}

/* Co-simulation --------------------------------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    Fmu *fmu = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (refused(fmu, __func__, STEP))
        return fmi2Error;
    fmu->last_step = status_of(fmu, __func__, instance_step(fmu->instance, currentCommunicationPoint, communicationStepSize));
    return fmu->last_step;
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
    const Fmu *fmu = c;
    (void)vr;
    (void)order;
    (void)value;
    if (refused(fmu, __func__, INSTANTIATED | INITIALIZATION | STEP))
        return fmi2Error;
    return nvr ? fail(fmu, __func__, "inputs are held over a step, not interpolated (canInterpolateInputs is false)") : fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                        fmi2Real value[])
{
    const Fmu *fmu = c;
    (void)vr;
    (void)order;
    (void)value;
    if (refused(fmu, __func__, STEP | TERMINATED))
        return fmi2Error;
    return nvr ? fail(fmu, __func__, "derivatives of outputs are not provided (maxOutputDerivativeOrder is 0)") : fmi2OK;
}

#define STATUS_PHASES (STEP | TERMINATED)

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2DoStepStatus)
        return fail(fmu, __func__, "only fmi2DoStepStatus is a status");
    *value = fmu->last_step;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2LastSuccessfulTime)
        return fail(fmu, __func__, "only fmi2LastSuccessfulTime is a Real status");
    *value = fmu->instance->engine->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    const Fmu *fmu = c;
    (void)s;
    (void)value;
    if (refused(fmu, __func__, STATUS_PHASES))
        return fmi2Error;
    return fail(fmu, __func__, "there is no Integer status");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2Terminated)
        return fail(fmu, __func__, "only fmi2Terminated is a Boolean status");
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    const Fmu *fmu = c;
    if (refused(fmu, __func__, STATUS_PHASES) || missing(fmu, __func__, 1, value, value))
        return fmi2Error;
    if (s != fmi2PendingStatus)
        return fail(fmu, __func__, "only fmi2PendingStatus is a String status");
    *value = "";
    return fmi2OK;
}
