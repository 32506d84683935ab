//! `kratos/libconcrete_phase_field.so`: `concrete_phase_field` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::concrete_damage::ConcretePhaseField, "concrete_phase_field");
