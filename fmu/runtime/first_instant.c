/* Derivatives through an instant: at the first one start values, then the updates of samples rank by rank; in event mode
 * those of the clocks that tick.
 *
 * The instant is gone through again beside the engine, so that each rank is differentiated at the values that it saw,
 * and so that what transitions assign is seen.
 */
#include "first_instant.h"

#include <math.h>
#include <string.h>

#include "variables.h"

/* Entries ----------------------------------------------------------------------------------------------------------- */

#define AGAIN(sensitivity, engine)                                                                                    \
    (engine)->time, (sensitivity)->x, (engine)->u, (engine)->p, (sensitivity)->q, (sensitivity)->m, (sensitivity)->r

/* The samples of the instant, each rank with the values that it saw. */
static void differentiate_samples(Sensitivity *one, const Engine *engine)
{
    const Model *model = engine->model;
    const Pattern *pattern = &brunovsky_jacobian.updates;
    model->relations(engine->time, one->x, engine->u, engine->p, one->q, one->m, one->r);
    for (int rank = 0; rank < model->ranks; rank++) {
        brunovsky_jacobian.differentiate_updates(AGAIN(one, engine), one->fresh);
        for (int k = 0; k < pattern->count; k++)
            if (model->q_rank[pattern->row[k]] == rank)
                one->updates[k] = one->fresh[k];
        model->updates(AGAIN(one, engine), one->q_new);
        for (int i = 0; i < model->nq; i++)
            if (model->q_rank[i] == rank && one->sampled[i])
                one->q[i] = one->q_new[i];
        model->relations(engine->time, one->x, engine->u, engine->p, one->q, one->m, one->r);
    }
}

/* Name of a state or sample that a transition of the first instant assigned; NULL if none did. */
static const char *assigned_by_transition(Sensitivity *one, const Engine *engine)
{
    const Model *model = engine->model;
    for (int i = 0; model->transitions && i <= MAX_EVENT_ITERATIONS; i++) {
        for (int k = 0; k < model->nx; k++)
            one->x_new[k] = NAN;
        for (int k = 0; k < model->nq; k++)
            one->q_new[k] = NAN;
        memcpy(one->m_new, one->m, (size_t)model->nm * sizeof *one->m);
        if (!model->fire(AGAIN(one, engine), one->x_new, one->q_new, one->m_new))
            return NULL;
        for (int k = 0; k < model->nx; k++)
            if (!isnan(one->x_new[k]))
                return model->x_names[k];
        for (int k = 0; k < model->nq; k++)
            if (!isnan(one->q_new[k]))
                return model->q_names[k];
        memcpy(one->m, one->m_new, (size_t)model->nm * sizeof *one->m);
        model->relations(engine->time, one->x, engine->u, engine->p, one->q, one->m, one->r);
    }
    return NULL;
}

Result differentiate_start(Instance *instance)
{
    const Engine *engine = instance->engine;
    const Model *model = engine->model;
    Sensitivity *one = instance->sensitivity;
    const char *name;
    brunovsky_jacobian.differentiate_starts(engine->p, one->starts);
    model->start(engine->p, one->x, one->q);
    memcpy(one->m, model->m_start, (size_t)model->nm * sizeof *one->m);
    for (int i = 0; i < model->nq; i++)
        one->sampled[i] = engine->due[i] > 0;
    differentiate_samples(one, engine);
    name = assigned_by_transition(one, engine);
    if (name)
        return instance_report(instance, FAILED,
                               "there are no derivatives in initialization mode: a transition of the first instant "
                               "assigned %s; ask for them afterwards",
                               name);
    return DONE;
}

void differentiate_ticks(Instance *instance)
{
    const Engine *engine = instance->engine;
    const Model *model = engine->model;
    Sensitivity *one = instance->sensitivity;
    int ticking = 0;
    for (int i = 0; i < model->nq; i++) {
        one->sampled[i] = engine_ticks(engine, i);
        one->q[i] = one->sampled[i] ? engine->previous[i] : engine->q[i];
        ticking = ticking || one->sampled[i];
    }
    if (!ticking)
        return;
    memcpy(one->x, engine->x, (size_t)model->nx * sizeof *one->x);
    memcpy(one->m, engine->m, (size_t)model->nm * sizeof *one->m);
    differentiate_samples(one, engine);
}

/* Products ---------------------------------------------------------------------------------------------------------- */

static int is_taken(const Sensitivity *one, int rank, int row)
{
    return rank < 0 || (brunovsky_model.q_rank[row] == rank && one->sampled[row]);
}

void multiply(const Sensitivity *one, const Pattern *pattern, const double *entries, int rank, const double *in, double *out)
{
    for (int k = 0; k < pattern->count; k++) {
        const int row = pattern->row[k];
        if (in[pattern->column[k]] != 0 && is_taken(one, rank, row))
            out[row] += entries[k] * in[pattern->column[k]];
    }
}

void multiply_transposed(const Sensitivity *one, const Pattern *pattern, const double *entries, int rank,
                         const double *in, double *out)
{
    for (int k = 0; k < pattern->count; k++) {
        const int row = pattern->row[k];
        if (in[row] != 0 && is_taken(one, rank, row))
            out[pattern->column[k]] += entries[k] * in[row];
    }
}

static double *columns_of_samples(const Sensitivity *one)
{
    const Model *model = &brunovsky_model;
    return one->columns + 1 + model->nx + model->nu + model->np;
}

void samples_forward(Sensitivity *one)
{
    const Model *model = &brunovsky_model;
    double *q = columns_of_samples(one);
    for (int rank = 0; rank < model->ranks; rank++) {
        memset(one->q_new, 0, (size_t)model->nq * sizeof(double));
        multiply(one, &brunovsky_jacobian.updates, one->updates, rank, one->columns, one->q_new);
        for (int i = 0; i < model->nq; i++)
            if (is_taken(one, rank, i))
                q[i] = one->q_new[i];
    }
}

void samples_backward(Sensitivity *one)
{
    const Model *model = &brunovsky_model;
    double *q = columns_of_samples(one);
    for (int rank = model->ranks - 1; rank >= 0; rank--) {
        memset(one->q_new, 0, (size_t)model->nq * sizeof(double));
        for (int i = 0; i < model->nq; i++)
            if (is_taken(one, rank, i)) {
                one->q_new[i] = q[i];
                q[i] = 0;
            }
        multiply_transposed(one, &brunovsky_jacobian.updates, one->updates, rank, one->q_new, one->columns);
    }
}

/* States and samples are next to each other in x_new and q_new. */
void start_forward(Sensitivity *one)
{
    const Model *model = &brunovsky_model;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq;
    memset(one->x_new, 0, (nx + nq) * sizeof(double));
    multiply(one, &brunovsky_jacobian.starts, one->starts, -1, one->columns + 1 + nx + model->nu, one->x_new);
    memcpy(one->columns + 1, one->x_new, nx * sizeof(double));
    memcpy(columns_of_samples(one), one->q_new, nq * sizeof(double));
}

void start_backward(Sensitivity *one)
{
    const Model *model = &brunovsky_model;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq;
    memcpy(one->x_new, one->columns + 1, nx * sizeof(double));
    memcpy(one->q_new, columns_of_samples(one), nq * sizeof(double));
    multiply_transposed(one, &brunovsky_jacobian.starts, one->starts, -1, one->x_new, one->columns + 1 + nx + model->nu);
}
