//! No law allocates in a call: counted by this program's own allocator, below the boundary of `umat_`.

use end_to_end_tests::{PointMemory, Sample, sample, strain_path};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use umat_abi::export::umat;
use umat_abi::umat::UmatArguments;

/// The system's allocator with a count of what the current thread asks of it.
struct Counting;

thread_local! {
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    REQUESTS.with(|requests| requests.set(requests.get() + 1));
}

// SAFETY: every request is passed on to the system's allocator; counting neither allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: forwarded to the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: forwarded to the caller.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: forwarded to the caller.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: forwarded to the caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn requests() -> u64 {
    REQUESTS.with(Cell::get)
}

/// The boundary of one law.
type Boundary = unsafe fn(&UmatArguments);

macro_rules! entries {
    (umat: [$($law:ty => $name:literal,)+], $($interface:tt)*) => {
        &[$(($name, umat::<$law>)),+]
    };
}

/// The boundary of every law, called directly: a plugin has an allocator of its own, which this program cannot count.
const ENTRIES: &[(&str, Boundary)] = models::laws!(entries);

#[test]
fn the_count_counts() {
    let before = requests();
    drop(std::hint::black_box(vec![0_u8; 64]));
    assert_eq!(requests() - before, 2);
}

#[test]
fn ten_thousand_calls_allocate_nothing() {
    for (name, entry) in ENTRIES {
        let law = sample(name);
        for stress_state in Sample::STRESS_STATES {
            let mut point = PointMemory::new(law, stress_state);
            let path = strain_path(17, point.ntens(), law.strain, 10_000);
            let before = requests();
            for increment in &path {
                point.dstran = *increment;
                // SAFETY: the point's own memory.
                unsafe { entry(&point.arguments()) };
                for (total, step) in point.stran.iter_mut().zip(increment) {
                    *total += step;
                }
            }
            assert_eq!(requests() - before, 0, "{name}");
            assert!(point.stress().iter().all(|stress| stress.is_finite()), "{name}");
            cut_backs_allocate_nothing(&mut point, *entry);
        }
    }
}

/// An increment that cannot be computed is as quiet.
fn cut_backs_allocate_nothing(point: &mut PointMemory, entry: Boundary) {
    point.dstran[0] = f64::NAN;
    let before = requests();
    for _ in 0..1000 {
        // SAFETY: the point's own memory.
        unsafe { entry(&point.arguments()) };
    }
    assert_eq!(requests() - before, 0);
    assert_eq!(point.pnewdt, 0.5);
}
