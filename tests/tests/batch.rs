//! `pullout_umat_batch_v1` gives the bits of single calls of `umat_`, whatever the points are.

use battery::BatchCall;
use end_to_end_tests::{LAWS, PointMemory, Random, Sample, plugin, sample, strain_path};
use umat_abi::host::Library;
use umat_abi::law::{Request, StressState};
use umat_abi::metadata::batch_results;

/// Points of a small batch.
const FEW: usize = 8;

/// A batch, and the same points one by one.
struct Both {
    law: Sample,
    stress_state: StressState,
    library: Library,
    batch: BatchCall,
    points: Vec<PointMemory>,
}

impl Both {
    fn new(law: &Sample, stress_state: StressState, count: usize) -> Self {
        let library = end_to_end_tests::open(&plugin(law.name));
        let batch = BatchCall::new(&library, stress_state, law.states, law.props, count).expect("a batch function");
        let mut points = vec![PointMemory::new(law, stress_state); count];
        points.iter_mut().for_each(|point| point.celent = 0.0);
        Self { law: *law, stress_state, library, batch, points }
    }

    fn set_length(&mut self, point: usize, length: f64) {
        self.points[point].celent = length;
        self.batch.celent[point] = length;
    }

    /// Sets strain and increment of one point.
    fn set_strain(&mut self, point: usize, increment: &[f64; 6]) {
        let count = self.points.len();
        let memory = &mut self.points[point];
        memory.dstran = *increment;
        for i in 0..self.stress_state.components().len() {
            self.batch.strain[i * count + point] = memory.stran[i];
            self.batch.dstrain[i * count + point] = increment[i];
        }
    }

    /// Calls both and compares every bit; then the strains move on where the increment was done.
    fn call(&mut self, request: Request) {
        let count = self.points.len();
        let function = self.library.umat(None).expect("umat_");
        self.batch.call(request);
        for (k, point) in self.points.iter_mut().enumerate() {
            point.pnewdt = 1.0;
            let mut arguments = point.arguments();
            if !request.wants_tangent() {
                arguments.ddsdde = std::ptr::null_mut();
            }
            // SAFETY: the point's own memory.
            unsafe { arguments.call(function) };
            let context = format!("{} {:?} {request:?}, point {k} of {count}", self.law.name, self.stress_state);
            let column = |array: &[f64], rows: usize| -> Vec<u64> {
                (0..rows).map(|row| array[row * count + k].to_bits()).collect()
            };
            let bits = |array: &[f64]| -> Vec<u64> { array.iter().map(|x| x.to_bits()).collect() };
            let ntens = point.ntens();
            assert_eq!(column(&self.batch.stress, ntens), bits(point.stress()), "stress, {context}");
            assert_eq!(column(&self.batch.statev, self.law.states), bits(&point.statev), "states, {context}");
            if request.wants_tangent() {
                assert_eq!(column(&self.batch.ddsdde, ntens * ntens), bits(point.tangent()), "tangent, {context}");
            }
            let refused = point.stress().iter().any(|stress| stress.is_nan());
            let expected = match point.pnewdt {
                1.0 => batch_results::DONE,
                _ if refused => batch_results::REFUSED,
                _ => batch_results::CUT_BACK,
            };
            assert_eq!(self.batch.status[k], expected, "status, {context}");
            if expected == batch_results::DONE {
                for i in 0..6 {
                    point.stran[i] += point.dstran[i];
                }
            }
        }
    }
}

/// Points on paths of their own, some virgin and elastic, some far beyond their limits.
fn follow_random_paths(law: &Sample, stress_state: StressState, count: usize, request: Request) {
    let mut both = Both::new(law, stress_state, count);
    let ntens = stress_state.components().len();
    let mut random = Random::new(count as u64);
    let paths: Vec<Vec<[f64; 6]>> = (0..count)
        .map(|k| {
            let size = law.strain * 10_f64.powf(1.5 * random.signed() - 0.5);
            let path = strain_path(1 + k as u64, ntens, size, 25);
            // some in a plane, some along the axes
            match k % 5 {
                1 if ntens == 6 => path.into_iter().map(|[a, b, c, d, ..]| [a, b, c, d, 0.0, 0.0]).collect(),
                2 => path
                    .into_iter()
                    .map(|[a, b, c, ..]| [a, b, if ntens == 3 { 0.0 } else { c }, 0.0, 0.0, 0.0])
                    .collect(),
                _ => path,
            }
        })
        .collect();
    for step in 0..25 {
        for (k, path) in paths.iter().enumerate() {
            both.set_strain(k, &path[step]);
        }
        both.call(request);
    }
}

