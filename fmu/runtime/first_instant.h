/* Work space of derivatives, and the part of their chain that goes through the first instant. */
#ifndef BRUNOVSKY_FIRST_INSTANT_H
#define BRUNOVSKY_FIRST_INSTANT_H

#include "instance.h"
#include "jacobian.h"

struct Sensitivity {
    double *columns;  /* a vector over time, states, inputs, parameters, samples */
    double *rows;     /* a vector over state derivatives, outputs, states */
    double *equations, *updates, *starts, *fresh; /* entries; fresh ones of updates */
    double *x, *q, *x_new, *q_new;                /* of the first instant, gone through again */
    int *m, *r, *m_new;
};

/* out += J in; rank >= 0 takes only the rows of samples of that rank that were updated. */
void multiply(const Engine *engine, const Pattern *pattern, const double *entries, int rank, const double *in, double *out);

/* out += J^T in; rank as before. */
void multiply_transposed(const Engine *engine, const Pattern *pattern, const double *entries, int rank, const double *in,
                         double *out);

/* Entries of start values and of the samples of the first instant; FAILED where a transition assigned something then. */
Result differentiate_start(Instance *instance);

/* Columns of states and samples from those of time, inputs and parameters, and backwards. */
void start_forward(const Engine *engine, Sensitivity *one);
void start_backward(const Engine *engine, Sensitivity *one);

#endif
