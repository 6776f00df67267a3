/* FMI 2.0 for the fault drivers: what harness.h asks of a version. The random calls are in calls2.c. */
#include "interface.h"

#include <stdlib.h>
#include <string.h>

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    EXPECT(name && (strcmp(name, "one %d") == 0 || strcmp(name, "?") == 0), "a message of an instance called %s", name ? name : "NULL");
    for (const char *sign = strchr(message, '%'); sign; sign = strchr(sign + 2, '%'))
        EXPECT(sign[1] == '%', "a per cent sign alone: %s", message);
    subject_log(environment, (int)status, category, message);
}

void subject_instantiate(Subject *subject, int kind)
{
    fmi2CallbackFunctions *callbacks = own(sizeof *callbacks);
    char *name = own(7), *token = own(strlen(brunovsky_description.token) + 1);
    memset(callbacks, 0, sizeof *callbacks);
    callbacks->logger = logger;
    callbacks->componentEnvironment = subject;
    memcpy(name, "one %d", 7);
    strcpy(token, brunovsky_description.token);
    subject->kind = kind;
    subject->phase = INSTANTIATED;
    subject->must_name = "fmi2Instantiate";
    subject->component =
        fmi2Instantiate(name, kind == MODEL_EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation, token, NULL, callbacks, 0, chance(50));
    disown(callbacks);
    disown(name);
    disown(token);
}

void subject_misuse(Subject *subject)
{
    const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, subject};
    const char *token = brunovsky_description.token, *const names[] = {NULL, ""};
    const fmi2Type other = has_kind(MODEL_EXCHANGE) ? (fmi2Type)7 : fmi2ModelExchange;
    void *component;
    clear_log(subject);
    switch (draw(5)) {
    case 0: component = fmi2Instantiate("one %d", fmi2CoSimulation, NULL, NULL, &callbacks, 0, 0); break;
    case 1: component = fmi2Instantiate("one %d", fmi2CoSimulation, "{0}", NULL, &callbacks, 0, 0); break;
    case 2: component = fmi2Instantiate("one %d", other, token, NULL, &callbacks, 0, 0); break;
    case 3: EXPECT(!fmi2Instantiate("one %d", fmi2CoSimulation, token, NULL, NULL, 0, 0), "no callbacks"); return;
    default: component = fmi2Instantiate(names[draw(2)], fmi2CoSimulation, token, NULL, &callbacks, 0, 0); break;
    }
    EXPECT(!component, "an instance of illegal arguments");
    subject->must_name = "fmi2Instantiate";
    check_log(subject, ERROR);
}

int has_kind(int kind)
{
    return kind == CO_SIMULATION || (kind == MODEL_EXCHANGE && !brunovsky_description.refused[kind]);
}

/* Copy of values in exactly as much memory as they need. */
static int *integers(const double *values, size_t n)
{
    int *copy = values ? own(n * sizeof *copy) : NULL;
    for (size_t i = 0; copy && i < n; i++)
        copy[i] = values[i] == values[i] ? (int)values[i] : 7;
    return copy;
}

int get_values(const Subject *subject, Type type, const unsigned *references, size_t count, double *values, size_t n)
{
    int *copy, status;
    (void)n; /* the same as count */
    if (type == REAL)
        return (int)fmi2GetReal(subject->component, references, count, values);
    copy = integers(values, count);
    if (type == INTEGER)
        status = (int)fmi2GetInteger(subject->component, references, count, copy);
    else
        status = (int)fmi2GetBoolean(subject->component, references, count, copy);
    for (size_t i = 0; copy && i < count; i++)
        values[i] = copy[i];
    disown(copy);
    return status;
}

int set_values(const Subject *subject, Type type, const unsigned *references, size_t count, const double *values, size_t n)
{
    int *copy, status;
    (void)n;
    if (type == REAL)
        return (int)fmi2SetReal(subject->component, references, count, values);
    copy = integers(values, count);
    if (type == INTEGER)
        status = (int)fmi2SetInteger(subject->component, references, count, copy);
    else
        status = (int)fmi2SetBoolean(subject->component, references, count, copy);
    disown(copy);
    return status;
}

int directional_derivative(const Subject *subject, int adjoint, const unsigned *unknowns, size_t n_unknowns,
                           const unsigned *knowns, size_t n_knowns, const double *seed, size_t n_seed, double *values,
                           size_t n)
{
    (void)adjoint, (void)n_seed, (void)n;
    return (int)fmi2GetDirectionalDerivative(subject->component, unknowns, n_unknowns, knowns, n_knowns, seed, values);
}

int output_derivatives(const Subject *subject, const unsigned *references, size_t count, const int *orders, double *values,
                       size_t n)
{
    (void)n;
    return (int)fmi2GetRealOutputDerivatives(subject->component, references, count, orders, values);
}

double settle_events(Subject *subject)
{
    fmi2EventInfo info;
    EXPECT(fmi2NewDiscreteStates(subject->component, &info) == fmi2OK, "an event fails: %s", subject->message);
    EXPECT(fmi2EnterContinuousTimeMode(subject->component) == fmi2OK, "continuous-time mode is refused: %s",
           subject->message);
    return info.nextEventTimeDefined ? info.nextEventTime : 1e9;
}

size_t subject_run(Subject *subject, int solver, double *found, size_t count)
{
    const fmi2ValueReference reference = SOLVER;
    const double length = 1.0 / 256;
    void *c = subject->component;
    double next = 1e9;
    size_t filled = 0;
    EXPECT(fmi2SetupExperiment(c, 1, 1e-6, 0, 0, 0) == fmi2OK, "%s", subject->message);
    if (brunovsky_model.nx)
        EXPECT(fmi2SetInteger(c, &reference, 1, &solver) == fmi2OK, "%s", subject->message);
    EXPECT(fmi2EnterInitializationMode(c) == fmi2OK, "%s", subject->message);
    set_inputs(subject, 0);
    EXPECT(fmi2ExitInitializationMode(c) == fmi2OK, "%s", subject->message);
    if (subject->kind == MODEL_EXCHANGE)
        next = settle_events(subject);
    for (int step = 0; step < 32 && filled + 2 * (size_t)brunovsky_model.ny < count; step++) {
        set_inputs(subject, step);
        if (subject->kind == MODEL_EXCHANGE)
            exchange_step(subject, step * length, length, &next);
        else
            EXPECT(fmi2DoStep(c, step * length, length, 1) == fmi2OK, "a legal step: %s", subject->message);
        filled += get_outputs(subject, found + filled);
    }
    EXPECT(fmi2Terminate(c) == fmi2OK, "%s", subject->message);
    subject->phase = TERMINATED;
    return filled;
}
