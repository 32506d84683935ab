/* Isotropic linear elasticity as a UMAT in C. PROPS: E, nu. NTENS 6 or 4. */
#include "pullout_umat.h"

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
           const int32_t *nstatv, const double *props, const int32_t *nprops, const double *coords,
           const double *drot, double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,
           const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt, const int32_t *jstep,
           const int32_t *kinc, size_t cmname_length)
{
    const int n = *ntens;
    const double mu = props[0] / (2.0 * (1.0 + props[1]));
    const double lambda = props[0] * props[1] / ((1.0 + props[1]) * (1.0 - 2.0 * props[1]));
    double trace = 0.0;
    int i, j;
    for (i = 0; i < *ndi; i++)
        trace += stran[i] + dstran[i];
    *sse = 0.0;
    for (i = 0; i < n; i++) {
        const double strain = stran[i] + dstran[i];
        const int direct = i < *ndi;
        stress[i] = direct ? lambda * trace + 2.0 * mu * strain : mu * strain;
        *sse += 0.5 * stress[i] * strain;
        for (j = 0; j < n; j++)
            ddsdde[j * n + i] = (direct && j < *ndi ? lambda : 0.0) + (i == j ? (direct ? 2.0 * mu : mu) : 0.0);
    }
    *spd = 0.0;
    *scd = 0.0;
    (void)statev, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)time, (void)dtime, (void)temp;
    (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)nshr, (void)nstatv, (void)nprops, (void)coords;
    (void)drot, (void)pnewdt, (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer;
    (void)kspt, (void)jstep, (void)kinc, (void)cmname_length;
}
