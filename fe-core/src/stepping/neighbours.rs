//! Runs of models that differ in one number by a little, led along the run of another one, which they differentiate.

use super::control::StepRun;
use super::newton::{Ahead, Attempt, Beside, Committed, Converged, Equilibrium, Target};
use super::{Analysis, ModelError, Record, Way};
use crate::contact::Settlement;
use crate::model::{IncrementContext, Model};
use umat_abi::host::ExternalDatabases;

/// The run of a model that differs by a little from the one that it goes along with.
pub(super) struct Neighbour<'m> {
    analysis: Analysis<'m>,
    ahead: Ahead,
    /// The present step, by its number.
    step: Option<(u32, StepRun)>,
    /// Where the present attempt leads.
    target: Target,
    context: IncrementContext,
    converged: Option<Converged>,
    /// Why it could not go along with the present attempt.
    trouble: Option<String>,
    /// Why it could not go along any further.
    lost: Option<String>,
}

impl<'m> Neighbour<'m> {
    /// Begins an attempt at an increment.
    fn begin(&mut self, to: Option<Way>, context: IncrementContext, start: &Committed) {
        let Analysis { model, present, equilibrium, .. } = &mut self.analysis;
        equilibrium.restore();
        self.ahead.set(&present.committed, start);
        self.context = context;
        self.trouble = None;
        self.target = match to {
            None => Target::Drives(present.committed.drives.clone()),
            Some(to) => {
                let number = context.step;
                let begins =
                    || (number, StepRun::new(&model.steps[number as usize - 1], &present.committed.drives, model));
                if self.step.as_ref().is_none_or(|(present, _)| *present != number) {
                    self.step = Some(begins());
                }
                self.step.get_or_insert_with(begins).1.recorded_target(to)
            }
        };
    }

    /// Its present state is the datum of its energies.
    pub(super) fn set_datum(&mut self) {
        self.analysis.set_datum();
    }

    fn go(&mut self, beside: Beside<'_, '_>) -> bool {
        let Self { analysis: Analysis { equilibrium, present, .. }, ahead, target, context, .. } = self;
        match equilibrium.go_beside(beside, &present.committed, target, *context, ahead) {
            Ok((converged, made_factor)) => {
                self.converged = Some(converged);
                made_factor
            }
            Err(trouble) => {
                let IncrementContext { step, increment, .. } = *context;
                self.trouble = Some(format!("step {step}, increment {increment}: {trouble}"));
                false
            }
        }
    }
}

fn another_mesh() -> ModelError {
    ModelError::Inconsistent("it makes another mesh, or other supports, contact or steps".into())
}

