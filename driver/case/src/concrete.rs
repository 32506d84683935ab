//! Concrete by its class: parameters of laws, and the matrix of bridging.

use crate::document::ConcreteStrength;
use crate::problem::Place;
use crate::reader::Reader;
use models::concrete_damage::ConcreteDamage;
use models::concrete_damage::calibration::{self, properties};
use pullout_bridging::Concrete;
use pullout_run::number::significant;
use umat_abi::law::{ConfigurationError, Law as _};

/// Returns the concrete that a case names, and notes its values.
pub fn resolve(reader: &mut Reader<'_>, given: &ConcreteStrength, place: &Place) -> Option<Concrete> {
    let concrete = match given {
        ConcreteStrength::Class(name) => Concrete::of_class(name),
        ConcreteStrength::Mean(mean) => Concrete::of_mean(mean.0),
    };
    let concrete = reader.without_problem(concrete, place)?;
    let values = [concrete.compressive_strength, concrete.tensile_strength, concrete.fracture_energy];
    let [strength, tensile, energy] = values.map(|value| significant(value, 4));
    reader.note(format!(
        "{}: mean values of the fib Model Code 2010: f_c = {strength} MPa, f_t = {tensile} MPa, E = {} MPa, G_f = {energy} N/mm",
        place.in_words(),
        significant(concrete.modulus, 5),
    ));
    Some(concrete)
}

/// What the calibration of concrete_damage takes of a concrete: its compression has no fracture energy, of which the Model Code says
/// nothing.
pub fn measured(concrete: &Concrete) -> calibration::ConcreteProperties {
    calibration::ConcreteProperties {
        youngs_modulus: concrete.modulus,
        poisson_ratio: Concrete::POISSON_RATIO,
        tensile_strength: concrete.tensile_strength,
        compressive_strength: concrete.compressive_strength,
        fracture_energy: Some(concrete.fracture_energy),
        crushing_energy: None,
    }
}

/// Parameters that follow from a concrete, by the names that laws have for them: strengths, and those of the calibrated damage, for the
/// E and ν that the case gives in place of the class's.
///
/// # Errors
/// An E or ν for which there is no calibration.
pub fn parameters(concrete: &Concrete, own: [Option<f64>; 2]) -> Result<Vec<(String, f64)>, ConfigurationError> {
    let of_class = measured(concrete);
    let [youngs_modulus, poisson_ratio] = own;
    let calibrated = properties(&calibration::ConcreteProperties {
        youngs_modulus: youngs_modulus.unwrap_or(of_class.youngs_modulus),
        poisson_ratio: poisson_ratio.unwrap_or(of_class.poisson_ratio),
        ..of_class
    })?;
    let names = ConcreteDamage::INFO.parameters.iter().map(|parameter| parameter.name().to_owned());
    let strengths = [("f_t", concrete.tensile_strength), ("f_c", concrete.compressive_strength)];
    let strengths = strengths.map(|(name, value)| (name.to_owned(), value));
    // 0: it says nothing of it
    Ok(names.zip(calibrated).filter(|(_, value)| *value != 0.0).chain(strengths).collect())
}
