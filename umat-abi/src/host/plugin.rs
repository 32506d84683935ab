//! A law of a library with everything that its calls need.

use super::{Frame, FricCall, LawDescription, Library, LoadError, Manner, UinterCall, UmatCall};
use crate::law::StressState;
use std::sync::Arc;

/// A law of a library, ready to be called.
#[derive(Clone, Debug)]
pub struct Plugin {
    /// The loaded library.
    pub library: Library,
    /// Metadata for the law; `None` for a plain UMAT, of which nothing is assumed.
    pub law: Option<LawDescription>,
    /// Name in messages and results: the law's name or the file's stem.
    pub name: String,
    /// The symbol of the entry point; `None`: the usual ones are tried.
    pub symbol: Option<String>,
    /// CMNAME or CINAME.
    pub cmname: String,
    /// PROPS.
    pub props: Vec<f64>,
    /// NSTATV.
    pub nstatv: usize,
    /// Manner in which its UMAT is called.
    pub manner: Manner,
    /// Local axes and free strains in which its UMAT sees its points; `None`: those of the host, and none.
    pub frame: Option<Arc<Frame>>,
}

impl Plugin {
    /// A law of a library; its PROPS stay those of the metadata.
    pub fn with_defaults(library: &Library, law: &LawDescription) -> Self {
        Self {
            library: library.clone(),
            name: law.name.clone(),
            symbol: None,
            cmname: law.name.to_uppercase(),
            props: Vec::new(),
            nstatv: law.states.len(),
            law: Some(law.clone()),
            manner: Manner::default(),
            frame: None,
        }
    }

    /// Plain calls of its UMAT.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn plain_umat(&self, state: StressState) -> Result<UmatCall, LoadError> {
        UmatCall::new(&self.library, self.symbol.as_deref(), &self.cmname, state, self.nstatv, &self.props)
    }

    /// Calls of its UINTER in 2 or 3 directions, the normal included.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn uinter(&self, directions: usize) -> Result<UinterCall, LoadError> {
        UinterCall::new(&self.library, self.symbol.as_deref(), &self.cmname, directions, self.nstatv, &self.props)
    }

    /// Calls of its FRIC with 1 or 2 tangential directions.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn fric(&self, directions: usize) -> Result<FricCall, LoadError> {
        FricCall::new(&self.library, self.symbol.as_deref(), &self.cmname, directions, self.nstatv, &self.props)
    }

    /// Index of the state that is the strain 33 of plane stress, if its metadata name one.
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
}
