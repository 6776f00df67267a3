/* FMI 3.0 for the fault drivers: what harness.h asks of a version. The random calls are in calls3.c. */
#include <string.h>

#include "calls3.h"

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    subject_log(environment, (int)status, category, message);
}

static void intermediate_update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set_requested,
                                fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early,
                                fmi3Float64 *early_time)
{
    EXPECT(environment && set_requested && get_allowed && finished, "an intermediate update that allows nothing");
    within_step(environment, time, can_return, early, early_time);
}

static void *make(Subject *subject, const char *name, const char *token, int kind, int logging)
{
    fmi3IntermediateUpdateCallback update = subject->with_callbacks ? intermediate_update : NULL;
    switch (kind) {
    case MODEL_EXCHANGE:
        subject->must_name = "fmi3InstantiateModelExchange";
        return fmi3InstantiateModelExchange(name, token, NULL, 0, logging, subject, logger);
    case SCHEDULED:
        subject->must_name = "fmi3InstantiateScheduledExecution";
        return fmi3InstantiateScheduledExecution(name, token, NULL, 0, logging, subject, logger, NULL, NULL, NULL);
    default:
        subject->must_name = "fmi3InstantiateCoSimulation";
        return fmi3InstantiateCoSimulation(name, token, NULL, 0, logging, kind != CO_SIMULATION,
                                           kind == EARLY_RETURN || (kind == CO_SIMULATION && update), NULL, 0, subject,
                                           logger, update);
    }
}

void subject_instantiate(Subject *subject, int kind)
{
    char *name = own(4), *token = own(strlen(brunovsky_description.token) + 1);
    memcpy(name, "one", 4);
    strcpy(token, brunovsky_description.token);
    subject->kind = kind;
    subject->phase = INSTANTIATED;
    subject->with_callbacks = chance(50);
    subject->component = make(subject, name, token, kind, chance(50));
    disown(name);
    disown(token);
}

void subject_misuse(Subject *subject)
{
    const char *token = brunovsky_description.token, *const names[] = {NULL, ""}, *const tokens[] = {NULL, "{0}", ""};
    const int kind = random_kind(), other = chance(50) ? SCHEDULED : MODEL_EXCHANGE;
    void *component;
    clear_log(subject);
    if (!has_kind(other) && chance(20))
        component = make(subject, "one", token, other, 0);
    else if (chance(50))
        component = make(subject, names[draw(2)], token, kind, 0);
    else
        component = make(subject, "one", tokens[draw(3)], kind, 0);
    EXPECT(!component, "an instance of illegal arguments");
    check_log(subject, ERROR);
}

int has_kind(int kind)
{
    int timed = 0;
    for (int i = 0; brunovsky_model.nk && i < brunovsky_model.nq; i++)
        timed |= brunovsky_model.q_clock[i] < 0;
    if (kind == MODEL_EXCHANGE)
        return !brunovsky_description.refused[kind];
    return kind != SCHEDULED || (brunovsky_model.nk && !brunovsky_model.nx && !timed);
}

#define EACH(FUNCTION, VALUE)                                                                                         \
    do {                                                                                                              \
        VALUE *copy = values ? own(n * sizeof *copy) : NULL;                                                          \
        for (size_t i = 0; copy && i < n; i++)                                                                        \
            copy[i] = values[i] == values[i] ? (VALUE)values[i] : (VALUE)7;                                           \
        status = (int)FUNCTION(subject->component, references, count, copy, n);                                       \
        COPY_BACK;                                                                                                    \
        disown(copy);                                                                                                 \
    } while (0)

#define COPY_BACK                                                                                                     \
    for (size_t i = 0; copy && i < n; i++)                                                                            \
    values[i] = (double)copy[i]

int get_values(const Subject *subject, Type type, const unsigned *references, size_t count, double *values, size_t n)
{
    int status;
    switch (type) {
    case REAL: return (int)fmi3GetFloat64(subject->component, references, count, values, n);
    case INTEGER: EACH(fmi3GetInt32, fmi3Int32); break;
    case ENUMERATION: EACH(fmi3GetInt64, fmi3Int64); break;
    default: EACH(fmi3GetBoolean, fmi3Boolean); break;
    }
    return status;
}

#undef COPY_BACK
#define COPY_BACK

int set_values(const Subject *subject, Type type, const unsigned *references, size_t count, const double *values, size_t n)
{
    int status;
    switch (type) {
    case REAL: return (int)fmi3SetFloat64(subject->component, references, count, values, n);
    case INTEGER: EACH(fmi3SetInt32, fmi3Int32); break;
    case ENUMERATION: EACH(fmi3SetInt64, fmi3Int64); break;
    default: EACH(fmi3SetBoolean, fmi3Boolean); break;
    }
    return status;
}

