/* Von Mises plasticity with linear isotropic hardening as a UMAT in C.
 * PROPS: E, nu, initial yield stress, hardening modulus. NTENS 6 or 4.
 * STATEV: equivalent plastic strain, then the plastic strain (6, engineering shear). */
#include "pullout_umat.h"
#include <math.h>

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
    const double shear = props[0] / (2.0 * (1.0 + props[1])), bulk = props[0] / (3.0 * (1.0 - 2.0 * props[1]));
    const double hardening = props[3], radius = props[2] + hardening * statev[0];
    double s[6] = {0.0}, flow[6] = {0.0}, pressure, norm = 0.0, plastic = 0.0, scale = 1.0, drop = 0.0;
    int i, j;

    for (i = 0; i < n; i++)
        s[i] = stran[i] + dstran[i] - statev[1 + i];
    pressure = bulk * (s[0] + s[1] + s[2]);
    for (i = 0; i < 6; i++)
        s[i] = i < 3 ? 2.0 * shear * (s[i] - pressure / (3.0 * bulk)) : shear * s[i];
    for (i = 0; i < 6; i++)
        norm += (i < 3 ? 1.5 : 3.0) * s[i] * s[i];
    norm = sqrt(norm);
    if (norm > radius) {
        plastic = (norm - radius) / (3.0 * shear + hardening);
        scale = (radius + hardening * plastic) / norm;
        drop = 3.0 * shear * (hardening / (3.0 * shear + hardening) - scale);
        for (i = 0; i < 6; i++) {
            flow[i] = s[i] / norm;
            statev[1 + i] += (i < 3 ? 1.5 : 3.0) * plastic * flow[i];
        }
        statev[0] += plastic;
    }
    for (i = 0; i < n; i++) {
        const int direct = i < *ndi;
        stress[i] = scale * s[i] + (direct ? pressure : 0.0);
        for (j = 0; j < n; j++) {
            double value = drop * flow[i] * flow[j];
            if (direct && j < *ndi)
                value += bulk - 2.0 / 3.0 * scale * shear;
            if (i == j)
                value += (direct ? 2.0 : 1.0) * scale * shear;
            ddsdde[j * n + i] = value;
        }
    }
    *sse = scale * norm * scale * norm / (6.0 * shear) + pressure * pressure / (2.0 * bulk);
    *spd = (props[2] + 0.5 * hardening * statev[0]) * statev[0];
    *scd = 0.0;
    (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)time, (void)dtime, (void)temp;
    (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)nshr, (void)nstatv, (void)nprops, (void)coords;
    (void)drot, (void)pnewdt, (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer;
    (void)kspt, (void)jstep, (void)kinc, (void)cmname_length;
}
