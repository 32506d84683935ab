//! Frame in which a law sees its point: local axes, and strains without the stress-free part.
//!
//! It corresponds to *ORIENTATION and *EXPANSION of ABAQUS. With the axes A (a row each), the rotation R of F = R U and
//! the free strain ε* (along the local axes, its logarithm where displacements are large):
//!
//! ```text
//! small       STRAN = A ε Aᵀ − ε*                STRESS = A σ Aᵀ
//! large       A₁ = A Rᵀ in the place of A        DFGRD = A U Aᵀ exp(−ε*)      DROT = A₁ ΔR A₀ᵀ
//! ```
//!
//! The axes follow the material, so that DFGRD has the components of the stretch and DROT is close to 1.

use super::call::UmatCall;
use crate::law::{Heat, Request, StressState};
use std::sync::Arc;

type Matrix = [[f64; 3]; 3];

/// Axes of the components 11, 22, 33, 12, 13, 23.
const AXES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
/// 33 among the six components.
const THROUGH: usize = 2;

/// Values along three axes that go linearly from place to place, and stay beyond the ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    places: Vec<f64>,
    values: Vec<[f64; 3]>,
}

impl Course {
    /// Values at places that grow; `None` if there are none, not as many of both, or a place does not grow.
    pub fn new(places: Vec<f64>, values: Vec<[f64; 3]>) -> Option<Self> {
        let grows = places.windows(2).all(|pair| pair[0] < pair[1]);
        (grows && places.len() == values.len() && !places.is_empty()).then_some(Self { places, values })
    }

    /// The same values at all places.
    pub fn constant(values: [f64; 3]) -> Self {
        Self { places: vec![0.0], values: vec![values] }
    }

    /// The values at a place.
    pub fn at(&self, place: f64) -> [f64; 3] {
        let after = self.places.partition_point(|known| *known < place);
        match (after.checked_sub(1), self.places.get(after)) {
            (Some(before), Some(next)) => {
                let share = (place - self.places[before]) / (next - self.places[before]);
                let [from, to] = [before, after].map(|k| self.values[k]);
                std::array::from_fn(|k| if share == 1.0 { to[k] } else { from[k] + share * (to[k] - from[k]) })
            }
            (Some(last), None) => self.values[last],
            (None, _) => self.values.first().copied().unwrap_or_default(),
        }
    }

    /// The values at a place, and how they change there; at a given place, from it on.
    fn with_slope(&self, place: f64) -> [[f64; 3]; 2] {
        let after = self.places.partition_point(|known| *known <= place);
        let slope = match (after.checked_sub(1), self.places.get(after)) {
            (Some(before), Some(next)) => {
                let [from, to] = [before, after].map(|k| self.values[k]);
                std::array::from_fn(|k| (to[k] - from[k]) / (next - self.places[before]))
            }
            _ => [0.0; 3],
        };
        [self.at(place), slope]
    }

    /// Returns whether the values are the same along all axes everywhere.
    pub fn is_isotropic(&self) -> bool {
        self.values.iter().all(|[first, others @ ..]| others.iter().all(|other| other == first))
    }
}

/// Thermal strain: ε = α(T) (T − T₀) − α(Tᵢ) (Tᵢ − T₀), a secant coefficient as in *EXPANSION.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    /// α over the temperature, along the local axes.
    pub coefficients: Course,
    /// T₀, to which α refers.
    pub zero_temperature: f64,
    /// Tᵢ, at which there is no thermal strain.
    pub initial_temperature: f64,
}

impl Expansion {
    /// The thermal strain along the local axes.
    pub fn strain(&self, temperature: f64) -> [f64; 3] {
        let from_zero = |temperature: f64| {
            self.coefficients.at(temperature).map(|coefficient| coefficient * (temperature - self.zero_temperature))
        };
        let (now, initial) = (from_zero(temperature), from_zero(self.initial_temperature));
        std::array::from_fn(|k| now[k] - initial[k])
    }

    /// The derivative of the thermal strain by the temperature.
    pub fn rate(&self, temperature: f64) -> [f64; 3] {
        let [coefficients, slope] = self.coefficients.with_slope(temperature);
        std::array::from_fn(|k| coefficients[k] + slope[k] * (temperature - self.zero_temperature))
    }
}

