/* What an FMU knows of its description beside the model: generated with the modelDescription.xml.
 *
 * Value references follow from the model's counts alone, one numbering for all types: 0 time, 1 step_size, 2 solver,
 * and from FIRST_PARAMETER on parameters, inputs, outputs, states, samples, modes, derivatives, event indicators, clocks.
 * FMI 2 shows no variables for the last two; without model exchange there are no indicators.
 */
#ifndef BRUNOVSKY_DESCRIPTION_H
#define BRUNOVSKY_DESCRIPTION_H

#include "names.h"

enum { FIRST_PARAMETER = 3 };

/* Bits, so that a function can accept several. */
typedef enum { REAL = 1, INTEGER = 2, BOOLEAN = 4, ENUMERATION = 8, CLOCK = 16 } Type;

typedef enum { CONSTANT = 1, FIXED, TUNABLE, DISCRETE, DEPENDENT } DependencyKind; /* of FMI 3, by its numbers */

/* That an unknown depends on a known, by value references of scalars. */
typedef struct {
    unsigned unknown, known;
    DependencyKind kind;
} Dependency;

typedef struct {
    const char *token;           /* identifies the description: guid, instantiation token */
    const char *const *m_names;
    const char *const *z_names;  /* of the indicators */
    const Type *y_types;
    const int *p_tunable;        /* 0 or 1 */
    const unsigned *spans;       /* how many elements a value reference names: n for an array, whose reference is that of
                                    its first element, 0 for the others of it; a null pointer if all are scalars */
    const char *refused[3];      /* why there is none of an interface, by its number; a null pointer if there is one */
    const Dependency *initial, *running; /* of initialization mode and afterwards, unknown by unknown */
    int n_initial, n_running;
} Description;

extern const Description brunovsky_description;

#endif
