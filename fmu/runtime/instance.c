/* Life cycle, variables and events of an FMU. See instance.h; the equations and their semantics are in engine.c. */
#include "instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sensitivity.h"
#include "variables.h"

#define DEFAULT_STEP_SIZE 1e-3
#define MIN_STEP_SIZE 1e-9
#define TIME_ROUNDING 1e-6  /* part of a step by which the master's time may differ from the instance's */
#define INDICATOR_SHIFT 1e-12 /* an indicator is this far from zero after its event, as FMI recommends */

Result report(Instance *instance, Result result, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(instance->message, sizeof instance->message, format, arguments);
    va_end(arguments);
    return result;
}

Instance *instance_new(int model_exchange)
{
    const Model *model = &brunovsky_model;
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance)
        return NULL;
    instance->engine = engine_new(model, DEFAULT_STEP_SIZE);
    instance->dx = calloc((size_t)(2 * model->nx + model->nz + model->nq) + 1, sizeof *instance->dx);
    instance->side = calloc((size_t)(model->nz + model->nr + model->nm) + 1, sizeof *instance->side);
    instance->sensitivity = sensitivity_new();
    if (!instance->engine || !instance->dx || !instance->side || !instance->sensitivity) {
        instance_free(instance);
        return NULL;
    }
    instance->z = instance->dx + model->nx;
    instance->before = instance->z + model->nz;
    instance->r = instance->side + model->nz;
    instance->modes_before = instance->r + model->nr;
    instance->model_exchange = model_exchange;
    instance_reset(instance);
    return instance;
}

void instance_free(Instance *instance)
{
    if (!instance)
        return;
    engine_free(instance->engine);
    free(instance->dx);
    free(instance->side);
    free(instance->sensitivity);
    free(instance);
}

static void outdate(Instance *instance)
{
    instance->outputs_current = instance->derivatives_current = instance->entries_current = 0;
}

void instance_reset(Instance *instance)
{
    engine_reset(instance->engine);
    instance->engine->step_size = DEFAULT_STEP_SIZE;
    instance->engine->tolerance = DEFAULT_TOLERANCE;
    instance->engine->solver = SOLVER_RK4;
    instance->phase = INSTANTIATED;
    instance->start = 0;
    instance->stop = HUGE_VAL;
    instance->started = instance->parameters_checked = instance->relations_current = 0;
    memset(instance->side, 0, (size_t)instance->engine->model->nz * sizeof *instance->side);
    outdate(instance);
}

static const char *phase_name(const Instance *instance)
{
    switch (instance->phase) {
    case INSTANTIATED: return "instantiated";
    case INITIALIZATION: return "in initialization mode";
    case STEP: return "between communication steps";
    case EVENT: return "in event mode";
    case CONTINUOUS_TIME: return "in continuous-time mode";
    default: return "terminated";
    }
}

Result instance_permits(Instance *instance, int phases)
{
    if (instance->phase & phases)
        return DONE;
    return report(instance, FAILED, "is not allowed while a %s instance is %s",
                  instance->model_exchange ? "model-exchange" : "co-simulation", phase_name(instance));
}

/* Variables ------------------------------------------------------------------------------------------------------- */

Kind locate(unsigned reference, int *index)
{
    const Model *model = &brunovsky_model;
    const struct {
        Kind kind;
        int count;
    } groups[] = {{TIME, 1},           {STEP_SIZE, 1},     {SOLVER, 1},         {PARAMETER, model->np},
                  {INPUT, model->nu},  {OUTPUT, model->ny}, {STATE, model->nx}, {SAMPLE, model->nq},
                  {MODE, model->nm},   {DERIVATIVE, model->nx}};
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        if (reference < (unsigned)groups[i].count) {
            *index = (int)reference;
            return groups[i].kind == SOLVER && !model->nx ? UNKNOWN : groups[i].kind;
        }
        reference -= (unsigned)groups[i].count;
    }
    *index = 0;
    return UNKNOWN;
}

Type type_of(Kind kind, int index)
{
    if (kind == OUTPUT)
        return brunovsky_description.y_types[index];
    return kind == SOLVER || kind == MODE ? INTEGER : REAL;
}

const char *name_of(Kind kind, int index)
{
    const Model *model = &brunovsky_model;
    switch (kind) {
    case TIME: return "time";
    case STEP_SIZE: return "step_size";
    case SOLVER: return "solver";
    case PARAMETER: return model->p_names[index];
    case INPUT: return model->u_names[index];
    case OUTPUT: return model->y_names[index];
    case STATE:
    case DERIVATIVE: return model->x_names[index];
    case SAMPLE: return model->q_names[index];
    case MODE: return brunovsky_description.m_names[index];
    default: return "?";
    }
}

