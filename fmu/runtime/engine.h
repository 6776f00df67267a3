/* A running instance of a model: events, integration, restoring after a failed step. See engine.c for the semantics. */
#ifndef BRUNOVSKY_ENGINE_H
#define BRUNOVSKY_ENGINE_H

#include <stddef.h>

#include "model.h"

enum { ENGINE_OK = 0, ENGINE_FAILED = 1, ENGINE_PAUSED = 2 };
enum { ENGINE_STEPPED, ENGINE_SWITCHED }; /* what is observed: an internal step is done; relations or modes changed */
enum { SOLVER_RK4 = 1, SOLVER_DORMAND_PRINCE = 2 };

#define MAX_EVENT_ITERATIONS 20 /* of transitions at one instant */
#define INPUT_ORDERS 3 /* derivatives of an input that a step follows */
#define DEFAULT_TOLERANCE 1e-6
#define LEAST_TOLERANCE 1e-13
#define LARGEST_TOLERANCE 1.0

typedef struct {
    const Model *model;
    double time, start_time, step_size;
    double tolerance; /* of Dormand-Prince */
    int solver;
    double *p, *u, *x, *q;
    long long *due; /* number of the next sample of each sampled state */
    int *m, *r;
    double *y;      /* outputs, as engine_outputs left them */
    double *work;
    void *backup;
    const char *reason; /* after a failure: name of the check that explains it, or "diverged" */
    char variable[128]; /* after a failure: where it showed */
    char message[512];  /* after a failure: what was wrong, where and when */
    double *du;         /* derivatives of the inputs, INPUT_ORDERS of each: see inputs.c */
    double *u_begin, begin; /* inputs and time at the beginning of a step over which they vary */
    int given;          /* derivatives were given for the next step, or the one under way: inputs vary over it */

    /* What a master wants of a communication step; all zero in the native simulation. */
    int (*observe)(void *observer, int what); /* a result other than 0 after ENGINE_STEPPED ends the step there */
    void *observer;
    int inputs_set;     /* by the observer */
    int leave_events;   /* events at the end of a step are the master's */
    int pause_at_event; /* the step ends at its first event, which is the master's */
    int event_due;      /* after a step: there is such an event */
    double crowd;       /* instant from which on Dormand-Prince counts events, against those that do not end */
    int crowded;        /* how many */
    double *trial;      /* work space: whether it changes anything */
    int clocked;        /* samples of clocks wait for engine_tick */
    int *active;        /* of each clock: it ticks at the present instant */
    double *previous;   /* samples of active clocks before the tick */
} Engine;

ENGINE_API Engine *engine_new(const Model *model, double step_size); /* NULL if out of memory */
ENGINE_API void engine_free(Engine *engine);

/* Defaults of parameters and inputs; before engine_start. */
ENGINE_API void engine_reset(Engine *engine);

/* Checks of the block that parameters have to pass; due at the start and after a parameter changed. */
ENGINE_API int engine_check_parameters(Engine *engine, int model_exchange);

/* Checks, start values and the events of the first instant. */
ENGINE_API int engine_start(Engine *engine, double start_time, int model_exchange);

/* Due samples, then relations and transitions until nothing changes. */
ENGINE_API int engine_event(Engine *engine);
ENGINE_API void engine_relations(Engine *engine);
/* Whether relations at this time and these states are not what they are frozen at. */
ENGINE_API int engine_relations_differ(const Engine *engine, double time, const double *x);
ENGINE_API double engine_next_sample(const Engine *engine); /* instant of the next sample; HUGE_VAL if there is none */

/* A tick of a clock at the present instant begins, or is taken back. The next engine_event makes it final;
 * engine_sample_clocks computes the samples that belong to the present inputs before that. */
ENGINE_API void engine_tick(Engine *engine, int clock, int active);
ENGINE_API void engine_sample_clocks(Engine *engine);
ENGINE_API int engine_ticks(const Engine *engine, int sample); /* whether the clock of a sample ticks now */

/* Derivative of an input, of order 1 to INPUT_ORDERS, where the next step begins; the others are 0. */
ENGINE_API void engine_set_input_derivative(Engine *engine, int input, int order, double value);

/* One communication step with the inputs held, or as their derivatives say; on failure the state from before it is
 * restored. The step may end early, which engine->time tells: see pause_at_event and observe. */
ENGINE_API int engine_advance(Engine *engine, double length);
/* Its continuation to a time; on failure the state from before the step is restored. */
ENGINE_API int engine_continue(Engine *engine, double stop);

ENGINE_API void engine_outputs(Engine *engine); /* into engine->y */
ENGINE_API void engine_derivatives(Engine *engine, double *dx);
ENGINE_API void engine_indicators(Engine *engine, double *z);

/* ENGINE_FAILED if an output or a derivative is not finite. */
ENGINE_API int engine_check_finite(Engine *engine);

/* Rows of (outputs, states, samples, modes) at n + 1 instants, n steps of `length` apart; inputs: n + 1 rows.
 * Returns the number of rows written: n + 1, or fewer if a step failed. */
ENGINE_API long engine_run(Engine *engine, long n, double length, const double *inputs, double *rows);

/* Everything that changes in a run, as plain bytes. */
ENGINE_API size_t engine_state_size(const Engine *engine);
ENGINE_API void engine_save(const Engine *engine, void *bytes);
ENGINE_API void engine_restore(Engine *engine, const void *bytes);

#endif
