/* What the FMI 2.0 files of the fault drivers share: the phases and the numbering of variables of the FMI 2.0 functions. */
#ifndef INTERFACE2_H
#define INTERFACE2_H

#include "description.h"
#include "fmi2Functions.h"
#include "harness.h"
#include "model.h"

enum { INSTANTIATED = 1, INITIALIZATION = 2, STEP = 4, EVENT = 8, CONTINUOUS = 16, TERMINATED = 32, ALWAYS = 63 };
enum { TIME = 0, STEP_SIZE = 1, SOLVER = 2, FIRST_PARAMETER = 3, MAX_VALUES = 512 };

#define FIRST_INPUT (FIRST_PARAMETER + (unsigned)brunovsky_model.np)
#define FIRST_OUTPUT (FIRST_INPUT + (unsigned)brunovsky_model.nu)
#define FIRST_STATE (FIRST_OUTPUT + (unsigned)brunovsky_model.ny)
#define FIRST_SAMPLE (FIRST_STATE + (unsigned)brunovsky_model.nx)
#define FIRST_MODE (FIRST_SAMPLE + (unsigned)brunovsky_model.nq)
#define FIRST_DERIVATIVE (FIRST_MODE + (unsigned)brunovsky_model.nm)
#define VARIABLES (FIRST_DERIVATIVE + (unsigned)brunovsky_model.nx)
#define BEYOND 100000u /* no model has so many variables */

/* variables2.c */
int get_REAL(Subject *subject);
int get_INTEGER(Subject *subject);
int get_BOOLEAN(Subject *subject);
int set_real(Subject *subject);
int set_integer(Subject *subject);
int set_boolean(Subject *subject);
int get_string(Subject *subject);
int set_string(Subject *subject);
int directional(Subject *subject);
int set_input_derivatives(Subject *subject);
int get_output_derivatives(Subject *subject);

/* states2.c */
int get_state(Subject *subject);
int set_state(Subject *subject);
int free_state(Subject *subject);
int serialize(Subject *subject);
int deserialize(Subject *subject);

int moved(Subject *subject, fmi2Status status, int phase); /* the subject is in this phase if the status is OK */

#endif
