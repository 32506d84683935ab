/* The plugin contract of Pullout: UMAT, FRIC and UINTER as gfortran compiles them on Linux, and the
 * self-description of a plugin.
 *
 * Generated from umat-abi/src by the test `contract`; do not edit. */

#ifndef PULLOUT_UMAT_H
#define PULLOUT_UMAT_H

#include <stddef.h>
#include <stdint.h>

/* Declare the symbols of a law, for programs that link several laws: PULLOUT_DECLARE_UMAT(linear_elastic); gives
 * linear_elastic_umat_. The library of a law and libpullout_laws have them. Kratos: shears 12, 23, 13. */
#ifdef __cplusplus
#define PULLOUT_DECLARE extern "C"
#else
#define PULLOUT_DECLARE extern
#endif
#define PULLOUT_DECLARE_UMAT(law) PULLOUT_DECLARE __typeof__(umat_) law##_umat_
#define PULLOUT_DECLARE_UMAT_KRATOS(law) PULLOUT_DECLARE __typeof__(umat_) law##_umat_kratos_
#define PULLOUT_DECLARE_UMAT_BATCH(law) PULLOUT_DECLARE __typeof__(pullout_umat_batch_v1) law##_umat_batch_v1
#define PULLOUT_DECLARE_FRIC(law) PULLOUT_DECLARE __typeof__(fric_) law##_fric_
#define PULLOUT_DECLARE_UINTER(law) PULLOUT_DECLARE __typeof__(uinter_) law##_uinter_
#define PULLOUT_DECLARE_PLUGIN(law) PULLOUT_DECLARE __typeof__(pullout_plugin_v1) law##_plugin_v1

/*
 Version of this layout; a host refuses any other.
 */
#define PULLOUT_ABI_VERSION 1

/*
 `umat_`
 */
#define PULLOUT_KIND_UMAT 1

/*
 `fric_`
 */
#define PULLOUT_KIND_FRIC 2

/*
 `uinter_`
 */
#define PULLOUT_KIND_UINTER 4

/*
 NTENS 6.
 */
#define PULLOUT_STRESS_STATE_THREE_D 1

/*
 NTENS 4, NDI 3.
 */
#define PULLOUT_STRESS_STATE_PLANE_STRAIN 2

/*
 NTENS 4, NDI 3, 11 rr, 22 zz, 33 θθ.
 */
#define PULLOUT_STRESS_STATE_AXISYMMETRIC 4

/*
 NTENS 3, NDI 2.
 */
#define PULLOUT_STRESS_STATE_PLANE_STRESS 8

/*
 All of them.
 */
#define PULLOUT_STRESS_STATE_ALL (((PULLOUT_STRESS_STATE_THREE_D | PULLOUT_STRESS_STATE_PLANE_STRAIN) | PULLOUT_STRESS_STATE_AXISYMMETRIC) | PULLOUT_STRESS_STATE_PLANE_STRESS)

/*
 The consistent tangent is symmetric for all parameters.
 */
#define PULLOUT_FLAG_SYMMETRIC_TANGENT 1

/*
 May be called from several threads at once.
 */
#define PULLOUT_FLAG_THREAD_SAFE 2

/*
 Reads CELENT (for some parameters).
 */
#define PULLOUT_FLAG_USES_CELENT 4

/*
 Uses DFGRD0/DFGRD1: a finite-strain law.
 */
#define PULLOUT_FLAG_FINITE_STRAIN 8

/*
 DDSDDE (UINTER: DDSDDR, FRIC: DDTDDG) = NULL means: stress only.
 */
#define PULLOUT_FLAG_STRESS_ONLY 16

/*
 For all parameters, the response does not depend on the increment size on proportional monotonic strain
 paths.
 */
#define PULLOUT_FLAG_PATH_EXACT 32

/*
 Isotropic: a rotated strain path gives the rotated stress path.
 */
#define PULLOUT_FLAG_ISOTROPIC 64

/*
 The lower bound itself is not admissible.
 */
#define PULLOUT_OPEN_BOUND_LOWER 1

/*
 The upper bound itself is not admissible.
 */
#define PULLOUT_OPEN_BOUND_UPPER 2

/*
 s itself.
 */
#define PULLOUT_DERIVED_FORM_IDENTITY 0

/*
 s/(1 + s): damage D from η.
 */
#define PULLOUT_DERIVED_FORM_DAMAGE_FROM_ETA 1

/*
 Parameters are usable.
 */
#define PULLOUT_VALIDATION_OK 0

/*
 The parameters are not admitted; the message says why.
 */
#define PULLOUT_VALIDATION_INVALID 1

