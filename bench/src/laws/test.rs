//! Errors are measured rightly, and the thesis's algorithms are what they are said to be.

use super::error::{ROUND_OFF, error, largest, order};
use super::forty_digits::compare_in;
use super::path::{Components, Path};
use super::subject::{Follow, MeasuredLaw, follow, subjects};
use models::biaxial_damage::BiaxialDamage;

fn subject(name: &str) -> MeasuredLaw {
    subjects().into_iter().find(|subject| subject.name == name).expect("a subject")
}

fn stresses(subject: &MeasuredLaw, path: Path, n: usize, follow: Follow) -> Vec<Components> {
    follow(&subject.props, &path.strains(&subject.extent, n), 1).expect("stresses")
}

fn thesis(subject: &MeasuredLaw) -> Follow {
    subject.thesis.expect("an algorithm of the thesis").1
}

#[test]
fn errors_are_the_largest_difference_at_common_increments() {
    let row = |s: f64| [s, 0.0, 0.0, -s, 0.0, 0.0];
    let reference = [1.0, 2.0, 3.0, 4.0].map(row);
    assert_eq!(largest(&reference), 4.0);
    assert_eq!(error(&[row(2.0), row(4.5)], &reference, 4.0), 0.125);
    assert_eq!(error(&[row(f64::NAN), row(4.0)], &reference, 4.0), f64::INFINITY);
}

#[test]
fn orders_are_slopes_of_what_is_above_rounding() {
    let falling = |power: i32| -> Vec<(usize, f64)> {
        [10, 100, 1000, 10_000, 100_000].map(|n: usize| (n, (0.5 * (n as f64).powi(-power)).max(1e-16))).into()
    };
    assert!((order(&falling(1)).expect("five errors") - 1.0).abs() < 1e-12);
    assert!((order(&falling(2)).expect("four errors above rounding") - 2.0).abs() < 1e-12);
    assert_eq!(order(&[(10, 1e-15), (100, 1e-15), (1000, 1e-16)]), None);
}

#[test]
fn refined_paths_pass_through_the_same_strains() {
    for subject in subjects() {
        for path in Path::ALL {
            let coarse = path.strains(&subject.extent, 20);
            let fine = path.strains(&subject.extent, 20_000);
            for (i, strain) in coarse.iter().enumerate() {
                assert_eq!(*strain, fine[(i + 1) * 1000 - 1], "{} {}", subject.name, path.name());
            }
        }
    }
}

#[test]
fn laws_without_path_error_have_none() {
    for subject in subjects().iter().filter(|subject| subject.is_path_exact) {
        for path in Path::ALL.into_iter().filter(|path| path.is_met_by_any_increments()) {
            let reference = stresses(subject, path, 10_000, subject.ours);
            for n in [10, 50, 1000] {
                let error = error(&stresses(subject, path, n, subject.ours), &reference, largest(&reference));
                assert!(error <= ROUND_OFF, "{}, {}, {n} increments: {error:e}", subject.name, path.name());
            }
        }
    }
}

#[test]
fn laws_agree_with_forty_digits_in_any_number_of_increments() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/reference");
    let comparisons = compare_in(&folder).expect("the responses of the repository");
    assert!(comparisons.len() >= 12);
    for comparison in comparisons {
        // model IV as printed depends on the path: on each of its rows only
        let rows = if comparison.law.starts_with("biaxial_damage") { 1 } else { comparison.errors.len() };
        for (n, error) in comparison.errors.iter().rev().take(rows) {
            assert!(*error <= ROUND_OFF, "{} in {n} increments: {error:e}", comparison.file);
        }
        assert!(!comparison.errors.is_empty(), "{}", comparison.file);
    }
}

/// Both are functions of the end strain and of the largest Y so far.
#[test]
fn boxes_4_1_and_4_2_are_the_laws() {
    for name in ["pure_damage (I)", "inelastic_damage (II)"] {
        let subject = subject(name);
        for path in Path::ALL {
            let law = stresses(&subject, path, 2000, subject.ours);
            let of_box = stresses(&subject, path, 2000, thesis(&subject));
            let difference = error(&of_box, &law, largest(&law));
            assert!(difference < 1e-11, "{name}, {}: {difference:e}", path.name());
        }
    }
}

/// The other parameters of model II, where Z(D) counts.
#[test]
fn box_4_2_is_the_law_where_the_threshold_rises() {
    let mut subject = subject("inelastic_damage (II)");
    subject.props = vec![31800.0, 0.2, 4e-3, 1.2, 3.35e-2, 1000.0, 1.0, 0.0];
    subject.extent.tension = 0.15;
    for path in [Path::Tension, Path::Cyclic] {
        let law = stresses(&subject, path, 1000, subject.ours);
        let of_box = stresses(&subject, path, 1000, thesis(&subject));
        let difference = error(&of_box, &law, largest(&law));
        assert!(difference < 1e-11, "{}: {difference:e}", path.name());
    }
}

#[test]
fn box_5_1_is_of_first_order_where_the_law_has_no_error() {
    let subject = subject("biaxial_damage (IV, implicit)");
    let reference = stresses(&subject, Path::Compression, 20_000, subject.ours);
    let scale = largest(&reference);
    let errors = |follow: Follow| {
        [200, 500, 1000, 2000, 4000]
            .map(|n| (n, error(&stresses(&subject, Path::Compression, n, follow), &reference, scale)))
    };
    let own = errors(subject.ours);
    assert!(own.iter().all(|(_, error)| *error < 1e-12), "{own:?}");
    let of_box = errors(thesis(&subject));
    let order = order(&of_box).expect("errors of the method");
    assert!((0.9..1.1).contains(&order), "order {order}: {of_box:?}");
}

/// `biaxial_damage` offers lagged weights of its own: on fine paths both find the same stress.
#[test]
fn box_5_1_and_lagged_weights_agree_on_fine_paths() {
    let subject = subject("biaxial_damage (IV, implicit)");
    let lagged: Vec<f64> = subject.props[..11].iter().copied().chain([1.0]).collect();
    let difference = |n: usize| {
        let law =
            follow::<BiaxialDamage>(&lagged, &Path::Compression.strains(&subject.extent, n), 1).expect("stresses");
        let of_box = stresses(&subject, Path::Compression, n, thesis(&subject));
        error(&of_box, &law, largest(&law))
    };
    let differences = [500, 5000].map(difference);
    assert!(differences[1] < 0.15 * differences[0].max(1e-12), "{differences:?}");
    assert!(differences[1] < 1e-4, "{differences:?}");
}
