/* Loads the FMI 2 library named by the first argument, runs it for a second and prints the first Real output that the
 * second argument names by its value reference. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#include "fmi2FunctionTypes.h"

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    va_list arguments;
    (void)environment;
    fprintf(stderr, "%s %d %s: ", name, (int)status, category);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
}

#define FUNCTION(NAME) fmi2##NAME##TYPE *const NAME = (fmi2##NAME##TYPE *)(void *)GetProcAddress(library, "fmi2" #NAME)

int main(int count, char **arguments)
{
    if (count != 4)
        return 2;
    const HMODULE library = LoadLibraryA(arguments[1]);
    if (!library)
        return 3;
    FUNCTION(Instantiate);
    FUNCTION(SetupExperiment);
    FUNCTION(EnterInitializationMode);
    FUNCTION(ExitInitializationMode);
    FUNCTION(DoStep);
    FUNCTION(GetReal);
    FUNCTION(Terminate);
    FUNCTION(FreeInstance);
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2Component instance = Instantiate("wine", fmi2CoSimulation, arguments[2], NULL, &callbacks, fmi2False, fmi2False);
    if (!instance)
        return 4;
    int status = SetupExperiment(instance, fmi2False, 0, 0, fmi2False, 0);
    status |= EnterInitializationMode(instance);
    status |= ExitInitializationMode(instance);
    for (int step = 0; step < 100; step++)
        status |= DoStep(instance, step * 0.01, 0.01, fmi2True);
    const fmi2ValueReference reference = (fmi2ValueReference)strtoul(arguments[3], NULL, 10);
    fmi2Real value = 0;
    status |= GetReal(instance, &reference, 1, &value);
    status |= Terminate(instance);
    FreeInstance(instance);
    printf("%.17g\n", value);
    return status ? 5 : 0;
}
