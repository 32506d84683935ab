//! Cracks that are a phase field: the notched beam against a cohesive crack.

use crate::program::{Desk, cases};

/// Peak, N, and work to 0.3 mm, N·mm, of the beam with a cohesive crack of the same opening curve along its ligament.
const COHESIVE: [f64; 2] = [1348.6, 170.9];

/// l and elements of 5 mm on a ligament of 50 mm: the peak is 1 %, the work 5 % above.
#[test]
fn a_notched_beam_takes_the_energy_of_a_cohesive_crack() {
    let desk = Desk::new();
    let run = desk.run(&cases().join("verification/notched-beam-phase-field.json"), &["output.vtu=100"], "out", 0);
    let [peak, work] = [run.peak("load", "max"), run.history.area("slip", "load")];
    let [of_law, of_field] = ["damage_energy", "field_energy"].map(|name| run.history.last(name));
    println!("peak {peak:.1} N, work {work:.1} N mm, dissipated {of_law:.1}, field {of_field:.1} N mm");
    assert!((peak / COHESIVE[0] - 1.0).abs() < 0.02, "{peak}");
    assert!((work / COHESIVE[1] - 1.0).abs() < 0.07, "{work}");
    // the same energy, as the laws pass it on and as the field has it; 1.2 % is what elements of 5 mm leave
    assert!((of_field / of_law - 1.0).abs() < 0.02, "{of_field} {of_law}");
    assert!((0.5..1.0).contains(&run.history.last("field_max")));
    let names = crate::program::xml_of_fields(&desk.path("out/fields/000000.vtu"));
    assert!(names.contains("Name=\"phase_field\""), "{names}");
}
