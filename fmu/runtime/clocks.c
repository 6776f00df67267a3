/* Clocks: ticks in event mode, their period, and scheduled execution. */
#include "instance.h"

#include <math.h>

#include "variables.h"

static Result find_clock(Instance *instance, unsigned reference, int *clock)
{
    Kind kind;
    return variable_find(instance, CLOCK, reference, &kind, clock);
}

void instance_tick(Instance *instance, unsigned reference, int active)
{
    int clock;
    variable_locate(reference, &clock);
    engine_tick(instance->engine, clock, active);
    instance->relations_current = 0;
    instance_outdate(instance);
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

Result instance_admits_period(Instance *instance, unsigned reference, double period)
{
    const Model *model = instance->engine->model;
    int clock, parameter;
    const Result result = find_clock(instance, reference, &clock);
    if (result != DONE)
        return result;
    parameter = model->k_parameter[clock];
    if (parameter < 0)
        return instance_report(instance, FAILED, "%s has a constant interval, %g s", model->k_names[clock],
                               model->k_period[clock]);
    return instance_admits(instance, REAL, FIRST_PARAMETER + (unsigned)parameter, period);
}

void instance_set_period(Instance *instance, unsigned reference, double period)
{
    int clock;
    variable_locate(reference, &clock);
    instance_set(instance, FIRST_PARAMETER + (unsigned)instance->engine->model->k_parameter[clock], period);
}

Result instance_activate(Instance *instance, unsigned reference, double time)
{
    Engine *engine = instance->engine;
    int clock;
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
    instance_outdate(instance);
    engine_save(engine, engine->backup);
    engine->time = time;
    engine_tick(engine, clock, 1);
    if (engine_event(engine) != ENGINE_OK || engine_check_finite(engine) != ENGINE_OK) {
        engine_restore(engine, engine->backup);
        instance_take_back_told(instance);
        return instance_report(instance, FAILED, "%s", engine->message);
    }
    engine->event_due = 0;
    instance->relations_current = 1;
    instance->activation[clock] = time;
    return DONE;
}
