/* What a master is told of events, and asked within a communication step. See Listener in instance.h. */
#include "instance.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void tell(const Instance *instance, Topic topic, const char *name, const char *change)
{
    char text[384];
    if (!instance->listener.tell)
        return;
    snprintf(text, sizeof text, "%s %s at t = %.9g s", name, change, instance->engine->time);
    instance->listener.tell(instance->listener.master, topic, text);
}

static int is_singularity(const char *name)
{
    const size_t length = strlen(name), end = strlen("singular");
    return length >= end && strcmp(name + length - end, "singular") == 0;
}

/* Tells what changed of the Boolean outputs and modes since the last time. */
static void tell_changes(Instance *instance)
{
    Engine *engine = instance->engine;
    const Model *model = engine->model;
    int *modes = instance->told + model->ny;
    char change[64];
    engine_outputs(engine);
    for (int i = 0; i < model->ny; i++) {
        const int value = engine->y[i] != 0;
        if (brunovsky_description.y_types[i] != BOOLEAN || value == instance->told[i])
            continue;
        instance->told[i] = value;
        tell(instance, is_singularity(model->y_names[i]) ? ABOUT_SINGULARITY : ABOUT_EVENTS, model->y_names[i],
             value ? "became true" : "became false");
    }
    for (int i = 0; i < model->nm; i++) {
        if (engine->m[i] == modes[i])
            continue;
        snprintf(change, sizeof change, "changed from %d to %d", modes[i], engine->m[i]);
        modes[i] = engine->m[i];
        tell(instance, ABOUT_EVENTS, brunovsky_description.m_names[i], change);
    }
}

static int ask(Instance *instance)
{
    int wanted;
    double end = instance->engine->time;
    instance->phase = INTERMEDIATE;
    instance_outdate(instance);
    wanted = instance->listener.ask(instance->listener.master, instance->engine->time, &end);
    instance->phase = STEP;
    if (!wanted || !(end < instance->end))
        return 0;
    instance->end = fmax(end, instance->engine->time);
    return 1;
}

static int observe(void *observer, int what)
{
    Instance *instance = observer;
    if (what == ENGINE_STEPPED)
        return instance->listener.ask && instance->phase == STEP ? ask(instance) : 0;
    if (instance->listener.tell)
        tell_changes(instance);
    return 0;
}

void instance_listen(Instance *instance, Listener listener)
{
    instance->listener.tell = NULL;
    if (instance->phase & ~(INSTANTIATED | INITIALIZATION))
        tell_changes(instance); /* what holds now is no news */
    instance->listener = listener;
    instance->engine->observer = instance;
    instance->engine->observe = listener.tell || listener.ask ? observe : NULL;
}

void instance_take_back_told(Instance *instance)
{
    if (instance->listener.tell)
        instance_listen(instance, instance->listener);
}

void instance_tell_start(Instance *instance)
{
    const Model *model = instance->engine->model;
    memset(instance->told, 0, (size_t)model->ny * sizeof *instance->told);
    memcpy(instance->told + model->ny, model->m_start, (size_t)model->nm * sizeof *instance->told);
    if (instance->listener.tell)
        tell_changes(instance);
}
