/* What the interfaces of both versions share: an instance with a name and a log. The numbers of the statuses are those of
 * both standards, and functions are named in messages by the standard's name. */
#ifndef BRUNOVSKY_FMU_H
#define BRUNOVSKY_FMU_H

#include <stddef.h>

#include "instance.h"

enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR };

/* Log categories; errors are always logged. */
enum { LOG_EVENTS = 1, LOG_SINGULARITY = 2, LOG_WARNING = 4, LOG_DISCARD = 8, LOG_ALL = 15 };

typedef void Log(void *callback, void *environment, const char *name, int status, const char *category, const char *text);

typedef struct {
    Log *log; /* of this version; what it calls and passes on: */
    void (*callback)(void);
    void *environment;
    const char *name;
} Logger;

typedef struct {
    Instance *instance;
    Logger logger;
    char *name;
    int logged;  /* categories that are switched on */
    int always;  /* those that cannot be switched off */
    int last_step;
    void (*update)(void); /* callbacks of FMI 3: during a step; */
    void (*lock)(void), (*unlock)(void); /* around what another model partition must not interrupt, or null pointers */
} Fmu;

/* A null pointer, with a message, if the token is another one or memory is out. */
Fmu *fmu_new(const char *function, Logger logger, Interface interface, const char *token, int logging, int always);
void fmu_free(Fmu *fmu);

void fmu_log(const Logger *logger, int status, const char *category, const char *format, ...);
int fmu_fail(const Fmu *fmu, const char *function, const char *problem);
/* Status of a result, its message logged. */
int fmu_status(const Fmu *fmu, const char *function, Result result);
/* Whether a call is refused in the present phase, with a message. */
int fmu_refused(const Fmu *fmu, const char *function, int phases);
/* The same for a function that only these interfaces have (bits 1 << Interface). */
int fmu_refused_to(const Fmu *fmu, const char *function, int interfaces, int phases);
int fmu_missing(const Fmu *fmu, const char *function, size_t count, const void *first, const void *second);

int fmu_set_logging(Fmu *fmu, const char *function, int on, size_t count, const char *const *categories);
int fmu_reset(Fmu *fmu, const char *function);
int fmu_terminate(Fmu *fmu, const char *function);

int fmu_get_state(const Fmu *fmu, const char *function, void **state);
int fmu_set_state(Fmu *fmu, const char *function, const void *state);
int fmu_free_state(const Fmu *fmu, const char *function, void **state);
int fmu_state_size(const Fmu *fmu, const char *function, const void *state, size_t *size);
int fmu_serialize(const Fmu *fmu, const char *function, const void *state, void *bytes, size_t size);
int fmu_deserialize(const Fmu *fmu, const char *function, const void *bytes, size_t size, void **state);

/* An event of event mode; what it changed is logged. */
int fmu_event(const Fmu *fmu, const char *function, Event *event);

#endif
