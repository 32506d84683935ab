//! `libconcrete_phase_field.so`: concrete whose cracks are a phase field as a UMAT.

umat_abi::export_umat!(models::concrete_damage::ConcretePhaseField, "concrete_phase_field");
