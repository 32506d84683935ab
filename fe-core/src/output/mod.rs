//! Fields at nodes and points, and the files that hold them.
