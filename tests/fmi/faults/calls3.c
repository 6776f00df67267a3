/* Random calls of the FMI 3.0 functions for the life cycle and stepping; where the standard allows each function. */
#include "calls3.h"

#include <math.h>

static int meddling; /* whether the master makes random calls during steps */

/* Life cycle ------------------------------------------------------------------------------------------------------- */

static int enter_initialization(Subject *subject)
{
    const double start = chance(95) ? uniform(-1, 1) : odd_number(), stop = chance(95) ? start + 10 : odd_number();
    const double tolerance = chance(70) ? 1e-6 : odd_number();
    const int has_stop = chance(50);
    must_fail = !isfinite(start) || (has_stop && !(stop >= start));
    return moved(subject, fmi3EnterInitializationMode(subject->component, chance(50), tolerance, start, has_stop, stop),
                 INITIALIZATION);
}

static int exit_initialization(Subject *subject)
{
    const int phases[] = {STEP, EVENT, EVENT, EVENT, ACTIVATION};
    return moved(subject, fmi3ExitInitializationMode(subject->component), phases[subject->kind]);
}

static int terminate(Subject *subject)
{
    return moved(subject, fmi3Terminate(subject->component), TERMINATED);
}

static int debug_logging(Subject *subject)
{
    const fmi3String names[] = {"logEvents", "logStatusWarning", "logStatusError", "logAll", "logSingularity", "", NULL};
    fmi3String chosen[2];
    const size_t count = draw(3);
    const int null = chance(3);
    must_fail = null && count;
    for (size_t i = 0; i < count; i++) {
        const unsigned which = chance(90) ? draw(5) : draw(7);
        chosen[i] = names[which];
        must_fail |= which > 4;
    }
    return (int)fmi3SetDebugLogging(subject->component, chance(50), count, null ? NULL : chosen);
}

/* Co-simulation ---------------------------------------------------------------------------------------------------- */

/* A call in the middle of a step; the log and what is expected of the step itself are kept. */
static void nested(Subject *subject)
{
    const unsigned most = chance(60) ? 2 : (unsigned)operation_count; /* the first two read and set values */
    const Operation *operation = &operations[draw(most)];
    const int allowed = (operation->phases[subject->kind] & WITHIN_STEP) != 0, expected = must_fail;
    const char *outer = doing;
    Subject before = *subject;
    int status;
    doing = operation->name;
    subject->must_name = operation->name;
    subject->phase = WITHIN_STEP;
    clear_log(subject);
    must_fail = 0;
    status = operation->call(subject);
    check_log(subject, status);
    EXPECT(allowed || status == ERROR, "status %d within a step", status);
    EXPECT(!must_fail || status >= DISCARD, "status %d for arguments that are illegal, within a step", status);
    EXPECT(subject->phase == WITHIN_STEP, "another phase within a step");
    *subject = before;
    must_fail = expected;
    doing = outer;
}

void within_step(Subject *subject, double time, int can_return, fmi3Boolean *early, fmi3Float64 *early_time)
{
    const int was_meddling = meddling;
    if (!meddling)
        return;
    EXPECT(isfinite(time), "an intermediate update at t = %g", time);
    for (unsigned i = draw(3); i; i--)
        nested(subject);
    meddling = was_meddling;
    if (!chance(5))
        return;
    *early = true; /* also where that is not allowed */
    *early_time = chance(70) ? time + uniform(0, 0.003) : odd_number();
    (void)can_return;
}

static int do_step(Subject *subject)
{
    const double now = real(subject, TIME), substep = real(subject, STEP_SIZE);
    double time = now, length = fmin(substep, 0.01) * uniform(0, 12), last = NAN;
    fmi3Boolean event = true, stop = true, early = true;
    const int null = chance(1);
    int status;
    if (chance(3))
        time = now + (chance(50) ? 1 : -0.5);
    if (chance(4))
        length = odd_number();
    if (chance(1))
        time = odd_number();
    must_fail = null || !isfinite(time) || !isfinite(length) || length <= 0 ||
                (fabs(time - now) > 0.1 && substep < 1 && length < 1 && fabs(now) < 1e6);
    meddling = subject->phase != WITHIN_STEP;
    status = (int)fmi3DoStep(subject->component, time, length, chance(50), &event, null ? NULL : &stop, &early, &last);
    meddling = 0;
    if (subject->phase != STEP || status == ERROR)
        return status;
    EXPECT(!stop && last == real(subject, TIME), "a step ends at %g", last);
    if (status == DISCARD)
        EXPECT(last == now && !event && !early, "a step that failed ends at %g", last);
    else if (early)
        EXPECT(last >= time && last <= time + length, "a step ends early at %g", last);
    else
        EXPECT(fabs(last - (time + length)) <= 1e-12 * fabs(time + length), "a step ends at %g", last);
    EXPECT(!event || subject->kind == EVENT_MODE || subject->kind == EARLY_RETURN, "an event without event mode");
    return status;
}

