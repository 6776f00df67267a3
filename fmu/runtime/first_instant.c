/* Derivatives through the first instant: start values, then the updates of samples rank by rank.
 *
 * The instant is gone through again beside the engine, so that each rank is differentiated at the values that it saw,
 * and so that what transitions assign is seen.
 */
#include "first_instant.h"

#include <math.h>
#include <string.h>

#include "variables.h"

#define MAX_EVENT_ITERATIONS 20

/* Entries ----------------------------------------------------------------------------------------------------------- */

#define AGAIN(sensitivity, engine)                                                                                    \
    (engine)->time, (sensitivity)->x, (engine)->u, (engine)->p, (sensitivity)->q, (sensitivity)->m, (sensitivity)->r

/* The samples of the first instant, each rank with the values that it saw. */
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
            if (model->q_rank[i] == rank && engine->due[i] > 0)
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
    differentiate_samples(one, engine);
    name = assigned_by_transition(one, engine);
    if (name)
        return instance_report(instance, FAILED, "there are no derivatives in initialization mode: a transition of the first "
                      "instant assigned %s; ask for them afterwards", name);
    return DONE;
}

/* Products ---------------------------------------------------------------------------------------------------------- */

void multiply(const Engine *engine, const Pattern *pattern, const double *entries, int rank, const double *in,
                     double *out)
{
    for (int k = 0; k < pattern->count; k++) {
        const int row = pattern->row[k];
        if (in[pattern->column[k]] != 0 && (rank < 0 || (engine->model->q_rank[row] == rank && engine->due[row] > 0)))
            out[row] += entries[k] * in[pattern->column[k]];
    }
}

void multiply_transposed(const Engine *engine, const Pattern *pattern, const double *entries, int rank,
                                const double *in, double *out)
{
    for (int k = 0; k < pattern->count; k++) {
        const int row = pattern->row[k];
        if (in[row] != 0 && (rank < 0 || (engine->model->q_rank[row] == rank && engine->due[row] > 0)))
            out[pattern->column[k]] += entries[k] * in[row];
    }
}

/* The states and samples of the start from the parameters: they are next to each other in x_new and q_new. */
void start_forward(const Engine *engine, Sensitivity *one)
{
    const Model *model = engine->model;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq;
    double *p = one->columns + 1 + nx + model->nu, *q = p + model->np;
    memset(one->x_new, 0, (nx + nq) * sizeof(double));
    multiply(engine, &brunovsky_jacobian.starts, one->starts, -1, p, one->x_new);
    memcpy(one->columns + 1, one->x_new, nx * sizeof(double));
    memcpy(q, one->q_new, nq * sizeof(double));
    for (int rank = 0; rank < model->ranks; rank++) {
        memset(one->q_new, 0, nq * sizeof(double));
        multiply(engine, &brunovsky_jacobian.updates, one->updates, rank, one->columns, one->q_new);
        for (int i = 0; i < model->nq; i++)
            if (model->q_rank[i] == rank && engine->due[i] > 0)
                q[i] = one->q_new[i];
    }
}

void start_backward(const Engine *engine, Sensitivity *one)
{
    const Model *model = engine->model;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq;
    double *p = one->columns + 1 + nx + model->nu, *q = p + model->np;
    for (int rank = model->ranks - 1; rank >= 0; rank--) {
        memset(one->q_new, 0, nq * sizeof(double));
        for (int i = 0; i < model->nq; i++)
            if (model->q_rank[i] == rank && engine->due[i] > 0) {
                one->q_new[i] = q[i];
                q[i] = 0;
            }
        multiply_transposed(engine, &brunovsky_jacobian.updates, one->updates, rank, one->q_new, one->columns);
    }
    memcpy(one->x_new, one->columns + 1, nx * sizeof(double));
    memcpy(one->q_new, q, nq * sizeof(double));
    multiply_transposed(engine, &brunovsky_jacobian.starts, one->starts, -1, one->x_new, p);
}
