/* Linear elasticity whose SDVINI, UEXTERNALDB or SIGINI misbehaves: ROUTINE (1, 2, 3), FAULT and, of UEXTERNALDB,
 * the LOP, step and increment AT_LOP, AT_STEP, AT_INCREMENT at which it does are defined in front of this text. */
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

enum { SDVINI = 1, UEXTERNALDB = 2, SIGINI = 3 };
enum { EXIT_0 = 1, ABORT, WILD_POINTER, ENDLESS_LOOP };

static void misbehave(void)
{
    switch (FAULT) {
    case EXIT_0: exit(0);
    case ABORT: abort();
    case WILD_POINTER: *(volatile int *)(uintptr_t)16 = 1; break;
    case ENDLESS_LOOP: for (;;) usleep(1000);
    }
}

void sdvini_(double *statev)
{
    statev[0] = 5.0;
    if (ROUTINE == SDVINI)
        misbehave();
}

void sigini_(double *sigma)
{
    if (ROUTINE == SIGINI)
        misbehave();
}

void uexternaldb_(const int32_t *lop, const int32_t *restart, const double *time, const double *dtime,
                  const int32_t *kstep, const int32_t *kinc)
{
    if (ROUTINE == UEXTERNALDB && *lop == AT_LOP && *kstep == AT_STEP && *kinc == AT_INCREMENT)
        misbehave();
}

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int32_t *ndi, const int32_t *nshr, const int32_t *ntens)
{
    const int n = *ntens;
    for (int i = 0; i < n; i++) {
        const double modulus = i < *ndi ? 1000.0 : 500.0;
        stress[i] += modulus * dstran[i];
        for (int j = 0; j < n; j++)
            ddsdde[i + n * j] = i == j ? modulus : 0.0;
    }
}
