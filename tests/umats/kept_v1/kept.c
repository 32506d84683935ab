/* Isotropic linear elasticity with the greatest strain as a state, described by the header as it once was.
 * Never changed: hosts must go on reading such libraries. */
#include "pullout_umat.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* the header beside this file, not that of today */
_Static_assert(sizeof(pullout_parameter) == 80, "parameters have grown");

static int is_valid(const double *props, int32_t nprops)
{
    return nprops == 2 && props[0] > 0.0 && isfinite(props[0]) && props[1] > -1.0 && props[1] < 0.5;
}

static int32_t validate(const double *props, int32_t nprops, double length, char *message, size_t capacity)
{
    (void)length;
    if (is_valid(props, nprops))
        return PULLOUT_VALIDATION_OK;
    snprintf(message, capacity, "E must be positive and nu between -1 and 0.5");
    return PULLOUT_VALIDATION_INVALID;
}

static int are_counts_known(int32_t ntens, int32_t ndi, int32_t nshr, int32_t nstatv)
{
    const int is_known = (ntens == 6 && ndi == 3) || (ntens == 4 && ndi == 3) || (ntens == 3 && ndi == 2);
    return is_known && nshr == ntens - ndi && nstatv == 3;
}

static int are_finite(const double *numbers, int count)
{
    int i;
    for (i = 0; i < count && isfinite(numbers[i]); i++)
        ;
    return i == count;
}

/* sigma = C : epsilon; C by (2 mu, lambda), in plane stress with lambda of that state. */
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
           const int32_t *nstatv, const double *props, const int32_t *nprops, const double *coords,
           const double *drot, double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,
           const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt, const int32_t *jstep,
           const int32_t *kinc, size_t cmname_length)
{
    const int n = *ntens, direct = *ndi;
    double shear, lambda, square = 0.0, energy = 0.0, strain[6];
    int i, j;
    (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)time, (void)dtime, (void)temp;
    (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)coords, (void)drot;
    (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer, (void)kspt, (void)jstep;
    (void)kinc, (void)cmname_length;
    if (!are_counts_known(n, direct, *nshr, *nstatv) || !is_valid(props, *nprops) || !are_finite(stran, n) ||
        !are_finite(dstran, n) || !are_finite(stress, n) || !are_finite(statev, 3)) {
        for (i = 0; i < n; i++)
            stress[i] = NAN;
        *pnewdt = 0.5;
        return;
    }
    shear = props[0] / (2.0 * (1.0 + props[1]));
    lambda = direct == 2 ? props[0] * props[1] / (1.0 - props[1] * props[1])
                         : props[0] * props[1] / ((1.0 + props[1]) * (1.0 - 2.0 * props[1]));
    memset(ddsdde, 0, sizeof *ddsdde * (size_t)(n * n));
    for (i = 0; i < n; i++) {
        strain[i] = stran[i] + dstran[i];
        square += (i < direct ? 1.0 : 0.5) * strain[i] * strain[i];
        ddsdde[i * n + i] = i < direct ? 2.0 * shear : shear;
        for (j = 0; i < direct && j < direct; j++)
            ddsdde[i * n + j] += lambda;
    }
    for (i = 0; i < n; i++) {
        stress[i] = 0.0;
        for (j = 0; j < n; j++)
            stress[i] += ddsdde[j * n + i] * strain[j];
        energy += 0.5 * stress[i] * strain[i];
    }
    *sse = energy;
    statev[1] = direct == 3 ? strain[2] : -props[1] / (1.0 - props[1]) * (strain[0] + strain[1]);
    square += direct == 3 ? 0.0 : statev[1] * statev[1];
    statev[0] = fmax(statev[0], sqrt(square));
    statev[2] = 0.0;
}

static const pullout_parameter parameters[2] = {
    {"E", "MPa", "Young's modulus", "", 30e3, 0.0, INFINITY, PULLOUT_OPEN_BOUND_LOWER, 0, {NULL, 0, sizeof(pullout_choice)}},
    {"nu", "-", "Poisson's ratio", "", 0.2, -1.0, 0.5, PULLOUT_OPEN_BOUND_LOWER | PULLOUT_OPEN_BOUND_UPPER, 0,
     {NULL, 0, sizeof(pullout_choice)}},
};

static const pullout_state_variable states[3] = {
    {"greatest_strain", "-", "greatest norm of the strain so far", 0, 0},
    {"strain_33", "-", "strain 33", 0, 0},
    {"dissipated_energy", "N*mm/mm^3", "dissipated energy: none", 0, 0},
};

static const pullout_plugin description = {
    .abi_version = PULLOUT_ABI_VERSION,
    .struct_size = sizeof(pullout_plugin),
    .law = "kept",
    .version = "1.0",
    .description = "Isotropic linear elasticity of a kept library.",
    .kinds = PULLOUT_KIND_UMAT,
    .stress_states = PULLOUT_STRESS_STATE_ALL,
    .flags = PULLOUT_FLAG_SYMMETRIC_TANGENT | PULLOUT_FLAG_THREAD_SAFE | PULLOUT_FLAG_PATH_EXACT | PULLOUT_FLAG_ISOTROPIC,
    .parameters = {parameters, 2, sizeof(pullout_parameter)},
    .states = {states, 3, sizeof(pullout_state_variable)},
    .derived = {NULL, 0, sizeof(pullout_derived_output)},
    .validate = validate,
};

const pullout_plugin *pullout_plugin_v1(void)
{
    return &description;
}
