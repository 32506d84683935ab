/* A host compiled with the header as it once was: prints what a library says of its laws, and calls one with the numbers that
 * follow as PROPS. Never changed: libraries of today must go on answering.
 *
 *     host LIBRARY [PROPS...]
 */
#include "pullout_umat.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the header beside this file, not that of today */
_Static_assert(sizeof(pullout_parameter) == 80, "parameters have grown");

static void *symbol(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "no %s\n", name);
        exit(1);
    }
    return found;
}

/* One name in a row of a table whose rows may have grown. */
#define ROW(table, type, k) ((const type *)((const char *)(table).first + (size_t)(k) * (table).stride))

static void tell(const pullout_plugin *law)
{
    uint32_t k;
    printf("law %s\n", law->law);
    for (k = 0; k < law->parameters.count; k++) {
        const pullout_parameter *parameter = ROW(law->parameters, pullout_parameter, k);
        printf("parameter %s %.17g\n", parameter->name, parameter->default_value);
    }
    for (k = 0; k < law->states.count; k++)
        printf("state %s\n", ROW(law->states, pullout_state_variable, k)->name);
}

static void call(void *library, const pullout_plugin *law, const double *props, int32_t nprops)
{
    double stress[6] = {0}, again[6] = {0}, tangent[36], strain[6] = {0}, dstrain[6] = {1e-4, 0, 0, 2e-4, 0, 0};
    double *states = calloc(law->states.count + 1, sizeof *states), length = 10.0;
    double sse = 0, spd = 0, scd = 0, rpl = 0, time[2] = {0, 0}, dtime = 1, temperature = 0, pnewdt = 1, identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int32_t ndi = 3, nshr = 3, ntens = 6, nstatv = (int32_t)law->states.count, one = 1, step[4] = {1, 1, 0, 0};
    char name[80];
    int32_t status = -1;
    int i;
    __typeof__(umat_) *update = (__typeof__(umat_) *)symbol(library, "umat_");
    __typeof__(pullout_umat_batch_v1) *batch = (__typeof__(pullout_umat_batch_v1) *)symbol(library, "pullout_umat_batch_v1");
    memset(name, ' ', sizeof name);
    memcpy(name, law->law, strlen(law->law));
    update(stress, states, tangent, &sse, &spd, &scd, &rpl, strain, strain, &rpl, strain, dstrain, time, &dtime,
           &temperature, &temperature, &temperature, &temperature, name, &ndi, &nshr, &ntens, &nstatv, props, &nprops, strain,
           identity, &pnewdt, &length, identity, identity, &one, &one, &one, &one, step, &one, sizeof name);
    memset(states, 0, sizeof *states * law->states.count);
    batch(1, ntens, ndi, props, nprops, strain, dstrain, again, states, nstatv, NULL, &length, &status);
    for (i = 0; i < 6; i++)
        printf("stress %.17g %.17g\n", stress[i], again[i]);
    printf("tangent %.17g\n", tangent[0]);
    printf("status %d\n", (int)status);
    free(states);
}

int main(int argc, char **argv)
{
    void *library = dlopen(argv[1], RTLD_NOW);
    const pullout_plugin *law, *first;
    double props[16];
    int32_t k;
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    first = ((const pullout_plugin *(*)(void))symbol(library, "pullout_plugin_v1"))();
    for (law = first; law; law = law->next) {
        if (law->abi_version != PULLOUT_ABI_VERSION || law->struct_size < sizeof *law) {
            fprintf(stderr, "%s: version %u, %u bytes\n", law->law, (unsigned)law->abi_version, (unsigned)law->struct_size);
            return 1;
        }
        tell(law);
    }
    for (k = 0; k + 2 < argc && k < 16; k++)
        props[k] = atof(argv[k + 2]);
    if (k > 0)
        call(library, first, props, k);
    return 0;
}
