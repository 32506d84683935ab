//! Driving a point along a path.

pub mod program;
