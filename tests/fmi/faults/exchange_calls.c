/* Model exchange in both versions: the legal run, and random calls. */
#include <math.h>

#include "interface.h"

static const char *const MESSAGE = "a legal call of model exchange: %s";

/* Explicit Euler with events after the steps. */
void exchange_step(Subject *subject, double time, double length, double *next)
{
    const size_t nx = (size_t)brunovsky_model.nx;
    double x[MAX_VALUES], dx[MAX_VALUES];
    Boolean event = 0, stop;
    void *c = subject->component;
    EXPECT(NAME(GetContinuousStates, GetContinuousStates)(c, x, nx) == 0 &&
               NAME(GetDerivatives, GetContinuousStateDerivatives)(c, dx, nx) == 0 &&
               NAME(SetTime, SetTime)(c, time + length) == 0,
           MESSAGE, subject->message);
    for (size_t i = 0; i < nx; i++)
        x[i] += length * dx[i];
    EXPECT(NAME(SetContinuousStates, SetContinuousStates)(c, x, nx) == 0 &&
               NAME(CompletedIntegratorStep, CompletedIntegratorStep)(c, 1, &event, &stop) == 0,
           MESSAGE, subject->message);
    if (event || *next <= time + length || brunovsky_model.nk) {
        EXPECT(NAME(EnterEventMode, EnterEventMode)(c) == 0, MESSAGE, subject->message);
        *next = settle_events(subject);
    }
}

int completed_step(Subject *subject)
{
    Boolean event = 0, stop = 1;
    const int null = chance(2);
    int status;
    must_fail = null;
    status = (int)NAME(CompletedIntegratorStep, CompletedIntegratorStep)(subject->component, 1, null ? NULL : &event, &stop);
    EXPECT(status != OK || ((event | 1) == 1 && stop == 0), "a completed step says %d and %d", event, stop);
    return status;
}

int set_time(Subject *subject)
{
    const double time = chance(95) ? real(subject, TIME) + uniform(0, 0.01) : odd_number();
    must_fail = !isfinite(time);
    return (int)NAME(SetTime, SetTime)(subject->component, time);
}

int set_states(Subject *subject)
{
    const size_t nx = (size_t)brunovsky_model.nx, count = chance(97) ? nx : nx + draw(5);
    double *values = own((count + 1) * sizeof *values);
    const int null = chance(2) && count;
    int status;
    must_fail = count != nx || null;
    for (size_t i = 0; i < count; i++) {
        values[i] = chance(99) ? uniform(-2, 2) * !chance(3) : odd_number();
        must_fail |= !isfinite(values[i]);
    }
    status = (int)NAME(SetContinuousStates, SetContinuousStates)(subject->component, null ? NULL : values, count);
    disown(values);
    return status;
}

typedef Status Vector(void *, double[], size_t);

static int vector(Subject *subject, Vector *function, int expected)
{
    const size_t count = chance(96) ? (size_t)expected : (size_t)expected + 1 - draw(3) % (unsigned)(expected + 1);
    double *values = own(count * sizeof *values);
    const int null = chance(2) && count;
    int status;
    must_fail = count != (size_t)expected || null;
    for (size_t i = 0; i < count; i++)
        values[i] = NAN;
    status = (int)function(subject->component, null ? NULL : values, count);
    for (size_t i = 0; status <= WARNING && i < count; i++)
        EXPECT(isfinite(values[i]), "number %d is %g", (int)i, values[i]);
    disown(values);
    return status;
}

int get_states(Subject *subject)
{
    return vector(subject, NAME(GetContinuousStates, GetContinuousStates), brunovsky_model.nx);
}

int get_derivatives(Subject *subject)
{
    return vector(subject, NAME(GetDerivatives, GetContinuousStateDerivatives), brunovsky_model.nx);
}

int get_indicators(Subject *subject)
{
    return vector(subject, NAME(GetEventIndicators, GetEventIndicators), brunovsky_model.nz);
}

int get_nominals(Subject *subject)
{
    return vector(subject, NAME(GetNominalsOfContinuousStates, GetNominalsOfContinuousStates), brunovsky_model.nx);
}
