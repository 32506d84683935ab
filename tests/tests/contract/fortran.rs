//! `pullout_umat.f90`: the three argument lists as abstract interfaces.

use crate::source::{Argument, EntryPoint};
use std::fmt::Write;

const PREFACE: &str = "\
! The plugin contract of Pullout: UMAT, FRIC and UINTER as Fortran sees them.
!
!    use pullout_umat, only: umat_interface
!    procedure(umat_interface) :: linear_elastic_umat   ! in liblinear_elastic.so and libpullout_laws.so
!
!    use pullout_umat, only: umat_batch_interface
!    procedure(umat_batch_interface), bind(c, name='linear_elastic_umat_batch_v1') :: linear_elastic_batch
!
! Generated from umat-abi/src by the test `contract`; do not edit.
module pullout_umat
   use, intrinsic :: iso_c_binding, only: c_double, c_int32_t, c_ptr, c_size_t
   implicit none
   private
   public :: umat_interface, fric_interface, uinter_interface, umat_batch_interface

   abstract interface
";

const LINE_LENGTH: usize = 100;

/// The whole module.
pub fn generate(entry_points: &[EntryPoint], batch: &[Argument]) -> String {
    let interfaces: Vec<_> = entry_points.iter().map(interface).chain([batch_interface(batch)]).collect();
    format!("{PREFACE}{}   end interface\nend module pullout_umat\n", interfaces.join("\n"))
}

fn interface(entry: &EntryPoint) -> String {
    let arguments: Vec<_> = entry.arguments.iter().filter(|argument| !argument.is_hidden_length()).collect();
    let mut text = String::new();
    for line in &entry.doc {
        let _ = writeln!(text, "      ! {line}");
    }
    let _ = writeln!(text, "      subroutine {}_interface( &\n{})", entry.name, wrapped(&arguments));
    text.push_str("         import :: c_double, c_int32_t\n");
    // Sizes come first: Fortran wants a name typed before it is used in a shape.
    let (sizes, others): (Vec<_>, Vec<_>) = arguments.iter().copied().partition(|a| is_size(a, &arguments));
    for argument in sizes.into_iter().chain(others) {
        let _ = writeln!(text, "         {}", declaration(argument));
    }
    let _ = writeln!(text, "      end subroutine {}_interface", entry.name);
    text
}

/// The function for many points: a C function, counts by value.
fn batch_interface(arguments: &[Argument]) -> String {
    let all: Vec<_> = arguments.iter().collect();
    let mut text = String::from(
        "      ! `<law>_umat_batch_v1`: UMAT for n points with the same parameters, to the same bits as n calls.\n",
    );
    let _ = writeln!(text, "      subroutine umat_batch_interface( &\n{}) bind(c)", wrapped(&all));
    text.push_str("         import :: c_double, c_int32_t, c_ptr, c_size_t\n");
    let (sizes, others): (Vec<_>, Vec<_>) = all.iter().copied().partition(|a| a.pointer().is_none());
    for argument in sizes.into_iter().chain(others) {
        let name = &argument.name;
        let rust_type = &argument.rust_type;
        let line = match quote::quote!(#rust_type).to_string().as_str() {
            "usize" => format!("integer(c_size_t), value :: {name}  ! {}", argument.doc),
            "i32" => format!("integer(c_int32_t), value :: {name}  ! {}", argument.doc),
            // Fortran 2008 passes no NULL for an array
            _ if argument.doc.ends_with("or NULL.") => {
                format!("type(c_ptr), value :: {name}  ! {}: {}", argument.shape.replace(',', ", "), argument.doc)
            }
            _ => declaration(argument),
        };
        let _ = writeln!(text, "         {line}");
    }
    text.push_str("      end subroutine umat_batch_interface\n");
    text
}

/// The names in order, continued over lines.
fn wrapped(arguments: &[&Argument]) -> String {
    let mut lines = vec![String::from("            ")];
    for (index, argument) in arguments.iter().enumerate() {
        let comma = if index + 1 < arguments.len() { ", " } else { "" };
        let word = format!("{}{comma}", argument.name);
        let last = lines.last_mut().expect("one line at least");
        if last.len() + word.len() > LINE_LENGTH {
            lines.push(format!("            {word}"));
        } else {
            last.push_str(&word);
        }
    }
    lines.join("&\n")
}

/// Returns whether another argument's shape names this one.
fn is_size(argument: &Argument, all: &[&Argument]) -> bool {
    all.iter().any(|other| other.shape.trim_matches(['(', ')']).split(',').any(|size| size == argument.name))
}

fn declaration(argument: &Argument) -> String {
    let (written, target) = argument.pointer().expect("Fortran passes every argument by reference");
    let intent = if written { "intent(inout)" } else { "intent(in)" };
    let (name, shape) = (&argument.name, argument.shape.replace(',', ", "));
    let (kind, shape) = match target.as_str() {
        "f64" => ("real(c_double)".to_owned(), shape),
        "i32" => ("integer(c_int32_t)".to_owned(), shape),
        // A CHARACTER's length is part of its type.
        "c_char" => (format!("character(len={})", shape.trim_matches(['(', ')'])), String::new()),
        other => panic!("no Fortran type for {other}"),
    };
    let comment = if argument.doc.is_empty() { String::new() } else { format!("  ! {}", argument.doc) };
    format!("{kind}, {intent} :: {name}{shape}{comment}")
}
