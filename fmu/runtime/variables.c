/* What value references name, reading and setting values. See instance.h and variables.h. */
#include "variables.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define MIN_STEP_SIZE 1e-9

Kind variable_locate(unsigned reference, int *index)
{
    const Model *model = &brunovsky_model;
    const int indicators = brunovsky_description.refused[MODEL_EXCHANGE] ? 0 : model->nz;
    const struct {
        Kind kind;
        int count;
    } groups[] = {{TIME, 1},           {STEP_SIZE, 1},     {SOLVER, 1},         {PARAMETER, model->np},
                  {INPUT, model->nu},  {OUTPUT, model->ny}, {STATE, model->nx}, {SAMPLE, model->nq},
                  {MODE, model->nm},   {DERIVATIVE, model->nx}, {INDICATOR, indicators}, {CLOCK_TICK, model->nk}};
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
        if (reference < (unsigned)groups[i].count) {
            *index = (int)reference;
            return groups[i].kind == SOLVER && !model->nx ? UNKNOWN : groups[i].kind;
        }
        reference -= (unsigned)groups[i].count;
    }
    *index = 0;
    return UNKNOWN;
}

Type variable_type(Kind kind, int index)
{
    if (kind == OUTPUT)
        return brunovsky_description.y_types[index];
    if (kind == SOLVER)
        return ENUMERATION;
    if (kind == CLOCK_TICK)
        return CLOCK;
    return kind == MODE ? INTEGER : REAL;
}

const char *variable_name(Kind kind, int index)
{
    const Model *model = &brunovsky_model;
    switch (kind) {
    case TIME: return "time";
    case STEP_SIZE: return "step_size";
    case SOLVER: return "solver";
    case PARAMETER: return model->p_names[index];
    case INPUT: return model->u_names[index];
    case OUTPUT: return model->y_names[index];
    case STATE:
    case DERIVATIVE: return model->x_names[index];
    case SAMPLE: return model->q_names[index];
    case MODE: return brunovsky_description.m_names[index];
    case INDICATOR: return brunovsky_description.z_names[index];
    case CLOCK_TICK: return model->k_names[index];
    default: return "?";
    }
}

/* Name of the lowest of these types. */
static const char *type_name(int types)
{
    int k = 0;
    while (!(types >> k & 1))
        k++;
    return TYPE_NAMES[k];
}

Result variable_find(Instance *instance, int types, unsigned reference, Kind *kind, int *index)
{
    *kind = variable_locate(reference, index);
    if (*kind == UNKNOWN)
        return instance_report(instance, FAILED, "there is no variable with value reference %u", reference);
    if (!(variable_type(*kind, *index) & types))
        return instance_report(instance, FAILED, "%s (value reference %u) is of type %s, not %s",
                               variable_name(*kind, *index), reference, type_name((int)variable_type(*kind, *index)),
                               type_name(types));
    return DONE;
}

Result instance_get(Instance *instance, int types, unsigned reference, double *value)
{
    const Engine *engine = instance->engine;
    Kind kind;
    int index;
    Result result = variable_find(instance, types, reference, &kind, &index);
    if (result == DONE && kind >= OUTPUT)
        result = instance_refresh(instance);
    if (result != DONE)
        return result;
    switch (kind) {
    case TIME: *value = instance->phase == INITIALIZATION ? instance->start : engine->time; break;
    case STEP_SIZE: *value = engine->step_size; break;
    case SOLVER: *value = engine->solver; break;
    case PARAMETER: *value = engine->p[index]; break;
    case INPUT: *value = engine->u[index]; break;
    case OUTPUT: *value = instance_outputs(instance)[index]; break;
    case STATE: *value = engine->x[index]; break;
    case SAMPLE: *value = engine->q[index]; break;
    case MODE: *value = engine->m[index]; break;
    case DERIVATIVE: *value = instance_derivatives(instance)[index]; break;
    case INDICATOR: *value = instance_indicators(instance)[index]; break;
    default: *value = engine->active[index]; break;
    }
    return isfinite(*value) ? DONE : instance_not_finite(instance, variable_name(kind, index));
}

int variable_state(Kind kind, int index)
{
    const Model *model = &brunovsky_model;
    if (kind == STATE)
        return index;
    for (int i = 0; kind == OUTPUT && i < model->nx; i++)
        if (strcmp(model->x_names[i], model->y_names[index]) == 0)
            return i;
    return -1;
}

/* FAILED unless a variable of this kind may be set now. Solvers that know no fmi2SetContinuousStates (casadi) set states
 * as variables. */
static Result settable(Instance *instance, Kind kind, int index)
{
    const char *name = variable_name(kind, index);
    const int tunable = kind == PARAMETER && brunovsky_description.p_tunable[index];
    if (instance->interface == MODEL_EXCHANGE && instance->phase & (EVENT | CONTINUOUS_TIME) && variable_state(kind, index) >= 0)
        return DONE;
    if (kind == TIME)
        return instance_report(instance, FAILED, "time is the independent variable and cannot be set as a variable");
    if (kind >= OUTPUT)
        return instance_report(instance, FAILED, "%s%s%s is calculated and cannot be set",
                               kind == DERIVATIVE ? "der(" : "", name, kind == DERIVATIVE ? ")" : "");
    if (instance->phase & (INSTANTIATED | INITIALIZATION) || kind == INPUT)
        return DONE;
    if (!tunable)
        return instance_report(instance, FAILED, "%s is a fixed parameter and cannot be set while the instance is %s", name,
                               instance_phase_name(instance));
    if (instance->phase == CONTINUOUS_TIME)
        return instance_report(instance, FAILED,
                               "%s is a parameter and cannot be set in continuous-time mode, but in event mode", name);
    if (instance->phase == INTERMEDIATE)
        return instance_report(instance, FAILED, "%s is a parameter and cannot be set within a communication step", name);
    return DONE;
}

static Result within(Instance *instance, const char *name, double value, double min, double max)
{
    if (value >= min && value <= max)
        return DONE;
    return instance_report(instance, FAILED, "%s = %g is out of its range from %g to %g", name, value, min, max);
}

Result instance_admits(Instance *instance, int types, unsigned reference, double value)
{
    const Model *model = instance->engine->model;
    Kind kind;
    int index;
    Result result = variable_find(instance, types, reference, &kind, &index);
    if (result == DONE)
        result = settable(instance, kind, index);
    if (result == DONE && !isfinite(value))
        result = instance_report(instance, FAILED, "%s cannot be set to %g: it is not finite", variable_name(kind, index),
                                 value);
    if (result != DONE)
        return result;
    switch (kind) {
    case PARAMETER: return within(instance, model->p_names[index], value, model->p_min[index], model->p_max[index]);
    case STEP_SIZE: return within(instance, "step_size", value, MIN_STEP_SIZE, DBL_MAX);
    case SOLVER: return within(instance, "solver", value, SOLVER_RK4, SOLVER_DORMAND_PRINCE);
    default: return DONE;
    }
}

void instance_set(Instance *instance, unsigned reference, double value)
{
    Engine *engine = instance->engine;
    int index;
    const Kind kind = variable_locate(reference, &index);
    switch (kind) {
    case PARAMETER:
        engine->p[index] = value;
        instance->parameters_checked = 0;
        break;
    case INPUT: engine->u[index] = value; break;
    case STEP_SIZE: engine->step_size = value; break;
    case SOLVER: engine->solver = (int)value; break;
    case OUTPUT:
    case STATE: engine->x[variable_state(kind, index)] = value; break;
    default: break;
    }
    instance->relations_current = 0;
    engine->inputs_set = 1;
    instance_outdate(instance);
}
