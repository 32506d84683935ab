//! The laws against responses that were computed with 40 digits (`tests/reference`), in fewer and fewer increments.

use super::error::{error, largest};
use super::path::Components;
use super::subject::{Follow, follow};
use crate::BenchError;
use models::biaxial_damage::BiaxialDamage;
use models::concrete_damage::ConcreteDamage;
use models::inelastic_damage::InelasticDamage;
use models::pure_damage::PureDamage;
use models::reverse_cyclic_damage::ReverseCyclicDamage;
use std::path::Path;

/// Their folder, relative to that of the repository.
const FOLDER: &str = "tests/reference";

/// A response and the law that has it.
struct Reference {
    file: &'static str,
    law: &'static str,
    path: &'static str,
    props: &'static [f64],
    follow: Follow,
    /// Rows may be left out: the path is monotonic.
    is_monotonic: bool,
}

/// The law against one of them.
#[derive(Clone, Debug)]
pub(super) struct Comparison {
    /// The law and its model.
    pub law: &'static str,
    /// The path.
    pub path: &'static str,
    /// The file.
    pub file: &'static str,
    /// Number of increments and error.
    pub errors: Vec<(usize, f64)>,
}

const I: &[f64] = &[31800.0, 0.18, 5000.0, 1.3, 2e-4];
const I_COMPRESSION: &[f64] = &[31800.0, 0.18, 21.0, 1.05, 4e-4];
const II: &[f64] = &[31800.0, 0.2, 2e18, 6.4, 6.45e-4, 3.5, 1.0, 0.0];
const III: &[f64] = &[31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 0.0];
const III_REGULAR: &[f64] = &[31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 1.0];
const IV: &[f64] = &[31800.0, 0.18, 7000.0, 1.1, 1.9e-4, 29.0, 0.94, 3e-4, 2.0, 0.7, 0.0, 0.0];
const IV_H: &[f64] = &[31800.0, 0.18, 7000.0, 1.1, 1.926098e-4, 32.25788, 1.2, 3e-4, 0.10988, 0.0, 0.0, 0.0, 0.0, 0.0];

const fn reference(
    file: &'static str,
    law: &'static str,
    path: &'static str,
    props: &'static [f64],
    follow: Follow,
    is_monotonic: bool,
) -> Reference {
    Reference { file, law, path, props, follow, is_monotonic }
}

const REFERENCES: &[Reference] = &[
    reference("I_t51t_unitens.csv", "pure_damage (I)", "tension", I, follow::<PureDamage>, true),
    reference("I_t51c_unicomp.csv", "pure_damage (I)", "compression", I_COMPRESSION, follow::<PureDamage>, true),
    reference("I_t51c_bi_c1_052.csv", "pure_damage (I)", "biaxial −1/−0.52", I_COMPRESSION, follow::<PureDamage>, true),
    reference("I_t51t_cyclic.csv", "pure_damage (I)", "cyclic", I, follow::<PureDamage>, false),
    reference("II_gs_unitens.csv", "inelastic_damage (II)", "tension", II, follow::<InelasticDamage>, true),
    reference("II_gs_cyclic.csv", "inelastic_damage (II)", "cyclic", II, follow::<InelasticDamage>, false),
    reference(
        "III_t51_unitens.csv",
        "reverse_cyclic_damage (III)",
        "tension",
        III,
        follow::<ReverseCyclicDamage>,
        true,
    ),
    reference(
        "III_t51_unicomp.csv",
        "reverse_cyclic_damage (III)",
        "compression",
        III,
        follow::<ReverseCyclicDamage>,
        true,
    ),
    reference(
        "IIIR_t51_cyclic.csv",
        "reverse_cyclic_damage (III, regular)",
        "cyclic",
        III_REGULAR,
        follow::<ReverseCyclicDamage>,
        false,
    ),
    reference("IV_t51_uni_unicomp.csv", "biaxial_damage (IV)", "compression", IV, follow::<BiaxialDamage>, true),
    reference("IVH_b120_unitens.csv", "concrete_damage (IV-H)", "tension", IV_H, follow::<ConcreteDamage>, true),
    reference("IVH_b120_unicomp.csv", "concrete_damage (IV-H)", "compression", IV_H, follow::<ConcreteDamage>, true),
    reference(
        "IVH_b120_bi_c1_052.csv",
        "concrete_damage (IV-H)",
        "biaxial −1/−0.52",
        IV_H,
        follow::<ConcreteDamage>,
        true,
    ),
    reference("IVH_b120_cyclic.csv", "concrete_damage (IV-H)", "cyclic", IV_H, follow::<ConcreteDamage>, false),
];

/// Every how-many-th row is an increment.
const STRIDES: [usize; 5] = [1, 2, 4, 10, 20];

/// Compares; nothing where the responses are not there.
///
/// # Errors
/// A response that cannot be read, or that its law refuses.
pub(super) fn compare() -> Result<Vec<Comparison>, BenchError> {
    compare_in(Path::new(FOLDER))
}

/// Compares with the references in another folder.
pub(super) fn compare_in(folder: &Path) -> Result<Vec<Comparison>, BenchError> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let compare = |reference: &Reference| {
        let failed = |message: String| BenchError::Failed(format!("{}: {message}", reference.file));
        let (strains, stresses) = read(&folder.join(reference.file)).map_err(failed)?;
        let mut errors = Vec::new();
        for stride in STRIDES {
            let used = strains.len() / stride;
            if (stride > 1 && !reference.is_monotonic) || used * stride != strains.len() {
                continue;
            }
            let increments: Vec<Components> = strains.iter().skip(stride - 1).step_by(stride).copied().collect();
            let computed = (reference.follow)(reference.props, &increments, 1).map_err(failed)?;
            errors.push((used, error(&computed, &stresses, largest(&stresses))));
        }
        errors.reverse();
        Ok(Comparison { law: reference.law, path: reference.path, file: reference.file, errors })
    };
    REFERENCES.iter().map(compare).collect()
}

/// Strains and stresses up to the first row where the law has several solutions.
fn read(file: &Path) -> Result<(Vec<Components>, Vec<Components>), String> {
    let mut reader = csv::Reader::from_path(file).map_err(|error| error.to_string())?;
    let header = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |name: &str| {
        header.iter().position(|column| column == name).ok_or_else(|| format!("there is no column {name}"))
    };
    let (strain, stress, roots) = (column("eps11")?, column("sig11")?, column("nroots")?);
    let (mut strains, mut stresses) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let number = |k: usize| {
            let text = record.get(k).unwrap_or_default();
            text.parse::<f64>().map_err(|_| format!("'{text}' is no number"))
        };
        let six = |first: usize| -> Result<Components, String> {
            let mut components = [0.0; 6];
            for (k, component) in components.iter_mut().enumerate() {
                *component = number(first + k)?;
            }
            Ok(components)
        };
        if number(roots)? > 1.0 {
            break;
        }
        strains.push(six(strain)?);
        stresses.push(six(stress)?);
    }
    Ok((strains, stresses))
}
