/* Classical Runge-Kutta of order 4 in equal substeps no longer than step_size, each of which begins with an event. */
#include "solver.h"

#include <math.h>
#include <string.h>

#define STEP_ROUNDING 1e-9 /* a step is cut into ceil(h/step_size - STEP_ROUNDING) substeps */

/* What explains a step that is not finite: the first check that fails at one of its stages that still are. */
static int failed_check(Engine *engine, double h)
{
    static const double fraction[] = {0, 0.5, 0.5, 1};
    const int n = engine->model->nx;
    double *slopes = engine->work, *stage = slopes + 4 * n;
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < n; i++)
            stage[i] = k ? engine->x[i] + fraction[k] * h * slopes[(k - 1) * n + i] : engine->x[i];
        inputs_at(engine, engine->time + fraction[k] * h);
        const int check = engine_stage_check(engine, engine->time + fraction[k] * h, stage);
        if (check != -1)
            return check < 0 ? -1 : check;
    }
    return -1;
}

static int rk4_step(Engine *engine, double h)
{
    const Model *model = engine->model;
    const int n = model->nx;
    const double t = engine->time;
    double *x = engine->x, *k1 = engine->work, *k2 = k1 + n, *k3 = k2 + n, *k4 = k3 + n, *stage = k4 + n;
    const double *u = engine->u, *p = engine->p, *q = engine->q;
    const int *m = engine->m, *r = engine->r;
    model->derivatives(t, x, u, p, q, m, r, k1);
    for (int i = 0; i < n; i++)
        stage[i] = x[i] + 0.5 * h * k1[i];
    inputs_at(engine, t + 0.5 * h);
    model->derivatives(t + 0.5 * h, stage, u, p, q, m, r, k2);
    for (int i = 0; i < n; i++)
        stage[i] = x[i] + 0.5 * h * k2[i];
    model->derivatives(t + 0.5 * h, stage, u, p, q, m, r, k3);
    for (int i = 0; i < n; i++)
        stage[i] = x[i] + h * k3[i];
    inputs_at(engine, t + h);
    model->derivatives(t + h, stage, u, p, q, m, r, k4);
    for (int i = 0; i < n; i++)
        stage[i] = x[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    const int bad = first_not_finite(stage, n);
    if (bad >= 0)
        return engine_fail(engine, failed_check(engine, h), model->x_names[bad], "is not finite after the step");
    memcpy(x, stage, (size_t)n * sizeof *x);
    return ENGINE_OK;
}

static long substeps(const Engine *engine, double length)
{
    if (length <= engine->step_size * (1 + STEP_ROUNDING))
        return 1;
    return (long)ceil(length / engine->step_size - STEP_ROUNDING);
}

int rk4_integrate(Engine *engine, double stop)
{
    const double begin = engine->time, length = stop - begin;
    const long count = substeps(engine, length);
    const double size = count == 1 ? length : length / (double)count;
    for (long i = 0; i < count; i++) {
        if (i && engine_event(engine) != ENGINE_OK)
            return ENGINE_FAILED;
        if (rk4_step(engine, size) != ENGINE_OK)
            return ENGINE_FAILED;
        engine->time = i + 1 < count ? begin + (double)(i + 1) * size : stop;
        inputs_at(engine, engine->time);
        if (engine_pause(engine) != ENGINE_OK)
            return ENGINE_PAUSED;
    }
    return ENGINE_OK;
}
