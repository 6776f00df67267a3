/* Time of a co-simulation step through fmi2DoStep or fmi3DoStep, and of the same RK4 step in plain C. See fmu_step.py. */
#define _POSIX_C_SOURCE 199309L
#include <stddef.h>
#include <time.h>

#include "description.h"
#include "model.h"

#if FMI == 3
#define FMI3_OVERRIDE_FUNCTION_PREFIX
#include "fmi3Functions.h"
#else
#include "fmi2Functions.h"
#endif

enum { MOST_STATES = 64 };

#define EXPORT __attribute__((visibility("default")))

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

typedef struct {
    double x[MOST_STATES], q[MOST_STATES], u[MOST_STATES], p[MOST_STATES];
    int m[MOST_STATES], r[MOST_STATES];
} Values;

/* What an FMU does besides is left out: four evaluations of the derivatives and the update. */
static void plain_step(Values *v, double t, double h)
{
    const Model *model = &brunovsky_model;
    double k1[MOST_STATES], k2[MOST_STATES], k3[MOST_STATES], k4[MOST_STATES], stage[MOST_STATES];
    model->derivatives(t, v->x, v->u, v->p, v->q, v->m, v->r, k1);
    for (int i = 0; i < model->nx; i++)
        stage[i] = v->x[i] + 0.5 * h * k1[i];
    model->derivatives(t + 0.5 * h, stage, v->u, v->p, v->q, v->m, v->r, k2);
    for (int i = 0; i < model->nx; i++)
        stage[i] = v->x[i] + 0.5 * h * k2[i];
    model->derivatives(t + 0.5 * h, stage, v->u, v->p, v->q, v->m, v->r, k3);
    for (int i = 0; i < model->nx; i++)
        stage[i] = v->x[i] + h * k3[i];
    model->derivatives(t + h, stage, v->u, v->p, v->q, v->m, v->r, k4);
    for (int i = 0; i < model->nx; i++)
        v->x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}

static double time_plain(const double *inputs, long steps, double h, double *last)
{
    const Model *model = &brunovsky_model;
    Values v = {{0}};
    for (int i = 0; i < model->np; i++)
        v.p[i] = model->p_default[i];
    for (int i = 0; i < model->nu; i++)
        v.u[i] = inputs[i];
    model->start(v.p, v.x, v.q);
    model->relations(0, v.x, v.u, v.p, v.q, v.m, v.r);
    const double begin = now();
    for (long i = 0; i < steps; i++)
        plain_step(&v, (double)i * h, h);
    const double seconds = now() - begin;
    for (int i = 0; i < model->nx; i++)
        last[i] = v.x[i];
    return seconds;
}

#if FMI == 3
static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)environment, (void)status, (void)category, (void)message;
}

static void *make(void)
{
    return fmi3InstantiateCoSimulation("one", brunovsky_description.token, "", 0, 0, 0, 0, NULL, 0, NULL, logger, NULL);
}

static int begin(void *one)
{
    return fmi3Reset(one) || fmi3EnterInitializationMode(one, 0, 0, 0, 0, 0);
}

static int step(void *one, double t, double h)
{
    fmi3Boolean event, terminate, early;
    fmi3Float64 last;
    return fmi3DoStep(one, t, h, 1, &event, &terminate, &early, &last) != fmi3OK;
}

#define SET_REAL(one, reference, value) fmi3SetFloat64(one, reference, 1, value, 1)
#define GET_REAL(one, reference, value) fmi3GetFloat64(one, reference, 1, value, 1)
#define EXIT_INITIALIZATION fmi3ExitInitializationMode
#define FREE fmi3FreeInstance
#else
static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

static void *make(void)
{
    static const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    return fmi2Instantiate("one", fmi2CoSimulation, brunovsky_description.token, "", &callbacks, 0, 0);
}

static int begin(void *one)
{
    return fmi2Reset(one) || fmi2SetupExperiment(one, 0, 0, 0, 0, 0) || fmi2EnterInitializationMode(one);
}

static int step(void *one, double t, double h)
{
    return fmi2DoStep(one, t, h, fmi2True) != fmi2OK;
}

#define SET_REAL(one, reference, value) fmi2SetReal(one, reference, 1, value)
#define GET_REAL(one, reference, value) fmi2GetReal(one, reference, 1, value)
#define EXIT_INITIALIZATION fmi2ExitInitializationMode
#define FREE fmi2FreeInstance
#endif

static int start(void *one, const double *inputs)
{
    const Model *model = &brunovsky_model;
    int failed = begin(one);
    for (int i = 0; i < model->nu; i++) {
        const unsigned reference = FIRST_PARAMETER + (unsigned)(model->np + i);
        failed = failed || SET_REAL(one, &reference, &inputs[i]);
    }
    return failed || EXIT_INITIALIZATION(one);
}

static double time_fmu(void *one, const double *inputs, long steps, double h, double *last)
{
    const Model *model = &brunovsky_model;
    int failed = start(one, inputs);
    const double begin_time = now();
    for (long i = 0; i < steps; i++)
        failed |= step(one, (double)i * h, h);
    const double seconds = now() - begin_time;
    for (int i = 0; i < model->nx; i++) {
        const unsigned reference = FIRST_PARAMETER + (unsigned)(model->np + model->nu + model->ny + i);
        failed |= GET_REAL(one, &reference, &last[i]) != 0;
    }
    return failed ? -1 : seconds;
}

/* Seconds of `steps` steps of size h, plain and as FMU, for each repetition, and the states that both reached;
 * returns 0 if all went well. */
EXPORT int measure(const double *inputs, long steps, double h, int repetitions, double *plain, double *fmu,
                   double *plain_states, double *fmu_states)
{
    void *one = make();
    int failed = !one;
    for (int i = 0; i < repetitions && !failed; i++) {
        plain[i] = time_plain(inputs, steps, h, plain_states);
        fmu[i] = time_fmu(one, inputs, steps, h, fmu_states);
        failed = fmu[i] < 0;
    }
    FREE(one);
    return failed;
}