/*
 The parameters need a characteristic length > 0.
 */
#define PULLOUT_VALIDATION_NEEDS_LENGTH 2

/*
 Arrays hold the new values.
 */
#define PULLOUT_BATCH_RESULT_DONE 0

/*
 The point needs a smaller increment; its arrays are as they were (if `status` is NULL, stress and tangent are NaN).
 */
#define PULLOUT_BATCH_RESULT_CUT_BACK 1

/*
 Parameters, counts or characteristic length are wrong: STRESS and DDSDDE are NaN.
 */
#define PULLOUT_BATCH_RESULT_REFUSED 2

/*
 A named value of a selecting parameter.
 */
typedef struct pullout_choice {
  /*
   The number in PROPS.
   */
  double value;
  /*
   The name that case files may use.
   */
  const char *name;
} pullout_choice;

/*
 `count` elements, `stride` bytes from one to the next: read them by the stride, they may grow.
 */
typedef struct pullout_choice_table {
  /*
   First element; NULL if `count` is 0.
   */
  const struct pullout_choice *first;
  /*
   Number of elements.
   */
  uint32_t count;
  /*
   Bytes from one element to the next.
   */
  uint32_t stride;
} pullout_choice_table;

/*
 One entry of PROPS.
 */
typedef struct pullout_parameter {
  /*
   Name in case files.
   */
  const char *name;
  /*
   Unit, "-" if none.
   */
  const char *unit;
  /*
   One sentence.
   */
  const char *doc;
  /*
   Quantity that a host may fill in when the value is 0: "normal_penalty", "tangential_penalty", or "".
   */
  const char *role;
  /*
   Used when a case names no value.
   */
  double default_value;
  /*
   Least value.
   */
  double lower;
  /*
   Greatest value.
   */
  double upper;
  /*
   PULLOUT_OPEN_BOUND_….
   */
  uint32_t open_bounds;
  /*
   Unused, 0.
   */
  uint32_t reserved;
  /*
   Named values, if this parameter selects a form.
   */
  struct pullout_choice_table choices;
  /*
   Least usual value: a host warns of others, which may be a slip of units. Libraries older than this entry end here:
   readers look at the stride of the table.
   */
  double typical_lower;
  /*
   Greatest usual value; 0, as `typical_lower`: none are said.
   */
  double typical_upper;
} pullout_parameter;

/*
 `count` elements, `stride` bytes from one to the next: read them by the stride, they may grow.
 */
typedef struct pullout_parameter_table {
  /*
   First element; NULL if `count` is 0.
   */
  const struct pullout_parameter *first;
  /*
   Number of elements.
   */
  uint32_t count;
  /*
   Bytes from one element to the next.
   */
  uint32_t stride;
} pullout_parameter_table;

/*
 The last `size` parameters of the table may occur several times in PROPS.
 */
typedef struct pullout_repeating_group {
  /*
   Key in case files: an array of arrays of `size` numbers.
   */
  const char *name;
  /*
   Parameters in one occurrence.
   */
  uint32_t size;
  /*
   Least number of occurrences.
   */
  uint32_t minimum;
  /*
   Index of the parameter that holds the number of occurrences, or −1 if NPROPS determines it.
   */
  int32_t count_parameter;
  /*
   Number of parameters, the last before the group, that were added to the law later: PROPS without them are
   accepted, and their defaults used. 0 unless occurrences are counted, since the count and NPROPS together
   determine it.
   */
  uint32_t added;
} pullout_repeating_group;

/*
 One entry of STATEV.
 */
typedef struct pullout_state_variable {
  /*
   Column name in `history.csv`.
   */
  const char *name;
  /*
   Unit, "-" if none.
   */
  const char *unit;
  /*
   One sentence.
   */
  const char *doc;
  /*
   0: a scalar. 1…6: component 11, 22, 33, 12, 13, 23 of a strain-like tensor (engineering
   shear), the six in a row; the ABI boundary rotates it by DROT.
   */
  uint32_t tensor_component;
  /*
   Unused, 0.
   */
  uint32_t reserved;
} pullout_state_variable;

/*
 `count` elements, `stride` bytes from one to the next: read them by the stride, they may grow.
 */
typedef struct pullout_state_variable_table {
  /*
   First element; NULL if `count` is 0.
   */
  const struct pullout_state_variable *first;
  /*
   Number of elements.
   */
  uint32_t count;
  /*
   Bytes from one element to the next.
   */
  uint32_t stride;
} pullout_state_variable_table;

/*
 A quantity that hosts print in addition to the states.
 */
