/* The symbol in capitals, as some compilers spell it, and tables of constants as C has them. PROPS: E, nu; NDI = 3. */
static double stiffness[36];

void UMAT(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl,
          double *ddsddt, double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime,
          double *temp, double *dtemp, double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens,
          int *nstatv, double *props)
{
    const double g = props[0] / (2.0 * (1.0 + props[1])), l = 2.0 * g * props[1] / (1.0 - 2.0 * props[1]);
    for (int k = 0; k < *ntens * *ntens; k++) {
        const int i = k % *ntens, j = k / *ntens;
        stiffness[k] = (i < *ndi && j < *ndi ? l : 0.0) + (i != j ? 0.0 : i < *ndi ? 2.0 * g : g);
        ddsdde[k] = stiffness[k];
        stress[i] += stiffness[k] * dstran[j];
    }
}
