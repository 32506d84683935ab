//! `pullout plugin build`: what it makes, and what it says where it cannot.

use super::close;
use crate::program::{Desk, command, pullout_in};
use end_to_end_tests::{Tool, find};
use serde_json::json;
use std::path::Path;
use std::process::Command;

/// A UMAT in a few lines: `call` is made in it, `name` is its name.
fn source(name: &str, call: &str) -> String {
    format!(
        "      SUBROUTINE {name}(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,\n     1 DRPLDE,DRPLDT,STRAN,DSTRAN)\n      \
         INCLUDE 'aba_param.inc'\n      DIMENSION STRESS(6),DDSDDE(6,6),DSTRAN(6)\n      DO I=1,6\n        \
         DDSDDE(I,I)=100.D0\n        STRESS(I)=STRESS(I)+100.D0*DSTRAN(I)\n      END DO\n{call}      END\n"
    )
}

/// The error of a build that fails.
fn refused(desk: &Desk, sources: &[&str], code: i32) -> String {
    let outcome = desk.pullout(["plugin", "build"].iter().chain(sources)).expect(code);
    assert!(!desk.path("libmine.so").exists(), "nothing half-made is left");
    outcome.stderr
}

#[test]
fn several_sources_make_one_library_under_the_first_ones_name() {
    if [Tool::Fortran, Tool::C, Tool::Cpp].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", &source("UMAT", "      CALL HELPER(STRESS)\n      CALL COUNTS(STRESS)\n"));
    desk.write("helper.c", "void helper_(double *stress) { stress[0] *= 2.0; }\n");
    desk.write(
        "counts.cpp",
        "#include <vector>\nextern \"C\" void counts_(double *s) { std::vector<double> v(3, 0.5); s[0] += v[1] + v[2]; }\n",
    );
    let outcome = desk.pullout(["plugin", "build", "mine.f", "helper.c", "counts.cpp"]).expect(0);
    assert_eq!(outcome.stdout, "libmine.so: umat_\n");
    let case = json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmine.so", "props": [], "nstatv": 0 },
        "steps": [{ "increments": 1, "target": { "e11": 0.01, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 } }] });
    close(desk.run(&desk.case("case.json", &case), &[], "out", 0).history.last("s11"), 2.0 * 1.0 + 1.0);
    let info = desk.pullout(["plugin", "info", "./libmine.so"]).expect(0).stdout;
    assert!(info.contains("without metadata"), "{info}");
}

#[test]
fn a_form_can_be_given() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", "subroutine umat(stress)\ndouble precision :: stress(6)\nstress = 1d0\nend subroutine\n");
    let words = refused(&desk, &["--fixed", "mine.f"], 1);
    assert!(words.contains("mine.f:1") && words.contains("--free"), "{words}");
    assert_eq!(desk.pullout(["plugin", "build", "--free", "mine.f"]).expect(0).stderr, "");
    // nobody says which: the other form is tried as well
    let words = desk.pullout(["plugin", "build", "mine.f"]).expect(0).stderr;
    assert!(words.contains("mine.f: read in free form"), "{words}");
}

#[test]
fn what_is_undefined_is_named() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    // XIT is offered; the others are not
    let calls = "      CALL XIT\n      CALL KEISER(STRESS)\n      CALL KGETRF(STRESS)\n";
    desk.write("mine.f", &source("UMAT", calls));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("libmine.so: not built: undefined symbols: keiser_, kgetrf_; "), "{words}");
    assert!(words.contains("ROTSIG") && words.contains("SMAINTARRAYCREATE") && words.contains("XIT"), "{words}");
}

/// A case of one increment of e11 = 0.01.
fn one_increment(nstatv: usize, props: &[f64]) -> serde_json::Value {
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmine.so", "props": props, "nstatv": nstatv },
        "steps": [{ "increments": 1, "target": { "e11": 0.01, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 } }] })
}

/// s11 of that case.
fn stress_of_one_increment(desk: &Desk, name: &str) -> f64 {
    desk.run(&desk.case(&format!("{name}.json"), &one_increment(0, &[])), &[], name, 0).history.last("s11")
}

#[test]
fn a_utility_that_is_not_offered_ends_the_run_only_where_it_is_reached() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    for (condition, code) in [("STRESS(1).GT.1.D9", 0), ("STRESS(1).GT.0.5D0", 1)] {
        let call = format!("      IF ({condition}) CALL GETVRMAVGATNODE(1,'S',STRESS)\n");
        desk.write("mine.f", &source("UMAT", &call));
        let outcome = desk.pullout(["plugin", "build", "mine.f"]).expect(0);
        assert!(outcome.stderr.contains("libmine.so: GETVRMAVGATNODE is a utility routine of ABAQUS"), "{outcome:?}");
        let run = desk.run(&desk.case("case.json", &one_increment(0, &[])), &[], "out", code);
        let is_reported = run.outcome.stderr.contains("the plugin called GETVRMAVGATNODE");
        assert_eq!(is_reported, code != 0, "{}", run.outcome.stderr);
    }
}

