/* What the code generated from a block provides: counts, names, defaults and its expressions as functions.
 *
 * Vectors are in the block's order of declaration: p parameters, u inputs, x continuous states, q sampled states,
 * m modes, r relations (0 or 1), y outputs (Boolean ones as 0 or 1), k clocks. Functions are pure: they read
 * their arguments and write to their last ones.
 */
#ifndef BRUNOVSKY_MODEL_H
#define BRUNOVSKY_MODEL_H

#include "names.h"

#define ARGUMENTS                                                                                                     \
    double t, const double *x, const double *u, const double *p, const double *q, const int *m, const int *r

typedef struct {
    const char *name;
    int np, nu, nx, nq, nm, nr, ny, nz;
    int ranks;        /* samples have the ranks 0 to ranks - 1 */
    int transitions;  /* how many */
    const char *const *p_names, *const *u_names, *const *x_names, *const *q_names, *const *y_names;
    const double *p_default, *p_min, *p_max, *u_default;
    const int *m_start;
    const int *q_rank; /* order of the samples of an instant, -1 of those that transitions alone change */
    void (*start)(const double *p, double *x, double *q);
    void (*periods)(const double *p, double *period);
    void (*derivatives)(ARGUMENTS, double *dx);
    void (*outputs)(ARGUMENTS, double *y);
    void (*indicators)(ARGUMENTS, double *z);
    void (*relations)(double t, const double *x, const double *u, const double *p, const double *q, const int *m, int *r);
    void (*updates)(ARGUMENTS, double *q_new);
    int (*fire)(ARGUMENTS, double *x_new, double *q_new, int *m_new); /* returns whether a transition fired */
    int (*start_check)(const double *p, int model_exchange);          /* index of the first check that fails, or -1 */
    int (*failure_check)(ARGUMENTS);                                  /* the same, of those that explain a failed step */
    const char *const *check_names, *const *check_messages;
    int acting; /* relations that act between samples, the first ones; the others are read by updates alone */
    int nk; /* clocks */
    const char *const *k_names;
    const int *k_parameter;  /* index of the parameter that is the period of a clock, -1 where this is a number */
    const double *k_period;  /* by default, s */
    const int *q_clock;      /* index of the clock of a sampled state, -1 where it has a period of its own */
    const double *x_nominal; /* typical magnitude of a state, in its unit */
} Model;

#ifndef ENGINE_API
#define ENGINE_API /* of a shared library: what exports a symbol */
#endif

extern ENGINE_API const Model brunovsky_model;

#endif
