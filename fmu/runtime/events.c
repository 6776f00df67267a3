/* What happens at an instant: samples in the order of their rank, relations, transitions, ticks of clocks. See engine.c. */
#include "solver.h"

#include <math.h>
#include <string.h>

/* Relations of a moment, beside those that are frozen. */
static int *relations_now(const Engine *e)
{
    return e->r + e->model->nr;
}

int engine_relations_differ(const Engine *e, double time, const double *x)
{
    int *now = relations_now(e);
    if (!e->model->acting)
        return 0;
    e->model->relations(time, x, e->u, e->p, e->q, e->m, now);
    return memcmp(now, e->r, (size_t)e->model->acting * sizeof *now) != 0;
}

void engine_relations(Engine *engine)
{
    const int switched = engine->observe && engine_relations_differ(engine, engine->time, engine->x);
    if (engine->model->nr)
        engine->model->relations(engine->time, engine->x, engine->u, engine->p, engine->q, engine->m, engine->r);
    if (switched)
        engine->observe(engine->observer, ENGINE_SWITCHED);
}

int engine_event_matters(Engine *e)
{
    const Model *model = e->model;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq, ny = (size_t)model->ny;
    const int *now = relations_now(e);
    double *old = e->trial, *new = old + nx + ny;
    if (!engine_relations_differ(e, e->time, e->x))
        return 0;
    memcpy(old, e->x, (nx + nq) * sizeof *old);
    memcpy(e->m + model->nm, e->m, (size_t)model->nm * sizeof *e->m);
    if (model->transitions && model->fire(e->time, e->x, e->u, e->p, e->q, e->m, now, old, old + nx, e->m + model->nm))
        return 1;
    model->derivatives(VALUES(e), old);
    model->outputs(VALUES(e), old + nx);
    model->derivatives(e->time, e->x, e->u, e->p, e->q, e->m, now, new);
    model->outputs(e->time, e->x, e->u, e->p, e->q, e->m, now, new + nx);
    if (memcmp(old, new, (nx + ny) * sizeof *old) != 0)
        return 1;
    memcpy(e->r, now, (size_t)model->nr * sizeof *now);
    return 0;
}

int engine_pause(Engine *engine)
{
    int paused = 0;
    engine->inputs_set = 0;
    if (engine->pause_at_event && engine_event_matters(engine))
        paused = engine->event_due = 1;
    if (engine->observe && engine->observe(engine->observer, ENGINE_STEPPED))
        paused = 1;
    return paused ? ENGINE_PAUSED : ENGINE_OK;
}

static int is_clocked(const Engine *engine, int sample)
{
    return engine->clocked && engine->model->nk && engine->model->q_clock[sample] >= 0;
}

int engine_ticks(const Engine *engine, int sample)
{
    return is_clocked(engine, sample) && engine->active[engine->model->q_clock[sample]];
}

static int is_timed(const Engine *engine, int sample)
{
    return engine->model->q_rank[sample] >= 0 && !is_clocked(engine, sample);
}

double engine_next_sample(const Engine *engine)
{
    const Model *model = engine->model;
    double next = HUGE_VAL, *period = engine->work;
    model->periods(engine->p, period);
    for (int i = 0; i < model->nq; i++)
        if (is_timed(engine, i))
            next = fmin(next, engine->start_time + (double)engine->due[i] * period[i]);
    return next;
}

static int is_due(const Engine *engine, int sample, double period)
{
    const double instant = engine->start_time + (double)engine->due[sample] * period;
    const double early = INSTANT_ROUNDING * fmin(period, engine->step_size);
    return is_timed(engine, sample) && instant <= engine->time + early;
}

/* Samples of active clocks, and if `timed` those whose instant has come. */
static void run_samples(Engine *engine, int timed)
{
    const Model *model = engine->model;
    double *period = engine->work, *updated = period + model->nq;
    model->periods(engine->p, period);
    engine_relations(engine);
    for (int rank = 0; rank < model->ranks; rank++) {
        int changed = 0;
        model->updates(VALUES(engine), updated);
        for (int i = 0; i < model->nq; i++) {
            const int due = timed && is_due(engine, i, period[i]);
            if (model->q_rank[i] == rank && (due || engine_ticks(engine, i))) {
                engine->q[i] = updated[i];
                engine->due[i] += due;
                changed = 1;
            }
        }
        if (changed)
            engine_relations(engine);
    }
}

static void take_back_samples(Engine *engine)
{
    for (int i = 0; i < engine->model->nq; i++)
        if (engine_ticks(engine, i))
            engine->q[i] = engine->previous[i];
}

void engine_tick(Engine *engine, int clock, int active)
{
    take_back_samples(engine);
    if (active && !engine->active[clock])
        for (int i = 0; i < engine->model->nq; i++)
            if (engine->model->q_clock[i] == clock)
                engine->previous[i] = engine->q[i];
    engine->active[clock] = active;
}

void engine_sample_clocks(Engine *engine)
{
    take_back_samples(engine);
    run_samples(engine, 0);
}

static int run_transitions(Engine *engine)
{
    const Model *model = engine->model;
    double *x = engine->work, *q = x + model->nx;
    int *m = engine->m + model->nm;
    memcpy(x, engine->x, (size_t)(model->nx + model->nq) * sizeof *x);
    memcpy(m, engine->m, (size_t)model->nm * sizeof *m);
    if (!model->fire(VALUES(engine), x, q, m))
        return 0;
    memcpy(engine->x, x, (size_t)(model->nx + model->nq) * sizeof *x);
    memcpy(engine->m, m, (size_t)model->nm * sizeof *m);
    if (engine->observe)
        engine->observe(engine->observer, ENGINE_SWITCHED);
    return 1;
}

int engine_event(Engine *engine)
{
    if (engine->model->nq) {
        take_back_samples(engine);
        run_samples(engine, 1);
        for (int i = 0; i < engine->model->nk; i++)
            engine->active[i] = 0;
    }
    return engine_settle(engine);
}

int engine_settle(Engine *engine)
{
    engine_relations(engine);
    if (!engine->model->transitions)
        return ENGINE_OK;
    for (int i = 0; i < MAX_EVENT_ITERATIONS; i++) {
        if (!run_transitions(engine))
            return ENGINE_OK;
        engine_relations(engine);
    }
    if (!run_transitions(engine))
        return ENGINE_OK;
    return engine_fail(engine, -1, "events", "do not end: transitions still fire after 20 iterations");
}

int engine_sample_is_due(const Engine *engine)
{
    const Model *model = engine->model;
    model->periods(engine->p, engine->work);
    for (int i = 0; i < model->nq; i++)
        if (is_due(engine, i, engine->work[i]))
            return 1;
    return 0;
}
