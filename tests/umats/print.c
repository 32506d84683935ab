/* Prints every argument of UMAT, UINTER and FRIC as it comes in: one line per call, NAME=value,value,… NAME=….
   Elastic, so that a path can be driven: E = PROPS(1), nu = 0. PROPS(2) of UMAT: how many field variables there are,
   which no argument gives; 1 without it. What a host must keep is changed in every call: STATEV(1)
   and the energies count, LOPENCLOSE and LSTATE become 1 and 2. */
#include <stddef.h>
#include <stdio.h>

#include "pullout_umat.h"

static void numbers(const char *name, const double *values, int count)
{
    printf(" %s=", name);
    for (int k = 0; k < count; k++)
        printf(k ? ",%.17g" : "%.17g", values[k]);
}

static void integers(const char *name, const int32_t *values, int count)
{
    printf(" %s=", name);
    for (int k = 0; k < count; k++)
        printf(k ? ",%d" : "%d", values[k]);
}

/* Blanks shown as underscores; the hidden length behind. */
static void text(const char *name, const char *value, size_t length)
{
    printf(" %s=", name);
    for (size_t k = 0; k < length; k++)
        putchar(value[k] == ' ' ? '_' : value[k]);
    printf(",%zu", length);
}

#define N(array, count) numbers(#array, array, count)
#define I(array, count) integers(#array, array, count)
#define T(value) text(#value, value, value##_length)

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens,
           const int32_t *nstatv, const double *props, const int32_t *nprops, const double *coords, const double *drot,
           double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1, const int32_t *noel,
           const int32_t *npt, const int32_t *layer, const int32_t *kspt, const int32_t *jstep, const int32_t *kinc,
           size_t cmname_length)
{
    const int n = *ntens, fields = *nprops > 1 ? (int)props[1] : 1;
    printf("UMAT");
    N(stress, n), N(statev, *nstatv), N(ddsdde, n * n), N(sse, 1), N(spd, 1), N(scd, 1), N(rpl, 1), N(ddsddt, n);
    N(drplde, n), N(drpldt, 1), N(stran, n), N(dstran, n), N(time, 2), N(dtime, 1), N(temp, 1), N(dtemp, 1);
    N(predef, fields), N(dpred, fields), T(cmname), I(ndi, 1), I(nshr, 1), I(ntens, 1), I(nstatv, 1), N(props, *nprops);
    I(nprops, 1), N(coords, 3), N(drot, 9), N(pnewdt, 1), N(celent, 1), N(dfgrd0, 9), N(dfgrd1, 9), I(noel, 1);
    I(npt, 1), I(layer, 1), I(kspt, 1), I(jstep, 4), I(kinc, 1);
    printf("\n");
    fflush(stdout);
    for (int i = 0; i < n; i++) {
        const double c = i < *ndi ? props[0] : 0.5 * props[0];
        stress[i] += c * dstran[i];
        ddsdde[i + n * i] = c;
    }
    statev[0] += 1.0;
    *sse += 1.0, *spd += 2.0, *scd += 3.0, *rpl = 9.0;
}

