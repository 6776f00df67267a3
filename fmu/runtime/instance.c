/* Life cycle, steps and events of an FMU. See instance.h; the equations and their semantics are in engine.c. */
#include "instance.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output_derivatives.h"
#include "sensitivity.h"
#include "variables.h"

#define DEFAULT_STEP_SIZE 1e-3
#define TIME_ROUNDING 1e-6  /* part of a step by which the master's time may differ from the instance's */
#define INDICATOR_SHIFT 1e-12 /* an indicator is this far from zero after its event, as FMI recommends */

Result instance_report(Instance *instance, Result result, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(instance->message, sizeof instance->message, format, arguments);
    va_end(arguments);
    return result;
}

Instance *instance_new(Interface interface)
{
    const Model *model = &brunovsky_model;
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance)
        return NULL;
    instance->engine = engine_new(model, DEFAULT_STEP_SIZE);
    instance->dx = calloc((size_t)(2 * model->nx + model->nz + model->nq + model->nk) + 1, sizeof *instance->dx);
    instance->dy = calloc((size_t)(brunovsky_output_derivatives.order * model->ny) + 1, sizeof *instance->dy);
    instance->side = calloc((size_t)(model->nz + model->nr + 2 * model->nm + model->ny) + 1, sizeof *instance->side);
    instance->sensitivity = sensitivity_new();
    if (!instance->engine || !instance->dx || !instance->dy || !instance->side || !instance->sensitivity) {
        instance_free(instance);
        return NULL;
    }
    instance->z = instance->dx + model->nx;
    instance->before = instance->z + model->nz;
    instance->activation = instance->before + model->nx + model->nq;
    instance->r = instance->side + model->nz;
    instance->modes_before = instance->r + model->nr;
    instance->told = instance->modes_before + model->nm;
    instance->interface = interface;
    instance_reset(instance);
    return instance;
}

void instance_free(Instance *instance)
{
    if (!instance)
        return;
    engine_free(instance->engine);
    free(instance->dx);
    free(instance->dy);
    free(instance->side);
    free(instance->sensitivity);
    free(instance);
}

void instance_outdate(Instance *instance)
{
    instance->outputs_current = instance->derivatives_current = 0;
    instance->entries_current = instance->output_derivatives_current = 0;
}

void instance_reset(Instance *instance)
{
    Engine *engine = instance->engine;
    engine_reset(engine);
    engine->step_size = DEFAULT_STEP_SIZE;
    engine->tolerance = DEFAULT_TOLERANCE;
    engine->solver = SOLVER_RK4;
    engine->event_due = 0;
    instance->phase = INSTANTIATED;
    instance->start = 0;
    instance->stop = HUGE_VAL;
    instance->started = instance->parameters_checked = instance->relations_current = 0;
    memset(instance->side, 0, (size_t)engine->model->nz * sizeof *instance->side);
    for (int i = 0; i < engine->model->nk; i++)
        instance->activation[i] = -HUGE_VAL;
    instance_outdate(instance);
}

const char *instance_phase_name(const Instance *instance)
{
    switch (instance->phase) {
    case INSTANTIATED: return "instantiated";
    case INITIALIZATION: return "in initialization mode";
    case STEP: return "between communication steps";
    case INTERMEDIATE: return "within a communication step";
    case EVENT: return "in event mode";
    case CONTINUOUS_TIME: return "in continuous-time mode";
    case ACTIVATION: return "in clock activation mode";
    default: return "terminated";
    }
}

Result instance_permits(Instance *instance, int phases)
{
    static const char *const interfaces[] = {"co-simulation", "model-exchange", "scheduled-execution"};
    if (instance->phase & phases)
        return DONE;
    return instance_report(instance, FAILED, "is not allowed while a %s instance is %s", interfaces[instance->interface],
                           instance_phase_name(instance));
}

/* Listening ------------------------------------------------------------------------------------------------------- */

