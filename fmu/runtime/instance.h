/* A model with the life cycle and the variables of an FMU, apart from the version of the standard.
 *
 * The functions of a version's interface (fmi2.c, fmi3.c) check nothing themselves: they translate arguments and
 * results. An instance that refuses a call is left as it was.
 *
 * instance.c: life cycle and calculated values; variables.c: value references; stepping.c: steps and events; clocks.c;
 * exchange.c: model exchange; listening.c: what a master is told; extrapolation.c: derivatives in time; sensitivity.c:
 * partial derivatives; state.c: bytes.
 */
#ifndef BRUNOVSKY_INSTANCE_H
#define BRUNOVSKY_INSTANCE_H

#include "description.h"
#include "engine.h"

typedef enum { CO_SIMULATION, MODEL_EXCHANGE, SCHEDULED_EXECUTION } Interface;

/* Phases as bits, so that a function can name several. STEP is between communication steps, INTERMEDIATE is within one,
 * while the master is asked; EVENT also exists in co-simulation where its event mode is used; CONTINUOUS_TIME is of model
 * exchange, ACTIVATION of scheduled execution. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    STEP = 4,
    EVENT = 8,
    CONTINUOUS_TIME = 16,
    TERMINATED = 32,
    INTERMEDIATE = 64,
    ACTIVATION = 128,
    ANY_PHASE = 255,
    READABLE = ANY_PHASE & ~INSTANTIATED
} Phase;

/* Every result but DONE comes with a message. WARNED: done all the same. DISCARDED: not finite, a solver may try again
 * closer by. FAILED: refused. */
typedef enum { DONE, WARNED, DISCARDED, FAILED } Result;

typedef enum { ABOUT_EVENTS, ABOUT_SINGULARITY } Topic;

/* What the master wants to be told and asked; functions may be null pointers. */
typedef struct {
    void (*tell)(void *master, Topic topic, const char *message);
    /* After an internal step of co-simulation, in phase INTERMEDIATE: whether the step shall end early, and when. */
    int (*ask)(void *master, double time, double *end);
    void *master;
} Listener;

typedef struct Sensitivity Sensitivity;

typedef struct {
    Engine *engine;
    Interface interface;
    int event_mode, early_return; /* of co-simulation: whether the master uses event mode, and lets steps end early */
    Phase phase;
    double start, stop; /* of the experiment; HUGE_VAL if the end is open */
    /* Since the last change; relations in initialization mode: also start values and the events of the first instant. */
    int parameters_checked, relations_current;
    int outputs_current, derivatives_current, entries_current, output_derivatives_current;
    Sensitivity *sensitivity;
    int *side;          /* of each indicator at the last event: 1, -1, or 0 if it was zero */
    double *activation; /* of each clock: instant of its last activation, -HUGE_VAL before */
    double *dx, *z, *before; /* before: states and samples */
    double *dy; /* time derivatives of all outputs, those of one order after another */
    int *modes_before;
    Listener listener;
    int *told; /* Boolean outputs and modes that the listener knows of */
    double end; /* of the step, as the listener wants it */
    char message[768];
} Instance;

typedef struct {
    int states_changed, discrete_changed;
    double next; /* instant of the next time event, HUGE_VAL if there is none */
} Event;

Instance *instance_new(Interface interface); /* NULL if out of memory */
/* Whether the master of a co-simulation uses event mode, and lets steps end early; once, after instance_new. */
void instance_use_events(Instance *instance, int event_mode, int early_return);
void instance_free(Instance *instance);
void instance_reset(Instance *instance);
/* What is told of and asked from now on. */
void instance_listen(Instance *instance, Listener listener);

/* FAILED unless the phase is one of these. */
Result instance_permits(Instance *instance, int phases);
const char *instance_phase_name(const Instance *instance);
const char *instance_interface_name(Interface interface);

Result instance_set_up(Instance *instance, double start, double stop, double tolerance);
void instance_enter_initialization(Instance *instance);
Result instance_exit_initialization(Instance *instance);

/* Values of all types as double; types: those that the calling function handles. A set is checked before, and then
 * cannot fail. */
Result instance_get(Instance *instance, int types, unsigned reference, double *value);
Result instance_admits(Instance *instance, int types, unsigned reference, double value);
void instance_set(Instance *instance, unsigned reference, double value);

/* Time derivatives, from order 1 on (extrapolation.c). Of an input: those that the next communication step follows; to be
 * set before it, once admitted. Of an output: exact ones of the branch that relations are frozen in, with the derivatives
 * of the inputs where the last step ended, or those set for the next one. */
Result instance_admits_input_derivative(Instance *instance, unsigned reference, int order, double value);
void instance_set_input_derivative(Instance *instance, unsigned reference, int order, double value);
Result instance_get_output_derivative(Instance *instance, unsigned reference, int order, double *value);

/* Co-simulation: one communication step from time on. It ended at engine->time; engine->event_due tells whether the
 * master has to handle an event there. DISCARDED if it could not be calculated. */
Result instance_step(Instance *instance, double time, double length);

/* Clocks: ticks in event mode, their period, and scheduled execution. A reference is checked before it ticks. */
Result instance_ticks(Instance *instance, unsigned reference, int *active);
void instance_tick(Instance *instance, unsigned reference, int active);
Result instance_period(Instance *instance, unsigned reference, double *period);
Result instance_admits_period(Instance *instance, unsigned reference, double period); /* before it is set */
void instance_set_period(Instance *instance, unsigned reference, double period);
Result instance_activate(Instance *instance, unsigned reference, double time);

/* Event mode, of model exchange and of co-simulation. */
void instance_enter_event(Instance *instance);
Result instance_event(Instance *instance, Event *event);
Result instance_enter_step(Instance *instance);

/* Model exchange. */
Result instance_set_time(Instance *instance, double time);
Result instance_set_states(Instance *instance, const double *states, size_t count);
Result instance_get_states(Instance *instance, double *states, size_t count);
Result instance_get_derivatives(Instance *instance, double *derivatives, size_t count);
Result instance_get_indicators(Instance *instance, double *indicators, size_t count);
Result instance_get_nominals(Instance *instance, double *nominals, size_t count);
Result instance_enter_continuous_time(Instance *instance);
int instance_complete_step(Instance *instance); /* whether an event is needed */

/* All of an instance as bytes that say whose they are: a copy of them restores it, others are refused. */
size_t instance_state_size(const Instance *instance);
void instance_save(const Instance *instance, void *bytes);
Result instance_restore(Instance *instance, const void *bytes);
Result instance_recognizes(Instance *instance, const void *bytes, size_t size);

/* For the files that make up an instance. */
/* Tells what is true at the end of initialization: nothing is known before, and modes have their start values. */
void instance_tell_start(Instance *instance);
/* After the values from before a failure are restored: what was told meanwhile is not so. */
void instance_take_back_told(Instance *instance);
/* Sides of the indicators, on which the relations now frozen were decided. */
void instance_choose_sides(Instance *instance);
Result instance_report(Instance *instance, Result result, const char *format, ...);
Result instance_not_finite(Instance *instance, const char *name);
Result instance_check_parameters(Instance *instance);
/* Makes what is calculated belong to the values set. */
Result instance_refresh(Instance *instance);
void instance_outdate(Instance *instance);
const double *instance_outputs(Instance *instance);
const double *instance_derivatives(Instance *instance);
const double *instance_indicators(Instance *instance);

#endif
