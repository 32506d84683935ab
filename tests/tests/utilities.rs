//! The utility routines against their manual's definitions, called as Fortran calls them: everything by reference, then the
//! CHARACTER lengths. (From Fortran itself, and what they print: `driver/tests/foreign/utilities.rs`.)

use end_to_end_tests::{Random, Tool, find, plugin, run};
use libloading::Library;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, Ordering};

/// Exports of the library: no others may be in the way of a plugin's own symbols.
const EXPORTS: [&str; 83] = [
    "SMAFloatArrayAccess",
    "SMAFloatArrayCreate",
    "SMAFloatArrayDelete",
    "SMAFloatArraySize",
    "SMAIntArrayAccess",
    "SMAIntArrayCreate",
    "SMAIntArrayDelete",
    "SMAIntArraySize",
    "SMALocalFloatArrayAccess",
    "SMALocalFloatArrayCreate",
    "SMALocalFloatArrayDelete",
    "SMALocalFloatArraySize",
    "SMALocalIntArrayAccess",
    "SMALocalIntArrayCreate",
    "SMALocalIntArrayDelete",
    "SMALocalIntArraySize",
    "SMALocalRealArrayAccess",
    "SMALocalRealArrayCreate",
    "SMALocalRealArrayDelete",
    "SMALocalRealArraySize",
    "SMARealArrayAccess",
    "SMARealArrayCreate",
    "SMARealArrayDelete",
    "SMARealArraySize",
    "getNumThreads",
    "get_thread_id",
    "get_thread_id_",
    "getcommunicator_",
    "getjobname_",
    "getnumcpus_",
    "getnumthreads_",
    "getoutdir_",
    "getparametertable_",
    "getparametertablerow_",
    "getpartinfo_",
    "getpropertytable_",
    "getrank_",
    "getvrm_",
    "mutexinit_",
    "mutexlock_",
    "mutexunlock_",
    "pullout_utilities_job_v1",
    "queryparametertable_",
    "querypropertytable_",
    "querytablecollectionnames_",
    "querytablecollectionsize_",
    "rotsig_",
    "settablecollection_",
    "sinv_",
    "smafloatarrayaccess_",
    "smafloatarraycreate_",
    "smafloatarraycreatedp_",
    "smafloatarraycreatesp_",
    "smafloatarraydelete_",
    "smafloatarraysize_",
    "smaintarrayaccess_",
    "smaintarraycreate_",
    "smaintarraydelete_",
    "smaintarraysize_",
    "smalocalfloatarrayaccess_",
    "smalocalfloatarraycreate_",
    "smalocalfloatarraycreatedp_",
    "smalocalfloatarraycreatesp_",
    "smalocalfloatarraydelete_",
    "smalocalfloatarraysize_",
    "smalocalintarrayaccess_",
    "smalocalintarraycreate_",
    "smalocalintarraydelete_",
    "smalocalintarraysize_",
    "smalocalrealarrayaccess_",
    "smalocalrealarraycreatedp_",
    "smalocalrealarraycreatesp_",
    "smalocalrealarraydelete_",
    "smalocalrealarraysize_",
    "smarealarrayaccess_",
    "smarealarraycreatedp_",
    "smarealarraycreatesp_",
    "smarealarraydelete_",
    "smarealarraysize_",
    "sprinc_",
    "sprind_",
    "stdb_abqerr_",
    "xit_",
];

const STRESS: i32 = 1;
const STRAIN: i32 = 2;

/// Never unloaded, as by the host: threads that took a lock know it to their end.
fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    // SAFETY: our own library.
    LIBRARY.get_or_init(|| unsafe { Library::new(plugin("pullout_utilities")) }.expect("a library that Cargo built"))
}

/// A routine by its name.
///
/// # Safety
/// `F` is its type.
unsafe fn routine<'l, F>(library: &'l Library, name: &str) -> libloading::Symbol<'l, F> {
    // SAFETY: forwarded to the caller.
    unsafe { library.get(name) }.unwrap_or_else(|error| panic!("{name}: {error}"))
}

type Sinv = unsafe extern "C" fn(*const f64, *mut f64, *mut f64, *const i32, *const i32);
type Sprinc = unsafe extern "C" fn(*const f64, *mut f64, *const i32, *const i32, *const i32);
type Sprind = unsafe extern "C" fn(*const f64, *mut f64, *mut f64, *const i32, *const i32, *const i32);
type Rotsig = unsafe extern "C" fn(*const f64, *const f64, *mut f64, *const i32, *const i32, *const i32);

