/* What the FMI 3.0 files of the fault drivers share beside interface.h. */
#ifndef CALLS3_H
#define CALLS3_H

#include "interface.h"

/* What a master that meddles does during a step. */
void within_step(Subject *subject, double time, int can_return, fmi3Boolean *early, fmi3Float64 *early_time);

/* clocks3.c: clocks, dependencies, and what is not provided */
int get_clock(Subject *subject);
int set_clock(Subject *subject);
int get_interval(Subject *subject);
int set_interval(Subject *subject);
int get_shift(Subject *subject);
int activate_partition(Subject *subject);
int dependencies(Subject *subject);
int not_provided(Subject *subject);
int read_other_types(Subject *subject);
int write_other_types(Subject *subject);

#endif
