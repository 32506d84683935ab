//! Calls as CalculiX makes them of external behaviours: a copy of the library under a name in capitals, the symbol in
//! capitals, six components whatever the element, PNEWDT = -1, a number in place of JSTEP(4), its own name of the
//! material.

use crate::Loaded;
use end_to_end_tests::{LAWS, PointMemory, plugin, strain_path, worst};
use umat_abi::law::StressState;

/// PNEWDT on entry: below 0, so that a UMAT's request is seen.
const ON_ENTRY: f64 = -1.0;

/// A point as CalculiX has it.
fn point(loaded: &Loaded, name: &str) -> PointMemory {
    let mut point = PointMemory::new(loaded.law, StressState::ThreeD);
    point.pnewdt = ON_ENTRY;
    point.cmname = [b' '; 80];
    point.cmname[..name.len()].copy_from_slice(name.as_bytes());
    // the memory after KSTEP is not JSTEP
    point.jstep = [1, i32::MIN, i32::MIN, i32::MIN];
    point
}

#[test]
fn its_conventions_are_honoured() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for law in LAWS {
        let capitals = law.name.replace('_', "").to_uppercase();
        let copy = folder.path().join(format!("lib{capitals}.so"));
        std::fs::copy(plugin(law.name), &copy).expect("a copy");
        let library = end_to_end_tests::open(&copy);
        let umat = library.umat(Some("UMAT")).expect("the symbol in capitals");
        let loaded = Loaded { law, library, umat };

        // a plane strain element: the same in six components as in four
        let mut solid = point(&loaded, &format!("@ABAQUS_{capitals}_UMAT"));
        let mut plane = PointMemory::new(law, StressState::PlaneStrainOrAxisymmetric);
        for increment in strain_path(23, 4, law.strain, 30) {
            let in_plane = [increment[0], increment[1], 0.0, increment[3], 0.0, 0.0];
            for point in [&mut solid, &mut plane] {
                point.ddsdde.fill(f64::NAN);
                point.advance(umat, &in_plane);
            }
            assert_eq!(solid.pnewdt, ON_ENTRY, "{}", law.name);
            let scale = plane.stress().iter().fold(f64::MIN_POSITIVE, |most, stress| most.max(stress.abs()));
            let apart = worst(plane.stress().iter().zip(&solid.stress).map(|(a, b)| (a - b).abs()));
            assert!(apart <= 1e-12 * scale, "{}: {apart:e} of {scale:e}", law.name);
            assert!(solid.tangent().iter().all(|modulus| modulus.is_finite()), "{}: every entry is set", law.name);
        }

        // a step that cannot be made asks for less of it
        let before = solid.output_bits();
        solid.dstran[0] = f64::NAN;
        solid.call(umat);
        assert!(solid.pnewdt > 0.0 && solid.pnewdt < 1.0, "{}: {}", law.name, solid.pnewdt);
        assert_eq!(solid.output_bits(), before, "{}", law.name);
    }
}
