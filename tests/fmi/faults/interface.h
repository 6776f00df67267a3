/* What both versions of the interface share in the fault drivers: phases, numbering of variables, names of functions. */
#ifndef INTERFACE_H
#define INTERFACE_H

#include "description.h"
#include "harness.h"
#include "model.h"

#if FMI == 3
#define FMI3_OVERRIDE_FUNCTION_PREFIX
#include "fmi3Functions.h"
#define NAME(TWO, THREE) fmi3##THREE
typedef fmi3Boolean Boolean;
typedef fmi3Status Status;
#define SOLVER_TYPE ENUMERATION
#else
#include "fmi2Functions.h"
#define NAME(TWO, THREE) fmi2##TWO
typedef fmi2Boolean Boolean;
typedef fmi2Status Status;
#define SOLVER_TYPE INTEGER
#endif

#define GetState NAME(GetFMUstate, GetFMUState)
#define SetState NAME(SetFMUstate, SetFMUState)
#define FreeState NAME(FreeFMUstate, FreeFMUState)
#define StateSize NAME(SerializedFMUstateSize, SerializedFMUStateSize)
#define SerializeState NAME(SerializeFMUstate, SerializeFMUState)
#define DeserializeState NAME(DeSerializeFMUstate, DeserializeFMUState)
#define TEXT(X) #X
#define QUOTE(X) TEXT(X)

enum {
    INSTANTIATED = 1, INITIALIZATION = 2, STEP = 4, EVENT = 8, CONTINUOUS = 16, TERMINATED = 32, WITHIN_STEP = 64,
    ACTIVATION = 128, ALWAYS = 255 - WITHIN_STEP
};
enum { TIME = 0, STEP_SIZE = 1, SOLVER = 2, MAX_VALUES = 512 };

#define FIRST_INPUT (FIRST_PARAMETER + (unsigned)brunovsky_model.np)
#define FIRST_OUTPUT (FIRST_INPUT + (unsigned)brunovsky_model.nu)
#define FIRST_STATE (FIRST_OUTPUT + (unsigned)brunovsky_model.ny)
#define FIRST_SAMPLE (FIRST_STATE + (unsigned)brunovsky_model.nx)
#define FIRST_MODE (FIRST_SAMPLE + (unsigned)brunovsky_model.nq)
#define FIRST_DERIVATIVE (FIRST_MODE + (unsigned)brunovsky_model.nm)
#define FIRST_INDICATOR (FIRST_DERIVATIVE + (unsigned)brunovsky_model.nx)
#define INDICATORS (brunovsky_description.refused[MODEL_EXCHANGE] ? 0u : (unsigned)brunovsky_model.nz)
#define FIRST_CLOCK (FIRST_INDICATOR + INDICATORS)
/* Number of variables, and a value reference that no model has. */
#define VARIABLES (FIRST_CLOCK + (FMI == 3 ? (unsigned)brunovsky_model.nk : 0))
#define BEYOND 100000u

/* Of interface2.c and interface3.c: values of one type as double; exactly as much memory as these are goes in. Null
 * pointers are passed on. */
int get_values(const Subject *subject, Type type, const unsigned *references, size_t count, double *values, size_t n);
int set_values(const Subject *subject, Type type, const unsigned *references, size_t count, const double *values, size_t n);
int directional_derivative(const Subject *subject, int adjoint, const unsigned *unknowns, size_t n_unknowns,
                           const unsigned *knowns, size_t n_knowns, const double *seed, size_t n_seed, double *values,
                           size_t n);
int output_derivatives(const Subject *subject, const unsigned *references, size_t count, const int *orders, double *values,
                       size_t n);
size_t get_outputs(Subject *subject, double *found); /* statuses and values of all outputs */
void set_inputs(Subject *subject, int step);         /* of a step of the legal run */
double real(const Subject *subject, unsigned reference); /* value of a variable that can be read; 0 otherwise */
int moved(Subject *subject, Status status, int phase);   /* the subject is in this phase if the status is OK */

/* variables.c */
unsigned span(unsigned reference); /* number of elements: 0 within an array, 1 for a scalar */
int get_real(Subject *subject);
int get_integer(Subject *subject);
int get_boolean(Subject *subject);
int get_enumeration(Subject *subject);
int set_real(Subject *subject);
int set_integer(Subject *subject);
int set_boolean(Subject *subject);
int set_enumeration(Subject *subject);
int directional(Subject *subject);
int adjoint(Subject *subject);
int get_output_derivatives(Subject *subject);

/* states.c */
int get_state(Subject *subject);
int set_state(Subject *subject);
int free_state(Subject *subject);
int serialize(Subject *subject);
int deserialize(Subject *subject);
void free_kept(const Subject *subject);

/* exchange_calls.c: a run of model exchange, and its random calls */
void exchange_step(Subject *subject, double time, double length, double *next);
double settle_events(Subject *subject); /* events until done, back in continuous time; instant of the next one */
int completed_step(Subject *subject);
int set_time(Subject *subject);
int set_states(Subject *subject);
int get_states(Subject *subject);
int get_derivatives(Subject *subject);
int get_indicators(Subject *subject);
int get_nominals(Subject *subject);

#endif
