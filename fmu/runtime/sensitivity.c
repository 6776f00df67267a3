/* Directional and adjoint derivatives from the entries of the frozen-branch Jacobian. See sensitivity.h.
 *
 * Both walk through the same chain. After initialization it is one product with the Jacobian of the equations. In
 * initialization mode states and samples are no knowns but functions of the others: start values, then the updates of
 * the first instant rank by rank, then the equations. While clocks tick in event mode, their samples are such functions.
 * Directions with factor zero are left out, so that an entry that is not finite matters only where it acts.
 */
#include "sensitivity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "first_instant.h"
#include "variables.h"

Sensitivity *sensitivity_new(void)
{
    const Model *model = &brunovsky_model;
    const Jacobian *jacobian = &brunovsky_jacobian;
    const size_t nx = (size_t)model->nx, nq = (size_t)model->nq, ny = (size_t)model->ny;
    const size_t nm = (size_t)model->nm, updates = (size_t)jacobian->updates.count;
    const size_t columns = 1 + nx + (size_t)(model->nu + model->np) + nq, rows = 2 * nx + ny;
    const size_t doubles =
        columns + rows + (size_t)(jacobian->equations.count + jacobian->starts.count) + 2 * updates + 2 * (nx + nq);
    Sensitivity *one = calloc(1, sizeof *one + doubles * sizeof(double) + (2 * nm + (size_t)model->nr + nq) * sizeof(int));
    if (!one)
        return NULL;
    one->columns = (double *)(one + 1);
    one->rows = one->columns + columns;
    one->equations = one->rows + rows;
    one->updates = one->equations + jacobian->equations.count;
    one->starts = one->updates + updates;
    one->fresh = one->starts + jacobian->starts.count;
    one->x = one->fresh + updates;
    one->q = one->x + nx;
    one->x_new = one->q + nq;
    one->q_new = one->x_new + nx;
    one->m = (int *)(one->q_new + nq);
    one->m_new = one->m + nm;
    one->r = one->m_new + nm;
    one->sampled = one->r + model->nr;
    return one;
}

/* Where things are -------------------------------------------------------------------------------------------------- */

/* What stands around the name of a state where its derivative is meant. */
static const char *opening(Kind kind)
{
    return kind == DERIVATIVE ? "der(" : "";
}

static const char *closing(Kind kind)
{
    return kind == DERIVATIVE ? ")" : "";
}

/* Row of an unknown; FAILED if it is none. */
static Result row_of(Instance *instance, unsigned reference, int *row)
{
    const Model *model = instance->engine->model;
    const int initial = instance->phase == INITIALIZATION;
    int index;
    const Kind kind = variable_locate(reference, &index);
    *row = kind == DERIVATIVE ? index : kind == OUTPUT ? model->nx + index : model->nx + model->ny + index;
    if (kind == UNKNOWN)
        return instance_report(instance, FAILED, "there is no variable with value reference %u", reference);
    if (kind == DERIVATIVE || (kind == OUTPUT && variable_type(kind, index) == REAL) || (kind == STATE && initial))
        return DONE;
    return instance_report(instance, FAILED,
                           "%s%s%s is no unknown: derivatives are of Real outputs and state derivatives%s", opening(kind),
                           variable_name(kind, index), closing(kind), initial ? ", and of states" : "");
}

/* Column of a known, -1 if nothing depends on it; FAILED if it is none. */
static Result column_of(Instance *instance, unsigned reference, int *column)
{
    const Model *model = instance->engine->model;
    const int initial = instance->phase == INITIALIZATION;
    int index;
    const Kind kind = variable_locate(reference, &index);
    const int state = variable_state(kind, index);
    *column = -1;
    if (kind == UNKNOWN)
        return instance_report(instance, FAILED, "there is no variable with value reference %u", reference);
    if (state >= 0 && !initial)
        *column = 1 + state;
    else if (kind == TIME)
        *column = 0;
    else if (kind == INPUT)
        *column = 1 + model->nx + index;
    else if (kind == PARAMETER)
        *column = 1 + model->nx + model->nu + index;
    else if (kind != STEP_SIZE)
        return instance_report(instance, FAILED,
                               "%s%s%s is no known: derivatives are with respect to time, inputs%s", opening(kind),
                               variable_name(kind, index), closing(kind),
                               initial ? " and parameters" : ", parameters and continuous states");
    return DONE;
}

/* Entries ----------------------------------------------------------------------------------------------------------- */