/// Local axes and free strains of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Local axes, a row each; `None`: those of the host.
    pub axes: Option<[[f64; 3]; 3]>,
    /// Thermal strain.
    pub expansion: Option<Expansion>,
    /// Strain over the total time that is free of stress whatever the temperature: shrinkage, swelling.
    pub shrinkage: Option<Course>,
}

impl Frame {
    /// Returns whether it changes nothing.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// The free strain along the local axes.
    pub fn free_strain(&self, temperature: f64, time: f64) -> [f64; 3] {
        let thermal = self.expansion.as_ref().map_or([0.0; 3], |expansion| expansion.strain(temperature));
        let Some(shrinkage) = &self.shrinkage else { return thermal };
        let other = shrinkage.at(time);
        std::array::from_fn(|k| thermal[k] + other[k])
    }

    /// Components of a stress in the host's axes, of one in the local axes; both have the components of the state.
    pub fn stress_outside(&self, stress: &mut [f64], state: StressState) {
        let Some(axes) = &self.axes else { return };
        let outside = of_components(&turned_back(&strain_turn(axes), &state.six(stress)), state);
        let count = stress.len();
        stress.copy_from_slice(&outside[..count]);
    }
}

/// What the law was given in a frame, and its stress, in the local axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct LawView {
    /// STRAN.
    pub strain: [f64; 6],
    /// DSTRAN.
    pub strain_increment: [f64; 6],
    /// STRESS on entry.
    pub stress_before: [f64; 6],
    /// STRESS.
    pub stress: [f64; 6],
    /// DFGRD0, column-major.
    pub dfgrd0: [[f64; 3]; 3],
}

/// Course of the free strain over an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FreeStrain {
    /// It grows from start to end.
    #[default]
    Grows,
    /// It stays as it is at the start.
    AtStart,
    /// It is that of the end from the start on.
    AtEnd,
}

/// A frame with what the last call in it was given.
#[derive(Clone, Debug)]
pub(super) struct Framed {
    frame: Arc<Frame>,
    course: FreeStrain,
    view: LawView,
}

/// Inputs as the host has them, while the law has its own.
struct Outside {
    strains: [[f64; 6]; 2],
    rotation: Matrix,
    gradients: [Matrix; 2],
    /// Turns strains into the local axes at the end.
    turn: Option<[[f64; 6]; 6]>,
}

impl UmatCall {
    /// Makes the plugin see its point in a frame.
    pub fn set_frame(&mut self, frame: Option<Arc<Frame>>) {
        self.put_framed(frame.map(|frame| Framed { frame, course: FreeStrain::default(), view: LawView::default() }));
    }

    /// Returns the frame.
    pub fn frame(&self) -> Option<&Frame> {
        Some(&self.detour.as_ref()?.framed.as_ref()?.frame)
    }

    /// Returns what the law was given in its frame by the last call; `None`: what the call has.
    pub fn law_view(&self) -> Option<&LawView> {
        Some(&self.detour.as_ref()?.framed.as_ref()?.view)
    }

    /// Sets how the free strain goes in the next calls.
    pub fn set_free_strain(&mut self, course: FreeStrain) {
        if let Some(framed) = self.detour.as_mut().and_then(|detour| detour.framed.as_mut()) {
            framed.course = course;
        }
    }

    /// The free strain 33 at a temperature and a total time; 0 without a frame.
    pub fn free_strain_33(&self, temperature: f64, time: f64) -> f64 {
        self.frame().map_or(0.0, |frame| frame.free_strain(temperature, time)[THROUGH])
    }

    /// The free strain 33 at the end of the increment; 0 without a frame.
    pub fn free_strain_33_at_end(&self) -> f64 {
        self.free_strain_33(self.temp + self.dtemp, self.time[1] + self.dtime)
    }

