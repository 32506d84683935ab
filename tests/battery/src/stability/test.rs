//! Every law of a solid, thrown at.

use super::forms;
use crate::STRESS_STATES;

/// States of each form and stress state.
const STATES: u64 = 10_000;

fn withstands(law: &str, label: &str) {
    let form = forms().into_iter().find(|form| form.law == law && form.label == label).expect("a form");
    for stress_state in STRESS_STATES {
        let ledger = form.throw(stress_state, STATES, 2, &|_| {});
        println!("{law} {label} {stress_state:?}: {ledger}");
        assert_eq!(ledger.failures(), 0, "{law} {label} {stress_state:?}: {ledger}");
    }
}

macro_rules! withstands {
    ($($test:ident: $law:literal $label:literal),* $(,)?) => {
        $(
            #[test]
            fn $test() {
                withstands($law, $label);
            }
        )*

        #[test]
        fn no_form_is_left_out() {
            let tested = [$(($law, $label)),*];
            assert_eq!(tested.to_vec(), forms().iter().map(|form| (form.law, form.label)).collect::<Vec<_>>());
        }
    };
}

withstands! {
    linear_elastic: "linear_elastic" "",
    pure_damage: "pure_damage" "",
    inelastic_damage: "inelastic_damage" "alpha = 1",
    inelastic_damage_marched: "inelastic_damage" "alpha != 1",
    reverse_cyclic_damage: "reverse_cyclic_damage" "thesis",
    reverse_cyclic_damage_regular: "reverse_cyclic_damage" "regular",
    biaxial_damage: "biaxial_damage" "implicit",
    biaxial_damage_lagged: "biaxial_damage" "lagged",
    concrete_damage: "concrete_damage" "IV-H",
    concrete_damage_inelastic: "concrete_damage" "IV-HP",
    concrete_damage_crack_band: "concrete_damage" "IV-H, crack band",
    concrete_damage_inelastic_crack_band: "concrete_damage" "IV-HP, crack band",
    concrete_phase_field: "concrete_phase_field" "",
    j2_plasticity: "j2_plasticity" "",
    drucker_prager: "drucker_prager" "",
}
