//! `libpullout_laws.so`: one `umat_`, `uinter_` and `fric_` for all laws, for hosts that load one library per job.
//! CMNAME or CINAME selects the law; see [`umat_abi::export_library!`].

use models::biaxial_damage::BiaxialDamage;
use models::bond_slip::BondSlip;
use models::concrete_damage::{ConcreteDamage, ConcreteDamageFixed, ConcreteDamageImplex, ConcretePhaseField};
use models::drucker_prager::DruckerPrager;
use models::inelastic_damage::InelasticDamage;
use models::j2_plasticity::J2Plasticity;
use models::linear_elastic::LinearElastic;
use models::pure_damage::PureDamage;
use models::reverse_cyclic_damage::ReverseCyclicDamage;

umat_abi::export_library!(
    umat: [
        LinearElastic => "linear_elastic",
        PureDamage => "pure_damage",
        InelasticDamage => "inelastic_damage",
        ReverseCyclicDamage => "reverse_cyclic_damage",
        BiaxialDamage => "biaxial_damage",
        ConcreteDamage => "concrete_damage",
        ConcreteDamageImplex => "concrete_damage_implex",
        ConcreteDamageFixed => "concrete_damage_fixed",
        ConcretePhaseField => "concrete_phase_field",
        J2Plasticity => "j2_plasticity",
        DruckerPrager => "drucker_prager",
    ],
    interface: [BondSlip => "bond_slip"],
);
