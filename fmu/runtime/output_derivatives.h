/* Time derivatives of a model's outputs: generated from the block, for FMUs only. */
#ifndef BRUNOVSKY_OUTPUT_DERIVATIVES_H
#define BRUNOVSKY_OUTPUT_DERIVATIVES_H

#include "model.h"

typedef struct {
    int order; /* how many orders there are, at least 1 */
    /* All orders, of the branch that relations are frozen in: dy[(k - 1)*ny + i] is the k-th derivative of output i, 0 for
     * Boolean ones; du[INPUT_ORDERS*j + k - 1] is that of input j. */
    void (*evaluate)(ARGUMENTS, const double *du, double *dy);
} OutputDerivatives;

extern const OutputDerivatives brunovsky_output_derivatives;

#endif
