//! The command line.

use clap::Parser;

/// Drives material and contact points through UMAT, UINTER and FRIC plugins.
#[derive(Parser)]
#[command(name = "pullout", version)]
struct Arguments {}

fn main() {
    Arguments::parse();
}
