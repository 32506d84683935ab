//! Strain-driven loading along 11 with some stresses kept at zero, and its peak.

use super::Point;
use umat_abi::law::{Law, StressState};

/// Bar whose free components share one strain and have zero stress: e.g. \[1, 2\] is uniaxial stress in 3-D, \[1\] is
/// uniaxial stress in plane stress or uniaxial plane strain, none is uniaxial strain.
pub struct Uniaxial<'p, L: Law> {
    point: Point<'p, L>,
    free: &'static [usize],
    /// Lateral over axial strain where the next search starts; it selects the branch, if there are several.
    pub ratio: f64,
}

impl<'p, L: Law> Uniaxial<'p, L> {
    /// Makes a bar whose `free` components of stress vanish.
    pub fn new(props: &'p [f64], stress_state: StressState, free: &'static [usize]) -> Self {
        Self { point: Point::virgin(props, stress_state), free, ratio: 0.0 }
    }

    /// σ11 at ε11 = `axial` from the virgin state, by Newton's method from the last call's ratio of
    /// lateral to axial strain.
    pub fn stress(&mut self, axial: f64) -> f64 {
        let mut lateral = self.ratio * axial;
        for _ in 0..60 {
            let mut strain = [axial, 0.0, 0.0, 0.0, 0.0, 0.0];
            for &i in self.free {
                strain[i] = lateral;
            }
            let (response, _) = self.point.trial(&strain);
            if self.free.is_empty() {
                return response.stress[0];
            }
            let slope: f64 = self.free.iter().map(|&j| response.tangent[self.free[0]][j]).sum();
            let step = -response.stress[self.free[0]] / slope;
            lateral += step;
            if step.abs() <= 1e-12 * axial.abs() {
                self.ratio = lateral / axial;
                return response.stress[0];
            }
        }
        panic!("{}: no uniaxial equilibrium at {axial}", L::INFO.name.to_string_lossy());
    }

    /// The first peak of |σ11| when ε11 grows in `cells` cells to `end`: (σ11, ε11).
    pub fn peak(&mut self, end: f64, cells: u32) -> (f64, f64) {
        let mut last = 0.0;
        let mut cell = 1;
        loop {
            let stress = self.stress(end * f64::from(cell) / f64::from(cells)).abs();
            if stress < last {
                break;
            }
            assert!(cell < cells, "no peak up to {end}");
            last = stress;
            cell += 1;
        }
        let at = |c: u32| end * f64::from(c) / f64::from(cells);
        self.peak_between(at(cell.saturating_sub(2)), at(cell))
    }

    /// The largest |σ11| between two axial strains: (σ11, ε11), by golden section.
    pub fn peak_between(&mut self, mut low: f64, mut high: f64) -> (f64, f64) {
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        while (high - low).abs() > 1e-9 * high.abs() {
            let (a, b) = (high - ratio * (high - low), low + ratio * (high - low));
            if self.stress(a).abs() > self.stress(b).abs() {
                high = b;
            } else {
                low = a;
            }
        }
        let axial = 0.5 * (low + high);
        (self.stress(axial), axial)
    }
}