/* Where a variable of this type and reference is; FAILED with its name, or its number if there is none. */
static Result find(Instance *instance, Type type, unsigned reference, Kind *kind, int *index)
{
    static const char *const types[] = {"Real", "Integer", "Boolean"};
    *kind = locate(reference, index);
    if (*kind == UNKNOWN)
        return report(instance, FAILED, "there is no variable with value reference %u", reference);
    if (type_of(*kind, *index) != type)
        return report(instance, FAILED, "%s (value reference %u) is of type %s, not %s", name_of(*kind, *index),
                      reference, types[type_of(*kind, *index)], types[type]);
    return DONE;
}

/* What explains a value that is not finite: the engine's diagnosis, which names the first output or derivative. */
Result not_finite(Instance *instance, const char *name)
{
    const Result result = instance->phase == CONTINUOUS_TIME ? DISCARDED : FAILED;
    if (engine_check_finite(instance->engine) != ENGINE_OK)
        return report(instance, result, "%s", instance->engine->message);
    return report(instance, result, "%s: %s is not finite at t = %.9g s", instance->engine->model->name, name,
                  instance->engine->time);
}

static Result check_parameters(Instance *instance)
{
    if (!instance->parameters_checked && engine_check_parameters(instance->engine, instance->model_exchange) != ENGINE_OK)
        return report(instance, FAILED, "%s", instance->engine->message);
    instance->parameters_checked = 1;
    return DONE;
}

/* Makes what is calculated belong to the values set: start values before the run; relations too at a communication
 * point where inputs changed and in event mode, so that outputs are of the branch that belongs to these values. */
Result refresh(Instance *instance)
{
    Engine *engine = instance->engine;
    if (instance->phase == INITIALIZATION && !instance->started) {
        outdate(instance);
        if (engine_start(engine, instance->start, instance->model_exchange) != ENGINE_OK)
            return report(instance, FAILED, "%s", engine->message);
        instance->started = instance->parameters_checked = instance->relations_current = 1;
    }
    if (!instance->relations_current && instance->phase & (STEP | EVENT)) {
        engine_relations(engine);
        instance->relations_current = 1;
    }
    return DONE;
}

static const double *outputs(Instance *instance)
{
    if (!instance->outputs_current)
        engine_outputs(instance->engine);
    instance->outputs_current = 1;
    return instance->engine->y;
}

static const double *derivatives(Instance *instance)
{
    if (!instance->derivatives_current)
        engine_derivatives(instance->engine, instance->dx);
    instance->derivatives_current = 1;
    return instance->dx;
}

Result instance_get(Instance *instance, Type type, unsigned reference, double *value)
{
    const Engine *engine = instance->engine;
    Kind kind;
    int index;
    Result result = find(instance, type, reference, &kind, &index);
    if (result == DONE && kind >= OUTPUT)
        result = refresh(instance);
    if (result != DONE)
        return result;
    switch (kind) {
    case TIME: *value = instance->phase == INITIALIZATION ? instance->start : engine->time; break;
    case STEP_SIZE: *value = engine->step_size; break;
    case SOLVER: *value = engine->solver; break;
    case PARAMETER: *value = engine->p[index]; break;
    case INPUT: *value = engine->u[index]; break;
    case OUTPUT: *value = outputs(instance)[index]; break;
    case STATE: *value = engine->x[index]; break;
    case SAMPLE: *value = engine->q[index]; break;
    case MODE: *value = engine->m[index]; break;
    default: *value = derivatives(instance)[index]; break;
    }
    return isfinite(*value) ? DONE : not_finite(instance, name_of(kind, index));
}

/* Index of the continuous state that a variable is, itself or as the output of the same name; -1 if it is none. */
int state_of(Kind kind, int index)
{
    const Model *model = &brunovsky_model;
    if (kind == STATE)
        return index;
    for (int i = 0; kind == OUTPUT && i < model->nx; i++)
        if (strcmp(model->x_names[i], model->y_names[index]) == 0)
            return i;
    return -1;
}

/* FAILED unless a variable of this kind may be set now. Solvers that know no fmi2SetContinuousStates (casadi) set states
 * as variables. */
