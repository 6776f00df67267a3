/* A model with the life cycle and the variables of an FMU, apart from the version of the standard.
 *
 * The functions of a version's interface (fmi2.c) check nothing themselves: they translate arguments and results.
 * An instance that refuses a call is left as it was.
 */
#ifndef BRUNOVSKY_INSTANCE_H
#define BRUNOVSKY_INSTANCE_H

#include "description.h"
#include "engine.h"

/* Phases as bits, so that a function can name several. STEP is between communication steps, EVENT and CONTINUOUS_TIME
 * are those of model exchange. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    STEP = 4,
    EVENT = 8,
    CONTINUOUS_TIME = 16,
    TERMINATED = 32,
    ANY_PHASE = 63,
    READABLE = INITIALIZATION | STEP | EVENT | CONTINUOUS_TIME | TERMINATED
} Phase;

/* Every result but DONE comes with a message. WARNED: done all the same. DISCARDED: not finite, a solver may try again
 * closer by. FAILED: refused. */
typedef enum { DONE, WARNED, DISCARDED, FAILED } Result;

typedef struct Sensitivity Sensitivity;

typedef struct {
    Engine *engine;
    int model_exchange;
    Phase phase;
    double start, stop; /* of the experiment; HUGE_VAL if the end is open */
    int parameters_checked, started, relations_current, outputs_current, derivatives_current; /* since the last change */
    int entries_current; /* of the derivatives, likewise */
    Sensitivity *sensitivity;
    int *side; /* of each indicator at the last event: 1, -1, or 0 if it was zero */
    double *dx, *z, *before;
    int *r, *modes_before; /* work space, as the line above */
    char message[768];
} Instance;

typedef struct {
    int states_changed, discrete_changed;
    double next; /* instant of the next time event, HUGE_VAL if there is none */
} Event;

Instance *instance_new(int model_exchange); /* NULL if out of memory */
void instance_free(Instance *instance);
void instance_reset(Instance *instance);

/* FAILED unless the phase is one of these. */
Result instance_permits(Instance *instance, int phases);

Result instance_set_up(Instance *instance, double start, double stop, double tolerance);
void instance_enter_initialization(Instance *instance);
Result instance_exit_initialization(Instance *instance);

/* Values of all types as double. A set is checked before, and then cannot fail. */
Result instance_get(Instance *instance, Type type, unsigned reference, double *value);
Result instance_admits(Instance *instance, Type type, unsigned reference, double value);
void instance_set(Instance *instance, unsigned reference, double value);

/* Co-simulation: one communication step from time on. */
Result instance_step(Instance *instance, double time, double length);

/* Model exchange. */
Result instance_set_time(Instance *instance, double time);
Result instance_set_states(Instance *instance, const double *states, size_t count);
Result instance_get_states(Instance *instance, double *states, size_t count);
Result instance_get_derivatives(Instance *instance, double *derivatives, size_t count);
Result instance_get_indicators(Instance *instance, double *indicators, size_t count);
void instance_enter_event(Instance *instance);
Result instance_event(Instance *instance, Event *event);
Result instance_enter_continuous_time(Instance *instance);
Result instance_complete_step(Instance *instance, int *event_needed);

/* All of an instance as bytes that say whose they are: a copy of them restores it, others are refused. */
size_t instance_state_size(const Instance *instance);
void instance_save(const Instance *instance, void *bytes);
Result instance_restore(Instance *instance, const void *bytes);
Result instance_recognizes(Instance *instance, const void *bytes, size_t size);

#endif
