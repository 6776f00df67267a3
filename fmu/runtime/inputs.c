/* Inputs that vary over a communication step: polynomials given by their derivatives where the step begins.
 *
 * u(t) = u0 + u1 (t - t0) + u2 (t - t0)^2/2 + ..., as FMI 2 and 3 have it. The derivatives belong to one step. At its
 * end the inputs stand where the polynomials end, and so do their derivatives, which outputs' derivatives are made of;
 * the next step holds its inputs unless derivatives are given anew.
 */
#include "solver.h"

#include <string.h>

static size_t derivatives_size(const Engine *engine)
{
    return (size_t)(INPUT_ORDERS * engine->model->nu) * sizeof(double);
}

/* Value of a polynomial's derivative of this order (its own value: 0), by Horner's rule. */
static double polynomial(double value, const double *derivatives, int order, double elapsed)
{
    double result = 0;
    for (int k = INPUT_ORDERS; k > order; k--)
        result = (derivatives[k - 1] + result) * elapsed / (k - order);
    return (order ? derivatives[order - 1] : value) + result;
}

void engine_set_input_derivative(Engine *engine, int input, int order, double value)
{
    if (!engine->given)
        memset(engine->du, 0, derivatives_size(engine)); /* those of the last step */
    engine->du[INPUT_ORDERS * input + order - 1] = value;
    engine->given = 1;
}

int engine_begin_inputs(Engine *engine, double stop)
{
    if (!engine->given) {
        memset(engine->du, 0, derivatives_size(engine));
        return ENGINE_OK;
    }
    memcpy(engine->u_begin, engine->u, (size_t)engine->model->nu * sizeof(double));
    engine->begin = engine->time;
    engine_vary_inputs(engine, stop);
    const int bad = first_not_finite(engine->u, engine->model->nu);
    if (bad >= 0)
        return engine_fail(engine, -1, engine->model->u_names[bad], "leaves all bounds within the step that begins");
    engine_vary_inputs(engine, engine->begin);
    return ENGINE_OK;
}

void engine_vary_inputs(const Engine *engine, double time)
{
    for (int i = 0; i < engine->model->nu; i++)
        engine->u[i] = polynomial(engine->u_begin[i], engine->du + INPUT_ORDERS * i, 0, time - engine->begin);
}

void engine_end_inputs(Engine *engine)
{
    for (int i = 0; i < engine->model->nu && engine->given; i++)
        for (int order = 1; order <= INPUT_ORDERS; order++) {
            double *derivatives = engine->du + INPUT_ORDERS * i;
            derivatives[order - 1] = polynomial(0, derivatives, order, engine->time - engine->begin);
        }
    engine->given = 0;
}
