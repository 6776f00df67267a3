/* All of an instance as bytes that say whose they are: a copy of them restores it, others are refused. */
#include <stdio.h>
#include <string.h>

#include "instance.h"

#define VERSION 4 /* of the bytes; a change of what they mean changes it */

typedef struct {
    char magic[16], token[48];
    unsigned long long check, length;
    double start, stop;
    int version, interface, event_mode, phase, relations_current;
} Header;

static const char MAGIC[16] = "brunovsky state";

static size_t sides_size(const Instance *instance)
{
    return (size_t)instance->engine->model->nz * sizeof *instance->side;
}

static size_t activations_size(const Instance *instance)
{
    return (size_t)instance->engine->model->nk * sizeof *instance->activation;
}

size_t instance_state_size(const Instance *instance)
{
    return sizeof(Header) + activations_size(instance) + sides_size(instance) + engine_state_size(instance->engine);
}

/* FNV-1a of what follows the header and of the header itself without its check. */
static unsigned long long check_of(const Header *header, const char *rest, size_t size)
{
    unsigned long long value = 14695981039346656037ULL;
    Header copy = *header;
    copy.check = 0;
    for (size_t i = 0; i < sizeof copy; i++)
        value = (value ^ ((const unsigned char *)&copy)[i]) * 1099511628211ULL;
    for (size_t i = 0; i < size; i++)
        value = (value ^ ((const unsigned char *)rest)[i]) * 1099511628211ULL;
    return value;
}

void instance_save(const Instance *instance, void *bytes)
{
    char *rest = (char *)bytes + sizeof(Header), *sides = rest + activations_size(instance);
    Header header;
    memset(&header, 0, sizeof header);
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    snprintf(header.token, sizeof header.token, "%s", brunovsky_description.token);
    header.length = instance_state_size(instance);
    header.version = VERSION;
    header.start = instance->start;
    header.stop = instance->stop;
    header.interface = (int)instance->interface;
    header.event_mode = instance->event_mode;
    header.phase = (int)instance->phase;
    header.relations_current = instance->relations_current;
    memcpy(rest, instance->activation, activations_size(instance));
    memcpy(sides, instance->side, sides_size(instance));
    engine_save(instance->engine, sides + sides_size(instance));
    header.check = check_of(&header, rest, instance_state_size(instance) - sizeof header);
    memcpy(bytes, &header, sizeof header);
}

Result instance_recognizes(Instance *instance, const void *bytes, size_t size)
{
    Header header;
    if (size < sizeof header)
        return instance_report(instance, FAILED, "the state is not one of this FMU: it has only %lu bytes",
                               (unsigned long)size);
    memcpy(&header, bytes, sizeof header);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0 || header.version != VERSION ||
        strncmp(header.token, brunovsky_description.token, sizeof header.token) != 0)
        return instance_report(instance, FAILED, "the state is not one of this FMU (%s, version %d of its states)",
                               brunovsky_description.token, VERSION);
    if (header.length != instance_state_size(instance) || size != instance_state_size(instance))
        return instance_report(instance, FAILED, "the state is damaged: it has %lu bytes instead of %lu",
                               (unsigned long)size, (unsigned long)instance_state_size(instance));
    if (header.check != check_of(&header, (const char *)bytes + sizeof header, size - sizeof header))
        return instance_report(instance, FAILED, "the state is damaged: its check sum does not match");
    if (header.interface != (int)instance->interface || header.event_mode != instance->event_mode)
        return instance_report(instance, FAILED, "the state is one of a %s instance%s",
                               instance_interface_name((Interface)header.interface),
                               header.event_mode ? " with event mode" : "");
    return DONE;
}

Result instance_restore(Instance *instance, const void *bytes)
{
    const char *rest = (const char *)bytes + sizeof(Header), *sides = rest + activations_size(instance);
    const Result result = instance_recognizes(instance, bytes, instance_state_size(instance));
    Header header;
    if (result != DONE)
        return result;
    memcpy(&header, bytes, sizeof header);
    instance->start = header.start;
    instance->stop = header.stop;
    instance->phase = (Phase)header.phase;
    instance->parameters_checked = 0; /* checked again rather than believed */
    instance->relations_current = header.relations_current;
    memcpy(instance->activation, rest, activations_size(instance));
    memcpy(instance->side, sides, sides_size(instance));
    engine_restore(instance->engine, sides + sides_size(instance));
    instance_outdate(instance);
    instance_listen(instance, instance->listener);
    return DONE;
}
