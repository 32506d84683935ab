//! The case that is computed: a perpendicular fibre in a block, or a case of the user's own, with the law of the moment.

use super::geometry::TestFibre;
use super::law::BondSlipLaw;
use models::concrete_damage::ConcreteDamage;
use models::concrete_damage::calibration::{COMPRESSIVE_EXPONENT, ConcreteProperties, properties_with_exponent};
use pullout_run::input::folder_of;
use pullout_run::isolation::{self, Need};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use umat_abi::host;
use umat_abi::law::Law as _;

/// The block is so many times as wide and as thick as the fibre, and not smaller than that of chapters 6 and 7 (mm).
const WIDTH: f64 = 12.0;
const LEAST_WIDTH: f64 = 25.4;
const THICKNESS: f64 = 8.0;
const LEAST_THICKNESS: f64 = 3.26;
/// Depth over the embedded length: that of chapters 6 and 7.
const DEPTH: f64 = 12.7 / 12.2;
/// Elements along the embedded length, and the size of the last over their mean.
const ELEMENTS: usize = 20;
const EXIT_SIZE: f64 = 0.5;
/// Growth of the elements away from the hole, the first being half of the fibre's diameter.
const GROWTH: f64 = 2.0;
/// The hard normal law's tension cap, MPa: above what any fibre opens (thesis, Fig. 6.19).
const TENSION_CAP: f64 = 1000.0;
/// Part of the diameter over which it fades.
const OPENING: f64 = 0.01;
/// Poisson's ratios.
const FIBRE_POISSON: f64 = 0.3;
const MATRIX_POISSON: f64 = 0.15;
/// Hardening of the fibre over its Young's modulus.
const HARDENING: f64 = 0.01;
/// Strengths, MPa, and fracture energies, N/mm, of the matrix of chapters 6 and 7.
const STRENGTHS: [f64; 2] = [3.0, 34.8];
const FRACTURE_ENERGIES: [f64; 2] = [0.06, 15.0];
/// End of the first step, as a multiple of the slip at the peak. The ends of the other steps follow in a geometric series.
const FIRST_STEP: f64 = 1.5;
const LATER_STEPS: u32 = 3;
/// Largest increment as a fraction of its step. On the rising branch, whose knee determines k_e, increments are smaller.
const RISING_INCREMENT: f64 = 0.02;
const FALLING_INCREMENT: f64 = 0.05;
/// The first increment over the greatest.
const INITIAL: f64 = 0.2;

/// Law of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
pub enum MatrixLaw {
    /// Linear elastic.
    Elastic,
    /// `concrete_damage` with f_t 3.0, f_c 34.8 MPa, G_f 0.06, G_c 15 N/mm.
    #[value(name = "concrete_damage")]
    ConcreteDamage,
}

/// The block around the fibre, and the fibre's yield.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials {
    /// Law of the matrix.
    pub matrix: MatrixLaw,
    /// Young's modulus, MPa.
    pub matrix_modulus: f64,
    /// First yield of the fibre, MPa; `None`: elastic.
    pub fibre_yield: Option<f64>,
}

/// A case without its bond law.
#[derive(Clone, Debug)]
pub(crate) struct Specimen {
    /// The case.
    document: Value,
    /// File of the case: paths in it are relative to its folder.
    pub file: PathBuf,
    /// Whether it is the user's own.
    pub is_own: bool,
}

