//! A law behind the plugin interface, with the parameters it runs with.

use crate::kinematics::{MAX_COMPONENTS, PlaneModel};
use umat_abi::host::{
    FricCall, InitialPoint, InitialStates, InitialStresses, Law, Library, LoadError, Manner, UinterCall, UmatCall,
};
use umat_abi::law::StressState;
use umat_abi::metadata::{EQUIVALENT_PLASTIC_STRAIN, OVERSTRESS_WORK, flags};

/// The plugin of a part or of a contact pair; this crate knows no law in particular.
#[derive(Clone, Debug)]
pub struct PluginLaw {
    /// The loaded library.
    pub library: Library,
    /// Metadata for the law; `None` for a plain UMAT, of which nothing is assumed.
    pub law: Option<Law>,
    /// Name in messages.
    pub name: String,
    /// The symbol of the entry point; `None`: the usual ones are tried.
    pub symbol: Option<String>,
    /// CMNAME or CINAME.
    pub cmname: String,
    /// PROPS.
    pub props: Vec<f64>,
    /// NSTATV.
    pub nstatv: usize,
    /// STATEV of every point of a part at the start, NSTATV values; `None`: what the library's SDVINI sets, or zeros.
    pub statev0: Option<Vec<f64>>,
    /// Stress of every point of a part at the start, MPa: 11, 22, 33, 12, or r, z, θ, rz; `None`: what the library's SIGINI
    /// sets, or 0.
    pub stress0: Option<[f64; MAX_COMPONENTS]>,
    /// Way in which its UMAT is called.
    pub manner: Manner,
}

/// A law that cannot be called.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name}: {message}")]
pub struct LawError {
    /// The law's name.
    pub name: String,
    /// Why.
    pub message: String,
}

