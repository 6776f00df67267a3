/* What the files of the FMI 3.0 interface share. */
#ifndef BRUNOVSKY_FMI3_H
#define BRUNOVSKY_FMI3_H

#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_OVERRIDE_FUNCTION_PREFIX
#endif
#include "fmi3Functions.h"

#include "fmu.h"

#define ONLY(INTERFACE) (1 << INTERFACE)

static inline fmi3Status fail(const Fmu *fmu, const char *function, const char *problem)
{
    return (fmi3Status)fmu_fail(fmu, function, problem);
}

/* Scheduled execution: partitions share work space, so none interrupts another, nor a master's reading and setting. */
static inline void lock(const Fmu *fmu)
{
    if (fmu->lock)
        fmu->lock();
}

static inline fmi3Status unlock(const Fmu *fmu, fmi3Status status)
{
    if (fmu->lock)
        fmu->unlock();
    return status;
}

static inline fmi3Status status_of(const Fmu *fmu, const char *function, Result result)
{
    return (fmi3Status)fmu_status(fmu, function, result);
}

#endif