static Result settable(Instance *instance, Kind kind, int index)
{
    const char *name = name_of(kind, index);
    const int tunable = kind == PARAMETER && brunovsky_description.p_tunable[index];
    if (instance->phase & (EVENT | CONTINUOUS_TIME) && state_of(kind, index) >= 0)
        return DONE;
    if (kind == TIME)
        return report(instance, FAILED, "time is the independent variable and cannot be set as a variable");
    if (kind >= OUTPUT)
        return report(instance, FAILED, "%s%s%s is calculated and cannot be set", kind == DERIVATIVE ? "der(" : "", name,
                      kind == DERIVATIVE ? ")" : "");
    if (instance->phase & (INSTANTIATED | INITIALIZATION) || kind == INPUT)
        return DONE;
    if (!tunable)
        return report(instance, FAILED, "%s is a fixed parameter and cannot be set while the instance is %s", name,
                      phase_name(instance));
    if (instance->phase == CONTINUOUS_TIME)
        return report(instance, FAILED, "%s is a parameter and cannot be set in continuous-time mode, but in event mode",
                      name);
    return DONE;
}

static Result within(Instance *instance, const char *name, double value, double min, double max)
{
    if (value >= min && value <= max)
        return DONE;
    return report(instance, FAILED, "%s = %g is out of its range from %g to %g", name, value, min, max);
}

Result instance_admits(Instance *instance, Type type, unsigned reference, double value)
{
    const Model *model = instance->engine->model;
    Kind kind;
    int index;
    Result result = find(instance, type, reference, &kind, &index);
    if (result == DONE)
        result = settable(instance, kind, index);
    if (result == DONE && !isfinite(value))
        result = report(instance, FAILED, "%s cannot be set to %g: it is not finite", name_of(kind, index), value);
    if (result != DONE)
        return result;
    switch (kind) {
    case PARAMETER: return within(instance, model->p_names[index], value, model->p_min[index], model->p_max[index]);
    case STEP_SIZE: return within(instance, "step_size", value, MIN_STEP_SIZE, DBL_MAX);
    case SOLVER: return within(instance, "solver", value, SOLVER_RK4, SOLVER_DORMAND_PRINCE);
    default: return DONE;
    }
}

void instance_set(Instance *instance, unsigned reference, double value)
{
    Engine *engine = instance->engine;
    int index;
    const Kind kind = locate(reference, &index);
    switch (kind) {
    case PARAMETER:
        engine->p[index] = value;
        instance->parameters_checked = 0;
        break;
    case INPUT: engine->u[index] = value; break;
    case STEP_SIZE: engine->step_size = value; break;
    case SOLVER: engine->solver = (int)value; break;
    case OUTPUT:
    case STATE: engine->x[state_of(kind, index)] = value; break;
    default: break;
    }
    instance->started = instance->relations_current = 0;
    outdate(instance);
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

Result instance_set_up(Instance *instance, double start, double stop, double tolerance)
{
    if (!isfinite(start) || isnan(stop) || stop < start)
        return report(instance, FAILED, "an experiment from %g s to %g s has no length", start, stop);
    instance->start = start;
    instance->stop = stop;
    instance->engine->tolerance = tolerance;
    return DONE;
}

void instance_enter_initialization(Instance *instance)
{
    instance->phase = INITIALIZATION;
    instance->started = 0;
}

/* Sides of the indicators, on which the relations now frozen were decided. */
static void choose_sides(Instance *instance)
{
    engine_indicators(instance->engine, instance->z);
    for (int i = 0; i < instance->engine->model->nz; i++)
        instance->side[i] = (instance->z[i] > 0) - (instance->z[i] < 0);
}

/* RK4 has no use for the tolerance, so it takes whatever a master gives. */
static Result check_tolerance(Instance *instance)
{
    const Engine *engine = instance->engine;
    if (engine->solver == SOLVER_RK4 || (engine->tolerance >= LEAST_TOLERANCE && engine->tolerance <= LARGEST_TOLERANCE))
        return DONE;
    return report(instance, FAILED, "the experiment's tolerance = %g is out of the range of this solver, from %g to %g",
                  engine->tolerance, LEAST_TOLERANCE, LARGEST_TOLERANCE);
}

Result instance_exit_initialization(Instance *instance)
{
    Result result = instance->model_exchange ? DONE : check_tolerance(instance);
    if (result == DONE)
        result = refresh(instance);
    if (result != DONE)
        return result;
    instance->phase = instance->model_exchange ? EVENT : STEP;
    choose_sides(instance);
    return DONE;
}

Result instance_step(Instance *instance, double time, double length)
{
    Engine *engine = instance->engine;
    const double rounding =
        TIME_ROUNDING * (length > 0 ? length : engine->step_size) + 4 * DBL_EPSILON * fabs(engine->time);
    Result result;
    if (!isfinite(time) || !isfinite(length) || length < 0)
        return report(instance, FAILED, "a communication step of %g s from t = %.9g s is not a finite step forward", length,
                      time);
    if (fabs(time - engine->time) > rounding)
        return report(instance, FAILED, "the communication point is t = %.9g s, but the instance is at t = %.9g s", time,
                      engine->time);
    if (time + length > instance->stop + rounding)
        return report(instance, FAILED, "a communication step of %g s from t = %.9g s passes the stop time, %.9g s", length,
                      time, instance->stop);
    if (time + length == time)
        return report(instance, WARNED, "a communication step of %g s at t = %.9g s does nothing", length, time);
    result = check_parameters(instance);
    if (result != DONE)
        return result;
    engine->time = time; /* the master's time, so that rounding does not add up */
    outdate(instance);
    if (engine_advance(engine, length) != ENGINE_OK)
        return report(instance, FAILED, "%s", engine->message);
    instance->relations_current = 1;
    return DONE;
}

/* Model exchange -------------------------------------------------------------------------------------------------- */

static Result counted(Instance *instance, const char *what, size_t count, int expected)
{
    if (count == (size_t)expected)
        return DONE;
    return report(instance, FAILED, "%lu %s were given or asked for, but there are %d", (unsigned long)count, what, expected);
}

Result instance_set_time(Instance *instance, double time)
{
    if (!isfinite(time))
        return report(instance, FAILED, "time cannot be set to %g: it is not finite", time);
    instance->engine->time = time;
    outdate(instance);
    return DONE;
}

Result instance_set_states(Instance *instance, const double *states, size_t count)
{
    Engine *engine = instance->engine;
    const Result result = counted(instance, "continuous states", count, engine->model->nx);
    if (result != DONE)
        return result;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(states[i]))
            return report(instance, FAILED, "state %s cannot be set to %g: it is not finite", engine->model->x_names[i],
                          states[i]);
    if (count)
        memcpy(engine->x, states, count * sizeof *states);
    outdate(instance);
    return DONE;
}

