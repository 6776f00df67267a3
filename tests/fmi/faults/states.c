/* Random calls of the functions for the state of an instance. */
#include <string.h>

#include "interface.h"

enum { KEPT = 4, HEADER = 120 }; /* about as many bytes say whose state it is */

/* States and bytes kept between calls, of whichever instance. */
static struct {
    void *state;
    char *bytes;
    size_t size;
    int state_phase, state_kind, bytes_phase, bytes_kind;
} kept[KEPT];

/* States go from instance to instance of the same family. */
static int family(const Subject *subject)
{
    return subject->kind == EARLY_RETURN ? EVENT_MODE : subject->kind;
}

int get_state(Subject *subject)
{
    const unsigned at = draw(KEPT);
    int status;
    must_fail = chance(2);
    status = (int)GetState(subject->component, must_fail ? NULL : &kept[at].state);
    if (status == OK) {
        kept[at].state_phase = subject->phase;
        kept[at].state_kind = family(subject);
    }
    return status;
}

int set_state(Subject *subject)
{
    const unsigned at = draw(KEPT);
    must_fail = !kept[at].state || kept[at].state_kind != family(subject);
    return moved(subject, SetState(subject->component, kept[at].state), kept[at].state_phase);
}

int free_state(Subject *subject)
{
    const unsigned at = draw(KEPT);
    const int status = (int)FreeState(subject->component, chance(2) ? NULL : &kept[at].state);
    EXPECT(status == OK || !subject->component || subject->phase == WITHIN_STEP, "a state is not freed");
    return status;
}

int serialize(Subject *subject)
{
    const unsigned at = draw(KEPT);
    size_t size = 0, given;
    char *bytes;
    int status;
    must_fail = !kept[at].state;
    status = (int)StateSize(subject->component, kept[at].state, &size);
    if (status != OK)
        return status;
    given = chance(90) ? size : draw((unsigned)size);
    must_fail = given < size;
    bytes = own(given);
    subject->must_name = QUOTE(SerializeState);
    status = (int)SerializeState(subject->component, kept[at].state, (void *)bytes, given);
    if (status != OK) {
        disown(bytes);
        return status;
    }
    disown(kept[at].bytes);
    kept[at].bytes = bytes;
    kept[at].size = size;
    kept[at].bytes_phase = kept[at].state_phase;
    kept[at].bytes_kind = kept[at].state_kind;
    return status;
}

/* Copy of kept bytes, sometimes damaged: bits, mostly of the header, a zeroed or repeated stretch, another length. */
static char *damage(const char *bytes, size_t *size)
{
    const size_t length = *size;
    char *copy;
    switch (draw(6)) {
    case 0: *size = draw((unsigned)length); break;
    case 1: *size = length + 1 + draw(64); break;
    default: break;
    }
    copy = own(*size);
    memset(copy, 0, *size);
    memcpy(copy, bytes, *size < length ? *size : length);
    if (*size == length) {
        const unsigned first = draw(HEADER < length && chance(60) ? HEADER : (unsigned)length);
        copy[first] = (char)(copy[first] ^ 1 << draw(8));
        for (unsigned i = chance(30) ? draw(8) : 0; i; i--)
            copy[draw((unsigned)length)] = (char)draw(256);
    }
    must_fail |= *size != length || memcmp(copy, bytes, length) != 0;
    return copy;
}

int deserialize(Subject *subject)
{
    const unsigned from = draw(KEPT), to = draw(KEPT);
    const int null = chance(2);
    size_t size = kept[from].size;
    char *copy = NULL;
    int status;
    must_fail = !kept[from].bytes || null || kept[from].bytes_kind != family(subject);
    if (kept[from].bytes && !null) {
        copy = own(size);
        memcpy(copy, kept[from].bytes, size);
        if (chance(50)) {
            disown(copy);
            copy = damage(kept[from].bytes, &size);
        }
    }
    const void *before = kept[to].state;
    status = (int)DeserializeState(subject->component, (void *)copy, size, &kept[to].state);
    EXPECT(status == OK || kept[to].state == before, "a refused state is there");
    if (status == OK) {
        kept[to].state_phase = kept[from].bytes_phase;
        kept[to].state_kind = kept[from].bytes_kind;
    }
    disown(copy);
    return status;
}

void free_kept(const Subject *subject)
{
    for (int i = 0; i < KEPT; i++) {
        FreeState(subject->component, &kept[i].state);
        disown(kept[i].bytes);
        kept[i].bytes = NULL;
    }
}
