/* Random calls of the FMI 2.0 functions for the life cycle and stepping; where the standard allows each function. */
#include <math.h>
#include <string.h>

#include "interface.h"

/* Life cycle ------------------------------------------------------------------------------------------------------- */

static int set_up(Subject *subject)
{
    const double start = chance(95) ? uniform(-1, 1) : odd_number(), stop = chance(95) ? start + 10 : odd_number();
    const double tolerance = chance(70) ? 1e-6 : odd_number();
    const int has_stop = chance(50);
    must_fail = !isfinite(start) || (has_stop && !(stop >= start));
    return (int)fmi2SetupExperiment(subject->component, chance(50), tolerance, start, has_stop, stop);
}

static int enter_initialization(Subject *subject)
{
    return moved(subject, fmi2EnterInitializationMode(subject->component), INITIALIZATION);
}

static int exit_initialization(Subject *subject)
{
    return moved(subject, fmi2ExitInitializationMode(subject->component), subject->kind == MODEL_EXCHANGE ? EVENT : STEP);
}

static int terminate(Subject *subject)
{
    return moved(subject, fmi2Terminate(subject->component), TERMINATED);
}

static int debug_logging(Subject *subject)
{
    const fmi2String names[] = {"logEvents", "logStatusWarning", "logStatusError", "logAll", "logNothing", "", NULL};
    fmi2String chosen[2];
    const size_t count = draw(3);
    const int null = chance(3);
    must_fail = null && count;
    for (size_t i = 0; i < count; i++) {
        const unsigned which = chance(90) ? draw(4) : draw(7);
        chosen[i] = names[which];
        must_fail |= which > 3;
    }
    return (int)fmi2SetDebugLogging(subject->component, chance(50), count, null ? NULL : chosen);
}

/* Co-simulation ---------------------------------------------------------------------------------------------------- */

static int do_step(Subject *subject)
{
    const double now = real(subject, TIME), substep = real(subject, STEP_SIZE);
    double time = now, length = fmin(substep, 0.01) * uniform(0, 12);
    int status;
    if (chance(3))
        time = now + (chance(50) ? 1 : -0.5);
    if (chance(4))
        length = odd_number();
    if (chance(1))
        time = odd_number();
    must_fail = !isfinite(time) || !isfinite(length) || length < 0 ||
                (fabs(time - now) > 0.1 && substep < 1 && length < 1 && fabs(now) < 1e6);
    status = (int)fmi2DoStep(subject->component, time, length, chance(50));
    if (!must_fail && length == 0 && time == now && subject->phase == STEP && subject->component) {
        EXPECT(status == OK && subject->logged[WARNING] == 1, "a step of zero length has status %d", status);
        EXPECT(real(subject, TIME) == now, "a step of zero length moves");
    } else if (status == OK && length > 0) {
        EXPECT(fabs(real(subject, TIME) - (time + length)) <= 1e-12 * fabs(time + length), "a step ends elsewhere");
    }
    return status;
}

static int cancel(Subject *subject)
{
    must_fail = 1; /* there is never a step to cancel */
    return (int)fmi2CancelStep(subject->component);
}

static int statuses(Subject *subject)
{
    const fmi2StatusKind kind = (fmi2StatusKind)draw(5);
    const int null = chance(5);
    fmi2Status status = fmi2Fatal;
    fmi2Real time = NAN;
    fmi2Boolean boolean = 7;
    fmi2String text = NULL;
    int result;
    switch (draw(4)) {
    case 0:
        must_fail = kind != fmi2DoStepStatus || null;
        result = (int)fmi2GetStatus(subject->component, kind, null ? NULL : &status);
        EXPECT(result != OK || status == fmi2OK || status == fmi2Error || status == fmi2Discard, "a status of %d", status);
        return result;
    case 1:
        must_fail = kind != fmi2LastSuccessfulTime || null;
        result = (int)fmi2GetRealStatus(subject->component, kind, null ? NULL : &time);
        EXPECT(result != OK || isfinite(time), "a time of %g", time);
        return result;
    case 2:
        must_fail = kind != fmi2Terminated || null;
        result = (int)fmi2GetBooleanStatus(subject->component, kind, null ? NULL : &boolean);
        EXPECT(result != OK || boolean == 0 || boolean == 1, "a Boolean of %d", boolean);
        return result;
    default:
        must_fail = kind != fmi2PendingStatus || null;
        result = (int)fmi2GetStringStatus(subject->component, kind, null ? NULL : &text);
        EXPECT(result != OK || text, "no text");
        return result;
    }
}

