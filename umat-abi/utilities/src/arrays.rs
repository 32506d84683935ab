//! `SMAIntArrayCreate` and its kin: arrays that routines make, and find again by a number.
//!
//! Global arrays are the process's, local ones a thread's. An array of one kind and one of another may have the same
//! number. `Create` of an array that is there changes its size and keeps what fits. Fortran passes numbers by reference,
//! C by value.

use crate::messages::say;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ptr;
use std::sync::{Mutex, PoisonError};

/// Type of an array's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Int,
    Float,
    Real,
}

/// A value at the start, by its bits.
#[derive(Clone, Copy)]
enum Start {
    Four(u32),
    Eight(u64),
}

impl Start {
    fn int(value: i32) -> Self {
        Self::Four(value.cast_unsigned())
    }
}

/// Value of integers that are given none.
const NO_INTEGER: i32 = i32::MAX;
/// Value of reals that are given none: a signalling NaN.
const NO_REAL: Start = Start::Eight(0x7ff4_0000_0000_0000);

/// Memory in units of 64 bits, whatever is in it.
#[derive(Default)]
struct Array {
    memory: Vec<u64>,
    size: i32,
}

type Arrays = BTreeMap<(Kind, i32), Array>;

static GLOBAL: Mutex<Arrays> = Mutex::new(BTreeMap::new());
thread_local! {
    static LOCAL: RefCell<Arrays> = const { RefCell::new(BTreeMap::new()) };
}

/// Owner of an array.
#[derive(Clone, Copy)]
enum Scope {
    Global,
    Local,
}

fn with<R>(scope: Scope, work: impl FnOnce(&mut Arrays) -> R) -> R {
    match scope {
        Scope::Global => work(&mut GLOBAL.lock().unwrap_or_else(PoisonError::into_inner)),
        Scope::Local => LOCAL.with_borrow_mut(work),
    }
}

/// The array's address; NULL if there can be none.
fn create(scope: Scope, kind: Kind, id: i32, size: i32, start: Start) -> *mut c_void {
    let Ok(length) = usize::try_from(size) else {
        say(&format!("***ERROR: an array of {size} values was asked for (SMA…ArrayCreate, ID {id})"));
        return ptr::null_mut();
    };
    with(scope, |arrays| {
        let array = arrays.entry((kind, id)).or_default();
        let kept = usize::try_from(array.size).unwrap_or_default();
        // an address also for an array without values
        array.memory.resize(length.max(1), 0);
        array.size = size;
        let memory = array.memory.as_mut_ptr();
        for k in kept..length {
            // SAFETY: entry `k` of `length` units of 64 bits, in its first half or whole.
            unsafe {
                match start {
                    Start::Four(bits) => *memory.cast::<u32>().add(k) = bits,
                    Start::Eight(bits) => *memory.add(k) = bits,
                }
            }
        }
        memory.cast()
    })
}

fn access(scope: Scope, kind: Kind, id: i32) -> *mut c_void {
    with(scope, |arrays| arrays.get_mut(&(kind, id)).map_or(ptr::null_mut(), |array| array.memory.as_mut_ptr().cast()))
}

fn size(scope: Scope, kind: Kind, id: i32) -> i32 {
    with(scope, |arrays| arrays.get(&(kind, id)).map_or(0, |array| array.size))
}

fn delete(scope: Scope, kind: Kind, id: i32) {
    with(scope, |arrays| arrays.remove(&(kind, id)));
}

/// `Create` from Fortran; INITVAL is optional.
macro_rules! create_from_fortran {
    ($($name:ident: $scope:ident $kind:ident, $type:ty, $start:expr, $none:expr;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name(id: *const i32, size: *const i32, initval: *const $type) -> *mut c_void {
            // SAFETY: the arguments are as the manual says, an optional one that is not given is NULL.
            let (id, size, value) = unsafe { (*id, *size, initval.as_ref()) };
            create(Scope::$scope, Kind::$kind, id, size, value.map_or($none, |&value| $start(value)))
        }
    )*};
}

/// `Create` from C.
macro_rules! create_from_c {
    ($($name:ident: $scope:ident $kind:ident, $type:ty, $start:expr;)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $name(id: i32, size: i32, value: $type) -> *mut c_void {
            create(Scope::$scope, Kind::$kind, id, size, $start(value))
        }
    )*};
}

