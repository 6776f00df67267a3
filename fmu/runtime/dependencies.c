/* Dependencies of the model structure, asked for at run time. See sensitivity.h. */
#include "sensitivity.h"
#include "variables.h"

const Dependency *instance_dependencies(const Instance *instance, unsigned unknown, size_t *count)
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
    const Kind kind = variable_locate(unknown, &index);
    if (kind == UNKNOWN)
        return instance_report(instance, FAILED, "there is no variable with value reference %u", unknown);
    if (kind < OUTPUT || kind == SAMPLE || kind == MODE)
        return instance_report(instance, FAILED, "%s is no unknown: it depends on nothing", variable_name(kind, index));
    instance_dependencies(instance, unknown, count);
    return DONE;
}