/// (NDI, NSHR) of 3-D, plane strain, plane stress.
const COUNTS: [(i32, i32); 3] = [(3, 3), (3, 1), (2, 1)];

/// The matrix of NDI direct and NSHR shear components, in whatever representation.
fn matrix(components: &[f64], ndi: i32, shear_share: f64) -> [[f64; 3]; 3] {
    let mut m = [[0.0; 3]; 3];
    let (direct, shear) = components.split_at(ndi as usize);
    direct.iter().enumerate().for_each(|(i, value)| m[i][i] = *value);
    for (&(i, j), value) in [(0, 1), (0, 2), (1, 2)].iter().zip(shear) {
        (m[i][j], m[j][i]) = (shear_share * value, shear_share * value);
    }
    m
}

fn share(lstr: i32) -> f64 {
    if lstr == STRAIN { 0.5 } else { 1.0 }
}

/// Random tensors of every size, as stresses and strains.
fn for_each_tensor(mut check: impl FnMut(&[f64], i32, i32, i32)) {
    let mut random = Random::new(7);
    for (ndi, nshr) in COUNTS {
        for lstr in [STRESS, STRAIN] {
            for _ in 0..200 {
                let tensor: Vec<f64> = (0..ndi + nshr).map(|_| 100.0 * random.signed()).collect();
                check(&tensor, lstr, ndi, nshr);
            }
        }
    }
}

/// Largest relative error of eigenvalues of tensors of size 100, and of rotations: rounding of some ten operations.
const ROUNDING: f64 = 1e-12;

#[test]
fn it_exports_the_routines_and_nothing_else() {
    let Some(mut nm) = find(Tool::Nm) else { return };
    let output = run(nm.args(["-D", "--defined-only", "--format=just-symbols"]).arg(plugin("pullout_utilities")));
    let text = String::from_utf8(output.stdout).expect("symbols");
    let mut found: Vec<&str> = text.split_whitespace().collect();
    found.sort_unstable();
    assert_eq!(found, EXPORTS);
}

#[test]
fn sinv_gives_mean_stress_and_mises_stress() {
    let library = library();
    // SAFETY: the routine's type.
    let sinv = unsafe { routine::<Sinv>(library, "sinv_") };
    let invariants = |stress: &[f64], ndi: i32, nshr: i32| {
        let (mut first, mut second) = (f64::NAN, f64::NAN);
        // SAFETY: NDI + NSHR values.
        unsafe { sinv(stress.as_ptr(), &mut first, &mut second, &ndi, &nshr) };
        (first, second)
    };
    // uniaxial tension, pure shear, hydrostatic pressure
    assert_eq!(invariants(&[300.0, 0.0, 0.0, 0.0, 0.0, 0.0], 3, 3), (100.0, 300.0));
    let (first, second) = invariants(&[0.0, 0.0, 0.0, 0.0, 0.0, 7.0], 3, 3);
    assert!(first == 0.0 && (second - 7.0 * 3.0_f64.sqrt()).abs() < ROUNDING);
    assert_eq!(invariants(&[-5.0, -5.0, -5.0, 0.0], 3, 1), (-5.0, 0.0));
    assert_eq!(invariants(&[30.0, 0.0, 0.0], 2, 1), (10.0, 30.0));
    // √(3/2 S:S) = √(½((σ11−σ22)² + …) + 3(σ12² + …))
    for_each_tensor(|stress, lstr, ndi, nshr| {
        if lstr != STRESS {
            return;
        }
        let [[a, d, e], [_, b, f], [_, _, c]] = matrix(stress, ndi, 1.0);
        let differences = (a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2);
        let mises = (0.5 * differences + 3.0 * (d * d + e * e + f * f)).sqrt();
        let (first, second) = invariants(stress, ndi, nshr);
        assert!((first - (a + b + c) / 3.0).abs() < 100.0 * ROUNDING);
        assert!((second - mises).abs() < ROUNDING * mises);
    });
}