static void tell(const Instance *instance, Topic topic, const char *name, const char *change)
{
    char text[384];
    if (!instance->listener.tell)
        return;
    snprintf(text, sizeof text, "%s %s at t = %.9g s", name, change, instance->engine->time);
    instance->listener.tell(instance->listener.master, topic, text);
}

static int is_singularity(const char *name)
{
    const size_t length = strlen(name), end = strlen("singular");
    return length >= end && strcmp(name + length - end, "singular") == 0;
}

/* Tells what changed of the Boolean outputs and modes since the last time. */
static void tell_changes(Instance *instance)
{
    Engine *engine = instance->engine;
    const Model *model = engine->model;
    int *modes = instance->told + model->ny;
    char change[64];
    engine_outputs(engine);
    for (int i = 0; i < model->ny; i++) {
        const int value = engine->y[i] != 0;
        if (brunovsky_description.y_types[i] != BOOLEAN || value == instance->told[i])
            continue;
        instance->told[i] = value;
        tell(instance, is_singularity(model->y_names[i]) ? ABOUT_SINGULARITY : ABOUT_EVENTS, model->y_names[i],
             value ? "became true" : "became false");
    }
    for (int i = 0; i < model->nm; i++) {
        if (engine->m[i] == modes[i])
            continue;
        snprintf(change, sizeof change, "changed from %d to %d", modes[i], engine->m[i]);
        modes[i] = engine->m[i];
        tell(instance, ABOUT_EVENTS, brunovsky_description.m_names[i], change);
    }
}

static int ask(Instance *instance)
{
    int wanted;
    double end = instance->engine->time;
    instance->phase = INTERMEDIATE;
    instance_outdate(instance);
    wanted = instance->listener.ask(instance->listener.master, instance->engine->time, &end);
    instance->phase = STEP;
    if (!wanted || !(end < instance->end))
        return 0;
    instance->end = fmax(end, instance->engine->time);
    return 1;
}

static int observe(void *observer, int what)
{
    Instance *instance = observer;
    if (what == ENGINE_STEPPED)
        return instance->listener.ask && instance->phase == STEP ? ask(instance) : 0;
    if (instance->listener.tell)
        tell_changes(instance);
    return 0;
}

void instance_listen(Instance *instance, Listener listener)
{
    instance->listener.tell = NULL;
    if (instance->phase & ~(INSTANTIATED | INITIALIZATION))
        tell_changes(instance); /* what holds now is no news */
    instance->listener = listener;
    instance->engine->observer = instance;
    instance->engine->observe = listener.tell || listener.ask ? observe : NULL;
}

/* Nothing is known to be true yet, and modes have their start values. */
static void forget_told(Instance *instance)
{
    const Model *model = instance->engine->model;
    memset(instance->told, 0, (size_t)model->ny * sizeof *instance->told);
    memcpy(instance->told + model->ny, model->m_start, (size_t)model->nm * sizeof *instance->told);
}

/* Values calculated ------------------------------------------------------------------------------------------------ */

/* What explains a value that is not finite: the engine's diagnosis, which names the first output or derivative. */
Result instance_not_finite(Instance *instance, const char *name)
{
    const Result result = instance->phase == CONTINUOUS_TIME ? DISCARDED : FAILED;
    if (engine_check_finite(instance->engine) != ENGINE_OK)
        return instance_report(instance, result, "%s", instance->engine->message);
    return instance_report(instance, result, "%s: %s is not finite at t = %.9g s", instance->engine->model->name, name,
                           instance->engine->time);
}

Result instance_check_parameters(Instance *instance)
{
    if (!instance->parameters_checked &&
        engine_check_parameters(instance->engine, instance->interface == MODEL_EXCHANGE) != ENGINE_OK)
        return instance_report(instance, FAILED, "%s", instance->engine->message);
    instance->parameters_checked = 1;
    return DONE;
}

/* Start values before the run. At a communication point where inputs changed and in event mode relations and the samples
 * of ticking clocks too, so that outputs are of the branch that belongs to these values. */