typedef struct pullout_derived_output {
  /*
   Column name.
   */
  const char *name;
  /*
   Index in STATEV, from 0.
   */
  uint32_t state;
  /*
   PULLOUT_DERIVED_FORM_….
   */
  uint32_t form;
} pullout_derived_output;

/*
 `count` elements, `stride` bytes from one to the next: read them by the stride, they may grow.
 */
typedef struct pullout_derived_output_table {
  /*
   First element; NULL if `count` is 0.
   */
  const struct pullout_derived_output *first;
  /*
   Number of elements.
   */
  uint32_t count;
  /*
   Bytes from one element to the next.
   */
  uint32_t stride;
} pullout_derived_output_table;

/*
 `validate(props, nprops, characteristic_length, message, capacity)` → PULLOUT_VALIDATION_…; writes a
 NUL-terminated UTF-8 message into `message` (capacity ≥ 512 bytes) unless OK.
 `characteristic_length` ≤ 0 or NaN: none is known.
 */
typedef int32_t (*pullout_validate)(const double *props,
                                    int32_t nprops,
                                    double characteristic_length,
                                    char *message,
                                    size_t capacity);

/*
 The description of one law in a library.
 */
typedef struct pullout_plugin {
  /*
   PULLOUT_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   Bytes of this struct as the library knows it.
   */
  uint32_t struct_size;
  /*
   Law name.
   */
  const char *law;
  /*
   Version of the plugin.
   */
  const char *version;
  /*
   One sentence.
   */
  const char *description;
  /*
   PULLOUT_KIND_….
   */
  uint32_t kinds;
  /*
   PULLOUT_STRESS_STATE_….
   */
  uint32_t stress_states;
  /*
   PULLOUT_FLAG_….
   */
  uint32_t flags;
  /*
   1 if `repeating` is meant.
   */
  uint32_t has_repeating;
  /*
   PROPS.
   */
  struct pullout_parameter_table parameters;
  /*
   A group of parameters at the end of PROPS.
   */
  struct pullout_repeating_group repeating;
  /*
   STATEV.
   */
  struct pullout_state_variable_table states;
  /*
   Derived outputs.
   */
  struct pullout_derived_output_table derived;
  /*
   Checks parameters.
   */
  pullout_validate validate;
  /*
   The next law of a library with several, or NULL.
   */
  const struct pullout_plugin *next;
  /*
   Unused, NULL.
   */
  const void *reserved;
} pullout_plugin;

