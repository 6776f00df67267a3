/* The integration methods, and what they share with the engine. */
#ifndef BRUNOVSKY_SOLVER_H
#define BRUNOVSKY_SOLVER_H

#include "engine.h"

#define VALUES(e) (e)->time, (e)->x, (e)->u, (e)->p, (e)->q, (e)->m, (e)->r

/* Inputs over a step: the step to stop begins, is at this time, has reached engine->time. */
int engine_begin_inputs(Engine *engine, double stop);
void engine_vary_inputs(const Engine *engine, double time);
void engine_end_inputs(Engine *engine);

/* Makes engine->u the inputs at this time; inputs that are held cost a comparison. */
static inline void inputs_at(const Engine *engine, double time)
{
    if (engine->given)
        engine_vary_inputs(engine, time);
}

/* From engine->time to stop, where the inputs are those at stop; ENGINE_PAUSED if they end before because a pause was
 * due. Both need work space: 9 nx doubles. */
int rk4_integrate(Engine *engine, double stop);
int dormand_prince_integrate(Engine *engine, double stop);

/* Relations and transitions until nothing changes: an event without samples. */
int engine_settle(Engine *engine);

/* ENGINE_PAUSED if the communication step has to end after the internal step that is just done. */
int engine_pause(Engine *engine);

#define INSTANT_ROUNDING 1e-6 /* a sample is due this part of its period or step early, against rounding of time */

/* Whether there is an event here that changes anything: that fires a transition, or changes an output or a derivative.
 * One that does not is over: its relations are those of the moment. */
int engine_event_matters(Engine *engine);

/* Whether the instant of a sample has come; its event has not been yet. */
int engine_sample_is_due(const Engine *engine);

/* ENGINE_FAILED, with a message; check is the index of the check that explains it, or -1. */
int engine_fail(Engine *engine, int check, const char *variable, const char *problem);
/* The same, explained by the first check that fails at the present values. */
int engine_fail_here(Engine *engine, const char *variable, const char *problem);

/* First check that fails at a stage of a step, where that is finite: -1 if none does, -2 if the stage is not finite. */
int engine_stage_check(const Engine *engine, double time, const double *stage);

/* Index of the first value that is not finite, -1 if all are. */
int first_not_finite(const double *values, int count);

#endif
