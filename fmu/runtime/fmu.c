/* What the interfaces of both versions share. See fmu.h. */
#include "fmu.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    int bits;
} CATEGORIES[] = {{"logEvents", LOG_EVENTS},
                  {"logSingularity", LOG_SINGULARITY},
                  {"logStatusWarning", LOG_WARNING},
                  {"logStatusDiscard", LOG_DISCARD},
                  {"logStatusError", 0},
                  {"logAll", LOG_ALL}};

/* Log ------------------------------------------------------------------------------------------------------------- */

void fmu_log(const Logger *logger, int status, const char *category, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    if (!logger->callback)
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    logger->log((void *)logger, logger->environment, logger->name, status, category, text);
}

int fmu_fail(const Fmu *fmu, const char *function, const char *problem)
{
    fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError", "%s: %s", function, problem);
    return STATUS_ERROR;
}

int fmu_status(const Fmu *fmu, const char *function, Result result)
{
    const char *message = fmu->instance->message;
    switch (result) {
    case DONE: return STATUS_OK;
    case WARNED:
        if (fmu->logged & LOG_WARNING)
            fmu_log(&fmu->logger, STATUS_WARNING, "logStatusWarning", "%s: %s", function, message);
        return STATUS_OK;
    case DISCARDED:
        if (fmu->logged & LOG_DISCARD)
            fmu_log(&fmu->logger, STATUS_DISCARD, "logStatusDiscard", "%s: %s", function, message);
        return STATUS_DISCARD;
    default: return fmu_fail(fmu, function, message);
    }
}

int fmu_refused(const Fmu *fmu, const char *function, int phases)
{
    if (!fmu)
        return 1;
    if (instance_permits(fmu->instance, phases) == DONE)
        return 0;
    fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError", "%s %s", function, fmu->instance->message);
    return 1;
}

int fmu_refused_to(const Fmu *fmu, const char *function, int interfaces, int phases)
{
    return fmu_refused(fmu, function, fmu && interfaces >> fmu->instance->interface & 1 ? phases : 0);
}

int fmu_missing(const Fmu *fmu, const char *function, size_t count, const void *first, const void *second)
{
    if (!count || (first && second))
        return 0;
    fmu_fail(fmu, function, "an argument is a null pointer");
    return 1;
}

static void tell(void *master, Topic topic, const char *message)
{
    const Fmu *fmu = master;
    const int category = topic == ABOUT_SINGULARITY ? 1 : 0;
    if (fmu->logged & CATEGORIES[category].bits)
        fmu_log(&fmu->logger, STATUS_OK, CATEGORIES[category].name, "%s", message);
}

static void listen_for(Fmu *fmu)
{
    Listener listener = fmu->instance->listener;
    listener.tell = fmu->logged & (LOG_EVENTS | LOG_SINGULARITY) ? tell : NULL;
    listener.master = fmu;
    instance_listen(fmu->instance, listener);
}

int fmu_set_logging(Fmu *fmu, const char *function, int on, size_t count, const char *const *categories)
{
    const size_t known = sizeof CATEGORIES / sizeof *CATEGORIES;
    int bits = count ? 0 : LOG_ALL;
    if (fmu_refused(fmu, function, ANY_PHASE) || fmu_missing(fmu, function, count, categories, categories))
        return STATUS_ERROR;
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < known && categories[i] && strcmp(categories[i], CATEGORIES[k].name) != 0)
            k++;
        if (k == known || !categories[i]) {
            fmu_log(&fmu->logger, STATUS_ERROR, "logStatusError", "%s: there is no log category '%s'", function,
                    categories[i] ? categories[i] : "NULL");
            return STATUS_ERROR;
        }
        bits |= CATEGORIES[k].bits;
    }
    fmu->logged = (on ? bits : fmu->logged & ~bits) | fmu->always; /* what is not listed is not asked for */
    listen_for(fmu);
    return STATUS_OK;
}

/* Life cycle ------------------------------------------------------------------------------------------------------ */

void fmu_free(Fmu *fmu)
{
    if (!fmu)
        return;
    instance_free(fmu->instance);
    free(fmu->name);
    free(fmu);
}

