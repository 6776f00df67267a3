/* Dependencies of the model structure, asked for at run time. See sensitivity.h. */
#include "sensitivity.h"
#include "variables.h"

/* Dependencies of an unknown: where they begin in the table of the present phase, and how many there are. */
static const Dependency *dependencies_of(const Instance *instance, unsigned unknown, size_t *count)
{
    const Description *description = &brunovsky_description;
    const int initial = (instance->phase & (INSTANTIATED | INITIALIZATION)) != 0;
    const Dependency *one = initial ? description->initial : description->running;
    const Dependency *end = one + (initial ? description->n_initial : description->n_running);
    while (one < end && one->unknown != unknown)
        one++;
    for (*count = 0; one + *count < end && one[*count].unknown == unknown; ++*count)
        ;
    return one;
}

Result instance_count_dependencies(Instance *instance, unsigned unknown, size_t *count)
{
    int index;
    const Kind kind = locate(unknown, &index);
    if (kind == UNKNOWN)
        return report(instance, FAILED, "there is no variable with value reference %u", unknown);
    if (kind < OUTPUT || kind == SAMPLE || kind == MODE)
        return report(instance, FAILED, "%s is no unknown: it depends on nothing", name_of(kind, index));
    dependencies_of(instance, unknown, count);
    return DONE;
}

Result instance_get_dependencies(Instance *instance, unsigned unknown, unsigned *knowns, DependencyKind *kinds, size_t count)
{
    size_t expected;
    const Dependency *found = dependencies_of(instance, unknown, &expected);
    const Result result = instance_count_dependencies(instance, unknown, &expected);
    if (result != DONE)
        return result;
    if (count != expected)
        return report(instance, FAILED, "%lu dependencies were asked for, but there are %lu", (unsigned long)count,
                      (unsigned long)expected);
    for (size_t i = 0; i < count; i++) {
        knowns[i] = found[i].known;
        kinds[i] = found[i].kind;
    }
    return DONE;
}
