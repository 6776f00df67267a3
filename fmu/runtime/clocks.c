/* Clocks: ticks in event mode, their period, and scheduled execution. */
#include "instance.h"

#include <math.h>

#include "variables.h"

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
