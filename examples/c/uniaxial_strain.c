/* Concrete in uniaxial strain, 20 increments to 4e-4 and 40 to -3e-3: prints e11, s11, s22 and s33 of each.
 *
 *    gcc uniaxial_strain.c $(pkg-config --cflags --libs pullout) -o uniaxial_strain
 */
#include <pullout_umat.h>
#include <stdio.h>
#include <string.h>

enum { NTENS = 6, NSTATV = 13, NPROPS = 14 };

int main(void)
{
    /* `pullout plugin info concrete_damage`: E nu, A_t B_t Y_t0, A_c B_c Y_c0, beta zeta_c, b_t b_c, G_f G_c */
    const double props[NPROPS] = {31800.0, 0.18,    5000.0, 1.3, 0.0001905077, 31.47479, 1.05,
                                  3e-4,    0.17227, 0.0,    0.0, 0.0,          0.0,      0.0};
    const int32_t ndi = 3, nshr = 3, ntens = NTENS, nstatv = NSTATV, nprops = NPROPS;
    const int32_t one = 1, jstep[4] = {1, 1, 0, 0};
    const double identity[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, origin[3] = {0.0};
    const double zero = 0.0, field[1] = {0.0}, dtime = 1.0, celent = 1.0;
    const struct { int increments; double e11; } steps[2] = {{20, 4e-4}, {40, -3e-3}};
    /* all zero: the virgin state */
    double stress[NTENS] = {0.0}, statev[NSTATV] = {0.0}, stran[NTENS] = {0.0}, dstran[NTENS] = {0.0};
    double ddsdde[NTENS * NTENS], ddsddt[NTENS], drplde[NTENS], sse, spd, scd, rpl, drpldt, pnewdt;
    double time[2] = {0.0, 0.0};
    char cmname[80];
    int32_t kinc;
    int step, k;

    /* the material's name tells the laws of libpullout_laws.so apart */
    memset(cmname, ' ', sizeof cmname);
    memcpy(cmname, "CONCRETE_DAMAGE", strlen("CONCRETE_DAMAGE"));
    for (step = 0; step < 2; step++) {
        dstran[0] = (steps[step].e11 - stran[0]) / steps[step].increments;
        for (kinc = 1; kinc <= steps[step].increments; kinc++) {
            pnewdt = 1e36;
            umat_(stress, statev, ddsdde, &sse, &spd, &scd, &rpl, ddsddt, drplde, &drpldt, stran, dstran, time, &dtime,
                  &zero, &zero, field, field, cmname, &ndi, &nshr, &ntens, &nstatv, props, &nprops, origin, identity,
                  &pnewdt, &celent, identity, identity, &one, &one, &one, &one, jstep, &kinc, sizeof cmname);
            if (pnewdt < 1.0) {
                fprintf(stderr, "the law asks for %g of increment %d\n", pnewdt, (int)kinc);
                return 1;
            }
            for (k = 0; k < NTENS; k++)
                stran[k] += dstran[k];
            printf("%.16e %.16e %.16e %.16e\n", stran[0], stress[0], stress[1], stress[2]);
        }
    }
    return 0;
}
