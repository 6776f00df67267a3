/* What the code generated from a block provides beside its model for an FMU: derivatives of its equations.
 *
 * All are of the frozen branch: relations and modes are constants. A matrix is given by the entries that are not
 * identically zero. The columns of equations and updates are time, states, inputs, parameters and samples, one after
 * the other.
 */
#ifndef BRUNOVSKY_JACOBIAN_H
#define BRUNOVSKY_JACOBIAN_H

#include "model.h"

typedef struct {
    int count;
    const int *row, *column; /* of each entry, row by row */
} Pattern;

typedef struct {
    Pattern equations; /* rows: state derivatives, then outputs */
    Pattern updates;   /* rows: updates of samples */
    Pattern starts;    /* rows: start values of states, then samples; columns: parameters */
    void (*differentiate_equations)(ARGUMENTS, double *entries);
    void (*differentiate_updates)(ARGUMENTS, double *entries);
    void (*differentiate_starts)(const double *p, double *entries);
} Jacobian;

extern const Jacobian brunovsky_jacobian;

#endif
