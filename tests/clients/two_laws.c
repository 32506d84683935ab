/* A program that links the libraries of two laws: what bears a law's name is that law's. Strains two points along x by each law's
 * batch and by its UMAT, without and with Kratos's order of shears; prints the names, then the stresses of each way. */
#include "pullout_umat.h"
#include <stdio.h>
#include <string.h>

PULLOUT_DECLARE_UMAT(linear_elastic);
PULLOUT_DECLARE_UMAT_KRATOS(linear_elastic);
PULLOUT_DECLARE_UMAT_BATCH(linear_elastic);
PULLOUT_DECLARE_PLUGIN(linear_elastic);
PULLOUT_DECLARE_UMAT(j2_plasticity);
PULLOUT_DECLARE_UMAT_KRATOS(j2_plasticity);
PULLOUT_DECLARE_UMAT_BATCH(j2_plasticity);
PULLOUT_DECLARE_PLUGIN(j2_plasticity);

enum { POINTS = 2, COMPONENTS = 6, STATES = 9 };

static const double strain[COMPONENTS] = {4e-3, -1e-3, -5e-4, 1e-3, 2e-3, 3e-3};

static void batch(__typeof__(pullout_umat_batch_v1) *function, const double *props, int32_t nprops, int32_t nstatv)
{
    double start[COMPONENTS * POINTS] = {0.0}, increment[COMPONENTS * POINTS], stress[COMPONENTS * POINTS] = {0.0};
    double statev[STATES * POINTS] = {0.0};
    int32_t status[POINTS] = {-1, -1};
    int k;
    for (k = 0; k < COMPONENTS * POINTS; k++)
        increment[k] = strain[k / POINTS];
    function(POINTS, COMPONENTS, 3, props, nprops, start, increment, stress, statev, nstatv, NULL, NULL, status);
    for (k = 0; k < COMPONENTS; k++)
        printf("%.16e ", stress[k * POINTS + 1]);
    printf("%d %d\n", (int)status[0], (int)status[1]);
}

static void single(__typeof__(umat_) *function, const int *order, const double *props, int32_t nprops, int32_t nstatv)
{
    double stran[COMPONENTS] = {0.0}, dstran[COMPONENTS], stress[COMPONENTS] = {0.0}, statev[STATES] = {0.0}, sse, spd, scd;
    int32_t ndi = 3, nshr = 3, ntens = COMPONENTS;
    double ddsdde[COMPONENTS * COMPONENTS];
    int k;
    for (k = 0; k < COMPONENTS; k++)
        dstran[k] = strain[order[k]];
    function(stress, statev, ddsdde, &sse, &spd, &scd, NULL, NULL, NULL, NULL, stran, dstran, NULL, NULL, NULL, NULL, NULL, NULL,
             NULL, &ndi, &nshr, &ntens, &nstatv, props, &nprops, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL,
             NULL, NULL, 0);
    for (k = 0; k < COMPONENTS; k++)
        printf("%.16e ", stress[order[k]]);
    printf("\n");
}

int main(void)
{
    static const double elastic[] = {210e3, 0.3}, plastic[] = {210e3, 0.3, 347.0, 0.0, 400.0, 0.1};
    static const int ours[] = {0, 1, 2, 3, 4, 5}, kratos[] = {0, 1, 2, 3, 5, 4};
    printf("%s %s\n", linear_elastic_plugin_v1()->law, j2_plasticity_plugin_v1()->law);
    batch(linear_elastic_umat_batch_v1, elastic, 2, 2);
    single(linear_elastic_umat_, ours, elastic, 2, 2);
    single(linear_elastic_umat_kratos_, kratos, elastic, 2, 2);
    batch(j2_plasticity_umat_batch_v1, plastic, 6, 9);
    single(j2_plasticity_umat_, ours, plastic, 6, 9);
    single(j2_plasticity_umat_kratos_, kratos, plastic, 6, 9);
    return 0;
}