static int integer_status(Subject *subject)
{
    fmi2Integer value;
    must_fail = 1; /* there is none */
    return (int)fmi2GetIntegerStatus(subject->component, fmi2DoStepStatus, &value);
}

static int set_input_derivatives(Subject *subject)
{
    const unsigned count = draw(3), beyond = FIRST_INPUT + (unsigned)brunovsky_model.nu;
    unsigned references[2];
    fmi2Integer orders[2];
    fmi2Real values[2];
    const int null = chance(2) && count;
    must_fail = null;
    for (unsigned i = 0; i < count; i++) {
        references[i] = chance(95) && brunovsky_model.nu ? FIRST_INPUT + draw((unsigned)brunovsky_model.nu) : draw(BEYOND);
        orders[i] = chance(95) ? 1 : (int)draw(5) - 2;
        values[i] = chance(95) ? uniform(-1, 1) : odd_number();
        must_fail |= references[i] < FIRST_INPUT || references[i] >= beyond || orders[i] < 1 || !isfinite(values[i]);
    }
    return (int)fmi2SetRealInputDerivatives(subject->component, references, count, null ? NULL : orders, values);
}

/* A type that no variable has. */
static int get_string(Subject *subject)
{
    const fmi2ValueReference reference = draw(VARIABLES);
    fmi2String value = NULL;
    const size_t count = draw(2);
    must_fail = count > 0;
    return (int)fmi2GetString(subject->component, &reference, count, &value);
}

static int set_string(Subject *subject)
{
    const fmi2ValueReference reference = draw(VARIABLES);
    const fmi2String value = "text";
    const size_t count = draw(2);
    must_fail = count > 0;
    return (int)fmi2SetString(subject->component, &reference, count, &value);
}

/* Model exchange --------------------------------------------------------------------------------------------------- */

static int enter_event(Subject *subject)
{
    return moved(subject, fmi2EnterEventMode(subject->component), EVENT);
}

static int enter_continuous(Subject *subject)
{
    return moved(subject, fmi2EnterContinuousTimeMode(subject->component), CONTINUOUS);
}

static int new_discrete_states(Subject *subject)
{
    const int null = chance(2);
    fmi2EventInfo info;
    int status;
    memset(&info, 0x55, sizeof info);
    must_fail = null;
    status = (int)fmi2NewDiscreteStates(subject->component, null ? NULL : &info);
    if (status == OK) {
        EXPECT(!info.newDiscreteStatesNeeded && !info.terminateSimulation && !info.nominalsOfContinuousStatesChanged &&
                   (info.valuesOfContinuousStatesChanged | 1) == 1 && (info.nextEventTimeDefined | 1) == 1,
               "what an event says is no Boolean");
        EXPECT(!info.nextEventTimeDefined || isfinite(info.nextEventTime), "the next event is at %g", info.nextEventTime);
    }
    return status;
}

/* The standard's tables of allowed calls (FMI 2.0, 3.2.3 and 4.2.4). --------------------------------------------- */

#define SET (INSTANTIATED | INITIALIZATION)
#define RUN (INITIALIZATION | EVENT | CONTINUOUS | TERMINATED)
#define READ {INITIALIZATION | STEP | TERMINATED, RUN}

