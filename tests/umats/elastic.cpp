// Isotropic elasticity in C++ as ABAQUS wants it: FOR_NAME and extern "C". PROPS: E, nu; NDI = 3.
// An inline function's static variable is a "unique" symbol, shared across libraries unless a compiler flag prevents that.
#include <omi_for_c.h>

#include <cstddef>
#include <map>
#include <stdexcept>
#include <vector>

inline int &calls() {
    static int count = 0;
    return count;
}

extern "C" void FOR_NAME(umat, UMAT)(double *stress, double *statev, double *ddsdde, double *, double *, double *,
                                     double *, double *, double *, double *, double *, double *dstran, double *,
                                     double *, double *, double *, double *, double *, char *, int *ndi, int *,
                                     int *ntens, int *nstatv, double *props, int *) {
    const int n = *ntens;
    std::map<int, double> moduli;
    moduli[0] = props[0] / (2.0 * (1.0 + props[1]));
    moduli[1] = 2.0 * moduli.at(0) * props[1] / (1.0 - 2.0 * props[1]);
    std::vector<double> c(static_cast<std::size_t>(n * n), 0.0);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            if (i < *ndi && j < *ndi)
                c[i + n * j] = moduli.at(1);
            if (i == j)
                c[i + n * j] += (i < *ndi ? 2.0 : 1.0) * moduli.at(0);
            ddsdde[i + n * j] = c[i + n * j];
            stress[i] += c[i + n * j] * dstran[j];
        }
    try {
        moduli.at(2);
    } catch (const std::out_of_range &) {
        calls()++;
    }
    if (*nstatv > 0)
        statev[0] = calls();
}
