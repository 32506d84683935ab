//! The host's normal law in the parameters of a law that is called as FRIC. The law takes the pressure that rubs
//! nothing (that of a soft normal law at gap 0) from its own parameters, since FRIC receives no other.

use crate::document::{PropValue, Props};
use crate::problem::Place;
use crate::reader::Reader;
use fe_core::model::NormalLaw;
use std::collections::BTreeMap;
use umat_abi::host::LawDescription;

/// Parameter that chooses a law's own normal law.
const KIND: &str = "normal_law";
/// Parameter for the pressure at gap 0 of the soft normal law, and for the tension that opens the hard one.
const PRESSURE: &str = "p_0";

/// Returns the parameters with the host's normal law where the case leaves it to the defaults of a law that has one;
/// problems where it names another. `None`: they stay as they are.
pub fn beside(
    reader: &mut Reader<'_>,
    law: &LawDescription,
    props: Option<&Props>,
    normal: NormalLaw,
    [place, place_of_normal]: [&Place; 2],
) -> Option<Props> {
    let kind = match normal {
        NormalLaw::Hard(_) => "hard",
        NormalLaw::Soft(_) => "soft",
    };
    let position = |name: &str| law.parameters.iter().position(|parameter| parameter.name == name);
    let (at, pressure_at) = (position(KIND)?, position(PRESSURE)?);
    let own = law.parameters[at].choices.iter().find(|choice| choice.name == kind)?.value;
    let place_of_normal = place_of_normal.key(kind);
    let advice = "FRIC uses the host's normal law; leave the parameter out, or give both the same value";
    if let Some((value, place)) = given(law, props, at, place)
        && value != own
    {
        reader.problem(&place, format!("is another normal law than {place_of_normal}: {advice}"));
        return None;
    }
    let place_of_pressure = place_of_normal.key(PRESSURE);
    match (given(law, props, pressure_at, place), normal) {
        (Some((value, place)), NormalLaw::Soft(soft)) if value != soft.p_0 => {
            let message = format!("{PRESSURE} is {value}, but {place_of_pressure} is {}: {advice}", soft.p_0);
            reader.problem(&place, message);
            return None;
        }
        // a list must have it
        (Some((value, place)), NormalLaw::Hard(hard))
            if value != hard.p_0 && !matches!(props, Some(Props::List(_))) =>
        {
            reader.warn_no_effect(&place, format!("under FRIC the tension that opens is {place_of_pressure}"));
        }
        _ => {}
    }
    let mut named = match props {
        Some(Props::List(_)) => return None,
        Some(Props::Named(named)) => named.clone(),
        None => BTreeMap::new(),
    };
    named.entry(KIND.to_owned()).or_insert(PropValue::Number(own));
    if let NormalLaw::Soft(soft) = normal {
        named.entry(PRESSURE.to_owned()).or_insert(PropValue::Number(soft.p_0));
    }
    Some(Props::Named(named))
}

/// Returns the value that a case gives a parameter, and its place; `None` also if it is wrong, which is reported with
/// the other parameters.
fn given(law: &LawDescription, props: Option<&Props>, at: usize, place: &Place) -> Option<(f64, Place)> {
    let parameter = &law.parameters[at];
    let named = match props? {
        Props::List(values) => return Some((*values.get(at)?, place.index(at))),
        Props::Named(named) => named,
    };
    let value = match named.get(&parameter.name)? {
        PropValue::Number(number) => *number,
        PropValue::Choice(name) => {
            parameter.choices.iter().find(|choice| choice.name.eq_ignore_ascii_case(name))?.value
        }
        PropValue::Occurrences(_) => return None,
    };
    Some((value, place.key(&parameter.name)))
}