#[test]
fn lines_of_the_preprocessor_are_obeyed_wherever_they_stand() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    // in the source, in a file it includes in other letters, and after a directive that Windows' compilers know
    desk.write("factor.inc", "#define FACTOR 3.D0\n#ifdef ABQ_LINUX\n      STRESS(1)=FACTOR*STRESS(1)\n#endif\n");
    desk.write("Offset.H", "#define OFFSET 0.25D0\n");
    let calls = "#define TWO 2.D0\n      STRESS(1)=TWO*STRESS(1)\n      INCLUDE 'FACTOR.INC'\n#INCLUDE \"offset.h\"\n      \
                 STRESS(1)=STRESS(1)+OFFSET\n";
    desk.write("mine.f", &source("UMAT", calls));
    desk.pullout(["plugin", "build", "mine.f"]).expect(0);
    close(stress_of_one_increment(&desk, "case"), 2.0 * 3.0 + 0.25);
    // the compiler's words still have the source's own lines
    desk.write("mine.f", &source("UMAT", &format!("{calls}      STRESS(1)=(\n")));
    std::fs::remove_file(desk.path("libmine.so")).expect("it was there");
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("mine.f:14:"), "{words}");
}

#[test]
fn modules_are_compiled_before_what_uses_them() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", &source("UMAT", "      CALL KSCALE(STRESS)\n"));
    desk.write("scale.f90", "subroutine kscale(s)\n  use outer\n  real(8) :: s(6)\n  s = factor * s\nend\n");
    desk.write("outer.f90", "module outer\n  use inner, only: two\n  real(8) :: factor = 2 * two\nend module\n");
    desk.write("inner.f90", "module inner\n  real(8), parameter :: two = 2\nend module\n");
    let sources = ["plugin", "build", "mine.f", "scale.f90", "outer.f90", "inner.f90"];
    desk.pullout(sources).expect(0);
    close(stress_of_one_increment(&desk, "case"), 4.0);
    desk.write("inner.f90", "module inner\n  use outer\n  real(8), parameter :: two = 2\nend module\n");
    let words = desk.pullout(sources).expect(2).stderr;
    assert!(words.contains("outer.f90, inner.f90"), "{words}");
}

#[test]
fn what_intels_compiler_understands_is_understood() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    // a format without a width, written and read; a debug line; an angle in degrees; KDIM stays the source's own
    let own = "      SUBROUTINE KWORK(S)\n      REAL*8 S(6)\n      CHARACTER*40 TEXT\n      WRITE(TEXT,100) 7\n 100  \
               FORMAT(I)\n      READ(TEXT,*) N\nD     THIS IS NO STATEMENT\n      S(1)=S(1)+N+KDIM(1)+SIND(30.D0)\n      \
               END\n      INTEGER FUNCTION KDIM(I)\n      KDIM=10*I\n      END\n";
    desk.write("mine.f", &(source("UMAT", "      CALL KWORK(STRESS)\n") + own));
    desk.pullout(["plugin", "build", "mine.f"]).expect(0);
    close(stress_of_one_increment(&desk, "case"), 1.0 + 7.0 + 10.0 + 0.5);
}