impl PluginLaw {
    /// Calls of its UMAT in a plane model.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn umat(&self, model: PlaneModel) -> Result<UmatCall, LawError> {
        let make = |state| self.plain_umat(state);
        self.manner.prepare(model.stress_state(), self.law.as_ref(), make).map_err(|error| self.error(&error))
    }

    /// Makes calls go through six components if the UMAT needs it and the user has not set it; then returns the reason. The
    /// call has the arguments of a virgin point.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn probe_umat(&self, call: &mut UmatCall) -> Result<Option<String>, LawError> {
        let make = |state| self.plain_umat(state);
        self.manner.probe(call, self.law.as_ref(), make).map_err(|error| self.error(&error))
    }

    /// Calls of its UMAT with six components.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn solid_umat(&self) -> Result<UmatCall, LawError> {
        self.plain_umat(StressState::ThreeD).map_err(|error| self.error(&error))
    }

    fn plain_umat(&self, state: StressState) -> Result<UmatCall, LoadError> {
        UmatCall::new(&self.library, self.symbol.as_deref(), &self.cmname, state, self.nstatv, &self.props)
    }

    /// Calls of its UINTER with one normal and one tangential direction.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn uinter(&self) -> Result<UinterCall, LawError> {
        let (symbol, name) = (self.symbol.as_deref(), &self.cmname);
        let call = UinterCall::new(&self.library, symbol, name, 2, self.nstatv, &self.props);
        let mut call = call.map_err(|error| self.error(&error))?;
        call.fence();
        Ok(call)
    }

    /// Calls of its FRIC with one tangential direction.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn fric(&self) -> Result<FricCall, LawError> {
        let (symbol, name) = (self.symbol.as_deref(), &self.cmname);
        let call = FricCall::new(&self.library, symbol, name, 1, self.nstatv, &self.props);
        let mut call = call.map_err(|error| self.error(&error))?;
        call.fence();
        Ok(call)
    }

    /// STATEV of a point at the start.
    ///
    /// # Errors
    /// A fault of SDVINI.
    pub fn states_of_point(&self, initial: &mut InitialStates, at: &InitialPoint) -> Result<Vec<f64>, LawError> {
        initial.of_point(at).map_err(|message| LawError { name: self.name.clone(), message })
    }

    /// Stress of a point at the start, in the order of UMAT's components.
    ///
    /// # Errors
    /// A fault of SIGINI.
    pub fn stress_of_point(
        &self,
        initial: &mut InitialStresses,
        at: &InitialPoint,
        element_type: &str,
    ) -> Result<Vec<f64>, LawError> {
        initial.of_point(at, element_type).map_err(|message| LawError { name: self.name.clone(), message })
    }

    /// Returns the source of the initial stresses of its points in a plane model.
    pub fn initial_stresses(&self, model: PlaneModel) -> InitialStresses {
        let components = model.stress_state().components();
        let given = self.stress0.map(|stress| components.iter().map(|&k| stress[k]).collect::<Vec<_>>());
        InitialStresses::new(&self.library, given.as_deref(), components.len())
    }

    /// Returns where the states of its points start from.
    pub fn initial_states(&self) -> InitialStates {
        InitialStates::new(&self.library, self.statev0.as_deref(), self.nstatv)
    }

    /// Returns whether its tangent is symmetric whatever the parameters and the state.
    pub fn has_symmetric_tangent(&self) -> bool {
        self.law.as_ref().is_some_and(|law| law.has(flags::SYMMETRIC_TANGENT))
    }

    /// Returns which of its states is the work of the overstress of a law that extrapolates, if it does.
    pub fn overstress_work(&self) -> Option<usize> {
        self.law.as_ref()?.state_index(OVERSTRESS_WORK)
    }

    /// Returns which of its states is the equivalent plastic strain, if it has one.
    pub fn equivalent_plastic_strain(&self) -> Option<usize> {
        self.law.as_ref()?.state_index(EQUIVALENT_PLASTIC_STRAIN)
    }

    /// Returns the index of the state that is the strain 33 of plane stress, if its metadata name one.
    pub fn strain_33(&self) -> Option<usize> {
        self.law.as_ref()?.state_index(c"strain_33")
    }

    /// Names of its state variables, by metadata or `sdv1`…, followed by those of its derived outputs.
    pub fn state_names(&self) -> Vec<String> {
        let described = self.law.iter().flat_map(|law| &law.states).map(|state| state.name.clone());
        let count = self.law.as_ref().map_or(0, |law| law.states.len());
        let others = (count + 1..=self.nstatv).map(|number| format!("sdv{number}"));
        let derived = self.law.iter().flat_map(|law| &law.derived).map(|derived| derived.name.clone());
        described.chain(others).chain(derived).collect()
    }

    fn error(&self, error: &LoadError) -> LawError {
        LawError { name: self.name.clone(), message: error.to_string() }
    }
}

#[cfg(test)]
impl PluginLaw {
    /// A shipped law with these parameters by name, the others at their defaults.
    pub(crate) fn shipped(name: &str, given: &[(&str, f64)]) -> Self {
        let library = end_to_end_tests::open(&end_to_end_tests::plugin(name));
        let law = library.laws()[0].clone();
        let mut props: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
        if let Some(group) = &law.group {
            props.truncate(law.parameters.len() - group.size);
        }
        for (key, value) in given {
            let index = law.parameters.iter().position(|parameter| parameter.name == *key);
            props[index.unwrap_or_else(|| panic!("{name} has no parameter {key}"))] = *value;
        }
        let (nstatv, cmname) = (law.states.len(), name.to_uppercase());
        Self {
            library,
            law: Some(law),
            name: name.into(),
            symbol: None,
            cmname,
            props,
            nstatv,
            statev0: None,
            stress0: None,
            manner: Manner::default(),
        }
    }

    /// Appends values to PROPS: a repeating group.
    pub(crate) fn followed_by(mut self, values: &[f64]) -> Self {
        self.props.extend_from_slice(values);
        self
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_shipped_law_is_called_through_its_plugin() {
        let law = PluginLaw::shipped("linear_elastic", &[("E", 200.0), ("nu", 0.0)]);
        assert!(law.has_symmetric_tangent());
        let mut call = law.umat(PlaneModel::PlaneStress).unwrap();
        call.dstran[0] = 0.01;
        call.call(umat_abi::law::Request::StressAndTangent).unwrap();
        assert_eq!(call.stress(), [2.0, 0.0, 0.0]);
        assert!(law.uinter().unwrap_err().to_string().starts_with("linear_elastic: "));
    }
}
