/* Life cycle, steps and events of an FMU. See instance.h; the equations and their semantics are in engine.c. */
#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output_derivatives.h"
#include "sensitivity.h"
#include "variables.h"

#define DEFAULT_STEP_SIZE 1e-3

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
    instance->side = calloc((size_t)(model->nz + 2 * model->nm + model->ny) + 1, sizeof *instance->side);
    instance->sensitivity = sensitivity_new();
    if (!instance->engine || !instance->dx || !instance->dy || !instance->side || !instance->sensitivity) {
        instance_free(instance);
        return NULL;
    }
    instance->z = instance->dx + model->nx;
    instance->before = instance->z + model->nz;
    instance->activation = instance->before + model->nx + model->nq;
    instance->modes_before = instance->side + model->nz;
    instance->told = instance->modes_before + model->nm;
    instance->interface = interface;
    instance_use_events(instance, 0, 0);
    instance_reset(instance);
    return instance;
}

void instance_use_events(Instance *instance, int event_mode, int early_return)
{
    Engine *engine = instance->engine;
    instance->event_mode = event_mode;
    instance->early_return = early_return;
    engine->leave_events = event_mode;
    engine->pause_at_event = event_mode && early_return;
    engine->clocked = event_mode || instance->interface != CO_SIMULATION;
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
    instance->parameters_checked = instance->relations_current = 0;
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

const char *instance_interface_name(Interface interface)
{
    static const char *const names[] = {"co-simulation", "model-exchange", "scheduled-execution"};
    return names[interface];
}

Result instance_permits(Instance *instance, int phases)
{
    if (instance->phase & phases)
        return DONE;
    return instance_report(instance, FAILED, "is not allowed while a %s instance is %s",
                           instance_interface_name(instance->interface), instance_phase_name(instance));
}

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
    if (instance->phase == INITIALIZATION && !instance->relations_current) {
        int (*const listening)(void *, int) = engine->observe;
        int status;
        instance_outdate(instance);
        engine->observe = NULL; /* trial values may follow */
        status = engine_start(engine, instance->start, instance->interface == MODEL_EXCHANGE);
        engine->observe = listening;
        if (status != ENGINE_OK)
            return instance_report(instance, FAILED, "%s", engine->message);
        instance->parameters_checked = instance->relations_current = 1;
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
    instance->phase = INITIALIZATION;
    instance->relations_current = 0;
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
    instance_outdate(instance); /* entries: states and samples are knowns from now on */
    instance_choose_sides(instance);
    instance_tell_start(instance);
    return DONE;
}