#[test]
fn arrays_threads_and_tables_are_answered_to_fortran_and_to_c() {
    if [Tool::Fortran, Tool::Cpp].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    let fortran = "      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE)
      INCLUDE 'ABA_PARAM.INC'
#include <SMAAspUserSubroutines.hdr>
      DIMENSION STRESS(6),STATEV(20),DDSDDE(6,6)
      CHARACTER*80 NAME
      DIMENSION RINDEP(1),FIELD(1),RPROPS(4),DPROPS(4)
      INTEGER IA(*)
      POINTER(PTRI,IA)
      REAL*8 B(*)
      POINTER(PTRB,B)
      REAL*4 C(*)
      POINTER(PTRC,C)
      DO I=1,6
        DDSDDE(I,I)=100.D0
      END DO
      PTRI=SMAIntArrayCreate(1,3,7)
      IA(2)=8
      PTRI=SMAIntArrayCreate(1,5,9)
      STATEV(1)=100*IA(1)+10*IA(2)+IA(5)
      STATEV(2)=SMAIntArraySize(1)
      PTRI=SMALocalIntArrayCreate(1,2)
      STATEV(3)=IA(2)
      PTRI=SMAIntArrayAccess(1)
      STATEV(4)=IA(3)
      PTRB=SMAFloatArrayCreate(1,4,-1.5)
      STATEV(5)=B(4)
      PTRB=SMALocalFloatArrayCreate(1,4,2.5D0)
      STATEV(6)=B(3)
      PTRB=SMAFloatArrayCreate(2,1)
      IF (B(1).NE.B(1)) STATEV(7)=1.D0
      PTRC=SMARealArrayCreate(1,4,0.5)
      STATEV(8)=C(4)
      CALL KFROMC(STATEV(9))
      STATEV(11)=SMAFloatArraySize(1)
      STATEV(12)=SMARealArrayAccess(99)
      STATEV(13)=get_thread_id()
      IF (getNumThreads().GE.1) STATEV(14)=1.D0
      STATEV(15)=getcommunicator()
      CALL setTableCollection('MATTC_X',JERROR)
      STATEV(16)=JERROR
      NAME='LABEL'
      CALL getPropertyTable(NAME,RINDEP,0.D0,FIELD,NUM,RPROPS,DPROPS,0,JERROR)
      STATEV(17)=JERROR
      CALL queryTableCollectionSize(JSIZE,JERROR)
      STATEV(18)=10*JSIZE+JERROR
      END
";
    let cpp = "#include <SMAAspUserSubroutines.h>
extern \"C\" void FOR_NAME(kfromc, KFROMC)(double *answers) {
  answers[0] = SMAFloatArrayAccess(1)[0] + SMAIntArrayAccess(1)[4];
  int *mine = SMALocalIntArrayCreate(5, 2);
  answers[1] = mine[1] == 2147483647 && SMAIntArrayAccess(5) == 0;
  SMAFloatArrayDelete(1);
}
";
    desk.write("mine.f", fortran);
    desk.write("fromc.cpp", cpp);
    desk.pullout(["plugin", "build", "mine.f", "fromc.cpp"]).expect(0);
    let run = desk.run(&desk.case("case.json", &one_increment(20, &[])), &[], "out", 0);
    let states: Vec<f64> = (1..=18).map(|k| run.history.last(&format!("sdv{k}"))).collect();
    let none = f64::from(i32::MAX);
    let expected = [789.0, 5.0, none, 7.0, -1.5, 2.5, 1.0, 0.5, 7.5, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    assert_eq!(states, expected);
    assert!(run.outcome.stderr.contains("there is no table collection MATTC_X"), "{}", run.outcome.stderr);
}

#[test]
fn nothing_but_a_library_is_overwritten() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    let text = source("UMAT", "");
    desk.write("mine.f", &text);
    desk.write("notes.so", "the only copy\n");
    let build = |output: &str, code| desk.pullout(["plugin", "build", "mine.f", "-o", output]).expect(code).stderr;
    for output in ["mine.f", "./mine.f"] {
        assert!(build(output, 2).contains("is one of the sources"), "{output}");
    }
    assert!(build("notes.so", 2).contains("notes.so: is there and is no shared library"));
    // a program is laid out like a library
    let program = desk.path("program");
    std::fs::copy(env!("CARGO_BIN_EXE_pullout"), &program).expect("a copy");
    assert!(build("program", 2).contains("is no shared library"));
    assert!(build(".", 2).contains("is no shared library"));
    assert_eq!(std::fs::read_to_string(desk.path("mine.f")).expect("it is there"), text);
    assert_eq!(std::fs::read_to_string(desk.path("notes.so")).expect("it is there"), "the only copy\n");
    build("libmine.so", 0);
    build("libmine.so", 0);
    let info = desk.pullout(["plugin", "info", "./libmine.so"]).expect(0).stdout;
    assert!(info.starts_with("./libmine.so: "), "{info}");
}

#[test]
fn a_missing_umat_is_explained() {
    if [Tool::Fortran, Tool::Cpp].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", &source("KUMATX", ""));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("none of the symbols umat_") && words.contains("-o libkumatx.so"), "{words}");
    desk.pullout(["plugin", "build", "mine.f", "-o", "libkumatx.so"]).expect(0);
    desk.write("mine.f90", "module m\ncontains\nsubroutine umat(s)\nreal(8) :: s\ns = 1\nend subroutine\nend module\n");
    let words = refused(&desk, &["mine.f90"], 1);
    assert!(words.contains("__m_MOD_umat is a procedure of a MODULE"), "{words}");
    desk.write("mine.cpp", "void umat_(double *s) { *s = 1; }\n");
    let words = refused(&desk, &["mine.cpp"], 1);
    assert!(words.contains("extern \"C\""), "{words}");
    desk.write("mine.f", &source("KOTHER", ""));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("SUBROUTINE UMAT"), "{words}");
}

