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

static inline fmi3Status status_of(const Fmu *fmu, const char *function, Result result)
{
    return (fmi3Status)fmu_status(fmu, function, result);
}

#endif