Result instance_get_states(Instance *instance, double *states, size_t count)
{
    Result result = counted(instance, "continuous states", count, instance->engine->model->nx);
    if (result == DONE)
        result = refresh(instance);
    if (result == DONE && count)
        memcpy(states, instance->engine->x, count * sizeof *states);
    return result;
}

Result instance_get_derivatives(Instance *instance, double *values, size_t count)
{
    const Model *model = instance->engine->model;
    Result result = counted(instance, "derivatives", count, model->nx);
    if (result == DONE)
        result = refresh(instance);
    if (result != DONE)
        return result;
    for (size_t i = 0; i < count; i++) {
        values[i] = derivatives(instance)[i];
        if (!isfinite(values[i]))
            return not_finite(instance, model->x_names[i]);
    }
    return DONE;
}

Result instance_get_indicators(Instance *instance, double *indicators, size_t count)
{
    Result result = counted(instance, "event indicators", count, instance->engine->model->nz);
    if (result == DONE)
        result = refresh(instance);
    if (result != DONE || !count)
        return result;
    engine_indicators(instance->engine, instance->z);
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(instance->z[i]))
            return not_finite(instance, "an event indicator");
        indicators[i] = instance->z[i] + instance->side[i] * INDICATOR_SHIFT;
    }
    return DONE;
}

void instance_enter_event(Instance *instance)
{
    instance->phase = EVENT;
    instance->relations_current = 0;
    outdate(instance);
}

Result instance_event(Instance *instance, Event *event)
{
    Engine *engine = instance->engine;
    const Model *model = engine->model;
    const size_t nx = (size_t)model->nx * sizeof(double), nq = (size_t)model->nq * sizeof(double);
    const size_t nm = (size_t)model->nm * sizeof(int);
    const Result result = check_parameters(instance);
    if (result != DONE)
        return result;
    outdate(instance);
    engine_save(engine, engine->backup);
    memcpy(instance->before, engine->x, nx + nq);
    memcpy(instance->modes_before, engine->m, nm);
    if (engine_event(engine) != ENGINE_OK) {
        engine_restore(engine, engine->backup);
        return report(instance, FAILED, "%s", engine->message);
    }
    instance->relations_current = 1;
    event->states_changed = memcmp(instance->before, engine->x, nx) != 0;
    event->discrete_changed =
        memcmp(instance->before + model->nx, engine->q, nq) != 0 || memcmp(instance->modes_before, engine->m, nm) != 0;
    event->next = engine_next_sample(engine);
    return DONE;
}