#[test]
fn wrong_sources_are_bad_input() {
    let desk = Desk::new();
    desk.write("mine.py", "");
    assert!(refused(&desk, &["mine.py"], 2).contains("mine.py: its suffix is that of no language"));
    assert!(refused(&desk, &["mine.f"], 2).contains("mine.f: "));
    desk.pullout(["plugin", "build"]).expect(2);
    desk.pullout(["plugin", "build", "--free", "--fixed", "mine.f"]).expect(2);
}

#[test]
fn a_compiler_that_is_not_installed_is_named() {
    let desk = Desk::new();
    desk.write("mine.f", &source("UMAT", ""));
    desk.write("empty/nothing", "");
    let mut program = command();
    let output = program
        .current_dir(desk.path("."))
        .env("PATH", desk.path("empty"))
        .args(["plugin", "build", "mine.f"])
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(words.contains("mine.f: gfortran is needed for it and is not installed"), "{words}");
    let other = pullout_in(Path::new(&desk.path(".")), ["plugin", "info", "./libmine.so"]);
    assert_eq!(other.code, 3);
}

/// A UMAT with all its arguments, elastic with a modulus of 100: `declarations` and `statements` are in it.
fn whole(declarations: &str, statements: &str) -> String {
    format!(
        "      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),STRAN(NTENS),DSTRAN(NTENS)
{declarations}      DO I=1,NTENS
        DDSDDE(I,I)=100.D0
        STRESS(I)=STRESS(I)+100.D0*DSTRAN(I)
      END DO
{statements}      END
"
    )
}

/// The line of a text that has some words, from 1.
fn line_of(text: &str, words: &str) -> usize {
    text.lines().position(|line| line.contains(words)).expect("they are there") + 1
}

/// A failed run of three increments with six states, its message.
fn failure(desk: &Desk, mode: &str) -> String {
    let mut case = json!({ "kind": "point", "mode": mode,
        "material": { "plugin": "./libmine.so", "props": [], "nstatv": 6 },
        "steps": [{ "increments": 3, "target": { "e11": 0.01, "g12": 0.0 } }] });
    if mode != "3d" {
        case["material"]["as"] = json!("plane");
    }
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 1);
    let summary = std::fs::read_to_string(desk.path("out/summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    let message = summary["message"].as_str().expect("a message").to_owned();
    assert!(run.outcome.stderr.contains(&message), "{}", run.outcome.stderr);
    message
}

/// valgrind names the line where a UMAT reads memory that it allocated and did not set, or past its end, and nothing in the
/// program around it.
#[test]
fn valgrind_finds_what_a_umat_does_to_its_own_memory() {
    if [Tool::Fortran, Tool::Valgrind].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    desk.case("case.json", &one_increment(0, &[]));
    let text = source(
        "UMAT",
        "      CALL KPART(STRESS)\n      END\n      SUBROUTINE KPART(STRESS)\n      REAL*8 STRESS(6)\n      \
         REAL*8, ALLOCATABLE :: W(:)\n      ALLOCATE(W(3))\n      IF (W(2).GT.2.D0) STRESS(1)=0.D0\n      \
         IF (W(4).GT.2.D0) STRESS(2)=0.D0\n      DEALLOCATE(W)\n",
    );
    desk.write("mine.f", &text);
    desk.pullout(["plugin", "build", "mine.f"]).expect(0);
    let mut valgrind = Command::new("valgrind");
    valgrind.current_dir(desk.path("")).args(["-q", "--error-exitcode=9", env!("CARGO_BIN_EXE_pullout")]);
    let output = valgrind.args(["run", "--quiet", "--in-process", "case.json"]).output().expect("valgrind starts");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(9), "{words}");
    // the first place of each error, not of the memory block that it mentions
    let lines: Vec<&str> = words.lines().collect();
    let first = lines.windows(2).filter(|pair| pair[1].contains("    at 0x") && !pair[0].contains("  Address 0x"));
    let errors: Vec<&str> = first.map(|pair| pair[1]).collect();
    let place = |statement: &str| format!("kpart_ (mine.f:{})", line_of(&text, statement));
    let places = [place("W(2)"), place("W(4)")];
    assert!(errors.iter().all(|error| places.iter().any(|place| error.contains(place))), "{words}");
    assert!(places.iter().all(|place| errors.iter().any(|error| error.contains(place))), "{words}");
}

