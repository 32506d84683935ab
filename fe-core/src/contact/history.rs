//! History of contact points: plain numbers in flat arrays, one set committed, one on trial.

use super::chain::Foot;
use super::normal::NormalState;
use serde::{Deserialize, Serialize};
use umat_abi::host::FricCall;

/// Status of a point. UINTER does not return one: there, slipping means that the plugin's dissipation grew in the
/// increment, and open that the traction is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum PointStatus {
    /// Holds without dissipation.
    #[default]
    Sticking,
    /// Slides, or its bond is degrading.
    Slipping,
    /// Transmits nothing.
    Open,
    /// Past an end of the master, or on matter that is gone.
    Released,
}

/// The numbers of one point. All energies are accumulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PointState {
    pub foot: Foot,
    /// g_N, ḡ of a patch, and g, mm.
    pub gap: f64,
    pub slip: f64,
    /// Arc length of the master from which the slip counts, mm.
    pub origin: f64,
    /// Whether it lies on a surface that came to light and has not touched the master yet: it transmits nothing, and has not slid.
    pub apart: bool,
    /// Whether its matter is gone: it never comes back.
    pub gone: bool,
    /// The point's own g_N, mm.
    pub own_gap: f64,
    /// n·dx/ds₀ where normals are smoothed.
    pub lean: f64,
    /// Largest |g| so far, mm.
    pub largest_slip: f64,
    /// w.
    pub weight: f64,
    /// p and τ, MPa.
    pub pressure: f64,
    pub shear: f64,
    /// Pressure due to the deviation of the point's own gap from its patch's, MPa, and the energy that it stores, N/mm.
    pub own_pressure: f64,
    pub own_energy: f64,
    pub normal: NormalState,
    pub status: PointStatus,
    /// Whether the penalty of a hard law holds it: what Uzawa updates.
    pub held: bool,
    /// Accumulated DSLIP of FRIC, mm, and its LM of the next call.
    pub inelastic_slip: f64,
    pub stick: i32,
    /// Depth to which its surface was crushed up to the start of the increment, from which gaps are measured, and depth by which it is
    /// crushed in the increment, mm.
    pub crushed: f64,
    pub crushing: f64,
    /// Depth beyond that to which its own pressure has crushed the surface, and crushes it in the increment, mm.
    pub turned: f64,
    pub turning: f64,
    /// LOPENCLOSE and LSTATE of UINTER.
    pub flags: [i32; 2],
    /// SED, SFD, SPD, SVD, SCD as the plugin left them, N/mm.
    pub plugin_energies: [f64; 5],
    /// Stored by the host's normal law, N/mm.
    pub normal_energy: f64,
    /// Work, N·mm: work on the point, dissipated in the plugin, opening of the host's law, lost by release.
    pub work: f64,
    /// Work of the pressure along normals that lean against their edges.
    pub leaning: f64,
    pub dissipated: f64,
    pub opening: f64,
    pub released: f64,
}

impl PointState {
    /// A virgin point over its foot.
    pub fn new(foot: Foot, weight: f64) -> Self {
        Self { foot, weight, stick: FricCall::STICKING, flags: [-1; 2], ..Self::default() }
    }

    /// Returns whether it is past an end of the master, and may come back.
    pub fn is_beyond(&self) -> bool {
        self.weight == 0.0 && !self.apart && !self.gone
    }

    /// Status by which it is counted: past an end of the master it is released, even if an attempt brought it back over the end, which
    /// takes its bond and leaves it open.
    pub fn counted_status(&self) -> PointStatus {
        if self.is_beyond() { PointStatus::Released } else { self.status }
    }

    /// The state that the next increment starts from: what was crushed is gone, and gaps are measured from what is left.
    pub fn crushed_for_good(self) -> Self {
        let Self { gap, own_gap, crushed, crushing, turned, turning, .. } = self;
        if crushing == 0.0 && turning == 0.0 {
            return self;
        }
        let (crushed, turned) = (crushed + crushing, turned + turning);
        Self { gap: gap + crushing, own_gap: own_gap + crushing, crushed, crushing: 0.0, turned, turning: 0.0, ..self }
    }

    /// Returns whether it has come over an end of the master, with less than half of its area so far: its gap need not be closed further
    /// than the penalty does, since the less of its area is over the master, the greater the pressure that this would take.
    pub fn comes_in(&self) -> bool {
        self.weight < 0.5 && self.normal.latched
    }

    /// Books the energies of an increment that led here from `start`, by trapezoids; `area` mm².
    pub fn book(&mut self, start: &Self, area: f64) {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let weight = mean(start.weight, self.weight);
        let pressing = |state: &Self| state.weight * (state.pressure + state.own_pressure);
        let pressing = [pressing(start), pressing(self)];
        let sliding = mean(start.weight * start.shear, self.weight * self.shear) * (self.slip - start.slip);
        // a point under a normal that leans against its edge moves along the normal when it slides: v·du = dg + (n·dx/ds₀) ds₀
        let leaning = mean(-pressing[0] * start.lean, -pressing[1] * self.lean) * (self.slip - start.slip);
        self.leaning += area * leaning;
        self.work += area * (mean(pressing[0], pressing[1]) * (start.own_gap - self.own_gap) + sliding);
        let spent = |state: &Self| state.plugin_energies[1..].iter().sum::<f64>();
        let alone = mean(start.weight * start.own_pressure, self.weight * self.own_pressure);
        let crushing = mean(pressing[0], pressing[1]) * self.crushing + alone * self.turning;
        self.dissipated += area * weight * (spent(self) - spent(start));
        self.dissipated += area * crushing;
        // tractions of a point under a force grow with 1/w, and ψ with 1/w²: the arithmetic mean would release more than there is
        let [before, after] = [start.stored(), self.stored()];
        // what comes over an end brings what it stores with it
        let stored = if start.weight == 0.0 { after } else { before.signum() * (before * after).max(0.0).sqrt() };
        // the pressure of a patch works on the gaps of its points: on the mean gap, except for what fades, as Σ A w
        // (g_N − ḡ) = 0
        let aside = |state: &Self| state.own_gap - state.gap;
        let fading = stored - mean(start.pressure * aside(self), self.pressure * aside(start));
        self.released += area * fading * (start.weight - self.weight);
        if self.normal.opening > start.normal.opening || self.normal.latched != start.normal.latched {
            let work = mean(start.pressure, self.pressure) * (start.gap - self.gap);
            self.opening += area * weight * (work + start.normal_energy - self.normal_energy);
        }
    }

    /// Ends contact for good where the surface is gone; `area` mm².
    pub fn release(&mut self, area: f64) {
        self.released += area * self.weight * self.stored();
        (self.weight, self.status, self.gone) = (0.0, PointStatus::Released, true);
        (self.pressure, self.shear, self.own_pressure, self.held) = (0.0, 0.0, 0.0, false);
    }

    /// Stored energy per area, plugin, normal law and the point's own gap, N/mm.
    pub fn stored(&self) -> f64 {
        self.plugin_energies[0] + self.normal_energy + self.own_energy
    }
}

/// All points of a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct History {
    pub points: Vec<PointState>,
    /// STATEV, point by point.
    pub statev: Vec<f64>,
}

impl History {
    /// Takes another one's numbers without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.points.copy_from_slice(&other.points);
        self.statev.copy_from_slice(&other.statev);
    }
}
