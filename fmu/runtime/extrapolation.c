/* Time derivatives of inputs and outputs, by which a master extrapolates signals over communication steps. */
#include <math.h>

#include "instance.h"
#include "output_derivatives.h"

#define FIRST_PARAMETER 3 /* value reference: see description.h */

Result instance_admits_input_derivative(Instance *instance, unsigned reference, int order, double value)
{
    const Model *model = instance->engine->model;
    const unsigned input = reference - (unsigned)(FIRST_PARAMETER + model->np); /* wraps below the first one */
    if (input >= (unsigned)model->nu)
        return instance_report(instance, FAILED, "only inputs have derivatives to set, and value reference %u is none", reference);
    if (order < 1 || order > INPUT_ORDERS)
        return instance_report(instance, FAILED, "the derivative of %s is of order %d; a step follows those from 1 to %d",
                      model->u_names[input], order, INPUT_ORDERS);
    if (!isfinite(value))
        return instance_report(instance, FAILED, "the derivative of order %d of %s cannot be set to %g: it is not finite", order,
                      model->u_names[input], value);
    return DONE;
}

Result instance_set_input_derivative(Instance *instance, unsigned reference, int order, double value)
{
    const Result result = instance_admits_input_derivative(instance, reference, order, value);
    if (result == DONE)
        engine_set_input_derivative(instance->engine,
                                    (int)reference - FIRST_PARAMETER - instance->engine->model->np, order, value);
    instance->output_derivatives_current = 0;
    return result;
}

Result instance_get_output_derivative(Instance *instance, unsigned reference, int order, double *value)
{
    const Engine *engine = instance->engine;
    const Model *model = engine->model;
    const unsigned output = reference - (unsigned)(FIRST_PARAMETER + model->np + model->nu);
    const Result result = instance_get(instance, REAL, reference, value); /* relations are those of the moment now */
    if (result != DONE)
        return result;
    if (output >= (unsigned)model->ny)
        return instance_report(instance, FAILED, "only outputs have derivatives to get, and value reference %u is none", reference);
    if (order < 1 || order > brunovsky_output_derivatives.order)
        return instance_report(instance, FAILED, "the derivative of %s is of order %d; there are those from 1 to %d (maxOutputDerivativeOrder)",
                      model->y_names[output], order, brunovsky_output_derivatives.order);
    if (!instance->output_derivatives_current)
        brunovsky_output_derivatives.evaluate(engine->time, engine->x, engine->u, engine->p, engine->q, engine->m,
                                              engine->r, engine->du, instance->dy);
    instance->output_derivatives_current = 1;
    *value = instance->dy[(order - 1) * model->ny + (int)output];
    if (!isfinite(*value))
        return instance_report(instance, FAILED, "%s: the derivative of order %d of %s is not finite at t = %.9g s", model->name, order,
                      model->y_names[output], engine->time);
    return DONE;
}
