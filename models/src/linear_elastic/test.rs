use super::*;
use battery::pages::{PARAMETERS, STATES};
use battery::{PATH_COUNTS, Promises, Sample, battery};

const PROPS: [f64; 2] = [31800.0, 0.18];

battery!(
    promised: LinearElastic,
    Promises {
        samples: vec![Sample::new(&PROPS, 1e-3)],
        histories: 200,
        monotone: &[],
        dissipative: true,
        steady: true,
        history: &[],
        elastic_strain: |_| 1.0,
        path_ends: &[[1.0, -0.2, 0.0, 0.3, 0.0, 0.0]],
        random_paths: [20, 2],
        path_counts: |_, _| &PATH_COUNTS,
    },
    pages: ["linear_elastic/doc.md": &[PARAMETERS, STATES]]
);

#[test]
fn uniaxial_strain_gives_the_constrained_modulus() {
    let mut point = battery::Point::<LinearElastic>::virgin(&PROPS, StressState::ThreeD);
    let stress = point.advance(&[1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]).stress;
    let constrained = 31800.0 * (1.0 - 0.18) / ((1.0 + 0.18) * (1.0 - 0.36));
    approx::assert_relative_eq!(stress[0], constrained * 1e-3, max_relative = 1e-15);
}
