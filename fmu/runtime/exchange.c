/* Model exchange: time, states and their derivatives, indicators, for a solver outside. */
#include "instance.h"

#include <math.h>
#include <string.h>

#define INDICATOR_SHIFT 1e-12 /* an indicator is this far from zero after its event, as FMI recommends */

static Result counted(Instance *instance, const char *what, size_t count, int expected)
{
    if (count == (size_t)expected)
        return DONE;
    return instance_report(instance, FAILED, "%lu %s were given or asked for, but there are %d", (unsigned long)count, what,
                           expected);
}

/* Indicators ------------------------------------------------------------------------------------------------------- */

static int side_of(double indicator)
{
    return (indicator > 0) - (indicator < 0);
}

void instance_choose_sides(Instance *instance)
{
    engine_indicators(instance->engine, instance->z);
    for (int i = 0; i < instance->engine->model->nz; i++)
        instance->side[i] = side_of(instance->z[i]);
}

const double *instance_indicators(Instance *instance)
{
    engine_indicators(instance->engine, instance->z);
    for (int i = 0; i < instance->engine->model->nz; i++)
        instance->z[i] += instance->side[i] * INDICATOR_SHIFT;
    return instance->z;
}

/* Model exchange --------------------------------------------------------------------------------------------------- */

Result instance_set_time(Instance *instance, double time)
{
    if (!isfinite(time))
        return instance_report(instance, FAILED, "time cannot be set to %g: it is not finite", time);
    instance->engine->time = time;
    instance->relations_current = 0;
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
    instance_choose_sides(instance);
    instance->phase = CONTINUOUS_TIME;
    return DONE;
}

/* An event is needed where a relation no longer is what it was frozen at: the solver may have stepped over a crossing,
 * or started exactly on one, where an indicator has no side to come from. */
int instance_complete_step(Instance *instance)
{
    Engine *engine = instance->engine;
    engine_indicators(engine, instance->z);
    for (int i = 0; i < engine->model->nz; i++)
        if (!instance->side[i])
            instance->side[i] = side_of(instance->z[i]);
    return engine_relations_differ(engine, engine->time, engine->x);
}
