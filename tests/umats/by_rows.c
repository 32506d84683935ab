/* Elasticity whose shear stiffens under tension in direction 1: an unsymmetric tangent. PROPS: E, nu, b; PROPS[3] = 1: DDSDDE is
   stored by rows, as matrices of C are; 2: its shears have 2 mu. */
#include <stddef.h>

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
           double *ddsddt, double *drplde, double *drpldt, const double *stran, const double *dstran,
           const double *time, const double *dtime, const double *temp, const double *dtemp, const double *predef,
           const double *dpred, const char *cmname, const int *ndi, const int *nshr, const int *ntens,
           const int *nstatv, const double *props)
{
    const int n = *ntens, error = (int)props[3];
    const double mu = props[0] / (2 * (1 + props[1])), lambda = 2 * mu * props[1] / (1 - 2 * props[1]), b = props[2];
    const double e11 = stran[0] + dstran[0];
    for (int i = 0; i < n; i++) {
        double sigma = 0;
        for (int j = 0; j < n; j++) {
            const double e = stran[j] + dstran[j];
            double c = i < *ndi && j < *ndi ? lambda : 0;
            if (i == j)
                c += i < *ndi ? 2 * mu : mu * (1 + b * e11);
            sigma += c * e;
            double d = c;
            if (i >= *ndi && j == 0)
                d = mu * b * (stran[i] + dstran[i]);
            if (error == 2 && i == j && i >= *ndi)
                d *= 2;
            ddsdde[error == 1 ? i * n + j : i + j * n] = d;
        }
        stress[i] = sigma;
    }
}
