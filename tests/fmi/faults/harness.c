/* See harness.h. Link with -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free. */
#include "harness.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

enum { NUMBERS = 4096 };

uint64_t seed = 1;
int allocations, failed_allocations, fail_at = -1, must_fail;
long outstanding;
const char *doing = "";

/* xorshift64* (S. Vigna, An experimental exploration of Marsaglia's xorshift generators, scrambled, 2016). */
unsigned draw(unsigned below)
{
    seed ^= seed >> 12;
    seed ^= seed << 25;
    seed ^= seed >> 27;
    return (unsigned)((seed * 2685821657736338717ULL) >> 33) % below;
}

double uniform(double low, double high)
{
    return low + (high - low) * draw(1u << 30) / (double)(1u << 30);
}

int chance(int percent)
{
    return (int)draw(100) < percent;
}

double odd_number(void)
{
    const double values[] = {NAN,  -NAN,    INFINITY, -INFINITY, 0,    -0.0,    -1,   1e-300,
                             1e30, DBL_MAX, -DBL_MAX, 1e9,       -1e6, DBL_MIN, 4e-324, -1e-9};
    return values[draw(sizeof values / sizeof *values)];
}

/* Allocations ------------------------------------------------------------------------------------------------------ */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void __wrap_free(void *memory);

static int fails(void)
{
    allocations++;
    if (fail_at < 0 || fail_at-- > 0)
        return 0;
    failed_allocations++;
    return 1;
}

static void *counted(void *memory)
{
    outstanding += memory != NULL;
    return memory;
}

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : counted(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : counted(__real_calloc(count, size));
}

void *__wrap_realloc(void *memory, size_t size)
{
    void *result = fails() ? NULL : __real_realloc(memory, size);
    outstanding += result && !memory;
    return result;
}

void __wrap_free(void *memory)
{
    outstanding -= memory != NULL;
    __real_free(memory);
}

void *own(size_t size)
{
    void *memory = __real_malloc(size);
    EXPECT(memory || !size, "the driver is out of memory");
    return memory;
}

void disown(void *memory)
{
    __real_free(memory);
}

/* Log -------------------------------------------------------------------------------------------------------------- */

void die(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "FAULT in %s: ", doing);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    exit(1);
}

void subject_log(Subject *subject, int status, const char *category, const char *text)
{
    EXPECT(subject, "a message without the environment of its instance: %s", text);
    EXPECT(status >= OK && status <= FATAL, "a message of status %d: %s", status, text);
    EXPECT(category && strncmp(category, "log", 3) == 0, "a message of category %s", category ? category : "NULL");
    EXPECT(text && *text, "an empty message");
    snprintf(subject->message, sizeof subject->message, "%s", text);
    subject->logged[status]++;
}

void clear_log(Subject *subject)
{
    memset(subject->logged, 0, sizeof subject->logged);
    subject->message[0] = 0;
}

void check_log(const Subject *subject, int status)
{
    const int *logged = subject->logged;
    EXPECT(status >= OK && status <= ERROR, "status %d", status);
    EXPECT(!logged[FATAL], "a fatal message: %s", subject->message);
    EXPECT(logged[ERROR] == (status == ERROR), "status %d with %d messages of errors: %s", status, logged[ERROR],
           subject->message);
    EXPECT(logged[DISCARD] <= (status == DISCARD), "status %d with %d messages of what is discarded: %s", status,
           logged[DISCARD], subject->message); /* that log can be switched off */
    if (logged[ERROR] || logged[DISCARD]) {
        EXPECT(!logged[WARNING], "a warning beside the message of status %d", status);
        EXPECT(!subject->must_name || strstr(subject->message, subject->must_name), "the message names no function: %s",
               subject->message);
    }
}

/* State ------------------------------------------------------------------------------------------------------------ */

void save(Subject *subject, char **bytes, size_t *size)
{
    const int before = fail_at;
    const long held = outstanding;
    void *state = NULL;
    fail_at = -1;
    EXPECT(subject_get_state(subject, &state) == OK && state, "the state cannot be saved: %s", subject->message);
    disown(*bytes);
    *bytes = NULL;
    *size = subject_serialize(subject, state, bytes);
    EXPECT(*bytes, "the state cannot be serialised: %s", subject->message);
    EXPECT(subject_free_state(subject, &state) == OK && !state, "the state cannot be freed");
    EXPECT(outstanding == held, "saving leaks");
    fail_at = before;
}

void restore(Subject *subject, const char *bytes, size_t size)
{
    void *state = NULL;
    EXPECT(subject_deserialize(subject, bytes, size, &state) == OK && state, "a state of its own is refused: %s",
           subject->message);
    EXPECT(subject_set_state(subject, state) == OK, "a state of its own is refused: %s", subject->message);
    subject_free_state(subject, &state);
}

void check_run(Subject *subject)
{
    static double reference[MOST_KINDS][2][NUMBERS], found[NUMBERS];
    static size_t counts[MOST_KINDS][2];
    const int solvers = subject->kind == MODEL_EXCHANGE || !brunovsky_model.nx ? 1 : 2;
    for (int solver = 1; solver <= solvers; solver++) {
        double *expected = reference[subject->kind][solver - 1];
        size_t *count = &counts[subject->kind][solver - 1];
        if (!*count) {
            const int before = allocations;
            Subject fresh = {0};
            subject_instantiate(&fresh, subject->kind);
            allocations = before;
            *count = subject_run(&fresh, solver, expected, NUMBERS);
            EXPECT(*count, "the reference run gives nothing: %s", fresh.message);
            subject_free(&fresh);
        }
        EXPECT(subject_reset(subject) == OK, "reset is refused: %s", subject->message);
        clear_log(subject);
        EXPECT(subject_run(subject, solver, found, NUMBERS) == *count, "another length of the run after reset");
        EXPECT(memcmp(found, expected, *count * sizeof *found) == 0, "the run after reset is another one");
    }
}
