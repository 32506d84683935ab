//! `pullout props LAW`: calibrated parameters, as JSON to be pasted into a case.

use super::{DONE, Refusal, complain, say};
use clap::Subcommand;
use models::concrete_damage::ConcreteDamage;
use models::concrete_damage::calibration::{COMPRESSIVE_EXPONENT, ConcreteProperties, properties_with_exponent};
use pullout_case::concrete_of_class;
use pullout_run::number::significant;
use umat_abi::law::Law as _;

/// Laws that can be calibrated.
#[derive(Debug, Subcommand)]
pub(super) enum CalibratedLaw {
    /// concrete_damage from strengths and fracture energies (N, mm, MPa).
    #[command(name = "concrete_damage")]
    ConcreteDamage {
        /// Class of the concrete, as C40 or C40/50: mean values of the fib Model Code 2010 for what is not given.
        #[arg(long)]
        class: Option<String>,
        /// Young's modulus, MPa.
        #[arg(long = "E", allow_negative_numbers = true, required_unless_present = "class")]
        youngs_modulus: Option<f64>,
        /// Poisson's ratio.
        #[arg(long = "nu", allow_negative_numbers = true, required_unless_present = "class")]
        poisson_ratio: Option<f64>,
        /// Uniaxial tensile strength, MPa.
        #[arg(long = "ft", allow_negative_numbers = true, required_unless_present = "class")]
        tensile_strength: Option<f64>,
        /// Uniaxial compressive strength (positive), MPa.
        #[arg(long = "fc", allow_negative_numbers = true, required_unless_present = "class")]
        compressive_strength: Option<f64>,
        /// Fracture energy in tension, N/mm. It activates the crack band.
        #[arg(long = "Gf", allow_negative_numbers = true)]
        fracture_energy: Option<f64>,
        /// Fracture energy in compression, N/mm.
        #[arg(long = "Gc", allow_negative_numbers = true)]
        crushing_energy: Option<f64>,
        /// Exponent of compressive damage. Smaller values are more ductile; values above 1 give a finite energy.
        #[arg(long = "Bc", allow_negative_numbers = true, default_value_t = COMPRESSIVE_EXPONENT)]
        compressive_exponent: f64,
    },
    /// Another law.
    #[command(external_subcommand)]
    Other(Vec<String>),
}

/// Usual range for concrete, from aerated to ultra-high-performance, MPa.
const USUAL: [(&str, [f64; 2]); 3] = [("--E", [500.0, 1e5]), ("--ft", [0.05, 50.0]), ("--fc", [0.5, 500.0])];

/// Exponents of damage below this leave more of the energy in the tail than comes before it.
const LONG_TAIL: f64 = 1.25;

pub(super) fn print(law: &CalibratedLaw) -> Result<u8, Refusal> {
    let CalibratedLaw::ConcreteDamage {
        class,
        youngs_modulus,
        poisson_ratio,
        tensile_strength,
        compressive_strength,
        fracture_energy,
        crushing_energy,
        compressive_exponent,
    } = law
    else {
        let CalibratedLaw::Other(words) = law else { return Ok(DONE) };
        let name = words.first().map_or("", String::as_str);
        return Err(Refusal::input(format!(
            "props {name}: parameters are found from strengths and fracture energies for concrete_damage alone; `pullout plugin \
             info {name}` lists those of a law, and `pullout fit` finds them from a measured curve"
        )));
    };
    let of_class = class.as_deref().map(pullout_bridging::Concrete::of_class).transpose();
    let of_class = of_class.map_err(|reason| Refusal::input(format!("props concrete_damage: --class {reason}")))?;
    let of_class = of_class.map(|concrete| concrete_of_class(&concrete));
    // clap requires those that no class gives
    let or_class = |given: Option<f64>, of: fn(&ConcreteProperties) -> f64| {
        given.or(of_class.as_ref().map(of)).unwrap_or(f64::NAN)
    };
    let concrete = ConcreteProperties {
        youngs_modulus: or_class(*youngs_modulus, |concrete| concrete.youngs_modulus),
        poisson_ratio: or_class(*poisson_ratio, |concrete| concrete.poisson_ratio),
        tensile_strength: or_class(*tensile_strength, |concrete| concrete.tensile_strength),
        compressive_strength: or_class(*compressive_strength, |concrete| concrete.compressive_strength),
        fracture_energy: fracture_energy.or(of_class.and_then(|concrete| concrete.fracture_energy)),
        crushing_energy: *crushing_energy,
    };
    let given = [concrete.youngs_modulus, concrete.tensile_strength, concrete.compressive_strength];
    for ((option, [lower, upper]), value) in USUAL.iter().zip(given) {
        if !(*lower..=*upper).contains(&value) {
            complain(format!(
                "warning: {option} {value} is outside the usual range of concretes, {lower} to {upper} MPa: is it in MPa?"
            ));
        }
    }
    if let Some(energy) = crushing_energy
        && *compressive_exponent < LONG_TAIL
    {
        let power = significant(2.0 - 2.0 * compressive_exponent, 2);
        complain(format!(
            "warning: --Gc {energy}: with --Bc {compressive_exponent} most of it lies in the tail: beyond a strain there is a part that falls as \
             strain^{power} (docs/theory/crack-band.md). Give a greater --Bc"
        ));
    }
    let properties = properties_with_exponent(&concrete, *compressive_exponent)
        .map_err(|error| Refusal::input(format!("props concrete_damage: {error}")))?;
    let names = ConcreteDamage::INFO.parameters.iter().map(|parameter| parameter.name().to_owned());
    let table: serde_json::Map<_, _> = names.zip(properties.iter().map(|&value| serde_json::json!(value))).collect();
    say(&format!("{:#}\n", serde_json::json!({ "plugin": "concrete_damage", "props": table })));
    Ok(DONE)
}
