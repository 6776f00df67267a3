/* What the fault drivers share: random numbers, counted allocations that can be made to fail, the log of an instance,
 * and the few things that each version of the interface does for them (interface2.c, interface3.c).
 */
#ifndef HARNESS_H
#define HARNESS_H

#include <stddef.h>
#include <stdint.h>

enum { OK, WARNING, DISCARD, ERROR, FATAL };

typedef struct {
    void *component;
    int kind, phase;           /* the version's own: how it is used; a bit of its table, as the driver follows it */
    int with_callbacks;        /* FMI 3: whether it was given a function for intermediate update */
    int logged[FATAL + 1];     /* messages of each status since the log was cleared */
    char message[2048];        /* the last one */
    const char *must_name;     /* what messages of errors begin with */
    char *bytes;               /* serialised state after the last call */
    size_t size;
} Subject;

/* Random numbers, the same for the same seed ------------------------------------------------------------------- */
extern uint64_t seed;
unsigned draw(unsigned below);
double uniform(double low, double high);
int chance(int percent);
double odd_number(void); /* NaN, infinite, zero, negative, tiny or huge */

/* Allocations of the FMU; the drivers' own are neither counted nor fail. --------------------------------------- */
extern int allocations, failed_allocations; /* since they were set to 0 */
extern long outstanding;                    /* blocks that are not freed */
extern int fail_at;                         /* the allocation with this number from now on fails; -1: none */
void *own(size_t size);
void disown(void *memory);

/* What is wrong, where it was found; ends the process with status 1. */
extern const char *doing;
void die(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
#define EXPECT(condition, ...)                                                                                        \
    do {                                                                                                              \
        if (!(condition))                                                                                             \
            die(__VA_ARGS__);                                                                                         \
    } while (0)

void subject_log(Subject *subject, int status, const char *category, const char *text);
void clear_log(Subject *subject);
/* Errors and what is discarded have one message each, of that status; what is OK has none but warnings. */
void check_log(const Subject *subject, int status);

/* The interface of a version ------------------------------------------------------------------------------------ */
enum { REPEATABLE = 1, ALLOCATES = 2 };
enum { CO_SIMULATION, MODEL_EXCHANGE, EVENT_MODE, EARLY_RETURN, SCHEDULED, MOST_KINDS }; /* from the third on: FMI 3 */

typedef struct {
    const char *name;
    int phases[MOST_KINDS];  /* where the standard allows it, for each kind of instance */
    int weight;              /* how often it is called where it is allowed */
    int flags;
    int (*call)(Subject *);  /* with random arguments; sets must_fail where they are illegal */
} Operation;

extern const Operation operations[];
extern const int operation_count;
extern int must_fail;
int random_kind(void); /* of those that the version and the block have */
int has_kind(int kind);

/* Tries to make an instance; its component is NULL if that fails. */
void subject_instantiate(Subject *subject, int kind);
void subject_misuse(Subject *subject); /* tries to make one with illegal arguments, and checks that it cannot */
void subject_free(Subject *subject);
int subject_reset(Subject *subject);

/* FMU state and bytes. Statuses are those of the calls; save with *bytes == NULL asks for memory of the driver. */
int subject_get_state(Subject *subject, void **state);
int subject_set_state(Subject *subject, void *state);
int subject_free_state(Subject *subject, void **state);
size_t subject_serialize(Subject *subject, void *state, char **bytes);
int subject_deserialize(Subject *subject, const char *bytes, size_t size, void **state);
int subject_settle(Subject *subject); /* makes what is calculated on demand current; status */

/* A legal run with this solver from an instantiated instance on: what it gave, count numbers at most. The instance
 * is terminated afterwards. */
size_t subject_run(Subject *subject, int solver, double *found, size_t count);
void forget_states(void); /* frees the states kept between calls */

/* Built from these. */
void save(Subject *subject, char **bytes, size_t *size);
void restore(Subject *subject, const char *bytes, size_t size);
void check_run(Subject *subject); /* resets, runs with each solver and compares with a fresh instance's run */

#endif