impl Specimen {
    /// The default: a fibre perpendicular to the face of a block whose sides are held.
    ///
    /// # Errors
    /// A matrix that cannot be calibrated.
    pub fn perpendicular_fibre(fibre: &TestFibre, materials: &Materials, residual: f64) -> Result<Self, String> {
        let TestFibre { diameter, embedded_length, free_length, youngs_modulus } = *fibre;
        let width = LEAST_WIDTH.max(WIDTH * diameter);
        let fibre_material = match materials.fibre_yield {
            None => json!({ "plugin": "linear_elastic", "props": { "E": youngs_modulus, "nu": FIBRE_POISSON } }),
            Some(stress) => {
                let hardening = [[stress, 0.0], [stress + HARDENING * youngs_modulus, 1.0]];
                let props = json!({ "E": youngs_modulus, "nu": FIBRE_POISSON, "hardening": hardening });
                json!({ "plugin": "j2_plasticity", "props": props })
            }
        };
        let document = json!({
            "kind": "pullout",
            "mesh": { "specimen": {
                "type": "perpendicular_fibre",
                "fibre_diameter": diameter,
                "embedded_length": embedded_length,
                "free_length": free_length,
                "width": width,
                "depth": DEPTH * embedded_length,
                "matrix_thickness": LEAST_THICKNESS.max(THICKNESS * diameter),
                "embedded_elements": ELEMENTS,
                "exit_size": EXIT_SIZE * embedded_length / ELEMENTS as f64,
                "interface_size": 0.5 * diameter,
                "growth": GROWTH,
                "largest_size": width / 6.0,
            } },
            "parts": { "fibre": { "material": fibre_material }, "matrix": { "material": matrix(materials)? } },
            "contact": { "law": { "plugin": "bond_slip", "props": {
                "normal_law": "hard",
                "p_0": TENSION_CAP,
                "delta_N": OPENING * diameter,
                "tau_res": residual,
                "k_u": 0.0,
                "mu": 0.0,
            } } },
        });
        Ok(Self { document, file: PathBuf::from("bond-law.json"), is_own: false })
    }

    /// Returns what it needs a process of its own for, if it does.
    pub fn need(&self, plugin_paths: &[PathBuf]) -> Option<Need> {
        isolation::need(&self.document, &self.file, plugin_paths)
    }

    /// A case of the user's own: everything of it but the bond law stays.
    ///
    /// # Errors
    /// Reason why a bond law cannot be put into it.
    pub fn own(document: Value, file: &Path, residual: Option<f64>) -> Result<Self, String> {
        if document["kind"] != "pullout" {
            return Err("$.kind: the simulation must be a case of kind \"pullout\"".into());
        }
        let mut specimen = Self { document, file: file.to_owned(), is_own: true };
        let laws = laws_of(&mut specimen.document);
        if laws.is_empty() {
            return Err("$.contact: the simulation needs contact with the law bond_slip".into());
        }
        for (place, law) in laws {
            if law["plugin"] != "bond_slip" {
                return Err(format!("{place}.plugin: the law that is fitted is 'bond_slip', not {}", law["plugin"]));
            }
            let props = law.as_object_mut().map(|law| law.entry("props").or_insert_with(|| json!({})));
            match (props.and_then(Value::as_object_mut), residual) {
                (Some(props), Some(residual)) => _ = props.insert("tau_res".into(), json!(residual)),
                (Some(_), None) => {}
                (None, _) => return Err(format!("{place}.props: parameters by name are needed, not a list")),
            }
        }
        Ok(specimen)
    }

    /// τ_res of the first contact pair, MPa, for pictures of the law.
    pub fn residual(&self) -> f64 {
        let mut document = self.document.clone();
        laws_of(&mut document).first().and_then(|(_, law)| law["props"]["tau_res"].as_f64()).unwrap_or(0.0)
    }

    /// Steps to a slip of the grip, in stretches that are short where the curve bends: around the slip of its peak. A case
    /// of the user's own keeps its steps. `until`: the column that ends the run at a value.
    #[must_use]
    pub fn pulled(mut self, peak_slip: f64, end: f64, until: (&str, f64)) -> Self {
        if !self.is_own {
            // the later steps need a length
            let first = (FIRST_STEP * peak_slip).min(0.5 * end);
            let step = |k: u32| {
                let slip = if k == LATER_STEPS {
                    end
                } else {
                    first * (end / first).powf(f64::from(k) / f64::from(LATER_STEPS))
                };
                let maximum = if k == 0 { RISING_INCREMENT } else { FALLING_INCREMENT };
                json!({ "slip": slip, "increments": { "maximum": maximum, "initial": INITIAL * maximum } })
            };
            self.document["steps"] = (0..=LATER_STEPS).map(step).collect();
        }
        if self.document.get("until").is_none() {
            self.document["until"] = json!({ "quantity": until.0, "greater_than": until.1 });
        }
        self
    }

