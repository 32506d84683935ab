//! Checks whether a crack band is valid for the cracks of a run: they must run along the edges of their elements, be
//! open all over them, and be as wide as CELENT, which the law receives.

use crate::number::significant;
use fe_core::assembly::Solids;
use fe_core::element::ElementKind;
use fe_core::model::{Model, PluginLaw};
use umat_abi::host::Validation;

/// Greatest angle of a crack that counts as one along an edge, degrees.
const ALONG: f64 = 10.0;
/// Below this share an element counts as open in part: one of two columns of points gives ½, strain that falls to a third
/// across an element ¾.
const OPEN_IN_PART: f64 = 0.7;
/// Widths of a band, relative to that which the law receives, that count as right.
const RIGHT_WIDTHS: std::ops::RangeInclusive<f64> = 0.75..=1.25;
/// Share of the damage up to which there is no warning.
const SMALL_SHARE: f64 = 0.2;
/// Share of the damage in the work, or in what the solids hold if that is more, below which nothing has cracked that would
/// govern a result.
const SMALL_DAMAGE: f64 = 0.01;

/// Crack of an element.
struct Crack {
    kind: ElementKind,
    /// Energy that it has dissipated, N·mm.
    damage: f64,
    /// The angle between the crack and the nearest edge, degrees.
    angle: f64,
    /// (∫ε dV)²/(V ∫ε² dV) of the greatest principal strain ε ≥ 0: the share of the element that opens.
    open: f64,
    /// The element's extent across the crack, of T6 the part that opens, relative to the width that the law receives.
    width: f64,
}

impl Crack {
    /// Returns whether it opens one of two columns of points.
    fn is_in_part(&self) -> bool {
        self.kind == ElementKind::Q8 && self.open < OPEN_IN_PART
    }
}

/// Warns of cracks that miss their energy, if that is a share of the drives' work that matters; the table is that of
/// `bench/crack-band`.
pub fn warnings(model: &Model, solids: &Solids, work: f64) -> Vec<String> {
    let has_band: Vec<bool> = model.laws.iter().map(has_band).collect();
    let elements = model.mesh.elements().iter().enumerate();
    let cracks: Vec<Crack> = elements
        .filter(|(element, definition)| has_band[definition.part()] && solids.damages(*element))
        .filter_map(|(element, _)| crack(model, solids, element))
        .collect();
    let energies = solids.energies();
    let all: f64 = cracks.iter().map(|crack| crack.damage).sum();
    let whole = work.abs().max(energies.stored + all);
    if all <= SMALL_DAMAGE * whole {
        return Vec::new();
    }
    let of_work = significant(100.0 * all / whole, 2);
    let share = |holds: &dyn Fn(&Crack) -> bool| {
        let held = cracks.iter().filter(|crack| holds(crack));
        held.map(|crack| crack.damage).sum::<f64>() / all
    };
    let reported = |share: f64| (share > SMALL_SHARE).then(|| significant(100.0 * share, 2));
    let across = reported(share(&|crack| crack.angle > ALONG)).map(|share| {
        format!(
            "crack band: cracks take {of_work} % of the work. Cracks lock in elements that they cross at more than {ALONG}° to the edges, which have {share} % of the damage: T6 dissipate up to 1.5 times the fracture energy, others up to twice. Put edges along the crack, or use T6 with concrete_damage_fixed (within 15 %)"
        )
    });
    let in_part = reported(share(&Crack::is_in_part)).map(|share| {
        format!(
            "crack band: cracks take {of_work} % of the work. Q8 elements with {share} % of the damage are only partly open, usually at one of two columns of points: they dissipate as little as 0.6 times the fracture energy. T6 and Q4 do not have this error"
        )
    });
    // the mean, since of two T6 that make a square one opens more and the other less
    let is_straight = |crack: &Crack| crack.angle <= ALONG && !crack.is_in_part();
    let straight = || cracks.iter().filter(|crack| is_straight(crack));
    let times = straight().map(|crack| crack.damage).sum::<f64>()
        / straight().map(|crack| crack.damage / crack.width).sum::<f64>();
    let wide = reported(share(&is_straight)).filter(|_| !RIGHT_WIDTHS.contains(&times)).map(|share| {
        let times = significant(times, 2);
        format!(
            "crack band: cracks take {of_work} % of the work. Cracks along edges, with {share} % of the damage, dissipate about {times} times the fracture energy, because the band is not as wide as CELENT (flat elements, or T6 that open all over): make elements as wide as long, or use Q4 where a whole column cracks"
        )
    });
    across.into_iter().chain(in_part).chain(wide).collect()
}

/// Returns whether a law asks for the width of a band.
fn has_band(law: &PluginLaw) -> bool {
    let validation = law.law.as_ref().map(|description| description.validate(&law.props, None));
    matches!(validation, Some(Validation::NeedsCharacteristicLength(_)))
}

/// `None` of an element that has dissipated nothing, or does not open.
fn crack(model: &Model, solids: &Solids, element: usize) -> Option<Crack> {
    let (mut volume, mut damage, mut mean) = (0.0, 0.0, [0.0; 3]);
    let (mut sum, mut squares) = (0.0, 0.0);
    for point in (0..solids.point_count(element)).map(|point| solids.point(element, point)) {
        let [e11, e22, e33, g12] = point.strain;
        let greatest = (0.5 * (e11 + e22) + 0.5 * (e11 - e22).hypot(g12)).max(e33).max(0.0);
        volume += point.volume;
        damage += point.volume * (point.energies[1] + point.energies[2]);
        sum += point.volume * greatest;
        squares += point.volume * greatest * greatest;
        mean.iter_mut().zip([e11, e22, g12]).for_each(|(mean, e)| *mean += point.volume * e);
    }
    if !(damage > 0.0 && squares > 0.0) {
        return None;
    }
    // the crack stands across the greatest principal strain
    let crack = 0.5 * mean[2].atan2(mean[0] - mean[1]) + std::f64::consts::FRAC_PI_2;
    let (positions, _) = model.mesh.element_positions(element);
    let kind = model.mesh.elements()[element].kind();
    let corners = kind.corner_count();
    let angle = |corner: usize| {
        let [[x0, y0], [x1, y1]] = [positions[corner], positions[(corner + 1) % corners]];
        let between = ((y1 - y0).atan2(x1 - x0) - crack).rem_euclid(std::f64::consts::PI);
        between.min(std::f64::consts::PI - between).to_degrees()
    };
    let angle = (0..corners).map(angle).fold(f64::INFINITY, f64::min);
    let open = sum * sum / (volume * squares);
    let (sine, cosine) = crack.sin_cos();
    let across = positions[..corners].iter().map(|[x, y]| y * cosine - x * sine);
    let [low, high] = across.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
    let opens = if kind == ElementKind::T6 { open } else { 1.0 };
    let width = opens * (high - low) / model.mesh.characteristic_length(element);
    Some(Crack { kind, damage, angle, open, width })
}
