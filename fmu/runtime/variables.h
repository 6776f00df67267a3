/* Where the variable of a value reference is, and what instance.c shares with the other parts of an instance. */
#ifndef BRUNOVSKY_VARIABLES_H
#define BRUNOVSKY_VARIABLES_H

#include "instance.h"

typedef enum { TIME, STEP_SIZE, SOLVER, PARAMETER, INPUT, OUTPUT, STATE, SAMPLE, MODE, DERIVATIVE, UNKNOWN } Kind;

Kind locate(unsigned reference, int *index);
Type type_of(Kind kind, int index);
const char *name_of(Kind kind, int index); /* of a derivative: the name of its state */
int state_of(Kind kind, int index);        /* state that a variable is, itself or as an output; -1 if it is none */

Result report(Instance *instance, Result result, const char *format, ...);
Result not_finite(Instance *instance, const char *name);
Result refresh(Instance *instance);

#endif
