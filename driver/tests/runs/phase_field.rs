//! Cracks that are a phase field: the notched beam against a cohesive crack, a bar that snaps back against its closed form.

use crate::program::{Desk, cases, goes_on_from_a_checkpoint};

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

/// Strength, MPa, G_f, N/mm, modulus, MPa, and length, mm, of half of a bar of 1 mm².
const BAR: [f64; 4] = [3.0, 0.009, 30e3, 60.0];

/// σ(w) is linear: u = σ L/E + (G_f/f_t)(1 − σ/f_t), and half of a crack takes G_f/2. Increments of any kind turn back. (Where the drive
/// led alone, it dissipated 1.87 of that: the energy that the bar had stored.)
#[test]
fn a_long_bar_snaps_back_as_its_closed_form_says() {
    let [strength, fracture_energy, modulus, length] = BAR;
    let [elastic, open] = [length * strength / modulus, fracture_energy / strength];
    let desk = Desk::new();
    for increments in ["steps.0.increments.initial=0.05", "steps.0.increments=25"] {
        let run = desk.run(&cases().join("verification/snap-back-phase-field.json"), &[increments], increments, 0);
        let [slip, load, dissipated] = ["slip", "load", "damage_energy"].map(|name| run.history.column(name));
        let peak = (0..load.len()).max_by(|&a, &b| load[a].total_cmp(&load[b])).expect("rows");
        assert!((load[peak] / strength - 1.0).abs() < 0.01, "{}", load[peak]);
        assert!((slip[peak] / elastic - 1.0).abs() < 0.01, "{}", slip[peak]);
        let mut turned_back = 0.0;
        for row in peak + 1..load.len() {
            assert!(dissipated[row] >= dissipated[row - 1], "row {row}");
            turned_back += (slip[row - 1] - slip[row]).max(0.0);
            let stress = load[row] / strength;
            // elements of l/4 and the weak end leave 1 %, and a tail of the crack below a tenth of the strength
            let expected = stress * elastic + (1.0 - stress) * open;
            assert!(stress < 0.1 || (slip[row] - expected).abs() < 0.01 * elastic, "{}: {expected}", slip[row]);
        }
        assert!(turned_back > 0.9 * (elastic - open), "{turned_back}");
        assert!(run.history.last("load") < 1e-3 * strength);
        let part = run.history.last("damage_energy") / (0.5 * fracture_energy);
        println!("{increments}: {} rows, turned back {turned_back:.6} mm, dissipated {part:.4}", load.len());
        assert!((part - 1.0).abs() < 0.02, "{part}");
        assert!(run.history.last("energy_error").abs() < 1e-6);
    }
}

/// The checkpoint lies where the field leads.
#[test]
fn a_snap_back_goes_on_from_a_checkpoint_to_the_same_bits() {
    goes_on_from_a_checkpoint(&Desk::new(), &cases().join("verification/snap-back-phase-field.json"), "40");
}