Result instance_refresh(Instance *instance)
{
    Engine *engine = instance->engine;
    const int settled = EVENT | ACTIVATION | (instance->event_mode ? 0 : STEP);
    if (instance->phase == INITIALIZATION && !instance->started) {
        int (*const listening)(void *, int) = engine->observe;
        int status;
        instance_outdate(instance);
        engine->observe = NULL; /* trial values may follow */
        status = engine_start(engine, instance->start, instance->interface == MODEL_EXCHANGE);
        engine->observe = listening;
        if (status != ENGINE_OK)
            return instance_report(instance, FAILED, "%s", engine->message);
        instance->started = instance->parameters_checked = instance->relations_current = 1;
    }
    if (!instance->relations_current && instance->phase & settled) {
        if (engine->model->nk)
            engine_sample_clocks(engine);
        engine_relations(engine);
        instance->relations_current = 1;
    }
    return DONE;
}

const double *instance_outputs(Instance *instance)
{
    if (!instance->outputs_current)
        engine_outputs(instance->engine);
    instance->outputs_current = 1;
    return instance->engine->y;
}

const double *instance_derivatives(Instance *instance)
{
    if (!instance->derivatives_current)
        engine_derivatives(instance->engine, instance->dx);
    instance->derivatives_current = 1;
    return instance->dx;
}