const Operation operations[] = {
    {"fmi2SetupExperiment", {INSTANTIATED, INSTANTIATED}, 20, REPEATABLE, set_up},
    {"fmi2EnterInitializationMode", {INSTANTIATED, INSTANTIATED}, 60, 0, enter_initialization},
    {"fmi2ExitInitializationMode", {INITIALIZATION, INITIALIZATION}, 60, 0, exit_initialization},
    {"fmi2Terminate", {STEP, EVENT | CONTINUOUS}, 1, 0, terminate},
    {"fmi2Reset", {ALWAYS, ALWAYS}, 1, 0, subject_reset},
    {"fmi2SetDebugLogging", {ALWAYS, ALWAYS}, 1, 0, debug_logging},
    {"fmi2GetReal", READ, 20, REPEATABLE, get_real},
    {"fmi2GetInteger", READ, 4, REPEATABLE, get_integer},
    {"fmi2GetBoolean", READ, 4, REPEATABLE, get_boolean},
    {"fmi2GetString", READ, 1, REPEATABLE, get_string},
    {"fmi2SetReal", {SET | STEP, SET | EVENT | CONTINUOUS}, 24, REPEATABLE, set_real},
    {"fmi2SetInteger", {SET | STEP, SET | EVENT}, 4, REPEATABLE, set_integer},
    {"fmi2SetBoolean", {SET | STEP, SET | EVENT}, 1, REPEATABLE, set_boolean},
    {"fmi2SetString", {SET | STEP, SET | EVENT}, 1, REPEATABLE, set_string},
    {"fmi2GetDirectionalDerivative", READ, 6, REPEATABLE, directional},
    {"fmi2GetFMUstate", {ALWAYS, ALWAYS}, 5, ALLOCATES, get_state},
    {"fmi2SetFMUstate", {ALWAYS, ALWAYS}, 3, 0, set_state},
    {"fmi2FreeFMUstate", {ALWAYS, ALWAYS}, 1, 0, free_state},
    {"fmi2SerializedFMUstateSize", {ALWAYS, ALWAYS}, 5, 0, serialize},
    {"fmi2DeSerializeFMUstate", {ALWAYS, ALWAYS}, 8, ALLOCATES, deserialize},
    {"fmi2DoStep", {STEP, 0}, 50, REPEATABLE, do_step},
    {"fmi2CancelStep", {STEP, 0}, 1, REPEATABLE, cancel},
    {"fmi2SetRealInputDerivatives", {SET | STEP, 0}, 6, REPEATABLE, set_input_derivatives},
    {"fmi2GetRealOutputDerivatives", {STEP | TERMINATED, 0}, 6, REPEATABLE, get_output_derivatives},
    {"Status", {STEP | TERMINATED, 0}, 3, REPEATABLE, statuses},
    {"fmi2GetIntegerStatus", {STEP | TERMINATED, 0}, 1, REPEATABLE, integer_status},
    {"fmi2EnterEventMode", {0, EVENT | CONTINUOUS}, 8, 0, enter_event},
    {"fmi2NewDiscreteStates", {0, EVENT}, 20, REPEATABLE, new_discrete_states},
    {"fmi2EnterContinuousTimeMode", {0, EVENT}, 20, 0, enter_continuous},
    {"fmi2CompletedIntegratorStep", {0, CONTINUOUS}, 20, REPEATABLE, completed_step},
    {"fmi2SetTime", {0, EVENT | CONTINUOUS}, 20, REPEATABLE, set_time},
    {"fmi2SetContinuousStates", {0, CONTINUOUS}, 20, REPEATABLE, set_states},
    {"fmi2GetContinuousStates", {0, RUN}, 8, REPEATABLE, get_states},
    {"fmi2GetDerivatives", {0, RUN}, 8, REPEATABLE, get_derivatives},
    {"fmi2GetEventIndicators", {0, RUN}, 8, REPEATABLE, get_indicators},
    {"fmi2GetNominalsOfContinuousStates", {0, ALWAYS}, 2, REPEATABLE, get_nominals},
};
const int operation_count = sizeof operations / sizeof *operations;
