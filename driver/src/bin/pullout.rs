//! The program: everything is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    driver::command::main(std::env::args_os()).into()
}