#ifdef __cplusplus
extern "C" {
#endif /* __cplusplus */

/*
 The description of the first law of a library; further ones follow by `next`.
 */
const struct pullout_plugin *pullout_plugin_v1(void);

/*
 `pullout_umat_batch_v1`: UMAT for `n` points with the same parameters, to the same bits as `n` calls of `umat_` with
 DROT = 1. Arrays hold `n` values of the first component, then `n` of the second, and so on: `strain` (at the start),
 `dstrain` and `stress` for `ntens` components, `statev` for `nstatv`, `ddsdde` for `ntens`·`ntens` (column by column; NULL:
 stress only). `celent` has `n` values or is NULL; `status` has `n`: PULLOUT_BATCH_RESULT_…. No allocation; any thread.

 In libraries of one law; where several are linked, or the library of all laws, `<law>_umat_batch_v1` is the name.
 */
void pullout_umat_batch_v1(size_t n,
                           int32_t ntens,
                           int32_t ndi,
                           const double *props,
                           int32_t nprops,
                           const double *strain,
                           const double *dstrain,
                           double *stress,
                           double *statev,
                           int32_t nstatv,
                           double *ddsdde,
                           const double *celent,
                           int32_t *status);

/*
 `umat_` as gfortran compiles it on Linux.
 The arguments of UMAT in order. Arrays are Fortran arrays: DDSDDE(NTENS,NTENS) column-major.

 - stress(ntens): in: stress at the start, rotated by the host; out: at the end.
 - statev(nstatv): state variables, all 0 in the virgin state.
 - ddsdde(ntens,ntens): out: consistent tangent, engineering shear; NULL: not requested.
 - sse: out: stored energy per volume.
 - spd: out: dissipated energy per volume.
 - scd: out: energy dissipated by creep per volume; our laws return 0.
 - rpl: out: heat generation per volume and time; 0 on entry, written by coupled laws only.
 - ddsddt(ntens): out: d stress / d temperature; 0 on entry, written by coupled laws only.
 - drplde(ntens): out: d RPL / d strain, engineering shear; 0 on entry, written by coupled laws only.
 - drpldt: out: d RPL / d temperature; 0 on entry, written by coupled laws only.
 - stran(ntens): total strain at the start, engineering shear.
 - dstran(ntens): strain increment.
 - time(2): step time and total time at the start.
 - dtime: time increment.
 - temp: temperature at the start.
 - dtemp: temperature increment.
 - predef(*): field variables at the start.
 - dpred(*): increments of the field variables.
 - cmname(80): material name, blank-padded.
 - ndi: number of direct components.
 - nshr: number of shear components.
 - ntens: number of components: 11, 22, 33, 12, 13, 23.
 - nstatv: number of state variables.
 - props(nprops): parameters.
 - nprops: number of parameters.
 - coords(3): coordinates of the point.
 - drot(3,3): incremental rotation.
 - pnewdt: out on failure: requested fraction of the increment, in (0,1).
 - celent: characteristic element length.
 - dfgrd0(3,3): deformation gradient at the start.
 - dfgrd1(3,3): deformation gradient at the end.
 - noel: element number.
 - npt: integration point.
 - layer: layer.
 - kspt: section point.
 - jstep(4): step number, procedure, NLGEOM, linear perturbation.
 - kinc: increment number.
 - cmname_length: hidden CHARACTER length.
 */
void umat_(double *stress,
           double *statev,
           double *ddsdde,
           double *sse,
           double *spd,
           double *scd,
           double *rpl,
           double *ddsddt,
           double *drplde,
           double *drpldt,
           const double *stran,
           const double *dstran,
           const double *time,
           const double *dtime,
           const double *temp,
           const double *dtemp,
           const double *predef,
           const double *dpred,
           const char *cmname,
           const int32_t *ndi,
           const int32_t *nshr,
           const int32_t *ntens,
           const int32_t *nstatv,
           const double *props,
           const int32_t *nprops,
           const double *coords,
           const double *drot,
           double *pnewdt,
           const double *celent,
           const double *dfgrd0,
           const double *dfgrd1,
           const int32_t *noel,
           const int32_t *npt,
           const int32_t *layer,
           const int32_t *kspt,
           const int32_t *jstep,
           const int32_t *kinc,
           size_t cmname_length);

/*
 `fric_` as gfortran compiles it on Linux.
 The arguments of FRIC in order.

 - lm: LM: on entry 0 slipping, 1 sticking, 2 open; on return 0: TAU, DDTDDG, DDTDDP, DSLIP are given.
 - tau(nfdir): shear traction.
 - ddtddg(nfdir,nfdir): out: d tau / d slip.
 - ddtddp(nfdir): out: d tau / d pressure.
 - dslip(nfdir): out: inelastic slip increment.
 - sed: out: stored energy per area.
 - sfd: out: dissipated energy per area.
 - ddtddt(nfdir,2): d tau / d temperature of the two surfaces; our laws do not write it.
 - pnewdt: out on failure: requested fraction of the increment, in (0,1).
 - statev(nstatv): state variables, all 0 in the virgin state.
 - dgam(nfdir): slip increment.
 - taulm(nfdir): constraint traction of the sticking point.
 - press: pressure at the end, positive in compression.
 - dpress: pressure increment.
 - ddpddh: d pressure / d overclosure.
 - slip(nfdir): inelastic slip at the start.
 - kstep: step number.
 - kinc: increment number.
 - time(2): step time and total time at the end.
 - dtime: time increment.
 - noel: element number.
 - ciname(80): name of the interaction property, blank-padded.
 - slname(80): slave surface.
 - msname(80): master surface.
 - npt: contact point.
 - node: slave node.
 - npatch: master patch.
 - coords(mcrd): coordinates of the point.
 - rcoord(mcrd): projection of the point on the master surface.
 - drot(2,2): incremental rotation of the tangential directions.
 - temp(2): temperatures of the two surfaces.
 - predef(2,*): field variables of the two surfaces.
 - nfdir: number of tangential directions.
 - mcrd: number of coordinates.
 - npred: number of field variables.
 - nstatv: number of state variables.
 - chrlngth: characteristic element length.
 - props(nprops): parameters.
 - nprops: number of parameters.
 - ciname_length: hidden CHARACTER length.
 - slname_length: hidden CHARACTER length.
 - msname_length: hidden CHARACTER length.
 */
void fric_(int32_t *lm,
           double *tau,
           double *ddtddg,
           double *ddtddp,
           double *dslip,
           double *sed,
           double *sfd,
           double *ddtddt,
           double *pnewdt,
           double *statev,
           const double *dgam,
           const double *taulm,
           const double *press,
           const double *dpress,
           const double *ddpddh,
           const double *slip,
           const int32_t *kstep,
           const int32_t *kinc,
           const double *time,
           const double *dtime,
           const int32_t *noel,
           const char *ciname,
           const char *slname,
           const char *msname,
           const int32_t *npt,
           const int32_t *node,
           const int32_t *npatch,
           const double *coords,
           const double *rcoord,
           const double *drot,
           const double *temp,
           const double *predef,
           const int32_t *nfdir,
           const int32_t *mcrd,
           const int32_t *npred,
           const int32_t *nstatv,
           const double *chrlngth,
           const double *props,
           const int32_t *nprops,
           size_t ciname_length,
           size_t slname_length,
           size_t msname_length);

/*
 `uinter_` as gfortran compiles it on Linux.
 The arguments of UINTER in order.

 - stress(ndir): traction; (1) is normal, positive in compression.
 - ddsddr(ndir,ndir): out: d traction / d relative displacement.
 - dviscous(ndir,ndir): viscous damping; our laws do not write it.
 - dstructural(ndir,ndir): structural damping; our laws do not write it.
 - flux(2): heat fluxes; our laws do not write them.
 - ddfddt(2,2): d flux / d temperature; our laws do not write it.
 - ddsddt(ndir,2): d traction / d temperature; our laws do not write it.
 - ddfddr(2,ndir): d flux / d relative displacement; our laws do not write it.
 - statev(nstatv): state variables, all 0 in the virgin state.
 - sed: out: stored energy per area.
 - sfd: out: dissipated energy per area.
 - spd: out: energy dissipated by plasticity per area; our laws return 0.
 - svd: out: energy dissipated by viscosity per area; our laws return 0.
 - scd: out: energy dissipated by creep per area; our laws return 0.
 - pnewdt: out on failure: requested fraction of the increment, in (0,1).
 - rdisp(ndir): relative displacement at the end; (1) positive is penetration.
 - drdisp(ndir): increment of the relative displacement.
 - temp(2): temperatures of the two surfaces at the end.
 - dtemp(2): temperature increments of the two surfaces.
 - predef(2,npred): field variables at the end.
 - dpred(2,npred): increments of the field variables.
 - time(2): step time and total time at the end.
 - dtime: time increment.
 - freqr: frequency.
 - ciname(80): name of the interaction property, blank-padded.
 - slname(80): slave surface.
 - msname(80): master surface.
 - props(nprops): parameters.
 - coords(mcrd): coordinates of the point.
 - alocaldir(mcrd,mcrd): local directions; the first is the normal.
 - drot(2,2): incremental rotation of the tangential directions.
 - area: area of the point.
 - chrlngth: characteristic element length.
 - node: slave node.
 - ndir: number of directions, normal included.
 - nstatv: number of state variables.
 - npred: number of field variables.
 - nprops: number of parameters.
 - mcrd: number of coordinates.
 - kstep: step number.
 - kinc: increment number.
 - kit: iteration number.
 - linper: 1 in a linear perturbation step.
 - lopenclose: contact state of the point; -1 at the start.
 - lstate: the law's own flag; -1 at the start.
 - lsdi: set to 1 to ask for a severe discontinuity iteration.
 - lprint: 1: messages are requested.
 - ciname_length: hidden CHARACTER length.
 - slname_length: hidden CHARACTER length.
 - msname_length: hidden CHARACTER length.
 */
void uinter_(double *stress,
             double *ddsddr,
             double *dviscous,
             double *dstructural,
             double *flux,
             double *ddfddt,
             double *ddsddt,
             double *ddfddr,
             double *statev,
             double *sed,
             double *sfd,
             double *spd,
             double *svd,
             double *scd,
             double *pnewdt,
             const double *rdisp,
             const double *drdisp,
             const double *temp,
             const double *dtemp,
             const double *predef,
             const double *dpred,
             const double *time,
             const double *dtime,
             const double *freqr,
             const char *ciname,
             const char *slname,
             const char *msname,
             const double *props,
             const double *coords,
             const double *alocaldir,
             const double *drot,
             const double *area,
             const double *chrlngth,
             const int32_t *node,
             const int32_t *ndir,
             const int32_t *nstatv,
             const int32_t *npred,
             const int32_t *nprops,
             const int32_t *mcrd,
             const int32_t *kstep,
             const int32_t *kinc,
             const int32_t *kit,
             const int32_t *linper,
             int32_t *lopenclose,
             int32_t *lstate,
             int32_t *lsdi,
             const int32_t *lprint,
             size_t ciname_length,
             size_t slname_length,
             size_t msname_length);

#ifdef __cplusplus
}  // extern "C"
#endif  /* __cplusplus */

#endif  /* PULLOUT_UMAT_H */
