//! The data that a library keeps between calls: SAVE variables, COMMON blocks, C statics.

use super::discovery::real_path;
use super::library::Library;
use std::ffi::{CStr, c_int, c_void};
use std::path::Path;

/// Writable memory of a loaded library.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DataSnapshot {
    /// Address in the file (as symbols have it), and the bytes there.
    segments: Vec<(u64, Vec<u8>)>,
}

impl DataSnapshot {
    /// Returns the present contents of the library's writable segments; empty where the system does not reveal their
    /// places. No call of the library may be under way.
    pub fn of(library: &Library) -> Self {
        let mut search: Search<'_> = (library.path(), Self::default());
        // SAFETY: the visitor is called before this returns, with the pointer given here.
        #[cfg(target_os = "linux")]
        unsafe {
            libc::dl_iterate_phdr(Some(visit), (&raw mut search).cast());
        }
        search.1
    }

    /// Addresses in the file whose bytes differ.
    pub fn differences(&self, other: &Self) -> Vec<u64> {
        let pairs = self.segments.iter().zip(&other.segments);
        pairs
            .flat_map(|((start, before), (_, after))| {
                let changed = before.iter().zip(after).enumerate().filter(|(_, (a, b))| a != b);
                changed.map(move |(offset, _)| start + offset as u64)
            })
            .collect()
    }
}

/// A library that is sought in the loader's list, and its data.
type Search<'p> = (&'p Path, DataSnapshot);

/// Returns whether the loader's name of a library is this file.
fn is_file(name: &CStr, file: &Path) -> bool {
    let name = Path::new(name.to_str().unwrap_or_default());
    !name.as_os_str().is_empty() && real_path(name) == real_path(file)
}

/// Visits a library of the loader's list: takes the data of the one that is sought.
#[cfg(target_os = "linux")]
unsafe extern "C" fn visit(info: *mut libc::dl_phdr_info, _size: usize, search: *mut c_void) -> c_int {
    // SAFETY: the loader passes a library's description; `search` is that of `of`.
    let (info, (path, found)) = unsafe { (&*info, &mut *search.cast::<Search<'_>>()) };
    // SAFETY: a C string, or NULL.
    if info.dlpi_name.is_null() || !is_file(unsafe { CStr::from_ptr(info.dlpi_name) }, path) {
        return 0;
    }
    for k in 0..usize::from(info.dlpi_phnum) {
        // SAFETY: one of the program headers.
        let header = unsafe { &*info.dlpi_phdr.add(k) };
        if header.p_type == libc::PT_LOAD && header.p_flags & libc::PF_W != 0 {
            let address = (info.dlpi_addr + header.p_vaddr) as usize;
            let memory = std::ptr::with_exposed_provenance::<u8>(address);
            // SAFETY: a loaded segment, which stays as long as the library; no call is under way.
            let bytes = unsafe { std::slice::from_raw_parts(memory, header.p_memsz as usize) }.to_vec();
            found.segments.push((header.p_vaddr, bytes));
        }
    }
    1
}
