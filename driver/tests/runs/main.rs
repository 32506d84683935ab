//! The program as its users meet it: exit codes, messages, files, figures. One test program, which is linked once.

mod book;
mod bridging;
mod cases;
mod claims;
mod command_line;
mod crack_band;
mod fit;
mod fit_case;
mod inclined;
mod increments;
mod misbehaving;
mod phase_field;
#[path = "../program/mod.rs"]
mod program;
mod restart;
mod results;
mod specimens;
mod study;
mod sweep;
mod threads;