#[test]
fn sprind_gives_principal_values_with_their_directions_and_sprinc_the_values() {
    let library = library();
    // SAFETY: the routines' types.
    let (sprinc, sprind) = unsafe { (routine::<Sprinc>(library, "sprinc_"), routine::<Sprind>(library, "sprind_")) };
    let decomposed = |tensor: &[f64], lstr: i32, ndi: i32, nshr: i32| {
        let (mut alone, mut values, mut cosines) = ([f64::NAN; 3], [f64::NAN; 3], [f64::NAN; 9]);
        // SAFETY: NDI + NSHR values; PS(3), AN(3,3).
        unsafe {
            sprinc(tensor.as_ptr(), alone.as_mut_ptr(), &lstr, &ndi, &nshr);
            sprind(tensor.as_ptr(), values.as_mut_ptr(), cosines.as_mut_ptr(), &lstr, &ndi, &nshr);
        }
        assert_eq!(alone, values);
        // AN(K,I), column-major
        (values, std::array::from_fn::<[f64; 3], 3, _>(|k| std::array::from_fn(|i| cosines[3 * i + k])))
    };
    for_each_tensor(|tensor, lstr, ndi, nshr| {
        let m = matrix(tensor, ndi, share(lstr));
        let (values, directions) = decomposed(tensor, lstr, ndi, nshr);
        for (value, n) in values.iter().zip(&directions) {
            for i in 0..3 {
                let image: f64 = (0..3).map(|j| m[i][j] * n[j]).sum();
                assert!((image - value * n[i]).abs() < 200.0 * ROUNDING, "{tensor:?}: {value}, {n:?}");
            }
        }
        for k in 0..3 {
            let [a, b] = [directions[k], directions[(k + 1) % 3]];
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            for i in 0..3 {
                assert!((cross[i] - directions[(k + 2) % 3][i]).abs() < ROUNDING, "right-handed: {directions:?}");
            }
        }
    });
    // pure shear of γ = 2e-3: ±1e-3 at 45°; of σ12 = 2: ±2
    let (values, directions) = decomposed(&[0.0, 0.0, 0.0, 2e-3, 0.0, 0.0], STRAIN, 3, 3);
    assert!((values[0] - 1e-3).abs() < 1e-18 && values[1] == 0.0 && (values[2] + 1e-3).abs() < 1e-18);
    assert!((directions[0][0].abs() - 0.5_f64.sqrt()).abs() < ROUNDING && directions[0][2] == 0.0);
    assert_eq!(decomposed(&[0.0, 0.0, 2.0], STRESS, 2, 1).0.map(f64::round), [2.0, 0.0, -2.0]);
}

