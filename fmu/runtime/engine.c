/* Semantics of a running block, the same as those of the NumPy engine that states them readably.
 *
 * Between events relations are frozen. At an event: due samples in the order of their rank, then relations and
 * transitions until nothing changes. A communication step is cut at sample instants; each piece is integrated by one of
 * two methods: equal substeps that each begin with an event (rk4.c), or steps chosen by the tolerance and cut where a
 * relation changes (dormand_prince.c). On the way out relations are evaluated once more, so that outputs belong to the
 * state reached and to the inputs at the end of the step; samples and transitions of that instant wait for the next
 * step and its inputs. Inputs are held, or vary over a step as their derivatives say (inputs.c).
 */
#include "solver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SUBSTEPS 1e9

static size_t doubles_saved(const Model *model)
{
    return 5 + (size_t)(model->nx + 2 * model->nq + (1 + INPUT_ORDERS) * model->nu + model->np);
}

Engine *engine_new(const Model *model, double step_size)
{
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq;
    const size_t trial = 2 * (nx + (size_t)model->ny) + nq; /* of event_matters */
    const size_t doubles = doubles_saved(model) + (size_t)(model->nu + model->ny) + 9 * nx + 2 * nq + trial + 1;
    const size_t integers = (size_t)(2 * model->nm + 2 * model->nr + model->nk) + 1;
    Engine *engine = calloc(1, sizeof *engine);
    double *store = calloc(doubles, sizeof *store);
    long long *due = calloc(nq + 1, sizeof *due);
    int *flags = calloc(integers, sizeof *flags);
    if (engine) {
        engine->model = model;
        engine->backup = malloc(engine_state_size(engine));
    }
    if (!engine || !store || !due || !flags || !engine->backup) {
        if (engine)
            free(engine->backup);
        free(engine);
        free(store);
        free(due);
        free(flags);
        return NULL;
    }
    engine->step_size = step_size;
    engine->tolerance = DEFAULT_TOLERANCE;
    engine->solver = SOLVER_RK4;
    engine->x = store;
    engine->q = engine->x + nx;
    engine->u = engine->q + nq;
    engine->p = engine->u + model->nu;
    engine->previous = engine->p + model->np;
    engine->du = engine->previous + nq;
    engine->u_begin = engine->du + INPUT_ORDERS * model->nu;
    engine->y = engine->u_begin + model->nu;
    engine->trial = engine->y + model->ny;
    engine->work = engine->trial + trial;
    engine->due = due;
    engine->m = flags;
    engine->r = flags + 2 * model->nm;
    engine->active = engine->r + 2 * model->nr;
    engine->reason = "";
    engine_reset(engine);
    return engine;
}

void engine_free(Engine *engine)
{
    if (!engine)
        return;
    free(engine->x);
    free(engine->due);
    free(engine->m);
    free(engine->backup);
    free(engine);
}

size_t engine_state_size(const Engine *engine)
{
    const Model *model = engine->model;
    return doubles_saved(model) * sizeof(double) + (size_t)model->nq * sizeof(long long) +
           (size_t)(3 + model->nm + model->nr + model->nk) * sizeof(int);
}

static void copy(char **bytes, void *values, size_t size, int restore)
{
    if (!size)
        return;
    if (restore)
        memcpy(values, *bytes, size);
    else
        memcpy(*bytes, values, size);
    *bytes += size;
}

static void transfer(Engine *engine, char *bytes, int restore)
{
    const Model *model = engine->model;
    copy(&bytes, &engine->time, sizeof(double), restore);
    copy(&bytes, &engine->start_time, sizeof(double), restore);
    copy(&bytes, &engine->step_size, sizeof(double), restore);
    copy(&bytes, &engine->tolerance, sizeof(double), restore);
    copy(&bytes, &engine->crowd, sizeof(double), restore);
    copy(&bytes, engine->x, (doubles_saved(model) - 5) * sizeof(double), restore); /* with q, u, p, previous and du */
    copy(&bytes, engine->due, (size_t)model->nq * sizeof(long long), restore);
    copy(&bytes, &engine->solver, sizeof(int), restore);
    copy(&bytes, &engine->given, sizeof(int), restore);
    copy(&bytes, &engine->crowded, sizeof(int), restore);
    copy(&bytes, engine->m, (size_t)model->nm * sizeof(int), restore);
    copy(&bytes, engine->r, (size_t)model->nr * sizeof(int), restore);
    copy(&bytes, engine->active, (size_t)model->nk * sizeof(int), restore);
}

