/* Work space of derivatives, and the part of their chain that goes through an instant. */
#ifndef BRUNOVSKY_FIRST_INSTANT_H
#define BRUNOVSKY_FIRST_INSTANT_H

#include "instance.h"
#include "jacobian.h"

struct Sensitivity {
    double *columns;  /* a vector over time, states, inputs, parameters, samples */
    double *rows;     /* a vector over state derivatives, outputs, states */
    double *equations, *updates, *starts, *fresh; /* entries; fresh ones of updates */
    double *x, *q, *x_new, *q_new;                /* of the instant, gone through again */
    int *m, *r, *m_new;
    int *sampled; /* of each sample: it was taken at this instant */
};

/* out += J in; rank >= 0 takes only the rows of samples of that rank that were taken. */
void multiply(const Sensitivity *one, const Pattern *pattern, const double *entries, int rank, const double *in, double *out);

/* out += J^T in; rank as before. */
void multiply_transposed(const Sensitivity *one, const Pattern *pattern, const double *entries, int rank, const double *in,
                         double *out);

/* Entries of start values and of the samples of the first instant; FAILED where a transition assigned something then. */
Result differentiate_start(Instance *instance);
/* Entries of the samples whose clocks tick now. */
void differentiate_ticks(Instance *instance);

/* Columns of states and samples from those of parameters, then of samples from those they are computed from; and
 * backwards, in the other order. */
void start_forward(Sensitivity *one);
void samples_forward(Sensitivity *one);
void samples_backward(Sensitivity *one);
void start_backward(Sensitivity *one);

#endif