Fmu *fmu_new(const char *function, Logger logger, Interface interface, const char *token, int logging, int always)
{
    const char *name = logger.name;
    Fmu *fmu;
    if (!name || !*name) {
        logger.name = "?";
        fmu_log(&logger, STATUS_ERROR, "logStatusError", "%s: the instance has no name", function);
        return NULL;
    }
    if (brunovsky_description.refused[interface]) {
        fmu_log(&logger, STATUS_ERROR, "logStatusError", "%s: %s", function, brunovsky_description.refused[interface]);
        return NULL;
    }
    if (!token || strcmp(token, brunovsky_description.token) != 0) {
        fmu_log(&logger, STATUS_ERROR, "logStatusError",
                "%s: the token is %s, but this binary has %s; do not mix files of different FMUs", function,
                token ? token : "a null pointer", brunovsky_description.token);
        return NULL;
    }
    fmu = calloc(1, sizeof *fmu);
    if (fmu) {
        fmu->name = malloc(strlen(name) + 1);
        fmu->instance = instance_new(interface);
    }
    if (!fmu || !fmu->name || !fmu->instance) {
        fmu_free(fmu);
        fmu_log(&logger, STATUS_ERROR, "logStatusError", "%s: out of memory", function);
        return NULL;
    }
    strcpy(fmu->name, name);
    fmu->logger = logger;
    fmu->logger.name = fmu->name;
    fmu->always = always;
    fmu->logged = (logging ? LOG_ALL : 0) | always;
    listen_for(fmu);
    return fmu;
}

int fmu_reset(Fmu *fmu, const char *function)
{
    if (fmu_refused(fmu, function, ANY_PHASE & ~INTERMEDIATE))
        return STATUS_ERROR;
    instance_reset(fmu->instance);
    fmu->last_step = STATUS_OK;
    return STATUS_OK;
}

int fmu_terminate(Fmu *fmu, const char *function)
{
    if (fmu_refused(fmu, function, STEP | EVENT | CONTINUOUS_TIME | ACTIVATION))
        return STATUS_ERROR;
    fmu->instance->phase = TERMINATED;
    return STATUS_OK;
}

int fmu_event(const Fmu *fmu, const char *function, Event *event)
{
    const Result result = instance_event(fmu->instance, event);
    if (result != DONE)
        return fmu_status(fmu, function, result);
    if (fmu->logged & LOG_EVENTS && (event->states_changed || event->discrete_changed))
        fmu_log(&fmu->logger, STATUS_OK, "logEvents", "event at t = %.9g s changed%s%s", fmu->instance->engine->time,
                event->states_changed ? " continuous states" : "", event->discrete_changed ? " samples or modes" : "");
    return STATUS_OK;
}

/* State of the FMU ------------------------------------------------------------------------------------------------- */

#define STATE_PHASES (ANY_PHASE & ~INTERMEDIATE)

int fmu_get_state(const Fmu *fmu, const char *function, void **state)
{
    if (fmu_refused(fmu, function, STATE_PHASES) || fmu_missing(fmu, function, 1, state, state))
        return STATUS_ERROR;
    if (!*state)
        *state = malloc(instance_state_size(fmu->instance));
    if (!*state)
        return fmu_fail(fmu, function, "out of memory");
    instance_save(fmu->instance, *state);
    return STATUS_OK;
}

int fmu_set_state(Fmu *fmu, const char *function, const void *state)
{
    if (fmu_refused(fmu, function, STATE_PHASES) || fmu_missing(fmu, function, 1, state, state))
        return STATUS_ERROR;
    return fmu_status(fmu, function, instance_restore(fmu->instance, state));
}

int fmu_free_state(const Fmu *fmu, const char *function, void **state)
{
    if (fmu_refused(fmu, function, STATE_PHASES))
        return STATUS_ERROR;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return STATUS_OK;
}

int fmu_state_size(const Fmu *fmu, const char *function, const void *state, size_t *size)
{
    if (fmu_refused(fmu, function, STATE_PHASES) || fmu_missing(fmu, function, 1, state, size))
        return STATUS_ERROR;
    *size = instance_state_size(fmu->instance);
    return STATUS_OK;
}

int fmu_serialize(const Fmu *fmu, const char *function, const void *state, void *bytes, size_t size)
{
    if (fmu_refused(fmu, function, STATE_PHASES) || fmu_missing(fmu, function, 1, state, bytes))
        return STATUS_ERROR;
    if (size < instance_state_size(fmu->instance))
        return fmu_fail(fmu, function, "the buffer is smaller than the size of a serialized state");
    memcpy(bytes, state, instance_state_size(fmu->instance));
    return STATUS_OK;
}

int fmu_deserialize(const Fmu *fmu, const char *function, const void *bytes, size_t size, void **state)
{
    Result result;
    if (fmu_refused(fmu, function, STATE_PHASES) || fmu_missing(fmu, function, 1, bytes, state))
        return STATUS_ERROR;
    result = instance_recognizes(fmu->instance, bytes, size);
    if (result != DONE)
        return fmu_status(fmu, function, result);
    if (!*state)
        *state = malloc(size);
    if (!*state)
        return fmu_fail(fmu, function, "out of memory");
    memcpy(*state, bytes, size);
    return STATUS_OK;
}