const double *instance_indicators(Instance *instance)
{
    engine_indicators(instance->engine, instance->z);
    for (int i = 0; i < instance->engine->model->nz; i++)
        instance->z[i] += instance->side[i] * INDICATOR_SHIFT;
    return instance->z;
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

Result instance_set_up(Instance *instance, double start, double stop, double tolerance)
{
    if (!isfinite(start) || isnan(stop) || stop < start)
        return instance_report(instance, FAILED, "an experiment from %g s to %g s has no length", start, stop);
    instance->start = start;
    instance->stop = stop;
    instance->engine->tolerance = tolerance;
    return DONE;
}

void instance_enter_initialization(Instance *instance)
{
    Engine *engine = instance->engine;
    instance->phase = INITIALIZATION;
    instance->started = 0;
    engine->leave_events = instance->event_mode;
    engine->pause_at_event = instance->event_mode && instance->early_return;
    engine->clocked = instance->event_mode || instance->interface != CO_SIMULATION;
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
    return instance_report(instance, FAILED,
                           "the experiment's tolerance = %g is out of the range of this solver, from %g to %g",
                           engine->tolerance, LEAST_TOLERANCE, LARGEST_TOLERANCE);
}

Result instance_exit_initialization(Instance *instance)
{
    Result result = instance->interface == CO_SIMULATION ? check_tolerance(instance) : DONE;
    if (result == DONE)
        result = instance_refresh(instance);
    if (result != DONE)
        return result;
    if (instance->interface == SCHEDULED_EXECUTION)
        instance->phase = ACTIVATION;
    else
        instance->phase = instance->interface == MODEL_EXCHANGE || instance->event_mode ? EVENT : STEP;
    choose_sides(instance);
    forget_told(instance);
    if (instance->listener.tell)
        tell_changes(instance);
    return DONE;
}

/* Steps ------------------------------------------------------------------------------------------------------------ */

static Result check_step(Instance *instance, double time, double length)
{
    const Engine *engine = instance->engine;
    const double rounding =
        TIME_ROUNDING * (length > 0 ? length : engine->step_size) + 4 * DBL_EPSILON * fabs(engine->time);
    if (!isfinite(time) || !isfinite(length) || length < 0)
        return instance_report(instance, FAILED,
                               "a communication step of %g s from t = %.9g s is not a finite step forward", length, time);
    if (fabs(time - engine->time) > rounding)
        return instance_report(instance, FAILED,
                               "the communication point is t = %.9g s, but the instance is at t = %.9g s", time,
                               engine->time);
    if (time + length > instance->stop + rounding)
        return instance_report(instance, FAILED,
                               "a communication step of %g s from t = %.9g s passes the stop time, %.9g s", length, time,
                               instance->stop);
    if (time + length == time)
        return instance_report(instance, WARNED, "a communication step of %g s at t = %.9g s does nothing", length, time);
    return DONE;
}

Result instance_step(Instance *instance, double time, double length)
{
    Engine *engine = instance->engine;
    const double before = engine->time;
    Result result = check_step(instance, time, length);
    int status;
    engine->event_due = 0;
    if (result == DONE)
        result = instance_check_parameters(instance);
    if (result != DONE)
        return result;
    engine->time = time; /* the master's time, so that rounding does not add up */
    instance->end = time + length;
    instance_outdate(instance);
    status = engine_advance(engine, length);
    while (status == ENGINE_OK && engine->time < instance->end && instance->end < time + length && !engine->event_due)
        status = engine_continue(engine, instance->end);
    instance->phase = STEP;
    instance_outdate(instance);
    if (status == ENGINE_OK) {
        instance->relations_current = 1;
        return DONE;
    }
    engine->time = before;
    if (instance->listener.tell)
        instance_listen(instance, instance->listener);
    return instance_report(instance, DISCARDED, "%s", engine->message);
}

/* Clocks ----------------------------------------------------------------------------------------------------------- */

static Result find_clock(Instance *instance, unsigned reference, int *clock)
{
    Kind kind;
    return variable_find(instance, CLOCK, reference, &kind, clock);
}

Result instance_tick(Instance *instance, unsigned reference, int active)
{
    int clock;
    const Result result = find_clock(instance, reference, &clock);
    if (result != DONE)
        return result;
    engine_tick(instance->engine, clock, active);
    instance->relations_current = 0;
    instance_outdate(instance);
    return DONE;
}

Result instance_ticks(Instance *instance, unsigned reference, int *active)
{
    int clock;
    const Result result = find_clock(instance, reference, &clock);
    if (result == DONE)
        *active = instance->engine->active[clock];
    return result;
}

Result instance_period(Instance *instance, unsigned reference, double *period)
{
    const Model *model = instance->engine->model;
    int clock;
    const Result result = find_clock(instance, reference, &clock);
    if (result == DONE)
        *period = model->k_parameter[clock] < 0 ? model->k_period[clock] : instance->engine->p[model->k_parameter[clock]];
    return result;
}

Result instance_set_period(Instance *instance, unsigned reference, double period)
{
    const Model *model = instance->engine->model;
    int clock, parameter;
    Result result = find_clock(instance, reference, &clock);
    if (result != DONE)
        return result;
    parameter = model->k_parameter[clock];
    if (parameter < 0)
        return instance_report(instance, FAILED, "%s has a constant interval, %g s", model->k_names[clock],
                               model->k_period[clock]);
    result = instance_admits(instance, REAL, 3 + (unsigned)parameter, period);
    if (result == DONE)
        instance_set(instance, 3 + (unsigned)parameter, period);
    return result;
}

Result instance_activate(Instance *instance, unsigned reference, double time)
{
    Engine *engine = instance->engine;
    double before;
    int clock;
    Event event;
    Result result = find_clock(instance, reference, &clock);
    if (result != DONE)
        return result;
    if (!isfinite(time) || time < instance->start || time <= instance->activation[clock])
        return instance_report(instance, FAILED,
                               "%s cannot be activated at t = %.9g s: it must be later than the last time, t = %.9g s",
                               engine->model->k_names[clock], time, fmax(instance->start, instance->activation[clock]));
    result = instance_check_parameters(instance);
    if (result != DONE)
        return result;
    before = engine->time;
    engine->time = time;
    engine_tick(engine, clock, 1);
    result = instance_event(instance, &event);
    if (result == DONE && engine_check_finite(engine) != ENGINE_OK)
        result = instance_report(instance, FAILED, "%s", engine->message);
    if (result == DONE) {
        instance->activation[clock] = time;
        return DONE;
    }
    engine_restore(engine, engine->backup); /* as instance_event began: the clock ticks */
    engine_tick(engine, clock, 0);
    engine->time = before;
    return result;
}

/* Events ----------------------------------------------------------------------------------------------------------- */

void instance_enter_event(Instance *instance)
{
    instance->phase = EVENT;
    instance->relations_current = 0;
    instance_outdate(instance);
}

Result instance_event(Instance *instance, Event *event)
{
    Engine *engine = instance->engine;
    const Model *model = engine->model;
    const size_t nx = (size_t)model->nx * sizeof(double), nq = (size_t)model->nq * sizeof(double);
    const size_t nm = (size_t)model->nm * sizeof(int);
    const Result result = instance_check_parameters(instance);
    if (result != DONE)
        return result;
    instance_outdate(instance);
    engine_save(engine, engine->backup);
    memcpy(instance->before, engine->x, nx + nq);
    memcpy(instance->modes_before, engine->m, nm);
    if (engine_event(engine) != ENGINE_OK) {
        engine_restore(engine, engine->backup);
        return instance_report(instance, FAILED, "%s", engine->message);
    }
    engine->event_due = 0;
    instance->relations_current = 1;
    event->states_changed = memcmp(instance->before, engine->x, nx) != 0;
    event->discrete_changed =
        memcmp(instance->before + model->nx, engine->q, nq) != 0 || memcmp(instance->modes_before, engine->m, nm) != 0;
    event->next = engine_next_sample(engine);
    return DONE;
}

Result instance_enter_step(Instance *instance)
{
    Result result = instance_check_parameters(instance);
    if (result == DONE)
        result = instance_refresh(instance);
    if (result == DONE)
        instance->phase = STEP;
    return result;
}

/* Model exchange -------------------------------------------------------------------------------------------------- */

static Result counted(Instance *instance, const char *what, size_t count, int expected)
{
    if (count == (size_t)expected)
        return DONE;
    return instance_report(instance, FAILED, "%lu %s were given or asked for, but there are %d", (unsigned long)count, what,
                           expected);
}

Result instance_set_time(Instance *instance, double time)
{
    if (!isfinite(time))
        return instance_report(instance, FAILED, "time cannot be set to %g: it is not finite", time);
    instance->engine->time = time;
    instance_outdate(instance);
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
            return instance_report(instance, FAILED, "state %s cannot be set to %g: it is not finite",
                                   engine->model->x_names[i], states[i]);
    if (count)
        memcpy(engine->x, states, count * sizeof *states);
    instance_outdate(instance);
    return DONE;
}

Result instance_get_states(Instance *instance, double *states, size_t count)
{
    Result result = counted(instance, "continuous states", count, instance->engine->model->nx);
    if (result == DONE)
        result = instance_refresh(instance);
    if (result == DONE && count)
        memcpy(states, instance->engine->x, count * sizeof *states);
    return result;
}

Result instance_get_derivatives(Instance *instance, double *values, size_t count)
{
    const Model *model = instance->engine->model;
    Result result = counted(instance, "derivatives", count, model->nx);
    if (result == DONE)
        result = instance_refresh(instance);
    if (result != DONE)
        return result;
    for (size_t i = 0; i < count; i++) {
        values[i] = instance_derivatives(instance)[i];
        if (!isfinite(values[i]))
            return instance_not_finite(instance, model->x_names[i]);
    }
    return DONE;
}

Result instance_get_indicators(Instance *instance, double *indicators, size_t count)
{
    Result result = counted(instance, "event indicators", count, instance->engine->model->nz);
    if (result == DONE)
        result = instance_refresh(instance);
    if (result != DONE || !count)
        return result;
    instance_indicators(instance);
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(instance->z[i]))
            return instance_not_finite(instance, "an event indicator");
        indicators[i] = instance->z[i];
    }
    return DONE;
}

Result instance_get_nominals(Instance *instance, double *nominals, size_t count)
{
    const Result result = counted(instance, "nominals of continuous states", count, instance->engine->model->nx);
    for (size_t i = 0; result == DONE && i < count; i++)
        nominals[i] = instance->engine->model->x_nominal[i];
    return result;
}

Result instance_enter_continuous_time(Instance *instance)
{
    Result result = instance_check_parameters(instance);
    if (result == DONE)
        result = instance_refresh(instance);
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