Result instance_enter_continuous_time(Instance *instance)
{
    Result result = check_parameters(instance);
    if (result == DONE)
        result = refresh(instance);
    if (result != DONE)
        return result;
    choose_sides(instance);
    instance->phase = CONTINUOUS_TIME;
    return DONE;
}

/* An event is needed where a relation no longer is what it was frozen at: the solver may have stepped over a crossing,
 * or started exactly on one, where an indicator has no side to come from. */
Result instance_complete_step(Instance *instance, int *event_needed)
{
    const Engine *engine = instance->engine;
    const Model *model = engine->model;
    const size_t size = (size_t)model->nr * sizeof *instance->r;
    memcpy(instance->r, engine->r, size);
    model->relations(engine->time, engine->x, engine->u, engine->p, engine->q, engine->m, instance->r);
    *event_needed = memcmp(instance->r, engine->r, size) != 0;
    engine_indicators(instance->engine, instance->z);
    for (int i = 0; i < model->nz; i++)
        if (!instance->side[i])
            instance->side[i] = (instance->z[i] > 0) - (instance->z[i] < 0);
    return DONE;
}

/* State as bytes --------------------------------------------------------------------------------------------------- */

typedef struct {
    char magic[16], token[48];
    unsigned long long check;
    double start, stop;
    int model_exchange, phase, parameters_checked, started, relations_current, unused;
} Header;

static const char MAGIC[16] = "brunovsky state";

static size_t sides_size(const Instance *instance)
{
    return (size_t)instance->engine->model->nz * sizeof *instance->side;
}

size_t instance_state_size(const Instance *instance)
{
    return sizeof(Header) + sides_size(instance) + engine_state_size(instance->engine);
}

/* FNV-1a of what follows the header and of the header itself without its check. */
static unsigned long long check_of(const Header *header, const char *rest, size_t size)
{
    unsigned long long value = 14695981039346656037ULL;
    Header copy = *header;
    copy.check = 0;
    for (size_t i = 0; i < sizeof copy; i++)
        value = (value ^ ((const unsigned char *)&copy)[i]) * 1099511628211ULL;
    for (size_t i = 0; i < size; i++)
        value = (value ^ ((const unsigned char *)rest)[i]) * 1099511628211ULL;
    return value;
}

void instance_save(const Instance *instance, void *bytes)
{
    char *rest = (char *)bytes + sizeof(Header);
    Header header;
    memset(&header, 0, sizeof header);
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    snprintf(header.token, sizeof header.token, "%s", brunovsky_description.token);
    header.start = instance->start;
    header.stop = instance->stop;
    header.model_exchange = instance->model_exchange;
    header.phase = (int)instance->phase;
    header.parameters_checked = instance->parameters_checked;
    header.started = instance->started;
    header.relations_current = instance->relations_current;
    memcpy(rest, instance->side, sides_size(instance));
    engine_save(instance->engine, rest + sides_size(instance));
    header.check = check_of(&header, rest, instance_state_size(instance) - sizeof header);
    memcpy(bytes, &header, sizeof header);
}

Result instance_recognizes(Instance *instance, const void *bytes, size_t size)
{
    Header header;
    if (size < sizeof header)
        return report(instance, FAILED, "the state is not one of this FMU: it has only %lu bytes", (unsigned long)size);
    memcpy(&header, bytes, sizeof header);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0 || size != instance_state_size(instance) ||
        strncmp(header.token, brunovsky_description.token, sizeof header.token) != 0)
        return report(instance, FAILED, "the state is not one of this FMU (%s)", brunovsky_description.token);
    if (header.model_exchange != instance->model_exchange)
        return report(instance, FAILED, "the state is one of a %s instance",
                      header.model_exchange ? "model-exchange" : "co-simulation");
    if (header.check != check_of(&header, (const char *)bytes + sizeof header, size - sizeof header))
        return report(instance, FAILED, "the state is damaged: its check sum does not match");
    return DONE;
}

Result instance_restore(Instance *instance, const void *bytes)
{
    const char *rest = (const char *)bytes + sizeof(Header);
    const Result result = instance_recognizes(instance, bytes, instance_state_size(instance));
    Header header;
    if (result != DONE)
        return result;
    memcpy(&header, bytes, sizeof header);
    instance->start = header.start;
    instance->stop = header.stop;
    instance->phase = (Phase)header.phase;
    instance->parameters_checked = header.parameters_checked;
    instance->started = header.started;
    instance->relations_current = header.relations_current;
    memcpy(instance->side, rest, sides_size(instance));
    engine_restore(instance->engine, rest + sides_size(instance));
    outdate(instance);
    return DONE;
}