void engine_save(const Engine *engine, void *bytes)
{
    transfer((Engine *)engine, bytes, 0);
}

void engine_restore(Engine *engine, const void *bytes)
{
    transfer(engine, (char *)bytes, 1);
}

void engine_reset(Engine *engine)
{
    const Model *model = engine->model;
    engine->time = engine->start_time = engine->crowd = 0;
    engine->crowded = 0;
    for (int i = 0; i < model->nx + model->nq; i++)
        engine->x[i] = 0;
    for (int i = 0; i < model->np; i++)
        engine->p[i] = model->p_default[i];
    for (int i = 0; i < model->nu; i++)
        engine->u[i] = model->u_default[i];
    for (int i = 0; i < INPUT_ORDERS * model->nu; i++)
        engine->du[i] = 0;
    engine->given = 0;
    for (int i = 0; i < model->nq; i++)
        engine->due[i] = 0;
    for (int i = 0; i < 2 * model->nm + model->nr; i++)
        engine->m[i] = 0;
    for (int i = 0; i < model->nk; i++)
        engine->active[i] = 0;
}

int engine_fail(Engine *engine, int check, const char *variable, const char *problem)
{
    const Model *model = engine->model;
    engine->reason = check < 0 ? "diverged" : model->check_names[check];
    snprintf(engine->variable, sizeof engine->variable, "%s", variable);
    snprintf(engine->message, sizeof engine->message, "%s: %s %s at t = %.9g s%s%s", model->name, variable, problem,
             engine->time, check < 0 ? "" : ": ", check < 0 ? "" : model->check_messages[check]);
    return ENGINE_FAILED;
}

int engine_fail_here(Engine *engine, const char *variable, const char *problem)
{
    return engine_fail(engine, engine->model->failure_check(VALUES(engine)), variable, problem);
}

int engine_check_parameters(Engine *engine, int model_exchange)
{
    const Model *model = engine->model;
    const int check = model->start_check(engine->p, model_exchange);
    if (check >= 0) {
        engine->reason = model->check_names[check];
        engine->variable[0] = 0;
        snprintf(engine->message, sizeof engine->message, "%s: %s", model->name, model->check_messages[check]);
        return ENGINE_FAILED;
    }
    model->periods(engine->p, engine->work);
    for (int i = 0; i < model->nq; i++)
        if (!(engine->work[i] > 0 && isfinite(engine->work[i])))
            return engine_fail(engine, -1, model->q_names[i], "has a period that is not positive and finite");
    return ENGINE_OK;
}

int engine_start(Engine *engine, double start_time, int model_exchange)
{
    const Model *model = engine->model;
    engine->time = engine->start_time = engine->crowd = start_time;
    engine->crowded = 0;
    model->start(engine->p, engine->x, engine->q);
    for (int i = 0; i < model->nm; i++)
        engine->m[i] = model->m_start[i];
    for (int i = 0; i < model->nq; i++)
        engine->due[i] = 0;
    for (int i = 0; i < model->nk; i++)
        engine->active[i] = 0;
    if (engine_check_parameters(engine, model_exchange) != ENGINE_OK || engine_event(engine) != ENGINE_OK)
        return ENGINE_FAILED;
    return engine_check_finite(engine);
}

void engine_outputs(Engine *engine)
{
    engine->model->outputs(VALUES(engine), engine->y);
}

void engine_derivatives(Engine *engine, double *dx)
{
    engine->model->derivatives(VALUES(engine), dx);
}

void engine_indicators(Engine *engine, double *z)
{
    engine->model->indicators(VALUES(engine), z);
}

int engine_check_finite(Engine *engine)
{
    const Model *model = engine->model;
    char name[128];
    int bad;
    engine_outputs(engine);
    bad = first_not_finite(engine->y, model->ny);
    if (bad >= 0)
        return engine_fail_here(engine, model->y_names[bad], "is not finite");
    engine_derivatives(engine, engine->work);
    bad = first_not_finite(engine->work, model->nx);
    if (bad < 0)
        return ENGINE_OK;
    snprintf(name, sizeof name, "der(%s)", model->x_names[bad]);
    return engine_fail_here(engine, name, "is not finite");
}

