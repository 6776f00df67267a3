/* Out of memory: each allocation of making an instance, of its state and of its bytes fails in turn. What fails is an
 * error with a message, leaves nothing behind, and the instance runs as if nothing had been. A run asks for no memory.
 */
#include "harness.h"

#include <stdio.h>

static void instantiate(Subject *subject, int kind)
{
    int k;
    doing = "instantiate";
    for (k = 0; !subject->component; k++) {
        allocations = failed_allocations = 0;
        fail_at = k;
        clear_log(subject);
        subject_instantiate(subject, kind);
        fail_at = -1;
        check_log(subject, failed_allocations ? ERROR : OK);
        EXPECT(!subject->component == !!failed_allocations, "the instance is there although allocation %d failed", k);
        EXPECT(subject->component || outstanding == 0, "%ld blocks are left after allocation %d failed", outstanding, k);
    }
    EXPECT(k > 1 && allocations == k - 1, "an instance without memory");
    printf("kind %d: %d allocations each failed\n", kind, allocations);
}

/* A state and its copy from bytes, both at the second attempt. */
static void states(Subject *subject, const char *phase)
{
    const long before = outstanding;
    void *state = NULL, *copy = NULL;
    char *bytes = NULL;
    size_t size;
    doing = phase;
    fail_at = 0;
    clear_log(subject);
    subject->must_name = NULL;
    EXPECT(subject_get_state(subject, &state) == ERROR && !state, "a state without memory");
    check_log(subject, ERROR);
    EXPECT(subject_get_state(subject, &state) == OK && state, "no state after memory came back");
    size = subject_serialize(subject, state, &bytes);
    fail_at = 0;
    clear_log(subject);
    EXPECT(subject_deserialize(subject, bytes, size, &copy) == ERROR && !copy, "a state without memory");
    check_log(subject, ERROR);
    EXPECT(subject_deserialize(subject, bytes, size, &copy) == OK && copy, "no state after memory came back");
    EXPECT(subject_set_state(subject, copy) == OK, "the state is refused: %s", subject->message);
    subject_free_state(subject, &state);
    subject_free_state(subject, &copy);
    disown(bytes);
    EXPECT(outstanding == before, "%ld blocks are left", outstanding - before);
    EXPECT(fail_at == -1, "nothing asked for memory");
}

int main(void)
{
    for (int kind = 0; kind < MOST_KINDS; kind++) {
        Subject subject = {0};
        if (!has_kind(kind))
            continue;
        instantiate(&subject, kind);
        states(&subject, "states before the run");
        allocations = 0;
        doing = "the run";
        check_run(&subject);
        EXPECT(allocations == 0, "%d allocations in a run", allocations);
        states(&subject, "states after the run");
        check_run(&subject);
        subject_free(&subject);
        EXPECT(outstanding == 0, "%ld blocks of memory are not freed", outstanding);
    }
    return 0;
}