/* All entries, of the values that the instance has now. */
static Result prepare(Instance *instance)
{
    const Engine *engine = instance->engine;
    Result result = instance_refresh(instance);
    if (result != DONE || instance->entries_current)
        return result;
    if (instance->phase == INITIALIZATION)
        result = differentiate_start(instance);
    else if (instance->phase == EVENT)
        differentiate_ticks(instance);
    if (result != DONE)
        return result;
    brunovsky_jacobian.differentiate_equations(engine->time, engine->x, engine->u, engine->p, engine->q, engine->m,
                                               engine->r, instance->sensitivity->equations);
    instance->entries_current = 1;
    return DONE;
}

/* Products ---------------------------------------------------------------------------------------------------------- */

static Result check(Instance *instance, const char *what, unsigned reference, double value)
{
    char name[192];
    int index;
    const Kind kind = variable_locate(reference, &index);
    if (isfinite(value))
        return DONE;
    snprintf(name, sizeof name, "the derivative %s %s%s%s", what, opening(kind), variable_name(kind, index), closing(kind));
    return instance_not_finite(instance, name);
}

typedef Result Place(Instance *instance, unsigned reference, int *index);

/* A seed spread over rows or columns; the other side is only checked. */
static Result spread(Instance *instance, Place *place, const unsigned *seeded, size_t n_seeded, const double *seed,
                     double *vector, Place *other, const unsigned *asked, size_t n_asked)
{
    Result result = DONE;
    int index;
    for (size_t i = 0; i < n_asked && result == DONE; i++)
        result = other(instance, asked[i], &index);
    for (size_t i = 0; i < n_seeded && result == DONE; i++) {
        result = place(instance, seeded[i], &index);
        if (result == DONE && !isfinite(seed[i]))
            result = instance_report(instance, FAILED, "seed %lu cannot be %g: it is not finite", (unsigned long)i, seed[i]);
        if (result == DONE && index >= 0)
            vector[index] += seed[i];
    }
    return result;
}

/* Whether samples can be functions of the knowns; those that are have been marked with the entries. */
static int samples_act(const Instance *instance)
{
    return (instance->phase & (INITIALIZATION | EVENT)) != 0;
}

static void clear(const Instance *instance)
{
    Sensitivity *one = instance->sensitivity;
    memset(one->columns, 0, (size_t)(one->equations - one->columns) * sizeof(double));
}

Result instance_directional(Instance *instance, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                            size_t n_knowns, const double *seed, double *result)
{
    Sensitivity *one = instance->sensitivity;
    const Model *model = instance->engine->model;
    int row;
    Result status = prepare(instance);
    clear(instance);
    if (status == DONE)
        status = spread(instance, column_of, knowns, n_knowns, seed, one->columns, row_of, unknowns, n_unknowns);
    if (status != DONE)
        return status;
    if (instance->phase == INITIALIZATION)
        start_forward(one);
    if (samples_act(instance))
        samples_forward(one);
    multiply(one, &brunovsky_jacobian.equations, one->equations, -1, one->columns, one->rows);
    memcpy(one->rows + model->nx + model->ny, one->columns + 1, (size_t)model->nx * sizeof(double));
    for (size_t i = 0; i < n_unknowns && status == DONE; i++) {
        row_of(instance, unknowns[i], &row);
        result[i] = one->rows[row];
        status = check(instance, "of", unknowns[i], result[i]);
    }
    return status;
}

Result instance_adjoint(Instance *instance, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                        size_t n_knowns, const double *seed, double *result)
{
    Sensitivity *one = instance->sensitivity;
    const Model *model = instance->engine->model;
    int column;
    Result status = prepare(instance);
    clear(instance);
    if (status == DONE)
        status = spread(instance, row_of, unknowns, n_unknowns, seed, one->rows, column_of, knowns, n_knowns);
    if (status != DONE)
        return status;
    memcpy(one->columns + 1, one->rows + model->nx + model->ny, (size_t)model->nx * sizeof(double));
    multiply_transposed(one, &brunovsky_jacobian.equations, one->equations, -1, one->rows, one->columns);
    if (samples_act(instance))
        samples_backward(one);
    if (instance->phase == INITIALIZATION)
        start_backward(one);
    for (size_t k = 0; k < n_knowns && status == DONE; k++) {
        column_of(instance, knowns[k], &column);
        result[k] = column < 0 ? 0 : one->columns[column];
        status = check(instance, "with respect to", knowns[k], result[k]);
    }
    return status;
}