int engine_stage_check(const Engine *engine, double time, const double *stage)
{
    if (first_not_finite(stage, engine->model->nx) >= 0)
        return -2;
    return engine->model->failure_check(time, stage, engine->u, engine->p, engine->q, engine->m, engine->r);
}

int first_not_finite(const double *values, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += values[i] - values[i]; /* NaN unless finite: one branch for all of them */
    if (sum == 0)
        return -1;
    for (int i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return i;
    return -1;
}

static int integrate(Engine *engine, double stop)
{
    return engine->solver == SOLVER_RK4 ? rk4_integrate(engine, stop) : dormand_prince_integrate(engine, stop);
}

/* ENGINE_FAILED if a step of this length would not end in any time that one would wait. */
static int check_length(Engine *engine, double length)
{
    const Model *model = engine->model;
    if (!(length <= MAX_SUBSTEPS * engine->step_size))
        return engine_fail(engine, -1, "step_size", "is too small: the step would take over a billion substeps");
    model->periods(engine->p, engine->work);
    for (int i = 0; i < model->nq; i++)
        if (!(length / engine->work[i] <= MAX_SUBSTEPS))
            return engine_fail(engine, -1, model->q_names[i],
                                "has too short a period: the step would take over a billion samples");
    return ENGINE_OK;
}

static int try_advance(Engine *engine, double stop)
{
    int paused = 0;
    engine->event_due = 0;
    if (check_length(engine, stop - engine->time) != ENGINE_OK || engine_event(engine) != ENGINE_OK)
        return ENGINE_FAILED;
    while (engine->time < stop && !paused) {
        const double sample = engine_next_sample(engine);
        const double until = sample < stop - INSTANT_ROUNDING * engine->step_size ? sample : stop;
        const int status = integrate(engine, until);
        if (status == ENGINE_FAILED)
            return ENGINE_FAILED;
        paused = status == ENGINE_PAUSED || (until < stop && engine->pause_at_event);
        if (until < stop && !paused && engine_event(engine) != ENGINE_OK)
            return ENGINE_FAILED;
    }
    if (!engine->leave_events)
        engine_relations(engine);
    else if (engine_event_matters(engine) || engine_sample_is_due(engine))
        engine->event_due = 1;
    return engine_check_finite(engine);
}

static int give_up(Engine *engine)
{
    engine_restore(engine, engine->backup);
    return ENGINE_FAILED;
}

static int advance_to(Engine *engine, double stop)
{
    engine_save(engine, engine->backup);
    return engine_begin_inputs(engine, stop) == ENGINE_OK ? engine_continue(engine, stop) : give_up(engine);
}

int engine_continue(Engine *engine, double stop)
{
    if (try_advance(engine, stop) == ENGINE_OK) {
        engine_end_inputs(engine);
        return ENGINE_OK;
    }
    return give_up(engine);
}

int engine_advance(Engine *engine, double length)
{
    return advance_to(engine, engine->time + length);
}

static void record(Engine *engine, double *row)
{
    const Model *model = engine->model;
    engine_outputs(engine);
    memcpy(row, engine->y, (size_t)model->ny * sizeof *row);
    memcpy(row + model->ny, engine->x, (size_t)(model->nx + model->nq) * sizeof *row);
    for (int i = 0; i < model->nm; i++)
        row[model->ny + model->nx + model->nq + i] = engine->m[i];
}

long engine_run(Engine *engine, long n, double length, const double *inputs, double *rows)
{
    const Model *model = engine->model;
    const int width = model->ny + model->nx + model->nq + model->nm;
    const double begin = engine->time;
    for (long i = 0; i <= n; i++) {
        if (i && advance_to(engine, begin + (double)i * length) != ENGINE_OK) /* roundings of time must not add up */
            return i;
        memcpy(engine->u, inputs + i * model->nu, (size_t)model->nu * sizeof *inputs);
        if (engine_event(engine) != ENGINE_OK)
            return i;
        record(engine, rows + i * width);
    }
    return n + 1;
}