#[test]
fn batches_of_all_laws_give_the_bits_of_single_calls() {
    for law in LAWS {
        for stress_state in Sample::STRESS_STATES {
            for count in [1, FEW - 1, 5 * FEW + 3] {
                follow_random_paths(law, stress_state, count, Request::Stress);
            }
            follow_random_paths(law, stress_state, FEW + 1, Request::StressAndTangent);
        }
    }
}

#[test]
fn batches_of_concrete_damage_give_the_bits_of_single_calls_for_all_its_forms() {
    const IV_H: &[f64] =
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0];
    const CONFINED: &[f64] =
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.5, 0.0, 0.0, 0.0, 0.0];
    let own = sample("concrete_damage");
    for props in [IV_H, CONFINED] {
        let law = Sample { props, ..*own };
        for stress_state in Sample::STRESS_STATES {
            follow_random_paths(&law, stress_state, 12 * FEW, Request::Stress);
        }
    }
}

#[test]
fn lengths_of_a_crack_band_are_those_of_each_point() {
    const CRACK_BAND: &[f64] =
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.1, 0.0];
    let law = Sample { props: CRACK_BAND, ..*sample("concrete_damage") };
    let mut both = Both::new(&law, StressState::ThreeD, 2 * FEW);
    for k in 0..2 * FEW {
        // without a length, as long as it may be, and longer
        both.set_length(k, [0.0, 10.0, 40.0, 1e4, f64::NAN][k % 5]);
    }
    for _ in 0..8 {
        for k in 0..2 * FEW {
            both.set_strain(k, &[6e-5, -1e-5, -1e-5, 1e-5, 0.0, 0.0]);
        }
        both.call(Request::Stress);
    }
    assert!(both.batch.status.contains(&batch_results::REFUSED));
}

#[test]
fn a_bad_point_leaves_its_neighbours_alone() {
    for name in ["linear_elastic", "concrete_damage"] {
        let law = sample(name);
        for bad in [f64::NAN, f64::INFINITY, 1e200, 1e300] {
            let mut both = Both::new(law, StressState::ThreeD, 3 * FEW);
            for step in 0..4 {
                for k in 0..3 * FEW {
                    let strain = if step == 2 && k == FEW + 2 { bad } else { 2e-4 * (k as f64 - 9.0) };
                    both.set_strain(k, &[strain, 1e-5, 0.0, 3e-5, 0.0, -2e-5]);
                }
                both.call(Request::Stress);
                let count = both.batch.status.iter().filter(|status| **status != batch_results::DONE).count();
                assert!(count == 0 || step == 2 && count == 1, "{name} {bad}: {:?}", both.batch.status);
            }
        }
    }
}

#[test]
fn refused_parameters_are_reported_for_every_point() {
    let law = sample("concrete_damage");
    let (index, value) = law.inadmissible;
    let mut props = law.props.to_vec();
    props[index] = value;
    let library = end_to_end_tests::open(&plugin(law.name));
    let mut wrong = [
        BatchCall::new(&library, StressState::ThreeD, law.states, &props, 11).expect("a batch function"),
        BatchCall::new(&library, StressState::ThreeD, law.states, &law.props[1..], 11).expect("a batch function"),
        BatchCall::new(&library, StressState::ThreeD, law.states - 1, law.props, 11).expect("a batch function"),
    ];
    for batch in &mut wrong {
        batch.call(Request::StressAndTangent);
        assert_eq!(batch.status[..], [batch_results::REFUSED; 11]);
        assert!(batch.stress.iter().chain(batch.ddsdde.iter()).all(|value| value.is_nan()));
        assert!(batch.statev.iter().all(|value| *value == 0.0));
    }
}

/// A law that panics at some strains, as `umat_` reports it.
#[test]
fn a_panic_is_that_of_its_point() {
    let library = end_to_end_tests::open(&plugin("panicking"));
    let law = &library.laws()[0];
    let props: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
    let mut batch =
        BatchCall::new(&library, StressState::ThreeD, law.states.len(), &props, 5).expect("a batch function");
    batch.dstrain.fill(1e-2);
    batch.call(Request::Stress);
    assert_eq!(batch.status[..], [batch_results::REFUSED; 5]);
    assert!(batch.stress.iter().all(|stress| stress.is_nan()));
}

#[test]
fn no_point_is_no_work() {
    let law = sample("concrete_damage");
    let library = end_to_end_tests::open(&plugin(law.name));
    BatchCall::new(&library, StressState::ThreeD, law.states, law.props, 0)
        .expect("a batch function")
        .call(Request::Stress);
}
