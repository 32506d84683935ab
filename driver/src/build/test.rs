use super::source::{Language, Source};
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
    Source::new(&file, form).unwrap().language
}

#[test]
fn the_suffix_tells_the_language_and_the_form() {
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
    assert!(matches!(Source::new(&file, None), Err(Refusal::Source { .. })));
}

#[test]
fn a_linkers_words_name_what_is_undefined() {
    let words = "ld: /tmp/0.o: in function `umat_':\nu.f:3: undefined reference to `kwork_'\n\
                 ld: u.f:9: undefined reference to `abc_'\nld: u.f:12: undefined reference to `kwork_'\n";
    assert_eq!(symbols::undefined(words), ["abc_", "kwork_"]);
}

#[test]
fn aba_param_is_found_in_whatever_letters_a_source_writes_it() {
    let (_folder, file) = written("a.f", "      INCLUDE 'Aba_Param.inc'\n      include 'aba_param.inc'\n");
    let folder = tempfile::tempdir().unwrap();
    includes::write(folder.path(), &[Source::new(&file, None).unwrap()]).unwrap();
    for name in ["Aba_Param.inc", "aba_param.inc", "pullout_umat.h"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    assert!(!folder.path().join("ABA_PARAM.INC").exists());
}
