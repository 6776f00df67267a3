/* The variables of an instance: what a value reference names, and whether it may be set now. */
#ifndef BRUNOVSKY_VARIABLES_H
#define BRUNOVSKY_VARIABLES_H

#include "instance.h"

typedef enum {
    TIME, STEP_SIZE, SOLVER, PARAMETER, INPUT, OUTPUT, STATE, SAMPLE, MODE, DERIVATIVE, INDICATOR, CLOCK_TICK, UNKNOWN
} Kind;

/* Names of the types in messages, in the order of their bits; each version of the interface has its own. */
extern const char *const TYPE_NAMES[];

/* Kind of the variable with this reference, and its index among those of the kind. */
Kind variable_locate(unsigned reference, int *index);
Type variable_type(Kind kind, int index);
const char *variable_name(Kind kind, int index); /* of a derivative: the name of its state */
int variable_state(Kind kind, int index); /* state that a variable is, itself or as an output; -1 if it is none */

/* The same for a variable of one of these types; FAILED with its name, or its number if there is none. */
Result variable_find(Instance *instance, int types, unsigned reference, Kind *kind, int *index);

#endif
