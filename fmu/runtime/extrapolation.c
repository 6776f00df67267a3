/* Time derivatives of inputs and outputs, by which a master extrapolates signals over communication steps. */
#include <math.h>

#include "output_derivatives.h"
#include "variables.h"

/* Index of the variable of this kind and reference; FAILED if it is another one or the order is out of range. */
static Result locate(Instance *instance, Kind kind, unsigned reference, int order, int highest, int *index)
{
    const char *what = kind == INPUT ? "input" : "output";
    Kind found;
    const Result result = variable_find(instance, REAL, reference, &found, index);
    if (result != DONE)
        return result;
    if (found != kind)
        return instance_report(instance, FAILED, "%s (value reference %u) is no %s", variable_name(found, *index), reference,
                               what);
    if (order < 1 || order > highest)
        return instance_report(instance, FAILED, "%s has no derivative of order %d; those of an %s are 1 to %d",
                               variable_name(found, *index), order, what, highest);
    return DONE;
}

Result instance_admits_input_derivative(Instance *instance, unsigned reference, int order, double value)
{
    int index;
    const Result result = locate(instance, INPUT, reference, order, INPUT_ORDERS, &index);
    if (result == DONE && !isfinite(value))
        return instance_report(instance, FAILED, "the derivative of order %d of %s cannot be set to %g: it is not finite",
                               order, variable_name(INPUT, index), value);
    return result;
}

void instance_set_input_derivative(Instance *instance, unsigned reference, int order, double value)
{
    int index;
    variable_locate(reference, &index);
    engine_set_input_derivative(instance->engine, index, order, value);
    instance->output_derivatives_current = 0;
}

Result instance_get_output_derivative(Instance *instance, unsigned reference, int order, double *value)
{
    const Engine *engine = instance->engine;
    int index;
    Result result = locate(instance, OUTPUT, reference, order, brunovsky_output_derivatives.order, &index);
    if (result == DONE)
        result = instance_get(instance, REAL, reference, value); /* relations are those of the moment now */
    if (result != DONE)
        return result;
    if (!instance->output_derivatives_current)
        brunovsky_output_derivatives.evaluate(engine->time, engine->x, engine->u, engine->p, engine->q, engine->m,
                                              engine->r, engine->du, instance->dy);
    instance->output_derivatives_current = 1;
    *value = instance->dy[(order - 1) * engine->model->ny + index];
    if (!isfinite(*value))
        return instance_report(instance, FAILED, "%s: the derivative of order %d of %s is not finite at t = %.9g s",
                               engine->model->name, order, variable_name(OUTPUT, index), engine->time);
    return DONE;
}