    /// The case with a bond law and nothing written but its history.
    pub fn computed(&self, law: &BondSlipLaw) -> Value {
        let mut case = self.with(law);
        case["output"] = json!({ "plots": false, "vtu": false });
        if let Some(case) = case.as_object_mut() {
            case.remove("compare");
        }
        case
    }

    /// The case with a bond law, to be kept in another folder; `compare` with what it was fitted to.
    pub fn kept(&self, law: &BondSlipLaw, title: &str, compare: Value) -> Value {
        let mut case = self.with(law);
        if self.is_own {
            make_absolute(&mut case, folder_of(&self.file));
        }
        case["title"] = json!(title);
        case["compare"] = json!([compare]);
        case
    }

    fn with(&self, law: &BondSlipLaw) -> Value {
        let mut case = self.document.clone();
        for (_, material) in laws_of(&mut case) {
            if let Some(props) = material["props"].as_object_mut() {
                // what belongs to another form would only mislead
                for name in ["a_1", "b_1", "a_2", "b_2", "points"] {
                    props.shift_remove(name);
                }
                props.extend(law.props());
            }
        }
        case
    }
}

/// The bond law of a case alone, to be pasted into another.
pub fn fragment(case: &Value) -> Value {
    let mut case = case.clone();
    let props = laws_of(&mut case).first().map(|(_, law)| law["props"].clone());
    json!({ "contact": { "law": { "plugin": "bond_slip", "props": props } } })
}

/// The materials of all contact pairs, with their places.
fn laws_of(case: &mut Value) -> Vec<(String, &mut Value)> {
    match &mut case["contact"] {
        Value::Object(pair) => pair.get_mut("law").map(|law| ("$.contact.law".into(), law)).into_iter().collect(),
        Value::Array(pairs) => {
            let pairs = pairs.iter_mut().enumerate();
            pairs.filter_map(|(k, pair)| Some((format!("$.contact[{k}].law"), pair.get_mut("law")?))).collect()
        }
        _ => Vec::new(),
    }
}

/// Names the files of a case in a folder so that it runs from any other.
pub fn make_absolute(value: &mut Value, folder: &Path) {
    match value {
        Value::String(text) if !text.is_empty() => {
            let path = folder.join(&text);
            if path.is_file() {
                *text = std::path::absolute(&path).unwrap_or(path).display().to_string();
            }
        }
        Value::Array(entries) => entries.iter_mut().for_each(|entry| make_absolute(entry, folder)),
        Value::Object(members) => {
            // the name of a law is no file
            let is_name = |key: &str, member: &Value| {
                key == "plugin" && member.as_str().is_some_and(|name| !host::names_a_file(name))
            };
            let members = members.iter_mut().filter(|(key, member)| !is_name(key, member));
            members.for_each(|(_, member)| make_absolute(member, folder));
        }
        _ => {}
    }
}

fn matrix(materials: &Materials) -> Result<Value, String> {
    let youngs_modulus = materials.matrix_modulus;
    match materials.matrix {
        MatrixLaw::Elastic => {
            Ok(json!({ "plugin": "linear_elastic", "props": { "E": youngs_modulus, "nu": MATRIX_POISSON } }))
        }
        MatrixLaw::ConcreteDamage => {
            let concrete = ConcreteProperties {
                youngs_modulus,
                poisson_ratio: MATRIX_POISSON,
                tensile_strength: STRENGTHS[0],
                compressive_strength: STRENGTHS[1],
                fracture_energy: Some(FRACTURE_ENERGIES[0]),
                crushing_energy: Some(FRACTURE_ENERGIES[1]),
            };
            let properties = properties_with_exponent(&concrete, COMPRESSIVE_EXPONENT)
                .map_err(|error| format!("--matrix concrete_damage: {error}"))?;
            let names = ConcreteDamage::INFO.parameters.iter().map(|parameter| parameter.name().to_owned());
            let props: Map<String, Value> = names.zip(properties.iter().map(|&value| json!(value))).collect();
            Ok(json!({ "plugin": "concrete_damage", "props": props }))
        }
    }
}
