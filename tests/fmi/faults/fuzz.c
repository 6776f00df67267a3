/* Random legal and illegal calls on several instances of an FMU: fuzz SEED CALLS.
 *
 * After every call: the status goes with the log; illegal calls are errors; a refused call left the instance, and every
 * call the other instances, as they were; memory was asked for only where the function has to; what a call did, it does
 * again from the state before it. At the end every instance runs as a fresh one does.
 */
#include "harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SUBJECTS = 4 };

static Subject subjects[SUBJECTS];

static int same(const char *one, size_t size, const Subject *subject)
{
    return size == subject->size && memcmp(one, subject->bytes, size) == 0;
}

/* An operation, by weight where the phase allows it, or, now and then, any. */
static const Operation *choose(const Subject *subject)
{
    int total = 0, at;
    if (chance(8))
        return &operations[draw((unsigned)operation_count)];
    for (int i = 0; i < operation_count; i++)
        if (operations[i].phases[subject->kind] & subject->phase)
            total += operations[i].weight;
    at = (int)draw((unsigned)total);
    for (int i = 0; i < operation_count; i++)
        if (operations[i].phases[subject->kind] & subject->phase && (at -= operations[i].weight) < 0)
            return &operations[i];
    return &operations[0];
}

/* What is calculated on demand may have been calculated by a call that was then refused. */
static void check_unchanged(Subject *subject, const char *before, size_t size)
{
    char *settled = NULL;
    size_t settled_size;
    if (same(before, size, subject))
        return;
    char *after = subject->bytes;
    const size_t after_size = subject->size;
    subject->bytes = NULL;
    subject_settle(subject);
    save(subject, &settled, &settled_size);
    restore(subject, before, size);
    subject_settle(subject);
    save(subject, &subject->bytes, &subject->size);
    EXPECT(same(settled, settled_size, subject), "a refused call changed the instance: %s", subject->message);
    restore(subject, after, after_size);
    disown(subject->bytes);
    disown(settled);
    subject->bytes = after;
    subject->size = after_size;
}

/* Another instance like this one. */
static void make_like(Subject *fresh, const Subject *subject)
{
    do {
        subject_free(fresh);
        subject_instantiate(fresh, subject->kind);
        EXPECT(fresh->component, "no instance: %s", fresh->message);
    } while (fresh->with_callbacks != subject->with_callbacks);
}

/* The same call from the same state on gives the same, in this instance or in a new one. */
static void repeat(Subject *subject, const Operation *operation, const char *before, size_t size, uint64_t numbers, int status)
{
    const uint64_t next = seed;
    Subject fresh = {0}, *again = subject;
    char *after = NULL;
    size_t after_size;
    if (chance(40)) {
        again = &fresh;
        make_like(again, subject);
        again->phase = subject->phase;
    }
    restore(again, before, size);
    seed = numbers;
    clear_log(again);
    EXPECT(operation->call(again) == status, "another status when repeated: %s", again->message);
    EXPECT(subject->phase == again->phase, "another phase when repeated");
    save(again, &after, &after_size);
    EXPECT(same(after, after_size, subject), "another state when repeated");
    disown(after);
    subject_free(&fresh);
    seed = next;
}

static void call(Subject *subject)
{
    const Operation *operation = choose(subject);
    const int allowed = (operation->phases[subject->kind] & subject->phase) != 0;
    char *before = NULL;
    size_t size;
    int status;
    doing = operation->name;
    save(subject, &before, &size);
    EXPECT(!subject->bytes || same(before, size, subject), "the instance changed while others were called");
    clear_log(subject);
    must_fail = allocations = failed_allocations = 0;
    fail_at = operation->flags & ALLOCATES && chance(10) ? (int)draw(2) : -1;
    subject->must_name = operation->name;
    const int phase = subject->phase;
    const uint64_t numbers = seed;
    status = operation->call(subject);
    fail_at = -1;
    check_log(subject, status);
    EXPECT(allowed || status == ERROR, "status %d in phase %d, where it is not allowed", status, phase);
    EXPECT(!must_fail || status >= DISCARD, "status %d for arguments that are illegal", status);
    EXPECT(!failed_allocations || status == ERROR, "status %d when out of memory", status);
    EXPECT(!allocations || operation->flags & ALLOCATES, "%d allocations", allocations);
    save(subject, &subject->bytes, &subject->size);
    if (status == ERROR || status == DISCARD)
        check_unchanged(subject, before, size);
    else if (operation->flags & REPEATABLE && phase == subject->phase && chance(10))
        repeat(subject, operation, before, size, numbers, status);
    disown(before);
}

/* Functions of no instance are errors. */
static void call_nobody(void)
{
    Subject nobody = {0};
    const Operation *operation = &operations[draw((unsigned)operation_count)];
    doing = operation->name;
    nobody.phase = 1 << draw(8);
    EXPECT(operation->call(&nobody) == ERROR, "no error for no instance");
}

static void replace(Subject *subject)
{
    doing = "the run of an instance that goes";
    if (subject->component && chance(30))
        check_run(subject);
    doing = "fmi2Instantiate";
    subject_free(subject);
    subject_misuse(subject);
    fail_at = chance(20) ? (int)draw(12) : -1;
    failed_allocations = 0;
    clear_log(subject);
    subject_instantiate(subject, random_kind());
    EXPECT(!failed_allocations == !!subject->component, "an instance that is half there");
    check_log(subject, failed_allocations ? ERROR : OK);
    fail_at = -1;
}

int main(int count, char **arguments)
{
    const long calls = count > 2 ? atol(arguments[2]) : 10000;
    long reached = 0;
    seed = 0x9e3779b97f4a7c15ULL * (uint64_t)(1 + (count > 1 ? atol(arguments[1]) : 1));
    for (long i = 0; i < calls; i++) {
        Subject *subject = &subjects[draw(SUBJECTS)];
        if (chance(1))
            call_nobody();
        if (!subject->component || draw(400) == 0)
            replace(subject);
        else
            call(subject);
        reached += subject->phase > 2;
    }
    for (int i = 0; i < SUBJECTS; i++) {
        doing = "the run at the end";
        if (subjects[i].component)
            check_run(&subjects[i]);
        subject_free(&subjects[i]);
    }
    forget_states();
    EXPECT(outstanding == 0, "%ld blocks of memory are not freed", outstanding);
    EXPECT(reached > calls / 3, "only %ld of %ld calls got beyond initialisation", reached, calls);
    printf("%ld calls, %ld beyond initialisation\n", calls, reached);
    return 0;
}
