/* Derivatives of an instance's unknowns with respect to its knowns, of the branch that acts.
 *
 * Unknowns are Real outputs and state derivatives, in initialization mode also states. Knowns are time, inputs and
 * parameters, after initialization also continuous states. The events of the first instant are differentiated through
 * where they sample; where a transition assigns a state or sample then, derivatives in initialization mode are refused.
 */
#ifndef BRUNOVSKY_SENSITIVITY_H
#define BRUNOVSKY_SENSITIVITY_H

#include "instance.h"

/* Work space, allocated with the instance. NULL if out of memory. */
Sensitivity *sensitivity_new(void);

/* result[i] = sum over k of d unknown_i / d known_k seed[k] */
Result instance_directional(Instance *instance, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                            size_t n_knowns, const double *seed, double *result);

/* result[k] = sum over i of seed[i] d unknown_i / d known_k */
Result instance_adjoint(Instance *instance, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns,
                        size_t n_knowns, const double *seed, double *result);

/* Dependencies of an unknown at present, those of initialization mode until its end: how many there are, FAILED where the
 * variable is no unknown; and which. */
Result instance_count_dependencies(Instance *instance, unsigned unknown, size_t *count);
const Dependency *instance_dependencies(const Instance *instance, unsigned unknown, size_t *count);

#endif
