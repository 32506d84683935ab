//! Parameter sets that the law is tried at.

use crate::Sample;
use models::concrete_damage::Parameters;
use umat_abi::table::Parameters as _;

/// The parameters that PROPS have by default.
pub fn defaults() -> [f64; 14] {
    std::array::from_fn(|i| Parameters::TABLE[i].default_value)
}

/// A parameter set with some values replaced.
pub fn with(mut props: [f64; 14], changes: &[(&str, f64)]) -> [f64; 14] {
    for &(name, value) in changes {
        let index = Parameters::TABLE.iter().position(|p| p.name() == name).expect("a parameter's name");
        props[index] = value;
    }
    props
}

/// The parameter sets that between them reach every term: IV-H, IV-HP, confinement, crack bands.
pub fn variants() -> [([f64; 14], Option<f64>); 5] {
    let plastic = with(defaults(), &[("b_t", 0.3), ("b_c", 0.2)]);
    let banded = with(defaults(), &[("G_f", 0.1), ("G_c", 20.0)]);
    let all = with(banded, &[("b_t", 0.2), ("b_c", 0.3), ("zeta_c", 1.0)]);
    [
        (defaults(), None),
        (plastic, None),
        (with(defaults(), &[("zeta_c", 2.0)]), None),
        (banded, Some(20.0)),
        (all, Some(50.0)),
    ]
}

/// A variant as the battery takes it.
pub fn sample((props, characteristic_length): &([f64; 14], Option<f64>)) -> Sample<'_> {
    Sample { characteristic_length: *characteristic_length, ..Sample::new(props, 3e-4) }
}