void uinter_(double *stress, double *ddsddr, double *dviscous, double *dstructural, double *flux, double *ddfddt,
             double *ddsddt, double *ddfddr, double *statev, double *sed, double *sfd, double *spd, double *svd,
             double *scd, double *pnewdt, const double *rdisp, const double *drdisp, const double *temp,
             const double *dtemp, const double *predef, const double *dpred, const double *time, const double *dtime,
             const double *freqr, const char *ciname, const char *slname, const char *msname, const double *props,
             const double *coords, const double *alocaldir, const double *drot, const double *area,
             const double *chrlngth, const int32_t *node, const int32_t *ndir, const int32_t *nstatv,
             const int32_t *npred, const int32_t *nprops, const int32_t *mcrd, const int32_t *kstep,
             const int32_t *kinc, const int32_t *kit, const int32_t *linper, int32_t *lopenclose, int32_t *lstate,
             int32_t *lsdi, const int32_t *lprint, size_t ciname_length, size_t slname_length, size_t msname_length)
{
    const int n = *ndir, m = *mcrd;
    printf("UINTER");
    N(stress, n), N(ddsddr, n * n), N(dviscous, n * n), N(dstructural, n * n), N(flux, 2), N(ddfddt, 4);
    N(ddsddt, 2 * n), N(ddfddr, 2 * n), N(statev, *nstatv), N(sed, 1), N(sfd, 1), N(spd, 1), N(svd, 1), N(scd, 1);
    N(pnewdt, 1), N(rdisp, n), N(drdisp, n), N(temp, 2), N(dtemp, 2), N(predef, 2 * *npred), N(dpred, 2 * *npred);
    N(time, 2), N(dtime, 1), N(freqr, 1), T(ciname), T(slname), T(msname), N(props, *nprops), N(coords, m);
    N(alocaldir, m * m), N(drot, 4), N(area, 1), N(chrlngth, 1), I(node, 1), I(ndir, 1), I(nstatv, 1), I(npred, 1);
    I(nprops, 1), I(mcrd, 1), I(kstep, 1), I(kinc, 1), I(kit, 1), I(linper, 1), I(lopenclose, 1), I(lstate, 1);
    I(lsdi, 1), I(lprint, 1);
    printf("\n");
    fflush(stdout);
    for (int i = 0; i < n; i++) {
        stress[i] += props[0] * drdisp[i];
        ddsddr[i + n * i] = props[0];
    }
    statev[0] += 1.0;
    *sed += 1.0, *sfd += 2.0, *spd += 3.0, *svd += 4.0, *scd += 5.0;
    *lopenclose = 1, *lstate = 2, *lsdi = 1;
}

void fric_(int32_t *lm, double *tau, double *ddtddg, double *ddtddp, double *dslip, double *sed, double *sfd,
           double *ddtddt, double *pnewdt, double *statev, const double *dgam, const double *taulm,
           const double *press, const double *dpress, const double *ddpddh, const double *slip, const int32_t *kstep,
           const int32_t *kinc, const double *time, const double *dtime, const int32_t *noel, const char *ciname,
           const char *slname, const char *msname, const int32_t *npt, const int32_t *node, const int32_t *npatch,
           const double *coords, const double *rcoord, const double *drot, const double *temp, const double *predef,
           const int32_t *nfdir, const int32_t *mcrd, const int32_t *npred, const int32_t *nstatv,
           const double *chrlngth, const double *props, const int32_t *nprops, size_t ciname_length,
           size_t slname_length, size_t msname_length)
{
    const int n = *nfdir, m = *mcrd;
    printf("FRIC");
    I(lm, 1), N(tau, n), N(ddtddg, n * n), N(ddtddp, n), N(dslip, n), N(sed, 1), N(sfd, 1), N(ddtddt, 2 * n);
    N(pnewdt, 1), N(statev, *nstatv), N(dgam, n), N(taulm, n), N(press, 1), N(dpress, 1), N(ddpddh, 1), N(slip, n);
    I(kstep, 1), I(kinc, 1), N(time, 2), N(dtime, 1), I(noel, 1), T(ciname), T(slname), T(msname), I(npt, 1);
    I(node, 1), I(npatch, 1), N(coords, m), N(rcoord, m), N(drot, 4), N(temp, 2), N(predef, 2 * *npred), I(nfdir, 1);
    I(mcrd, 1), I(npred, 1), I(nstatv, 1), N(chrlngth, 1), N(props, *nprops), I(nprops, 1);
    printf("\n");
    fflush(stdout);
    for (int i = 0; i < n; i++) {
        tau[i] += props[0] * dgam[i];
        ddtddg[i + n * i] = props[0];
        dslip[i] = 0.5 * dgam[i];
    }
    statev[0] += 1.0;
    *sed += 1.0, *sfd += 2.0;
    *lm = 0;
}