/// `Access`, `Size` and `Delete`, from Fortran and from C.
macro_rules! find {
    ($($scope:ident $kind:ident: $access:ident $access_c:ident $size:ident $size_c:ident $delete:ident $delete_c:ident;)*)
    => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $access(id: *const i32) -> *mut c_void {
            // SAFETY: the argument is as the manual says.
            access(Scope::$scope, Kind::$kind, unsafe { *id })
        }
        #[unsafe(no_mangle)]
        extern "C" fn $access_c(id: i32) -> *mut c_void {
            access(Scope::$scope, Kind::$kind, id)
        }
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $size(id: *const i32) -> i32 {
            // SAFETY: the argument is as the manual says.
            size(Scope::$scope, Kind::$kind, unsafe { *id })
        }
        #[unsafe(no_mangle)]
        extern "C" fn $size_c(id: i32) -> i32 {
            size(Scope::$scope, Kind::$kind, id)
        }
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $delete(id: *const i32) {
            // SAFETY: the argument is as the manual says.
            delete(Scope::$scope, Kind::$kind, unsafe { *id });
        }
        #[unsafe(no_mangle)]
        extern "C" fn $delete_c(id: i32) {
            delete(Scope::$scope, Kind::$kind, id);
        }
    )*};
}

/// A value of SMAFloatArrays in single precision: they hold double precision whatever they are given.
fn widened(value: f32) -> Start {
    double(f64::from(value))
}

/// A value of an SMARealArray in single precision, which is of that.
fn single(value: f32) -> Start {
    Start::Four(value.to_bits())
}

fn double(value: f64) -> Start {
    Start::Eight(value.to_bits())
}

create_from_fortran! {
    smaintarraycreate_: Global Int, i32, Start::int, Start::int(NO_INTEGER);
    smalocalintarraycreate_: Local Int, i32, Start::int, Start::int(NO_INTEGER);
    smafloatarraycreate_: Global Float, f64, double, NO_REAL;
    smalocalfloatarraycreate_: Local Float, f64, double, NO_REAL;
    smafloatarraycreatedp_: Global Float, f64, double, NO_REAL;
    smalocalfloatarraycreatedp_: Local Float, f64, double, NO_REAL;
    smafloatarraycreatesp_: Global Float, f32, widened, NO_REAL;
    smalocalfloatarraycreatesp_: Local Float, f32, widened, NO_REAL;
    smarealarraycreatedp_: Global Real, f64, double, NO_REAL;
    smalocalrealarraycreatedp_: Local Real, f64, double, NO_REAL;
    smarealarraycreatesp_: Global Real, f32, single, NO_REAL;
    smalocalrealarraycreatesp_: Local Real, f32, single, NO_REAL;
}

create_from_c! {
    SMAIntArrayCreate: Global Int, i32, Start::int;
    SMALocalIntArrayCreate: Local Int, i32, Start::int;
    SMAFloatArrayCreate: Global Float, f64, double;
    SMALocalFloatArrayCreate: Local Float, f64, double;
    SMARealArrayCreate: Global Real, f64, double;
    SMALocalRealArrayCreate: Local Real, f64, double;
}

find! {
    Global Int: smaintarrayaccess_ SMAIntArrayAccess
        smaintarraysize_ SMAIntArraySize
        smaintarraydelete_ SMAIntArrayDelete;
    Global Float: smafloatarrayaccess_ SMAFloatArrayAccess
        smafloatarraysize_ SMAFloatArraySize
        smafloatarraydelete_ SMAFloatArrayDelete;
    Global Real: smarealarrayaccess_ SMARealArrayAccess
        smarealarraysize_ SMARealArraySize
        smarealarraydelete_ SMARealArrayDelete;
    Local Int: smalocalintarrayaccess_ SMALocalIntArrayAccess
        smalocalintarraysize_ SMALocalIntArraySize
        smalocalintarraydelete_ SMALocalIntArrayDelete;
    Local Float: smalocalfloatarrayaccess_ SMALocalFloatArrayAccess
        smalocalfloatarraysize_ SMALocalFloatArraySize
        smalocalfloatarraydelete_ SMALocalFloatArrayDelete;
    Local Real: smalocalrealarrayaccess_ SMALocalRealArrayAccess
        smalocalrealarraysize_ SMALocalRealArraySize
        smalocalrealarraydelete_ SMALocalRealArrayDelete;
}
