//! Closed-form solutions that tests of the FE core compare with, each with its source.

pub mod beam;
pub mod capstan;
pub mod cylinder;
pub mod hertz;
pub mod pull_out;

#[cfg(test)]
mod test;