static int enter_step(Subject *subject)
{
    return moved(subject, fmi3EnterStepMode(subject->component), STEP);
}

/* Events ----------------------------------------------------------------------------------------------------------- */

static int enter_event(Subject *subject)
{
    return moved(subject, fmi3EnterEventMode(subject->component), EVENT);
}

static int enter_continuous(Subject *subject)
{
    return moved(subject, fmi3EnterContinuousTimeMode(subject->component), CONTINUOUS);
}

static int evaluate(Subject *subject)
{
    return (int)fmi3EvaluateDiscreteStates(subject->component);
}

static int update(Subject *subject)
{
    fmi3Boolean again = true, stop = true, nominals = true, states = true, defined = true;
    double next = NAN;
    int status;
    must_fail = chance(2);
    status = (int)fmi3UpdateDiscreteStates(subject->component, &again, &stop, must_fail ? NULL : &nominals, &states, &defined,
                                           &next);
    EXPECT(status != OK || (!again && !stop && !nominals && (!defined || isfinite(next))), "the next event is at %g", next);
    return status;
}

static int numbers(Subject *subject)
{
    size_t states = 99999, indicators = 99999;
    const int status = (int)fmi3GetNumberOfContinuousStates(subject->component, &states);
    if (status != OK)
        return status;
    EXPECT(states == (size_t)brunovsky_model.nx, "%d states", (int)states);
    must_fail = chance(5);
    return (int)fmi3GetNumberOfEventIndicators(subject->component, must_fail ? NULL : &indicators);
}

/* The standard's state machines (FMI 3.0, 2.3, 3.2, 4.2, 5.2). --------------------------------------------------- */

#define SET (INSTANTIATED | INITIALIZATION)
#define READ(MORE)                                                                                                    \
    {INITIALIZATION | STEP | TERMINATED | MORE, INITIALIZATION | EVENT | CONTINUOUS | TERMINATED,                     \
     INITIALIZATION | STEP | EVENT | TERMINATED | MORE, INITIALIZATION | STEP | EVENT | TERMINATED | MORE,            \
     INITIALIZATION | ACTIVATION | TERMINATED}
#define WRITE                                                                                                         \
    {SET | STEP | WITHIN_STEP, SET | EVENT | CONTINUOUS, SET | STEP | EVENT | WITHIN_STEP,                            \
     SET | STEP | EVENT | WITHIN_STEP, SET | ACTIVATION}
#define EACH(PHASES) {PHASES, PHASES, PHASES, PHASES, PHASES}
#define EXCHANGE(PHASES) {0, PHASES, 0, 0, 0}
#define SIMULATION(PHASES) {PHASES, 0, PHASES, PHASES, 0}
#define EVENTS {0, EVENT, EVENT, EVENT, 0}
#define INTERVALS {INITIALIZATION | STEP, INITIALIZATION | EVENT, INITIALIZATION | STEP | EVENT, \
                   INITIALIZATION | STEP | EVENT, INITIALIZATION | ACTIVATION}
#define RUN (INITIALIZATION | EVENT | CONTINUOUS | TERMINATED)

