use super::source::{Language, PluginSource};
use super::*;

/// A source file in a folder of its own.
fn written(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

fn language(name: &str, text: &str, form: Option<Form>) -> Language {
    let (_folder, file) = written(name, text);
    PluginSource::new(&file, form).unwrap().language
}

#[test]
fn the_suffix_determines_the_language_and_the_form() {
    for (name, expected) in [
        ("a.f", Language::Fortran(Form::Fixed)),
        ("a.FOR", Language::Fortran(Form::Fixed)),
        ("a.f90", Language::Fortran(Form::Free)),
        ("a.c", Language::C),
        ("a.C", Language::Cpp),
        ("a.cxx", Language::Cpp),
        ("a.o", Language::Object),
    ] {
        assert_eq!(language(name, "", None), expected, "{name}");
    }
    assert_eq!(language("a.for", "", Some(Form::Free)), Language::Fortran(Form::Free));
    assert_eq!(language("a.for", "C comment\n!DIR$ FREEFORM\n", None), Language::Fortran(Form::Free));
    assert_eq!(language("a.for", "      END\n!DIR$ FREEFORM\n", None), Language::Fortran(Form::Fixed));
    let (_folder, file) = written("a.txt", "");
    assert!(matches!(PluginSource::new(&file, None), Err(Refusal::File { .. })));
}

#[test]
fn a_linkers_words_name_what_is_undefined() {
    let words = "ld: /tmp/0.o: in function `umat_':\nu.f:3: undefined reference to `kwork_'\n\
                 ld: u.f:9: undefined reference to `abc_'\nld: u.f:12: undefined reference to `kwork_'\n";
    assert_eq!(symbols::undefined(words), ["abc_", "kwork_"]);
}

/// Returns the scan of a source with this name and text.
fn scanned(name: &str, text: &str) -> (tempfile::TempDir, Scan) {
    let (folder, file) = written(name, text);
    let scan = Scan::of(&PluginSource::new(&file, None).unwrap());
    (folder, scan)
}

#[test]
fn our_includes_are_found_in_whatever_letters_a_source_writes_them() {
    let text = "      INCLUDE 'Aba_Param.inc'\n      include 'aba_param.inc'\n#include <SMAAspUserSubroutines.hdr>\n";
    let (_folder, scan) = scanned("a.f", text);
    assert!(scan.preprocessed && scan.rewritten.is_none());
    let folder = tempfile::tempdir().unwrap();
    includes::write(folder.path(), &[scan]).unwrap();
    for name in ["Aba_Param.inc", "aba_param.inc", "SMAAspUserSubroutines.hdr", "omi_for_c.h", "pullout_umat.h"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    assert!(!folder.path().join("ABA_PARAM.INC").exists());
}

#[test]
fn lines_of_the_preprocessor_are_found_and_nothing_else_is_taken_for_one() {
    for (name, text, expected) in [
        ("a.f", "#define A 1\n", true),
        ("a.f90", "# ifdef A\n#endif\n", true),
        ("a.F", "      END\n", true),
        ("a.F90", "end\n", true),
        ("a.f", "C #define A\n     # ,B)\n", false),
        ("a.f", "#ff0000\n", false),
        ("a.c", "#define A\n", false),
    ] {
        assert_eq!(scanned(name, text).1.preprocessed, expected, "{name}: {text}");
    }
}

#[test]
fn sources_are_ordered_by_their_modules() {
    let scans = |texts: &[&str]| texts.iter().map(|text| scanned("a.f90", text).1).collect::<Vec<_>>();
    let order = |texts: &[&str]| scan::order(&scans(texts));
    let user = "subroutine umat\n  use, intrinsic :: iso_c_binding\n  USE Outer, only: a\nend\n";
    let outer =
        "module outer\n use inner; use iso_fortran_env\n contains\n module procedure x\n end\nend module outer\n";
    let inner = "! use outer\nMODULE INNER ! the first\nend module\n";
    assert_eq!(order(&[user, outer, inner]), Ok(vec![2, 1, 0]));
    assert_eq!(order(&["end\n", "end\n"]), Ok(vec![0, 1]), "as they are given");
    assert_eq!(order(&["submodule (inner) part\nend\n", inner]), Ok(vec![1, 0]));
    let other = "module inner\nuse outer\nend module\n";
    assert_eq!(order(&[user, outer, other, "module alone\nend\n"]), Err(vec![1, 2]), "the circle alone");
}

/// What cases take for a source is what can be built.
#[test]
fn every_suffix_of_a_source_determines_a_language() {
    for suffix in umat_abi::host::SOURCES {
        assert_ne!(language(&format!("a.{suffix}"), "", None), Language::Object, "{suffix}");
    }
}

#[test]
fn structures_and_typed_units_are_seen() {
    let has = |text: &str| scanned("a.f", text).1.has_structures;
    assert!(has("      STRUCTURE /K/\n") && has("      RECORD /K/ L\n"));
    assert!(!has("C     STRUCTURE /K/\n") && !has("      STRUCTURE=1/2\n      A=B.DD.C\n"));
    let typed = "      SUBROUTINE A\n      IMPLICIT NONE\n      INCLUDE 'ABA_PARAM.INC'\n      END\n";
    let other = "      SUBROUTINE B\n      INCLUDE 'ABA_PARAM.INC'\n      END\n";
    let rewritten = |text: String| scanned("a.f", &text).1.rewritten;
    assert!(rewritten(format!("{other}{typed}")).is_some_and(|text| text.matches("nprecd").count() == 2));
    // what one unit says is not said of the next
    assert!(rewritten(format!("{}{other}", typed.replace("INCLUDE", "!INCLUDE"))).is_none());
}

#[test]
fn routines_of_lapack_are_known_by_their_names() {
    for (symbol, expected) in
        [("dgesv_", true), ("zheev_", true), ("idamax_", true), ("dgesv", true), ("kgesv_", false), ("dmat_", false)]
    {
        assert_eq!(lapack::has(symbol), expected, "{symbol}");
    }
}
