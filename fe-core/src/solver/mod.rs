//! Sparse direct solution with reused symbolic factorisations and checked residuals.