    /// Does something with the law's arguments in the place of the host's, and turns its results back; `request`: those there are.
    pub(super) fn in_frame<T>(&mut self, framed: &mut Framed, request: Request, act: impl FnOnce(&mut Self) -> T) -> T {
        let at_start = || framed.frame.free_strain(self.temp, self.time[1]);
        let at_end = || framed.frame.free_strain(self.temp + self.dtemp, self.time[1] + self.dtime);
        let [start, end] = match framed.course {
            FreeStrain::Grows => [at_start(), at_end()],
            FreeStrain::AtStart => [at_start(); 2],
            FreeStrain::AtEnd => [at_end(); 2],
        };
        let outside = self.enter(&framed.frame, [start, end]);
        self.strain_33 -= start[THROUGH];
        framed.view = LawView {
            strain: self.stran,
            strain_increment: self.dstran,
            stress_before: first_six(self.stress()),
            stress: [0.0; 6],
            dfgrd0: self.dfgrd0,
        };
        let result = act(self);
        self.strain_33 += end[THROUGH];
        framed.view.stress = first_six(self.stress());
        if let Some(expansion) = &framed.frame.expansion
            && framed.course != FreeStrain::AtStart
        {
            self.follow_expansion(expansion.rate(self.temp + self.dtemp), request);
        }
        self.leave(&outside, request);
        result
    }

    /// Sets the law's arguments.
    fn enter(&mut self, frame: &Frame, free: [[f64; 3]; 2]) -> Outside {
        let state = self.stress_state();
        let is_large = self.jstep[2] != 0;
        let (strains, rotation) = ([self.stran, self.dstran], self.drot);
        let columns = [self.dfgrd0, self.dfgrd1];
        let mut gradients = columns.each_ref().map(transpose);
        let mut turn = None;
        if let Some(axes) = &frame.axes {
            let mut axes_at_end = *axes;
            if is_large {
                let [start, end] = gradients.each_ref().map(|f| product(axes, &transpose(&rotation_of(f))));
                gradients = [(start, gradients[0]), (end, gradients[1])]
                    .map(|(now, gradient)| product(&product(&now, &gradient), &transpose(axes)));
                // DROT is column-major as well
                self.drot = transpose(&product(&product(&end, &transpose(&rotation)), &transpose(&start)));
                axes_at_end = end;
            }
            let of_strain = strain_turn(&axes_at_end);
            let of_stress = stress_turn(&axes_at_end);
            self.stran = of_components(&turned(&of_strain, &state.six(&strains[0])), state);
            self.dstran = of_components(&turned(&of_strain, &state.six(&strains[1])), state);
            let stress = of_components(&turned(&of_stress, &state.six(self.stress())), state);
            let count = self.ntens();
            self.stress_mut().copy_from_slice(&stress[..count]);
            turn = Some(of_strain);
        }
        for (k, &component) in state.components().iter().enumerate().filter(|(_, component)| **component < 3) {
            self.stran[k] -= free[0][component];
            self.dstran[k] -= free[1][component] - free[0][component];
        }
        if is_large {
            for (gradient, free) in gradients.iter_mut().zip(&free) {
                for row in &mut *gradient {
                    row.iter_mut().zip(free).for_each(|(entry, strain)| *entry *= (-strain).exp());
                }
                if state == StressState::PlaneStress {
                    // of a constant volume, as a host has it without a frame
                    gradient[2][2] = 1.0 / (gradient[0][0] * gradient[1][1] - gradient[0][1] * gradient[1][0]);
                }
            }
            [self.dfgrd0, self.dfgrd1] = gradients.each_ref().map(transpose);
        }
        Outside { strains, rotation, gradients: columns, turn }
    }

    /// Makes the derivatives by the temperature those at a given strain of the host: the strain of the law falls by what expands. DDSDDT follows
    /// where there is DDSDDE, which is that of the Kirchhoff stress under large displacements.
    fn follow_expansion(&mut self, rate: [f64; 3], request: Request) {
        let components = self.stress_state().components();
        let rates: [f64; 6] =
            std::array::from_fn(|k| components.get(k).filter(|component| **component < 3).map_or(0.0, |&k| rate[k]));
        let mut heat = self.heat();
        heat.drpldt -= heat.drplde.iter().zip(&rates).map(|(by, rate)| by * rate).sum::<f64>();
        if request.wants_tangent() {
            let dilatation = if self.jstep[2] != 0 { rates.iter().sum() } else { 0.0 };
            for (row, stress) in self.stress().iter().enumerate() {
                let lost: f64 = (0..self.ntens()).map(|column| self.tangent(row, column) * rates[column]).sum();
                heat.ddsddt[row] += dilatation * stress - lost;
            }
        }
        self.set_heat(heat);
    }

