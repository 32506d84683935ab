/* A program that links one plugin, -DLAW=<law>, by its unique name and drives a material point along the strain
 * path on stdin: NTENS NDI NSHR NSTATV NPROPS, PROPS, the number of increments, NTENS numbers for each.
 * Prints what the plugin says of itself, then the stresses of each increment with 17 digits. */
#include "pullout_umat.h"
#include <stdio.h>
#include <string.h>

#define DECLARE(law) PULLOUT_DECLARE_UMAT(law)
#define JOIN(law) law##_umat_
#define ENTRY(law) JOIN(law)

DECLARE(LAW);

enum { MOST_VALUES = 64 };

static int read_numbers(double *numbers, int count)
{
    int i;
    for (i = 0; i < count; i++)
        if (scanf("%lf", &numbers[i]) != 1)
            return 0;
    return 1;
}

/* The i-th parameter: by the table's stride, so that a newer plugin is read as well. */
static const pullout_parameter *parameter(const pullout_plugin *plugin, uint32_t i)
{
    return (const pullout_parameter *)((const char *)plugin->parameters.first + i * plugin->parameters.stride);
}

static int describe(const double *props, int32_t nprops)
{
    const pullout_plugin *plugin = pullout_plugin_v1();
    char message[512];
    uint32_t i;
    int32_t status;
    if (plugin->abi_version != PULLOUT_ABI_VERSION || plugin->struct_size < sizeof *plugin)
        return 0;
    if (!(plugin->kinds & PULLOUT_KIND_UMAT) || !(plugin->flags & PULLOUT_FLAG_THREAD_SAFE))
        return 0;
    printf("%s %u", plugin->law, (unsigned)plugin->states.count);
    for (i = 0; i < plugin->parameters.count; i++)
        printf(" %s", parameter(plugin, i)->name);
    status = plugin->validate(props, nprops, 1.0, message, sizeof message);
    printf("\nvalid %d\n", (int)status);
    status = plugin->validate(props, nprops - 1, 1.0, message, sizeof message);
    printf("one fewer %d %s\n", (int)status, status == PULLOUT_VALIDATION_OK ? "" : message);
    return 1;
}

int main(void)
{
    double stress[6] = {0.0}, statev[MOST_VALUES] = {0.0}, ddsdde[36], props[MOST_VALUES];
    double stran[6] = {0.0}, dstran[6] = {0.0}, sse, spd, scd, rpl = 0.0, ddsddt[6], drplde[6], drpldt = 0.0;
    double time[2] = {0.0}, dtime = 1.0, temp = 0.0, dtemp = 0.0, predef[1] = {0.0}, dpred[1] = {0.0};
    double coords[3] = {0.0}, identity[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, celent = 1.0, pnewdt;
    int32_t ntens, ndi, nshr, nstatv, nprops, one = 1, jstep[4] = {1, 1, 0, 0}, kinc;
    char cmname[80];
    int count, i;

    memset(cmname, ' ', sizeof cmname);
    memcpy(cmname, "MATERIAL", 8);
    if (scanf("%d %d %d %d %d", &ntens, &ndi, &nshr, &nstatv, &nprops) != 5 || ntens > 6 || nstatv > MOST_VALUES ||
        nprops > MOST_VALUES || !read_numbers(props, nprops) || scanf("%d", &count) != 1)
        return 2;
    if (!describe(props, nprops))
        return 3;
    for (kinc = 1; kinc <= count; kinc++) {
        if (!read_numbers(dstran, ntens))
            return 2;
        pnewdt = 1e36;
        ENTRY(LAW)(stress, statev, ddsdde, &sse, &spd, &scd, &rpl, ddsddt, drplde, &drpldt, stran, dstran, time,
                   &dtime, &temp, &dtemp, predef, dpred, cmname, &ndi, &nshr, &ntens, &nstatv, props, &nprops,
                   coords, identity, &pnewdt, &celent, identity, identity, &one, &one, &one, &one, jstep, &kinc,
                   sizeof cmname);
        if (pnewdt < 1.0)
            return 4;
        for (i = 0; i < ntens; i++) {
            stran[i] += dstran[i];
            printf("%.16e ", stress[i]);
        }
        printf("\n");
    }
    return 0;
}
