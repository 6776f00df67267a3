/* A lag y' = (u - y)/0.2 in FMI 2 co-simulation by Euler's rule, and one fault of each kind on request. */
#include "fmi2Functions.h"
#include <stdlib.h>
#include <string.h>

typedef struct {
    double u, y, time, stop;
    int initialised;
} Instance;

#if SHARED
static Instance shared;
#endif

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

static void begin(Instance *it)
{
    memset(it, 0, sizeof *it);
    it->u = 1;
    it->stop = 1e300;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || (strcmp(guid, "{tiny}") && !ANY_TOKEN))
        return NULL;
#if SHARED
    Instance *it = &shared;
#else
    Instance *it = malloc(sizeof *it);
#endif
    begin(it);
    return it;
}

void fmi2FreeInstance(fmi2Component c)
{
#if SHARED
    (void)c;
#else
    free(c);
#endif
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean t, fmi2Real tolerance, fmi2Real start, fmi2Boolean s,
                               fmi2Real stop)
{
    Instance *it = c;
    (void)t, (void)tolerance;
    it->time = start;
    it->stop = s && !ENDLESS ? stop : 1e300;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *it = c;
    if (it->initialised)
        return fmi2Error;
    it->initialised = 1;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) { return c ? fmi2OK : fmi2Error; }

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *it = c;
    if (IGNORES_RESET)
        it->initialised = 0;
    else
        begin(it);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real values[])
{
    Instance *it = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i] > 1 && !ANY_VARIABLE)
            return fmi2Error;
        values[i] = vr[i] ? it->y + FEEDTHROUGH * it->u : it->u;
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real values[])
{
    Instance *it = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i])
            return fmi2Error;
        it->u = values[i];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no)
{
    Instance *it = c;
    (void)no;
    if (!it->initialised || h < 0 || t + h > it->stop + 1e-9)
        return fmi2Error;
    it->y += h / 0.2 * (it->u - it->y);
    it->time += h;
    if (it->time > 0.5 && CRASHES)
        abort();
    while (it->time > 0.5 && HANGS)
        ;
    if (it->time > 0.5 && EXITS)
        exit(0);
    if (it->time > 0.5 && NAN_AT_HALF)
        it->y = 0.0 / 0.0 * it->y;
    if (NOISY)
        it->y += h < 0.009 ? 0.5 / h * 1e-5 : 0;
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    *state = malloc(sizeof(Instance));
    memcpy(*state, c, sizeof(Instance));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (CRASHES_ON_RESTORE)
        abort();
    if (!FORGETS)
        memcpy(c, state, sizeof(Instance));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Instance);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)c;
    memcpy(bytes, state, size);
    if (LOSES)
        bytes[8] ^= 1, bytes[14] ^= 1;
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    (void)c;
    *state = malloc(size);
    memcpy(*state, bytes, size);
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference z[], size_t nz,
                                        const fmi2ValueReference v[], size_t nv, const fmi2Real seed[],
                                        fmi2Real values[])
{
    (void)c, (void)z, (void)v, (void)nv;
    for (size_t i = 0; i < nz; i++)
        values[i] = (FEEDTHROUGH + WRONG_DERIVATIVE) * seed[0];
    return fmi2OK;
}

/* What the standard wants to be there and nobody calls. */
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

#define UNUSED(NAME, TYPE)                                                                                             \
    fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE values[])                  \
    {                                                                                                                  \
        (void)c, (void)vr, (void)n, (void)values;                                                                      \
        return fmi2Error;                                                                                              \
    }                                                                                                                  \
    fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, const TYPE values[])            \
    {                                                                                                                  \
        (void)c, (void)vr, (void)n, (void)values;                                                                      \
        return fmi2Error;                                                                                              \
    }
UNUSED(Integer, fmi2Integer)
UNUSED(Boolean, fmi2Boolean)
UNUSED(String, fmi2String)

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[])
{
    (void)c, (void)vr, (void)n, (void)order, (void)values;
    return fmi2Error;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[])
{
    (void)c, (void)vr, (void)n, (void)order, (void)values;
    return fmi2Error;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return c ? fmi2Error : fmi2Fatal; }

#define STATUS(NAME, TYPE)                                                                                             \
    fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value)                                  \
    {                                                                                                                  \
        (void)c, (void)kind, (void)value;                                                                              \
        return fmi2Discard;                                                                                            \
    }
STATUS(Status, fmi2Status)
STATUS(RealStatus, fmi2Real)
STATUS(IntegerStatus, fmi2Integer)
STATUS(BooleanStatus, fmi2Boolean)
STATUS(StringStatus, fmi2String)