/// Leads all neighbours to the equilibrium beside one. The first that needs a factor of present tangents makes it for all.
fn go(
    neighbours: &mut [Neighbour<'_>],
    other: &mut Equilibrium<'_>,
    between: [&Committed; 2],
    iterations: usize,
    ends: bool,
) {
    let mut maker: Option<usize> = None;
    for index in 0..neighbours.len() {
        let (before, rest) = neighbours.split_at_mut(index);
        let goes_on = |neighbour: &&mut Neighbour<'_>| neighbour.lost.is_none() && neighbour.trouble.is_none();
        let Some(neighbour) = rest.first_mut().filter(goes_on) else { continue };
        let factor = maker.map(|maker| &mut before[maker].analysis.equilibrium.system);
        if neighbour.go(Beside { other, between, iterations, factor, ends }) {
            maker = Some(index);
        }
    }
}

/// Settles the contact of neighbours as that of an attempt that they go along with.
pub(super) fn settle(
    neighbours: &mut [Neighbour<'_>],
    other: &mut Equilibrium<'_>,
    attempt: &Attempt<'_>,
    settlement: &Settlement,
) {
    // multipliers become what pressures are; points that open forget theirs
    if !settlement.updated.is_empty() {
        go(neighbours, other, attempt.between(), attempt.iteration_count(), false);
    }
    for neighbour in neighbours {
        neighbour.analysis.equilibrium.contact.settle_as(settlement);
    }
}

impl<'m> Analysis<'m> {
    /// Lets the run of a model that differs from this one by a little go along: the observer hears of it by
    /// [`super::Observer::neighbours`]. It makes the increments of this run, opens the points of contact that open here and
    /// releases the elements that are released here, so that its records less those of this run, over the difference of the
    /// models, are derivatives (doc.md). Nothing of this run depends on it.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`], a model with another mesh, and libraries with UEXTERNALDB, which know one analysis only.
    pub fn accompany(&mut self, model: &'m Model) -> Result<(), ModelError> {
        Self::may_accompany(self.model, model)?;
        let mut analysis = Self::new(model)?;
        analysis.set_threads(self.equilibrium.threads().clone());
        let rows = |analysis: &Self| analysis.equilibrium.system.row_count();
        let (own, other) = (&analysis.equilibrium.contact, &self.equilibrium.contact);
        if rows(&analysis) != rows(self) || !own.has_points_of(other) {
            return Err(another_mesh());
        }
        self.neighbours.push(Neighbour {
            analysis,
            ahead: Ahead::default(),
            step: None,
            target: Target::Drives(Vec::new()),
            context: IncrementContext::default(),
            converged: None,
            trouble: None,
            lost: None,
        });
        Ok(())
    }

    /// Checks whether a model differs from another one in numbers alone.
    ///
    /// # Errors
    ///
    /// Another mesh, other supports, contact, loads or steps, and libraries with UEXTERNALDB.
    pub fn may_accompany(model: &Model, neighbour: &Model) -> Result<(), ModelError> {
        if ExternalDatabases::is_in(neighbour.libraries()) {
            let message = "a library has UEXTERNALDB, which knows one analysis at a time: no other goes along with it";
            return Err(ModelError::Inconsistent(message.into()));
        }
        let [own, other] = [neighbour, model].map(|model| {
            let Model { mesh, contacts, drives, supports, steps, couplings, measured, .. } = model;
            let elements: Vec<&[usize]> = mesh.elements().iter().map(|element| element.nodes()).collect();
            let edges: Vec<_> = contacts.iter().map(|pair| (&pair.slave, &pair.master)).collect();
            let nodes: Vec<_> = supports.iter().map(|support| (&support.nodes, support.drive)).collect();
            let coupled: Vec<_> = couplings.iter().map(|coupling| coupling.dependent).collect();
            (mesh.nodes().len(), elements, edges, nodes, coupled, [drives.len(), steps.len(), measured.fibres.len()])
        });
        if own == other { Ok(()) } else { Err(another_mesh()) }
    }

    /// Returns of each neighbour where and why it could not go along any further, if that is so.
    pub fn lost_neighbours(&self) -> impl Iterator<Item = Option<&str>> {
        self.neighbours.iter().map(|neighbour| neighbour.lost.as_deref())
    }

    /// Returns of each neighbour which part of what it differs by is rounding.
    pub fn uncertainty_of_neighbours(&self) -> impl Iterator<Item = f64> {
        self.neighbours.iter().map(|neighbour| neighbour.ahead.uncertainty())
    }

    /// Neighbours begin an attempt; `to`: not that of the datum.
    pub(super) fn begin_neighbours(&mut self, to: Option<Way>, context: IncrementContext) {
        for neighbour in &mut self.neighbours {
            neighbour.begin(to, context, &self.present.committed);
        }
    }

    /// Leads neighbours beside a converged increment, which is not committed yet.
    pub(super) fn lead_neighbours(&mut self, converged: &Converged) {
        let between = [&self.present.committed, &converged.end];
        go(&mut self.neighbours, &mut self.equilibrium, between, converged.iterations.len(), true);
    }

    /// Makes what neighbours were led to their present state, after the increment was committed; `released`: elements that were
    /// released then.
    pub(super) fn commit_neighbours(&mut self, time: f64, released: &[usize]) {
        for neighbour in self.neighbours.iter_mut().filter(|neighbour| neighbour.lost.is_none()) {
            neighbour.lost = neighbour.trouble.take();
            let Some(converged) = neighbour.converged.take().filter(|_| neighbour.lost.is_none()) else { continue };
            let own = &mut neighbour.analysis;
            let found = own.equilibrium.solids.trust_as(&self.equilibrium.solids);
            own.disbelieve(found);
            own.commit(converged, time);
            own.fade();
            if !released.is_empty() {
                own.release(released);
            }
        }
    }

    /// The records of neighbours.
    pub(super) fn records_of_neighbours(&self, step: u32, increment: u32) -> Vec<Option<Record>> {
        let record = |neighbour: &Neighbour<'_>| neighbour.analysis.record(step, increment, 0, Vec::new());
        self.neighbours.iter().map(|neighbour| neighbour.lost.is_none().then(|| record(neighbour))).collect()
    }
}
