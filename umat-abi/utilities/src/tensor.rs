//! SINV, SPRINC, SPRIND, ROTSIG.
//!
//! A tensor has NDI direct components 11, 22, 33 and then NSHR shear components 12, 13, 23; what it lacks is 0. LSTR
//! is 1 for a stress (tensor components) and 2 for a strain (engineering shear).
//!
//! A caller may have floating-point traps on; principal values are computed without.

use models::tensor::{Spectral, deviator, stress_norm_squared, trace};
use umat_abi::{in_default_environment, table::rotated};

/// LSTR of a strain.
const STRAIN: i32 = 2;

/// The six components of a tensor in memory.
///
/// # Safety
/// `tensor` points to `ndi + nshr` values.
unsafe fn components(tensor: *const f64, ndi: i32, nshr: i32) -> [f64; 6] {
    let mut components = [0.0; 6];
    for (place, target) in places(ndi, nshr) {
        // SAFETY: `place` is below NDI + NSHR.
        components[target] = unsafe { *tensor.add(place) };
    }
    components
}

/// Place in memory and among the six of each component.
fn places(ndi: i32, nshr: i32) -> impl Iterator<Item = (usize, usize)> {
    let count = |n: i32| usize::try_from(n.clamp(0, 3)).unwrap_or(0);
    let (direct, shear) = (count(ndi), count(nshr));
    (0..direct).map(|i| (i, i)).chain((0..shear).map(move |i| (direct + i, 3 + i)))
}

/// Principal values, descending, and directions as a right-handed triad.
///
/// # Safety
/// As for [`components`]; `lstr` can be read.
unsafe fn spectral(tensor: *const f64, lstr: *const i32, ndi: *const i32, nshr: *const i32) -> Spectral {
    // SAFETY: said above.
    let (components, lstr) = unsafe { (components(tensor, *ndi, *nshr), *lstr) };
    in_default_environment(|| {
        if lstr == STRAIN { Spectral::of_strain(&components) } else { Spectral::of_stress(&components) }
    })
}

/// SINV(STRESS,SINV1,SINV2,NDI,NSHR): SINV1 = tr σ/3, SINV2 = √(3/2 S:S) with the deviator S.
#[unsafe(no_mangle)]
unsafe extern "C" fn sinv_(stress: *const f64, sinv1: *mut f64, sinv2: *mut f64, ndi: *const i32, nshr: *const i32) {
    // SAFETY: the arguments are as the manual says.
    let stress = unsafe { components(stress, *ndi, *nshr) };
    // SAFETY: as above.
    unsafe {
        *sinv1 = trace(&stress) / 3.0;
        *sinv2 = (1.5 * stress_norm_squared(&deviator(&stress))).sqrt();
    }
}

/// SPRINC(S,PS,LSTR,NDI,NSHR): the three principal values PS.
#[unsafe(no_mangle)]
unsafe extern "C" fn sprinc_(s: *const f64, ps: *mut f64, lstr: *const i32, ndi: *const i32, nshr: *const i32) {
    // SAFETY: the arguments are as the manual says; PS has three values.
    unsafe { ps.copy_from_nonoverlapping(spectral(s, lstr, ndi, nshr).values.as_ptr(), 3) };
}

/// SPRIND(S,PS,AN,LSTR,NDI,NSHR): the principal values PS, and AN(K,1…3), the direction cosines of PS(K).
#[unsafe(no_mangle)]
unsafe extern "C" fn sprind_(
    s: *const f64,
    ps: *mut f64,
    an: *mut f64,
    lstr: *const i32,
    ndi: *const i32,
    nshr: *const i32,
) {
    // SAFETY: the arguments are as the manual says.
    let Spectral { values, directions: [a, b, c] } = unsafe { spectral(s, lstr, ndi, nshr) };
    // Callers use AN as a rotation.
    let triple = (0..3).map(|k| c[k] * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]));
    let third = if triple.sum::<f64>() < 0.0 { c.map(|cosine| -cosine) } else { c };
    for (k, direction) in [a, b, third].iter().enumerate() {
        for (i, cosine) in direction.iter().enumerate() {
            // SAFETY: AN is 3 × 3, column-major.
            unsafe { *an.add(3 * i + k) = *cosine };
        }
    }
    // SAFETY: PS has three values.
    unsafe { ps.copy_from_nonoverlapping(values.as_ptr(), 3) };
}

/// ROTSIG(S,R,SPRIME,LSTR,NDI,NSHR): S' = R S Rᵀ. S and SPRIME may be one array.
#[unsafe(no_mangle)]
unsafe extern "C" fn rotsig_(
    s: *const f64,
    r: *const f64,
    sprime: *mut f64,
    lstr: *const i32,
    ndi: *const i32,
    nshr: *const i32,
) {
    // SAFETY: the arguments are as the manual says.
    let (ndi, nshr, lstr) = unsafe { (*ndi, *nshr, *lstr) };
    // SAFETY: as above.
    let given = unsafe { components(s, ndi, nshr) };
    // SAFETY: R is 3 × 3, column-major.
    let rotation = std::array::from_fn(|i| std::array::from_fn(|j| unsafe { *r.add(3 * j + i) }));
    let rotated = rotated(&given, &rotation, if lstr == STRAIN { 2.0 } else { 1.0 });
    for (place, source) in places(ndi, nshr) {
        // SAFETY: SPRIME has NDI + NSHR values.
        unsafe { *sprime.add(place) = rotated[source] };
    }
}
