/* Communication steps of co-simulation, and the events of event mode. */
#include "instance.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define TIME_ROUNDING 1e-6  /* part of a step by which the master's time may differ from the instance's */

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
    const int relations_before = instance->relations_current;
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
    instance->relations_current = relations_before;
    instance_take_back_told(instance);
    return instance_report(instance, DISCARDED, "%s", engine->message);
}

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
        instance_take_back_told(instance);
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
