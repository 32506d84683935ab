//! Increments: Newton, line search, cut-back, indirect control, energies.
