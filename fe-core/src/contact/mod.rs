//! Contact between two chains of edges: kinematics, laws, enforcement.
