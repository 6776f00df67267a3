/* Opens to the tests what only FMI 3 passes on: the instance behind a component of fmi2.c. */
#include "sensitivity.h"

#if defined _WIN32
#define OPEN __declspec(dllexport)
#else
#define OPEN __attribute__((visibility("default")))
#endif

OPEN int test_adjoint(void *component, const unsigned *unknowns, size_t n_unknowns, const unsigned *knowns, size_t n_knowns,
                      const double *seed, double *result)
{
    return (int)instance_adjoint(*(Instance **)component, unknowns, n_unknowns, knowns, n_knowns, seed, result);
}

OPEN const char *test_message(void *component)
{
    return (*(Instance **)component)->message;
}

OPEN int test_count_dependencies(void *component, unsigned unknown, size_t *count)
{
    return (int)instance_count_dependencies(*(Instance **)component, unknown, count);
}

OPEN int test_get_dependencies(void *component, unsigned unknown, unsigned *knowns, int *kinds, size_t count)
{
    size_t expected;
    const Dependency *found = instance_dependencies(*(Instance **)component, unknown, &expected);
    for (size_t i = 0; i < count && count == expected; i++) {
        knowns[i] = found[i].known;
        kinds[i] = (int)found[i].kind;
    }
    return count == expected ? DONE : FAILED;
}
