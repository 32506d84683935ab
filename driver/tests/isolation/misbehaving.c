/* Linear elasticity that misbehaves where it is told to.
 *
 * PROPS: E, the fault (below), and the step and increment in which it is made.
 * With the fault "print" every argument is printed before the process is aborted. */
#define _GNU_SOURCE
#include <fenv.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include "pullout_umat.h"

enum fault { NONE, EXIT_0, EXIT_7, ABORT, WILD_POINTER, ENDLESS_LOOP, STACK, TRAP, CLOSE_STDOUT, PRINT,
             HANG_AT_EXIT };

static void print(const char *name, const double *values, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++)
        printf(" %.17g", values[i]);
    printf("\n");
}

static void print_integers(const char *name, const int32_t *values, int count)
{
    printf("%s", name);
    for (int i = 0; i < count; i++)
        printf(" %d", values[i]);
    printf("\n");
}

static void print_name(const char *name, const char *text, size_t length)
{
    printf("%s %.*s\n", name, (int)length, text);
}

/* not a tail call: every frame stays */
static double deeper(double x)
{
    volatile double frame[500];
    frame[0] = x;
    return x < 0.0 ? x : deeper(x + 1.0) + frame[0];
}

static void hang(void)
{
    for (;;)
        sleep(1);
}

static void misbehave(enum fault fault)
{
    static volatile double zero, sink;
    switch (fault) {
    case EXIT_0: exit(0);
    case EXIT_7: exit(7);
    case ABORT: abort();
    case WILD_POINTER: *(volatile int *)(uintptr_t)16 = 1; break;
    case ENDLESS_LOOP: for (;;) usleep(1000);
    case STACK: sink = deeper(1.0); break;
    case TRAP: feenableexcept(FE_DIVBYZERO); sink = 1.0 / zero; break;
    case CLOSE_STDOUT: fclose(stdout); break;
    case PRINT: fflush(stdout); abort();
    case HANG_AT_EXIT: atexit(hang); break;
    default: break;
    }
}

static enum fault fault_now(const double *props, int step, int increment)
{
    return step == (int)props[2] && increment == (int)props[3] ? (enum fault)props[1] : NONE;
}

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
    const enum fault fault = fault_now(props, jstep[0], *kinc);
    if (fault == PRINT) {
        print("CALL", NULL, 0);
        print("stress", stress, n), print("statev", statev, *nstatv), print("ddsdde", ddsdde, n * n);
        print("sse", sse, 1), print("spd", spd, 1), print("scd", scd, 1);
        print("stran", stran, n), print("dstran", dstran, n), print("time", time, 2), print("dtime", dtime, 1);
        print("temp", temp, 1), print("dtemp", dtemp, 1), print("predef", predef, 1), print("dpred", dpred, 1);
        print_name("cmname", cmname, cmname_length);
        print_integers("ndi", ndi, 1), print_integers("nshr", nshr, 1), print_integers("ntens", ntens, 1);
        print_integers("nstatv", nstatv, 1), print("props", props, *nprops), print("coords", coords, 3);
        print("drot", drot, 9), print("pnewdt", pnewdt, 1), print("celent", celent, 1);
        print("dfgrd0", dfgrd0, 9), print("dfgrd1", dfgrd1, 9), print_integers("noel", noel, 1);
        print_integers("npt", npt, 1), print_integers("layer", layer, 1), print_integers("kspt", kspt, 1);
        print_integers("jstep", jstep, 4), print_integers("kinc", kinc, 1);
    }
    for (int i = 0; i < n; i++) {
        const double modulus = i < *ndi ? props[0] : 0.5 * props[0];
        stress[i] += modulus * dstran[i];
        for (int j = 0; j < n; j++)
            ddsdde[i + n * j] = i == j ? modulus : 0.0;
    }
    *sse += stress[0] * dstran[0];
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    misbehave(fault);
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
    const int n = *ndir;
    const enum fault fault = fault_now(props, *kstep, *kinc);
    if (fault == PRINT) {
        print("CALL", NULL, 0);
        print("stress", stress, n), print("ddsddr", ddsddr, n * n), print("statev", statev, *nstatv);
        print("sed", sed, 1), print("sfd", sfd, 1), print("spd", spd, 1), print("svd", svd, 1), print("scd", scd, 1);
        print("pnewdt", pnewdt, 1), print("rdisp", rdisp, n), print("drdisp", drdisp, n);
        print("temp", temp, 2), print("dtemp", dtemp, 2), print("predef", predef, 2), print("dpred", dpred, 2);
        print("time", time, 2), print("dtime", dtime, 1), print("freqr", freqr, 1);
        print_name("ciname", ciname, ciname_length), print_name("slname", slname, slname_length);
        print_name("msname", msname, msname_length), print("props", props, *nprops), print("coords", coords, 3);
        print("alocaldir", alocaldir, 9), print("drot", drot, 4), print("area", area, 1);
        print("chrlngth", chrlngth, 1), print_integers("node", node, 1), print_integers("ndir", ndir, 1);
        print_integers("kstep", kstep, 1), print_integers("kinc", kinc, 1), print_integers("kit", kit, 1);
        print_integers("lopenclose", lopenclose, 1), print_integers("lstate", lstate, 1);
        print_integers("lsdi", lsdi, 1);
    }
    for (int i = 0; i < n; i++) {
        const double stiffness = i == 0 ? props[0] : 0.1 * props[0];
        stress[i] += stiffness * drdisp[i];
        ddsddr[i + n * i] = stiffness;
    }
    *sed += stress[0] * drdisp[0];
    *lopenclose = 1;
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    misbehave(fault);
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
    const int n = *nfdir;
    const enum fault fault = fault_now(props, *kstep, *kinc);
    if (fault == PRINT) {
        print("CALL", NULL, 0);
        print_integers("lm", lm, 1), print("tau", tau, n), print("ddtddg", ddtddg, n * n);
        print("ddtddp", ddtddp, n), print("dslip", dslip, n), print("sed", sed, 1), print("sfd", sfd, 1);
        print("pnewdt", pnewdt, 1), print("statev", statev, *nstatv), print("dgam", dgam, n);
        print("press", press, 1), print("dpress", dpress, 1), print("slip", slip, n);
        print_integers("kstep", kstep, 1), print_integers("kinc", kinc, 1), print("time", time, 2);
        print("dtime", dtime, 1), print_name("ciname", ciname, ciname_length), print_integers("npt", npt, 1);
        print_integers("node", node, 1), print("coords", coords, 3), print("rcoord", rcoord, 3);
        print_integers("nfdir", nfdir, 1), print("chrlngth", chrlngth, 1), print("props", props, *nprops);
    }
    *lm = 0;
    for (int i = 0; i < n; i++) {
        tau[i] += 0.1 * props[0] * dgam[i];
        ddtddg[i + n * i] = 0.1 * props[0];
        ddtddp[i] = 0.0;
        dslip[i] = 0.5 * dgam[i];
        *sfd += tau[i] * dslip[i];
    }
    for (int i = 0; i < *nstatv; i++)
        statev[i] += i + 1.0;
    misbehave(fault);
}
