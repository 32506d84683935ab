// Isotropic elasticity with Eigen's matrices over ABAQUS's arrays, whose columns lie one behind the other as in Fortran.
#include <Eigen/Dense>
#include <cstddef>

extern "C" void umat_(double *stress, double *, double *ddsdde, double *sse, double *, double *, double *, double *, double *,
                      double *, const double *stran, const double *dstran, const double *, const double *, const double *,
                      const double *, const double *, const double *, const char *, const int *ndi, const int *,
                      const int *ntens, const int *, const double *props)
{
    const int n = *ntens, direct = *ndi;
    const double mu = props[0] / (2 * (1 + props[1])), lambda = 2 * mu * props[1] / (1 - 2 * props[1]);
    Eigen::Map<Eigen::MatrixXd> tangent(ddsdde, n, n);
    Eigen::Map<Eigen::VectorXd> sigma(stress, n);
    Eigen::Map<const Eigen::VectorXd> before(stran, n), step(dstran, n);
    tangent.setZero();
    tangent.topLeftCorner(direct, direct).setConstant(lambda);
    tangent.diagonal().head(direct).array() += 2 * mu;
    tangent.diagonal().tail(n - direct).array() += mu;
    sigma += tangent * step;
    *sse = 0.5 * sigma.dot(before + step);
}