const Operation operations[] = {
    {"fmi3GetFloat64", READ(WITHIN_STEP), 20, REPEATABLE, get_real},
    {"fmi3SetFloat64", WRITE, 24, REPEATABLE, set_real},
    {"fmi3GetInt32", READ(WITHIN_STEP), 3, REPEATABLE, get_integer},
    {"fmi3GetInt64", READ(WITHIN_STEP), 3, REPEATABLE, get_enumeration},
    {"fmi3GetBoolean", READ(WITHIN_STEP), 3, REPEATABLE, get_boolean},
    {"fmi3Get", READ(WITHIN_STEP), 1, REPEATABLE, read_other_types},
    {"fmi3SetInt32", WRITE, 1, REPEATABLE, set_integer},
    {"fmi3SetInt64", WRITE, 4, REPEATABLE, set_enumeration},
    {"fmi3SetBoolean", WRITE, 1, REPEATABLE, set_boolean},
    {"fmi3Set", WRITE, 1, REPEATABLE, write_other_types},
    {"fmi3EnterInitializationMode", EACH(INSTANTIATED), 60, 0, enter_initialization},
    {"fmi3ExitInitializationMode", EACH(INITIALIZATION), 60, 0, exit_initialization},
    {"fmi3Terminate", {STEP, EVENT | CONTINUOUS, STEP | EVENT, STEP | EVENT, ACTIVATION}, 1, 0, terminate},
    {"fmi3Reset", EACH(ALWAYS), 1, 0, subject_reset},
    {"fmi3SetDebugLogging", EACH(ALWAYS | WITHIN_STEP), 1, 0, debug_logging},
    {"fmi3", EACH(0), 1, REPEATABLE, not_provided},
    {"fmi3GetDirectionalDerivative", READ(0), 6, REPEATABLE | ALLOCATES, directional},
    {"fmi3GetAdjointDerivative", READ(0), 6, REPEATABLE | ALLOCATES, adjoint},
    {"VariableDependencies", EACH(ALWAYS), 3, REPEATABLE, dependencies},
    {"fmi3GetFMUState", EACH(ALWAYS), 5, ALLOCATES, get_state},
    {"fmi3SetFMUState", EACH(ALWAYS), 3, 0, set_state},
    {"fmi3FreeFMUState", EACH(ALWAYS), 1, 0, free_state},
    {"fmi3SerializedFMUStateSize", EACH(ALWAYS), 5, 0, serialize},
    {"fmi3DeserializeFMUState", EACH(ALWAYS), 8, ALLOCATES, deserialize},
    {"fmi3DoStep", SIMULATION(STEP), 50, REPEATABLE, do_step},
    {"fmi3GetOutputDerivatives", SIMULATION(STEP | WITHIN_STEP | TERMINATED), 6, REPEATABLE, get_output_derivatives},
    {"fmi3EnterEventMode", {0, CONTINUOUS, STEP, STEP, 0}, 8, 0, enter_event},
    {"fmi3EnterStepMode", {0, 0, EVENT, EVENT, 0}, 20, 0, enter_step},
    {"fmi3EvaluateDiscreteStates", EVENTS, 5, REPEATABLE, evaluate},
    {"fmi3UpdateDiscreteStates", EVENTS, 20, REPEATABLE, update},
    {"fmi3GetClock", EVENTS, 4, REPEATABLE, get_clock},
    {"fmi3SetClock", EVENTS, 8, REPEATABLE, set_clock},
    {"fmi3GetIntervalDecimal", INTERVALS, 3, REPEATABLE, get_interval},
    {"fmi3GetShiftDecimal", INTERVALS, 3, REPEATABLE, get_shift},
    {"fmi3SetIntervalDecimal", EACH(SET), 3, REPEATABLE, set_interval},
    {"fmi3ActivateModelPartition", {0, 0, 0, 0, ACTIVATION}, 40, REPEATABLE, activate_partition},
    {"fmi3EnterContinuousTimeMode", EXCHANGE(EVENT), 20, 0, enter_continuous},
    {"fmi3CompletedIntegratorStep", EXCHANGE(CONTINUOUS), 20, REPEATABLE, completed_step},
    {"fmi3SetTime", EXCHANGE(EVENT | CONTINUOUS), 20, REPEATABLE, set_time},
    {"fmi3SetContinuousStates", EXCHANGE(CONTINUOUS), 20, REPEATABLE, set_states},
    {"fmi3GetContinuousStates", EXCHANGE(RUN), 8, REPEATABLE, get_states},
    {"fmi3GetContinuousStateDerivatives", EXCHANGE(RUN), 8, REPEATABLE, get_derivatives},
    {"fmi3GetEventIndicators", EXCHANGE(RUN), 8, REPEATABLE, get_indicators},
    {"fmi3GetNominalsOfContinuousStates", EXCHANGE(ALWAYS), 2, REPEATABLE, get_nominals},
    {"fmi3GetNumberOf", EXCHANGE(ALWAYS), 2, REPEATABLE, numbers},
};
const int operation_count = sizeof operations / sizeof *operations;
