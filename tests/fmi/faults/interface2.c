/* FMI 2.0 for the fault drivers: what harness.h asks of a version. The random calls are in calls2.c. */
#include "interface2.h"

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

void subject_instantiate(Subject *subject, int model_exchange)
{
    fmi2CallbackFunctions *callbacks = own(sizeof *callbacks);
    char *name = own(7), *token = own(strlen(brunovsky_description.token) + 1);
    memset(callbacks, 0, sizeof *callbacks);
    callbacks->logger = logger;
    callbacks->componentEnvironment = subject;
    memcpy(name, "one %d", 7);
    strcpy(token, brunovsky_description.token);
    subject->model_exchange = model_exchange;
    subject->phase = INSTANTIATED;
    subject->must_name = "fmi2Instantiate";
    subject->component =
        fmi2Instantiate(name, model_exchange ? fmi2ModelExchange : fmi2CoSimulation, token, NULL, callbacks, 0, chance(50));
    disown(callbacks);
    disown(name);
    disown(token);
}

void subject_misuse(Subject *subject)
{
    const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, subject};
    const char *token = brunovsky_description.token, *const names[] = {NULL, ""};
    void *component;
    clear_log(subject);
    switch (draw(5)) {
    case 0: component = fmi2Instantiate("one %d", fmi2CoSimulation, NULL, NULL, &callbacks, 0, 0); break;
    case 1: component = fmi2Instantiate("one %d", fmi2CoSimulation, "{0}", NULL, &callbacks, 0, 0); break;
    case 2: component = fmi2Instantiate("one %d", (fmi2Type)7, token, NULL, &callbacks, 0, 0); break;
    case 3: EXPECT(!fmi2Instantiate("one %d", fmi2CoSimulation, token, NULL, NULL, 0, 0), "no callbacks"); return;
    default: component = fmi2Instantiate(names[draw(2)], fmi2CoSimulation, token, NULL, &callbacks, 0, 0); break;
    }
    EXPECT(!component, "an instance of illegal arguments");
    subject->must_name = "fmi2Instantiate";
    check_log(subject, ERROR);
}

void subject_free(Subject *subject)
{
    fmi2FreeInstance(subject->component);
    subject->component = NULL;
    disown(subject->bytes);
    subject->bytes = NULL;
}

int subject_reset(Subject *subject)
{
    const int status = (int)fmi2Reset(subject->component);
    if (status == OK)
        subject->phase = INSTANTIATED;
    return status;
}

int subject_get_state(Subject *subject, void **state)
{
    return (int)fmi2GetFMUstate(subject->component, state);
}

int subject_set_state(Subject *subject, void *state)
{
    return (int)fmi2SetFMUstate(subject->component, state);
}

int subject_free_state(Subject *subject, void **state)
{
    return (int)fmi2FreeFMUstate(subject->component, state);
}

size_t subject_serialize(Subject *subject, void *state, char **bytes)
{
    size_t size = 0;
    if (fmi2SerializedFMUstateSize(subject->component, state, &size) != fmi2OK)
        return 0;
    *bytes = own(size);
    if (fmi2SerializeFMUstate(subject->component, state, *bytes, size) != fmi2OK) {
        disown(*bytes);
        *bytes = NULL;
    }
    return size;
}

int subject_deserialize(Subject *subject, const char *bytes, size_t size, void **state)
{
    return (int)fmi2DeSerializeFMUstate(subject->component, bytes, size, state);
}

static size_t get_outputs(Subject *subject, double *found)
{
    size_t filled = 0;
    for (unsigned i = 0; i < (unsigned)brunovsky_model.ny; i++) {
        const fmi2ValueReference reference = FIRST_OUTPUT + i;
        fmi2Real real = 0;
        fmi2Integer integer = 0;
        int status;
        switch (brunovsky_description.y_types[i]) {
        case REAL: status = (int)fmi2GetReal(subject->component, &reference, 1, &real); break;
        case INTEGER: status = (int)fmi2GetInteger(subject->component, &reference, 1, &integer); break;
        default: status = (int)fmi2GetBoolean(subject->component, &reference, 1, &integer); break;
        }
        found[filled++] = status;
        found[filled++] = real + integer;
    }
    return filled;
}

int subject_settle(Subject *subject)
{
    double found[2 * MAX_VALUES];
    get_outputs(subject, found);
    return (int)found[0];
}

/* Inputs of a step of the legal run; any function of its number does. */
static void set_inputs(Subject *subject, int step)
{
    for (unsigned i = 0; i < (unsigned)brunovsky_model.nu; i++) {
        const fmi2ValueReference reference = FIRST_INPUT + i;
        const fmi2Real value = brunovsky_model.u_default[i] + 0.1 * ((step * 7 + (int)i * 3) % 11 - 5);
        EXPECT(fmi2SetReal(subject->component, &reference, 1, &value) == fmi2OK, "an input is refused: %s",
               subject->message);
    }
}

static double events(Subject *subject)
{
    fmi2EventInfo info;
    EXPECT(fmi2NewDiscreteStates(subject->component, &info) == fmi2OK, "an event fails: %s", subject->message);
    EXPECT(fmi2EnterContinuousTimeMode(subject->component) == fmi2OK, "continuous-time mode is refused: %s",
           subject->message);
    return info.nextEventTimeDefined ? info.nextEventTime : 1e9;
}

/* Explicit Euler with events after the steps. */
static void exchange_step(Subject *subject, double time, double length, double *next)
{
    const size_t nx = (size_t)brunovsky_model.nx;
    double x[MAX_VALUES], dx[MAX_VALUES];
    fmi2Boolean event = fmi2False, stop;
    void *c = subject->component;
    EXPECT(fmi2GetContinuousStates(c, x, nx) == fmi2OK && fmi2GetDerivatives(c, dx, nx) == fmi2OK &&
               fmi2SetTime(c, time + length) == fmi2OK,
           "a legal step: %s", subject->message);
    for (size_t i = 0; i < nx; i++)
        x[i] += length * dx[i];
    EXPECT(fmi2SetContinuousStates(c, x, nx) == fmi2OK && fmi2CompletedIntegratorStep(c, 1, &event, &stop) == fmi2OK,
           "a legal step: %s", subject->message);
    if (event || *next <= time + length) {
        EXPECT(fmi2EnterEventMode(c) == fmi2OK, "event mode is refused: %s", subject->message);
        *next = events(subject);
    }
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
    if (fmi2ExitInitializationMode(c) != fmi2OK) { /* a block that model exchange refuses */
        found[0] = subject->logged[ERROR];
        return 1;
    }
    if (subject->model_exchange)
        next = events(subject);
    for (int step = 0; step < 32 && filled + 2 * (size_t)brunovsky_model.ny < count; step++) {
        set_inputs(subject, step);
        if (subject->model_exchange)
            exchange_step(subject, step * length, length, &next);
        else
            EXPECT(fmi2DoStep(c, step * length, length, 1) == fmi2OK, "a legal step: %s", subject->message);
        filled += get_outputs(subject, found + filled);
    }
    EXPECT(fmi2Terminate(c) == fmi2OK, "%s", subject->message);
    subject->phase = TERMINATED;
    return filled;
}
