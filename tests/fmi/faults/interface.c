/* What is the same in both versions once values are numbers. */
#include <string.h>

#include "interface.h"

int subject_get_state(Subject *subject, void **state)
{
    return (int)GetState(subject->component, state);
}

int subject_set_state(Subject *subject, void *state)
{
    return (int)SetState(subject->component, state);
}

int subject_free_state(Subject *subject, void **state)
{
    return (int)FreeState(subject->component, state);
}

size_t subject_serialize(Subject *subject, void *state, char **bytes)
{
    size_t size = 0;
    if (StateSize(subject->component, state, &size) != 0)
        return 0;
    *bytes = own(size);
    if (SerializeState(subject->component, state, (void *)*bytes, size) != 0) {
        disown(*bytes);
        *bytes = NULL;
    }
    return size;
}

int subject_deserialize(Subject *subject, const char *bytes, size_t size, void **state)
{
    return (int)DeserializeState(subject->component, (const void *)bytes, size, state);
}

void subject_free(Subject *subject)
{
    NAME(FreeInstance, FreeInstance)(subject->component);
    subject->component = NULL;
    disown(subject->bytes);
    subject->bytes = NULL;
}

int subject_reset(Subject *subject)
{
    return moved(subject, NAME(Reset, Reset)(subject->component), INSTANTIATED);
}

int moved(Subject *subject, Status status, int phase)
{
    if (status == 0)
        subject->phase = phase;
    return (int)status;
}

int random_kind(void)
{
    int kind = (int)draw(MOST_KINDS);
    while (!has_kind(kind))
        kind = (int)draw(MOST_KINDS);
    return kind;
}

double real(const Subject *subject, unsigned reference)
{
    double value = 0;
    if (subject->component && subject->phase > INSTANTIATED)
        EXPECT(get_values(subject, REAL, &reference, 1, &value, 1) == 0, "time and step_size can be read");
    return value;
}

size_t get_outputs(Subject *subject, double *found)
{
    size_t filled = 0;
    for (unsigned i = 0; i < (unsigned)brunovsky_model.ny; i += span(FIRST_OUTPUT + i)) {
        const unsigned reference = FIRST_OUTPUT + i;
        const size_t n = span(reference);
        for (size_t k = 0; k < n; k++)
            found[filled + 1 + k] = 0;
        found[filled] = get_values(subject, brunovsky_description.y_types[i], &reference, 1, found + filled + 1, n);
        filled += 1 + n;
    }
    return filled;
}

int subject_settle(Subject *subject)
{
    double found[2 * MAX_VALUES];
    return get_outputs(subject, found) ? (int)found[0] : OK;
}

/* Any function of the step's number does. */
void set_inputs(Subject *subject, int step)
{
    double values[MAX_VALUES];
    for (unsigned i = 0; i < (unsigned)brunovsky_model.nu; i += span(FIRST_INPUT + i)) {
        const unsigned reference = FIRST_INPUT + i;
        for (unsigned k = 0; k < span(reference); k++)
            values[k] = brunovsky_model.u_default[i + k] + 0.1 * ((step * 7 + (int)(i + k) * 3) % 11 - 5);
        EXPECT(set_values(subject, REAL, &reference, 1, values, span(reference)) == 0, "an input is refused: %s",
               subject->message);
    }
}

void forget_states(void)
{
    Subject any = {0};
    while (!has_kind(any.kind))
        any.kind++;
    subject_instantiate(&any, any.kind);
    free_kept(&any);
    subject_free(&any);
}
