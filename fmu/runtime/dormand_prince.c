/* The embedded pair of Dormand and Prince, 5(4), with steps chosen by the tolerance and events located within them.
 *
 * E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993: table II.5.2,
 * eqs. II.4.11 and II.4.13, II.4 "starting step size", interpolation of section II.6. A step in which a relation is no
 * longer what it is frozen at is cut just after the change; relations and transitions are evaluated there, and
 * integration begins afresh. The NumPy engine does the same.
 */
#include "solver.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define ABSOLUTE 0.01 /* absolute tolerance of a state as part of the relative one, in units of its nominal value */
#define SAFETY 0.9
#define SMALLEST_FACTOR 0.2
#define LARGEST_FACTOR 5.0
#define LOCATION 1e-9 /* part of a step, or of step_size if shorter, within which a change is located */
#define MAX_STEPS 100000 /* within a time of step_size */
#define MAX_EVENTS 200   /* within a part CROWD of step_size */
#define CROWD 1e-3
#define REMEDY "use solver RK4, a boundary layer, hysteresis or a sampled law"
#define STAGES 7

static const double NODES[STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
static const double MATRIX[STAGES][STAGES - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double ERROR[STAGES] = {71.0 / 57600,      0,           -71.0 / 16695, 71.0 / 1920,
                                     -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
static const double INTERIOR[STAGES] = {-12715105075.0 / 11282082432.0, 0,
                                        87487479700.0 / 32700410799.0,  -10690763975.0 / 1880347072.0,
                                        701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
                                        69997945.0 / 29380423.0};
static const double CHECKED[] = {0.25, 0.5, 0.75, 1}; /* parts of a step where relations are compared */

/* A step: from engine->time and engine->x on; its memory is the engine's. */
typedef struct {
    Engine *engine;
    double size;
    double *slopes, *end, *inside; /* STAGES nx, nx, nx */
} Step;

static double slope(const Step *step, int stage, int i)
{
    return step->slopes[stage * step->engine->model->nx + i];
}

static double weighted(const Step *step, const double *weights, int stages, int i)
{
    double total = weights[0] * slope(step, 0, i);
    for (int k = 1; k < stages; k++)
        total += weights[k] * slope(step, k, i);
    return total;
}

static void derivatives(const Step *step, double time, const double *x, double *dx)
{
    const Engine *e = step->engine;
    inputs_at(e, time);
    e->model->derivatives(time, x, e->u, e->p, e->q, e->m, e->r, dx);
}

static void stage_states(const Step *step, int stage, double *states)
{
    const double *start = step->engine->x;
    for (int i = 0; i < step->engine->model->nx; i++)
        states[i] = stage ? start[i] + step->size * weighted(step, MATRIX[stage], stage, i) : start[i];
}

/* All slopes but the first, which is there, and the states at the end. */
static void attempt(const Step *step)
{
    for (int k = 1; k < STAGES; k++) {
        stage_states(step, k, step->end);
        derivatives(step, step->engine->time + NODES[k] * step->size, step->end,
                    step->slopes + k * step->engine->model->nx);
    }
}

/* States within the step, by interpolation of order 4. */
static void interpolate(const Step *step, double fraction, double *states)
{
    const double other = 1 - fraction;
    for (int i = 0; i < step->engine->model->nx; i++) {
        const double start = step->engine->x[i], rise = step->end[i] - start;
        const double bend = step->size * slope(step, 0, i) - rise;
        const double back = rise - step->size * slope(step, STAGES - 1, i) - bend;
        const double high = step->size * weighted(step, INTERIOR, STAGES, i);
        states[i] = start + fraction * (rise + other * (bend + fraction * (back + other * high)));
    }
}

static double scale(const Engine *engine, int i, double other)
{
    const double largest = fmax(fabs(engine->x[i]), fabs(other));
    return ABSOLUTE * engine->tolerance * engine->model->x_nominal[i] + engine->tolerance * largest;
}

static double mean_root(double squares, int count)
{
    return count ? sqrt(squares / count) : 0;
}

/* Estimated error, 1 at the tolerance; not finite where the step is not. */
static double error_of(const Step *step)
{
    const Engine *engine = step->engine;
    double squares = 0;
    if (first_not_finite(step->end, engine->model->nx) >= 0)
        return NAN;
    for (int i = 0; i < engine->model->nx; i++) {
        const double error = step->size * weighted(step, ERROR, STAGES, i) / scale(engine, i, step->end[i]);
        squares += error * error;
    }
    return mean_root(squares, engine->model->nx);
}

/* Size to begin with, from the first two derivatives of the states; the first slope is there. */
static double first_size(const Step *step, double longest)
{
    const Engine *engine = step->engine;
    const int n = engine->model->nx;
    double *second = step->slopes + n, states = 0, slopes = 0, bend = 0;
    for (int i = 0; i < n; i++) {
        const double weight = scale(engine, i, engine->x[i]);
        states += engine->x[i] / weight * (engine->x[i] / weight);
        slopes += step->slopes[i] / weight * (step->slopes[i] / weight);
    }
    states = mean_root(states, n);
    slopes = mean_root(slopes, n);
    double trial = states < 1e-5 || slopes < 1e-5 ? 1e-6 : 0.01 * states / slopes;
    trial = fmin(trial, longest);
    for (int i = 0; i < n; i++)
        step->end[i] = engine->x[i] + trial * step->slopes[i];
    derivatives(step, engine->time + trial, step->end, second);
    for (int i = 0; i < n; i++) {
        const double change = (second[i] - step->slopes[i]) / scale(engine, i, engine->x[i]);
        bend += change * change;
    }
    bend = mean_root(bend, n) / trial;
    if (!isfinite(bend) || !isfinite(slopes))
        return trial;
    const double largest = fmax(slopes, bend);
    const double size = largest <= 1e-15 ? fmax(1e-6, 1e-3 * trial) : pow(0.01 / largest, 0.2);
    return fmin(fmin(100 * trial, size), longest);
}

/* How much longer the next step may be, below 1 after an error above 1. */
static double factor(double error)
{
    if (!isfinite(error))
        return SMALLEST_FACTOR;
    return error > 0 ? fmin(LARGEST_FACTOR, fmax(SMALLEST_FACTOR, SAFETY * pow(error, -0.2))) : LARGEST_FACTOR;
}

/* Whether relations within the step are not what they are frozen at. */
static int differs(const Step *step, double fraction)
{
    const double time = step->engine->time + fraction * step->size;
    interpolate(step, fraction, step->inside);
    inputs_at(step->engine, time);
    return engine_relations_differ(step->engine, time, step->inside);
}

/* Part of the step just after which relations first differ from what they are frozen at, HUGE_VAL if nowhere. */
static double first_change(const Step *step)
{
    const Engine *engine = step->engine;
    const double location = LOCATION * fmin(engine->step_size, step->size) + 4 * DBL_EPSILON * fabs(engine->time);
    const double width = location / step->size;
    double before = 0, after = 0;
    size_t k = 0;
    if (!engine->model->acting)
        return HUGE_VAL;
    while (k < sizeof CHECKED / sizeof *CHECKED && !differs(step, CHECKED[k]))
        before = CHECKED[k++];
    if (k == sizeof CHECKED / sizeof *CHECKED)
        return HUGE_VAL;
    after = CHECKED[k];
    while (after - before > width) {
        const double middle = 0.5 * (before + after);
        if (!(before < middle && middle < after))
            break;
        if (differs(step, middle))
            after = middle;
        else
            before = middle;
    }
    return after;
}

static int fail_slope(Engine *engine, int index)
{
    char name[128];
    snprintf(name, sizeof name, "der(%s)", engine->model->x_names[index]);
    return engine_fail_here(engine, name, "is not finite");
}

/* ENGINE_FAILED if a rejected step cannot be followed by a smaller one. */
static int check_rejected(const Step *step, int steps, double smallest)
{
    Engine *engine = step->engine;
    char problem[128];
    int check = -1;
    if (step->size > smallest && steps < MAX_STEPS)
        return ENGINE_OK;
    const int bad = first_not_finite(step->end, engine->model->nx);
    for (int k = 0; k < STAGES && check == -1; k++) {
        stage_states(step, k, step->inside);
        inputs_at(engine, engine->time + NODES[k] * step->size);
        check = engine_stage_check(engine, engine->time + NODES[k] * step->size, step->inside);
    }
    check = check < 0 ? -1 : check;
    if (bad >= 0)
        return engine_fail(engine, check, engine->model->x_names[bad], "is not finite after the step");
    snprintf(problem, sizeof problem, "finds no step that keeps the tolerance of %g", engine->tolerance);
    return engine_fail(engine, check, "solver", problem);
}

static int check_effort(Engine *engine, int steps)
{
    char problem[256];
    if (steps >= MAX_STEPS) {
        snprintf(problem, sizeof problem,
                 "needs over %d steps within %g s: it is stiff or hardly stops switching; "
                 "take a smaller step_size, or " REMEDY,
                 MAX_STEPS, engine->step_size);
        return engine_fail(engine, -1, "solver", problem);
    }
    if (engine->crowded > MAX_EVENTS) {
        snprintf(problem, sizeof problem, "do not end: over %d within %g s; " REMEDY, MAX_EVENTS,
                 CROWD * engine->step_size);
        return engine_fail(engine, -1, "events", problem);
    }
    return ENGINE_OK;
}

/* The step is over: the time it reached, the states there, and its last slope as the first of the next one. */
static void accept(const Step *step, double time)
{
    const size_t n = (size_t)step->engine->model->nx;
    step->engine->time = time;
    inputs_at(step->engine, time);
    memcpy(step->engine->x, step->end, n * sizeof(double));
    memcpy(step->slopes, step->slopes + (STAGES - 1) * n, n * sizeof(double));
}

/* The step is cut for an event. */
static int cut(const Step *step, double fraction)
{
    Engine *engine = step->engine;
    interpolate(step, fraction, step->inside);
    engine->time += fraction * step->size;
    inputs_at(engine, engine->time);
    memcpy(engine->x, step->inside, (size_t)engine->model->nx * sizeof(double));
    return engine->pause_at_event ? ENGINE_OK : engine_settle(engine);
}

int dormand_prince_integrate(Engine *engine, double stop)
{
    const int n = engine->model->nx;
    Step step = {engine, 0, engine->work, engine->work + STAGES * n, engine->work + (STAGES + 1) * n};
    double window = engine->time, growth = LARGEST_FACTOR;
    int steps = 0, fresh = 1;
    if (!engine->pause_at_event) { /* otherwise one call ends at its first event */
        engine->crowd = engine->time;
        engine->crowded = 0;
    }
    while (engine->time < stop) {
        if (engine->time > window + engine->step_size) {
            window = engine->time;
            steps = 0;
        }
        if (engine->time > engine->crowd + CROWD * engine->step_size) {
            engine->crowd = engine->time;
            engine->crowded = 0;
        }
        if (fresh) {
            derivatives(&step, engine->time, engine->x, step.slopes);
            const int bad = first_not_finite(step.slopes, n);
            if (bad >= 0)
                return fail_slope(engine, bad);
            step.size = first_size(&step, stop - engine->time);
            fresh = 0;
        }
        const int last = 1.01 * step.size >= stop - engine->time;
        if (last)
            step.size = stop - engine->time;
        attempt(&step);
        steps++;
        const double error = error_of(&step);
        if (!(error <= 1)) {
            if (check_rejected(&step, steps, 16 * DBL_EPSILON * fmax(fabs(engine->time), fabs(stop))) != ENGINE_OK)
                return ENGINE_FAILED;
            step.size *= fmin(factor(error), SAFETY);
            growth = 1;
            continue;
        }
        const double fraction = first_change(&step);
        if (engine->time + fraction * step.size >= stop || fraction > 1) { /* an event at the end is the caller's */
            accept(&step, last ? stop : engine->time + step.size);
            step.size *= fmin(factor(error), growth);
            growth = LARGEST_FACTOR;
        } else {
            if (cut(&step, fraction) != ENGINE_OK)
                return ENGINE_FAILED;
            engine->crowded++;
            fresh = 1;
        }
        if (check_effort(engine, steps) != ENGINE_OK)
            return ENGINE_FAILED;
        if (engine_pause(engine) != ENGINE_OK)
            return ENGINE_PAUSED;
        fresh = fresh || engine->inputs_set;
    }
    return ENGINE_OK;
}