#[test]
fn a_library_made_to_be_debugged_names_the_line_that_goes_wrong() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    let square = "      DIMENSION DDSDDE(NTENS,NTENS)\n";
    let routine = "      SUBROUTINE KPART(S)\n      REAL*8 S,X\n      IF (S.GT.1.D9) X=1.D0\n      S=S+X\n      END\n";
    for (statements, expected, line) in [
        (
            "      K=6+KINC/2\n      STATEV(K)=1.D0\n",
            "Index '7' of dimension 1 of array 'statev' above upper bound of 6",
            "STATEV(K)",
        ),
        ("      IF (KINC.EQ.2) CALL KPART(STRESS(1))\n", "SIGFPE", "S=S+X"),
        ("      IF (KINC.EQ.2) STRESS(2)=LOG(STRESS(1)-1.D3)\n", "SIGFPE", "LOG("),
        // never set, which a compiler knows
        ("      IF (KINC.EQ.2) STATEV(1)=X+1.D0\n", "SIGFPE", "X+1.D0"),
    ] {
        let text = whole(square, statements) + routine;
        desk.write("mine.f", &text);
        desk.pullout(["plugin", "build", "--debug", "mine.f"]).expect(0);
        let message = failure(&desk, "3d");
        let routine = if line == "S=S+X" { "kpart" } else { "umat" };
        let place = format!("{routine}, mine.f:{}", line_of(&text, line));
        assert!(message.contains("step 1, increment 2") && message.contains(expected), "{message}");
        assert!(message.contains(&place), "{place}: {message}");
        let check = desk.pullout(["plugin", "check", "./libmine.so", "--case", "case.json"]);
        assert!(check.code != 0, "{}", check.stdout);
    }
    // the check traps as well where it gives what makes no sense
    let text = whole(square, "      IF (DSTRAN(1).GT.1.D9) STATEV(1)=0.D0\n");
    desk.write("mine.f", &text);
    desk.pullout(["plugin", "build", "--debug", "mine.f"]).expect(0);
    let check = desk.pullout(["plugin", "check", "./libmine.so", "--case", "case.json"]);
    let row = check.stdout.lines().find(|row| row.contains("NaN and infinity")).expect("a row");
    assert!(row.contains("SIGFPE") && row.contains(&format!("umat, mine.f:{}", line_of(&text, "DSTRAN(1)"))), "{row}");
    // what is sound runs, and a C source as well
    desk.write("mine.f", &whole(square, "      CALL KPART(STRESS(1))\n"));
    desk.write("part.c", "void kpart_(double *s) {\n  double zero = *s - *s;\n  if (*s > 0.5) *s = 1.0 / zero;\n}\n");
    desk.pullout(["plugin", "build", "--debug", "mine.f", "part.c"]).expect(0);
    let message = failure(&desk, "3d");
    assert!(
        message.contains("increment 2") && message.contains("SIGFPE") && message.contains("kpart, part.c:3"),
        "{message}"
    );
}

#[test]
fn arrays_that_are_overrun_are_named_as_far_as_can_be_known() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    // made for six components, called with four because the case insists on that
    let fixed = "      DIMENSION DDSDDE(6,6)\n";
    desk.write(
        "mine.f",
        &whole(fixed, "      DO I=1,6\n        DO J=1,6\n          DDSDDE(I,J)=1.D0\n        END DO\n      END DO\n"),
    );
    desk.pullout(["plugin", "build", "mine.f"]).expect(0);
    let message = failure(&desk, "plane_strain");
    assert!(message.contains("writes DDSDDE(") && message.contains("which has 16 elements"), "{message}");
    // an array of its own
    let own = "      DIMENSION DDSDDE(NTENS,NTENS),WORK(NTENS*500)\n";
    let overrun = "      DO I=1,3000\n        WORK(I)=STRESS(1)+I\n      END DO\n      CALL KSINK(WORK)\n";
    let sink = "      SUBROUTINE KSINK(W)\n      REAL*8 W(*)\n      W(1)=W(2)\n      END\n";
    desk.write("mine.f", &(whole(own, overrun) + sink));
    desk.pullout(["plugin", "build", "mine.f", "--flag=-fno-inline"]).expect(0);
    let message = failure(&desk, "plane_strain");
    assert!(message.contains("SIGABRT") && message.contains("wrote past the end of an array"), "{message}");
    desk.pullout(["plugin", "build", "--debug", "mine.f"]).expect(0);
    let message = failure(&desk, "plane_strain");
    assert!(message.contains("Index '2001' of dimension 1 of array 'work' above upper bound of 2000"), "{message}");
}