    /// Sets the host's inputs again, and turns the results into its axes.
    fn leave(&mut self, outside: &Outside, request: Request) {
        [self.stran, self.dstran] = outside.strains;
        self.drot = outside.rotation;
        [self.dfgrd0, self.dfgrd1] = outside.gradients;
        let Some(turn) = &outside.turn else { return };
        let state = self.stress_state();
        let stress = of_components(&turned_back(turn, &state.six(self.stress())), state);
        let ntens = self.ntens();
        self.stress_mut().copy_from_slice(&stress[..ntens]);
        let heat = self.heat();
        let [ddsddt, drplde] =
            [heat.ddsddt, heat.drplde].map(|law| of_components(&turned_back(turn, &state.six(&law[..ntens])), state));
        self.set_heat(Heat { ddsddt, drplde, ..heat });
        if !request.wants_tangent() {
            return;
        }
        let components = state.components();
        let mut moduli = [[0.0; 6]; 6];
        for (i, &row) in components.iter().enumerate() {
            for (j, &column) in components.iter().enumerate() {
                moduli[row][column] = self.tangent(i, j);
            }
        }
        // Nᵀ C N
        let half: [[f64; 6]; 6] = moduli.map(|row| turned_back(turn, &row));
        for (j, &column) in components.iter().enumerate() {
            let of_column = turned_back(turn, &half.map(|row| row[column]));
            for (i, &row) in components.iter().enumerate() {
                self.tangent.as_mut_slice()[j * ntens + i] = of_column[row];
            }
        }
    }
}

/// Returns the components of a stress state, in its order, followed by zeros.
fn of_components(six: &[f64; 6], state: StressState) -> [f64; 6] {
    let mut values = [0.0; 6];
    values.iter_mut().zip(state.components()).for_each(|(value, &component)| *value = six[component]);
    values
}

/// Returns the values, followed by zeros.
fn first_six(values: &[f64]) -> [f64; 6] {
    std::array::from_fn(|k| values.get(k).copied().unwrap_or_default())
}

/// Matrix that turns the components of a strain, with engineering shear, into axes (a row each).
fn strain_turn(axes: &Matrix) -> [[f64; 6]; 6] {
    turn(axes, [2.0, 0.5])
}

/// Matrix that turns the components of a stress into axes.
fn stress_turn(axes: &Matrix) -> [[f64; 6]; 6] {
    turn(axes, [1.0, 1.0])
}

/// Matrix that turns the six components of a symmetric tensor, whose shears are `to` times those of the tensor afterwards, and
/// have half of `from` of both halves of it before.
fn turn(a: &Matrix, [to, from]: [f64; 2]) -> [[f64; 6]; 6] {
    AXES.map(|[i, j]| {
        AXES.map(|[k, l]| {
            let sum = if k == l { a[i][k] * a[j][k] } else { from * (a[i][k] * a[j][l] + a[i][l] * a[j][k]) };
            if i == j { sum } else { to * sum }
        })
    })
}

fn turned(turn: &[[f64; 6]; 6], tensor: &[f64; 6]) -> [f64; 6] {
    turn.map(|row| row.iter().zip(tensor).map(|(a, b)| a * b).sum())
}

/// By the transpose: what is conjugate to a turned strain, back in the axes before.
fn turned_back(turn: &[[f64; 6]; 6], tensor: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|column| turn.iter().zip(tensor).map(|(row, value)| row[column] * value).sum())
}

fn transpose(matrix: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[j][i]))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// R of F = R U, by Newton's method: R → (R + R⁻ᵀ)/2.
fn rotation_of(gradient: &Matrix) -> Matrix {
    // quadratic: a stretch of 1000 takes 15
    const MAX_ITERATIONS: usize = 40;
    const TOLERANCE: f64 = 1e-15;
    let mut rotation = *gradient;
    for _ in 0..MAX_ITERATIONS {
        let [a, b, c] = rotation;
        let cofactors = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let determinant: f64 = a.iter().zip(&cofactors[0]).map(|(x, y)| x * y).sum();
        let next: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (rotation[i][j] + cofactors[i][j] / determinant)));
        let changes = next.as_flattened().iter().zip(rotation.as_flattened());
        let change = changes.fold(0.0_f64, |most, (new, old)| most.max((new - old).abs()));
        rotation = next;
        if change <= TOLERANCE || !change.is_finite() {
            break;
        }
    }
    rotation
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

#[cfg(test)]
mod test;