#[test]
fn rotsig_turns_a_tensor() {
    let library = library();
    // SAFETY: the routine's type.
    let rotsig = unsafe { routine::<Rotsig>(library, "rotsig_") };
    let turned = |tensor: &[f64], r: &[[f64; 3]; 3], lstr: i32, ndi: i32, nshr: i32| {
        let columns: Vec<f64> = (0..9).map(|k| r[k % 3][k / 3]).collect();
        let mut result = vec![f64::NAN; tensor.len()];
        // SAFETY: NDI + NSHR values twice; R(3,3).
        unsafe { rotsig(tensor.as_ptr(), columns.as_ptr(), result.as_mut_ptr(), &lstr, &ndi, &nshr) };
        result
    };
    // a quarter turn about axis 3 takes 1 to 2 and 2 to −1
    let quarter = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for lstr in [STRESS, STRAIN] {
        assert_eq!(turned(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &quarter, lstr, 3, 3), [2.0, 1.0, 3.0, -4.0, -6.0, 5.0]);
        assert_eq!(turned(&[1.0, 2.0, 4.0], &quarter, lstr, 2, 1), [2.0, 1.0, -4.0]);
    }
    // any rotation about axis 3, which works for all sizes: R S Rᵀ written out
    let (sine, cosine) = 0.7_f64.sin_cos();
    let r = [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
    for_each_tensor(|tensor, lstr, ndi, nshr| {
        let s = matrix(tensor, ndi, share(lstr));
        let found = matrix(&turned(tensor, &r, lstr, ndi, nshr), ndi, share(lstr));
        for i in 0..3 {
            for j in 0..3 {
                let sum: f64 = (0..9).map(|k| r[i][k / 3] * s[k / 3][k % 3] * r[j][k % 3]).sum();
                assert!((found[i][j] - sum).abs() < 100.0 * ROUNDING, "{tensor:?}");
            }
        }
    });
}

#[test]
fn the_run_is_described() {
    type Name = unsafe extern "C" fn(*mut u8, *mut i32, usize);
    type Job = unsafe extern "C" fn(*const u8, usize, *const u8, usize);
    type Number = unsafe extern "C" fn(*mut i32);
    let library = library();
    // SAFETY: the routines' types, and memory as their manual says.
    unsafe {
        let name = |routine_name: &str| {
            let (mut text, mut length) = ([0_u8; 256], -1);
            routine::<Name>(library, routine_name)(text.as_mut_ptr(), &mut length, text.len());
            let text = String::from_utf8(text.to_vec()).expect("text");
            assert_eq!(text.trim_end().len(), length as usize, "blank-padded");
            text.trim_end().to_owned()
        };
        assert_eq!(name("getjobname_"), "pullout");
        assert_eq!(name("getoutdir_"), std::env::current_dir().expect("a folder").to_string_lossy());
        routine::<Job>(library, "pullout_utilities_job_v1")("karsan".as_ptr(), 6, "/out/karsan".as_ptr(), 11);
        assert_eq!((name("getjobname_"), name("getoutdir_")), ("karsan".into(), "/out/karsan".into()));
        for (routine_name, expected) in [("getrank_", 0), ("getnumcpus_", 1)] {
            let mut number = -1;
            routine::<Number>(library, routine_name)(&mut number);
            assert_eq!(number, expected, "{routine_name}");
        }
    }
}

#[test]
fn there_are_no_part_instances_and_no_output_variables() {
    type GetPartInfo = unsafe extern "C" fn(*const i32, *const i32, *mut u8, *mut i32, *mut i32, usize);
    type Variable = unsafe extern "C" fn(
        *const u8,
        *mut f64,
        *mut i32,
        *mut u8,
        *mut i32,
        *const i32,
        *const i32,
        *const i32,
        *const i32,
        usize,
        usize,
    );
    let library = library();
    let (zero, mut code) = (0, -1);
    // SAFETY: the routines' types, and memory as their manual says.
    unsafe {
        let part = routine::<GetPartInfo>(library, "getpartinfo_");
        for (number, kind, expected) in [(12, 1, (12, 0)), (3, 0, (3, 0)), (0, 1, (0, 1)), (4, 2, (0, 1))] {
            let (mut name, mut local) = ([b'x'; 80], -1);
            part(&number, &kind, name.as_mut_ptr(), &mut local, &mut code, name.len());
            assert_eq!(((local, code), name), (expected, [b' '; 80]));
        }
        let (mut array, mut integers, mut flags) = ([9.0; 15], [9; 15], [b'x'; 45]);
        let variable = routine::<Variable>(library, "getvrm_");
        let (a, j, f) = (array.as_mut_ptr(), integers.as_mut_ptr(), flags.as_mut_ptr());
        variable(b"S".as_ptr(), a, j, f, &mut code, &zero, &zero, &zero, &zero, 1, 3);
        assert_eq!((array, integers, code), ([0.0; 15], [0; 15], 1));
        assert_eq!(flags, *b"N/A".repeat(15));
    }
}

#[test]
fn a_mutex_admits_one_thread() {
    type Mutex = unsafe extern "C" fn(*const i32);
    const ROUNDS: i32 = 2000;
    let library = library();
    // SAFETY: the routines' types.
    let [init, lock, unlock] =
        ["mutexinit_", "mutexlock_", "mutexunlock_"].map(|name| unsafe { routine::<Mutex>(library, name) });
    let id = 100;
    let value = AtomicI32::new(0);
    // SAFETY: the ID as the manual says.
    unsafe { init(&id) };
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                for _ in 0..ROUNDS {
                    // SAFETY: as above. What is read and then written is changed by nobody in between.
                    unsafe { lock(&id) };
                    let before = value.load(Ordering::Relaxed);
                    std::hint::spin_loop();
                    value.store(before + 1, Ordering::Relaxed);
                    // SAFETY: as above.
                    unsafe { unlock(&id) };
                }
            });
        }
    });
    assert_eq!(value.into_inner(), 3 * ROUNDS);
    // numbers that no mutex has are refused, and a thread does not wait for itself
    for id in [0, 101, -1] {
        // SAFETY: an ID is read.
        unsafe { (lock(&id), unlock(&id)) };
    }
    // SAFETY: as above.
    unsafe { (lock(&id), lock(&id), unlock(&id)) };
}