int directional_derivative(const Subject *subject, int is_adjoint, const unsigned *unknowns, size_t n_unknowns,
                           const unsigned *knowns, size_t n_knowns, const double *seed, size_t n_seed, double *values,
                           size_t n)
{
    return (int)(is_adjoint ? fmi3GetAdjointDerivative : fmi3GetDirectionalDerivative)(
        subject->component, unknowns, n_unknowns, knowns, n_knowns, seed, n_seed, values, n);
}

int output_derivatives(const Subject *subject, const unsigned *references, size_t count, const int *orders, double *values,
                       size_t n)
{
    return (int)fmi3GetOutputDerivatives(subject->component, references, count, orders, values, n);
}

/* The legal run ---------------------------------------------------------------------------------------------------- */

static const char *const MESSAGE = "a legal call: %s";

/* An event at which all clocks tick; instant of the next one. */
static double update(Subject *subject)
{
    fmi3Boolean again = true, stop = true, nominals = true, states = true, defined = true;
    double next = 0;
    for (int i = 0; i < brunovsky_model.nk; i++) {
        const unsigned reference = FIRST_CLOCK + (unsigned)i;
        const fmi3Clock tick = fmi3ClockActive;
        EXPECT(fmi3SetClock(subject->component, &reference, 1, &tick) == fmi3OK, MESSAGE, subject->message);
    }
    EXPECT(fmi3UpdateDiscreteStates(subject->component, &again, &stop, &nominals, &states, &defined, &next) == fmi3OK, MESSAGE,
           subject->message);
    return defined ? next : 1e9;
}

double settle_events(Subject *subject)
{
    const double next = update(subject);
    EXPECT(fmi3EnterContinuousTimeMode(subject->component) == fmi3OK, MESSAGE, subject->message);
    return next;
}

static void handle(Subject *subject)
{
    update(subject);
    EXPECT(fmi3EnterStepMode(subject->component) == fmi3OK, MESSAGE, subject->message);
}

/* To this time, whatever ends the step before. */
static void simulate_to(Subject *subject, double stop)
{
    fmi3Boolean event = false, terminated = false, early = false;
    double time = real(subject, TIME);
    while (time < stop) {
        EXPECT(fmi3DoStep(subject->component, time, stop - time, true, &event, &terminated, &early, &time) == fmi3OK, MESSAGE,
               subject->message);
        if (event || brunovsky_model.nk) {
            if (subject->kind == CO_SIMULATION)
                continue;
            EXPECT(fmi3EnterEventMode(subject->component) == fmi3OK, MESSAGE, subject->message);
            handle(subject);
        }
    }
}

static void activate(Subject *subject, double time)
{
    for (int i = 0; i < brunovsky_model.nk; i++)
        EXPECT(fmi3ActivateModelPartition(subject->component, FIRST_CLOCK + (unsigned)i, time) == fmi3OK, MESSAGE,
               subject->message);
}

size_t subject_run(Subject *subject, int solver, double *found, size_t count)
{
    const unsigned reference = SOLVER;
    const double length = 1.0 / 256, number = solver;
    void *c = subject->component;
    double next = 1e9;
    size_t filled = 0;
    if (brunovsky_model.nx)
        EXPECT(set_values(subject, ENUMERATION, &reference, 1, &number, 1) == OK, MESSAGE, subject->message);
    EXPECT(fmi3EnterInitializationMode(c, 1, 1e-6, 0, 0, 0) == fmi3OK, MESSAGE, subject->message);
    subject->phase = INITIALIZATION;
    set_inputs(subject, 0);
    EXPECT(fmi3ExitInitializationMode(c) == fmi3OK, MESSAGE, subject->message);
    if (subject->kind == MODEL_EXCHANGE)
        next = settle_events(subject);
    else if (subject->kind == EVENT_MODE || subject->kind == EARLY_RETURN)
        handle(subject);
    for (int step = 0; step < 32 && filled + 2 * (size_t)brunovsky_model.ny < count; step++) {
        set_inputs(subject, step);
        if (subject->kind == MODEL_EXCHANGE)
            exchange_step(subject, step * length, length, &next);
        else if (subject->kind == SCHEDULED)
            activate(subject, step * length);
        else
            simulate_to(subject, (step + 1) * length);
        filled += get_outputs(subject, found + filled);
    }
    EXPECT(fmi3Terminate(c) == fmi3OK, MESSAGE, subject->message);
    subject->phase = TERMINATED;
    return filled;
}
