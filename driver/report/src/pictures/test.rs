use super::*;

#[test]
fn what_rounding_leaves_is_nothing() {
    let shown = [32.0, -1e-7, 3.7e-12, -0.0].map(|value| without_rounding(value, 32.0));
    assert_eq!(shown, [32.0, -1e-7, 0.0, 0.0]);
}

#[test]
fn the_total_damage_is_drawn_alone() {
    assert_eq!(damages(&["eta", "D_t", "D", "D_c", "strain_33"]), ["D"]);
    assert_eq!(damages(&["D_t", "D_c", "peeq"]), ["D_t", "D_c"]);
    assert!(damages(&["peeq", "dissipated_energy"]).is_empty());
}
