//! `libpullout_laws.so`: every law behind one `umat_`, `uinter_` and `fric_`, for hosts that load one library per job.
//! CMNAME and CINAME choose the law; see [`umat_abi::export_library!`].

use models::biaxial_damage::BiaxialDamage;
use models::bond_slip::BondSlip;
use models::concrete_damage::ConcreteDamage;
use models::drucker_prager::DruckerPrager;
use models::inelastic_damage::InelasticDamage;
use models::j2_plasticity::J2Plasticity;
use models::linear_elastic::LinearElastic;
use models::pure_damage::PureDamage;
use models::reverse_cyclic_damage::ReverseCyclicDamage;

umat_abi::export_library!(
    umat: [
        LinearElastic,
        PureDamage,
        InelasticDamage,
        ReverseCyclicDamage,
        BiaxialDamage,
        ConcreteDamage,
        J2Plasticity,
        DruckerPrager,
    ],
    interface: [BondSlip],
);
