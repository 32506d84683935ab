use super::*;
use umat_abi::law::StressState;

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
        Plugin { props, ..Plugin::with_defaults(&library, &law) }.into()
    }

    /// Appends values to PROPS: a repeating group.
    pub(crate) fn followed_by(mut self, values: &[f64]) -> Self {
        self.plugin.props.extend_from_slice(values);
        self
    }
}

#[test]
fn a_shipped_law_is_called_through_its_plugin() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 200.0), ("nu", 0.0)]);
    assert!(law.has_symmetric_tangent());
    let mut call = law.umat(StressState::PlaneStress).unwrap();
    call.dstran[0] = 0.01;
    call.call(umat_abi::law::Request::StressAndTangent).unwrap();
    assert_eq!(call.stress(), [2.0, 0.0, 0.0]);
    assert!(law.error(law.uinter(2).unwrap_err()).to_string().starts_with("linear_elastic: "));
}
