//! `pullout plugin check` on laws whose verdict was wrong: sound laws that were blamed, and errors that passed.

use super::check_around::row;
use super::point;
use crate::program::{Desk, Outcome};
use end_to_end_tests::{Tool, find};
use serde_json::{Value, json};

/// Builds a UMAT of these statements; `None`: there is no Fortran compiler.
pub(super) fn umat(desk: &Desk, name: &str, statements: &str) -> Option<Value> {
    const ARGUMENTS: &str = "stress,statev,ddsdde,sse,spd,scd,rpl,ddsddt,drplde,drpldt,stran,dstran,time,dtime,&\n\
         & temp,dtemp,predef,dpred,cmname,ndi,nshr,ntens,nstatv,props,nprops,coords,drot,pnewdt,celent,&\n\
         & dfgrd0,dfgrd1,noel,npt,layer,kspt,jstep,kinc";
    const TYPES: &str = "implicit real(8) (a-h,o-z)\ncharacter(80) cmname\n\
         dimension stress(ntens),statev(*),ddsdde(ntens,ntens),ddsddt(ntens),drplde(ntens),stran(ntens),&\n\
         & dstran(ntens),time(2),predef(*),dpred(*),props(*),coords(3),drot(3,3),dfgrd0(3,3),dfgrd1(3,3),jstep(4)";
    built(desk, name, &format!("subroutine umat({ARGUMENTS})\n{TYPES}\n{statements}\nend subroutine\n"))
}

fn built(desk: &Desk, name: &str, source: &str) -> Option<Value> {
    find(Tool::Fortran)?;
    let file = desk.write(&format!("{name}.f90"), source);
    let library = desk.path(&format!("lib{name}.so"));
    let [file, to] = [&file, &library].map(|path| path.to_str().expect("UTF-8"));
    desk.pullout(["plugin", "build", file, "-o", to]).expect(0);
    Some(json!(library))
}

/// The check of the library of a case.
pub(super) fn checked(desk: &Desk, case: &Value) -> Outcome {
    let library = case["material"]["plugin"].as_str().expect("a path");
    let case = desk.case("case.json", case);
    let arguments = ["plugin", "check", library, "--states", "60", "--case", case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(arguments);
    println!("{}", outcome.stdout);
    outcome
}

/// A linear law with stiffnesses 11, 22, 33, 12, 13, 23 and the shears; the entry of DDSDDE with the number PROPS(10) is
/// multiplied by PROPS(11) afterwards.
const ORTHOTROPIC: &str = "
  ddsdde = 0
  do i = 1, 3
    ddsdde(i,i) = props(i)
    ddsdde(i+3,i+3) = props(i+6)
  end do
  ddsdde(1,2) = props(4); ddsdde(1,3) = props(5); ddsdde(2,3) = props(6)
  ddsdde(2,1) = props(4); ddsdde(3,1) = props(5); ddsdde(3,2) = props(6)
  stress = stress + matmul(ddsdde, dstran)
  k = int(props(10)) - 1
  ddsdde(mod(k,6)+1, k/6+1) = ddsdde(mod(k,6)+1, k/6+1)*props(11)";

/// The nine stiffnesses of an isotropic law.
fn isotropic(modulus: f64, nu: f64) -> [f64; 9] {
    let mu = modulus / (2.0 * (1.0 + nu));
    let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
    let direct = lambda + 2.0 * mu;
    [direct, direct, direct, lambda, lambda, lambda, mu, mu, mu]
}

/// A fibre ply (E 140, 10, 8 GPa, G 5, 4, 3 GPa; stiffnesses rounded), and isotropic materials that are nearly
/// incompressible: what is wrong is at most 2 % of the largest entry, and in the last two less than 1e-5.
#[test]
fn a_small_entry_of_the_tangent_is_compared_with_its_like() {
    let desk = Desk::new();
    let Some(library) = umat(&desk, "orthotropic", ORTHOTROPIC) else { return };
    let ply = [143e3, 12e3, 9.6e3, 5.1e3, 4.5e3, 4.2e3, 5e3, 4e3, 3e3];
    let target = json!({ "e11": 1e-3, "e22": -5e-4, "e33": 3e-4, "g12": 8e-4, "g13": -6e-4, "g23": 4e-4 });
    let case = |stiffness: [f64; 9], entry: f64, factor: f64| {
        let props: Vec<f64> = stiffness.into_iter().chain([entry, factor]).collect();
        let material = json!({ "plugin": library, "props": props, "nstatv": 0 });
        point(material, "3d", json!([{ "increments": 3, "target": target }]))
    };
    let wrong = [
        (ply, 36.0, 2.0),
        (isotropic(1.0, 0.4999), 22.0, 1.1),
        (isotropic(1.0, 0.499), 22.0, 1.01),
        (isotropic(1.0, 0.49999), 29.0, 1.1),
        (isotropic(1.0, 0.499999), 36.0, 1.5),
    ];
    for (stiffness, entry, factor) in wrong {
        let right = checked(&desk, &case(stiffness, entry, 1.0));
        let line = row(&right, "consistent tangent");
        assert!(line.starts_with("pass"), "{line}");
        let outcome = checked(&desk, &case(stiffness, entry, factor)).expect(1);
        let line = row(&outcome, "consistent tangent");
        assert!(line.starts_with("FAIL") && !line.contains("elastic") && !line.contains("transpose"), "{line}");
    }
    // damaged to a millionth: differences of the elastic stress alone
    let damaged = isotropic(30e3, 0.2).map(|stiffness| 1e-6 * stiffness);
    assert!(row(&checked(&desk, &case(damaged, 1.0, 1.0)), "consistent tangent").starts_with("pass"));
}

/// Errors of a symmetric tangent in the fifth digit, which rounding STRESS(1) makes, or doubling a small entry: the transpose is
/// no better, and stays unnamed. That of an entry which is wrong by transposition alone is named.
#[test]
fn a_symmetric_tangent_is_not_called_transposed() {
    let desk = Desk::new();
    let shear = "ddsdde(4:6,:) = 0; ddsdde(:,4:6) = 0; do i = 4, 6; ddsdde(i,i) = props(2); end do\n";
    let law = |more: &str, last: &str| {
        format!(
            "ddsdde = 0\nddsdde(1:3,1:3) = props(1)\ndo i = 1, 3\nddsdde(i,i) = props(1) + 2*props(2)\nend do\n{shear}{more}\
             stress = stress + matmul(ddsdde, dstran)\n{last}"
        )
    };
    let case = |library: &Value| {
        let material = json!({ "plugin": library, "props": [100.0, 75.0], "nstatv": 0 });
        point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3, "g12": 4e-4 } }]))
    };
    let Some(little) = umat(&desk, "little", &law("", "ddsdde(1,1) = ddsdde(1,1)*(1 + 5e-6)")) else { return };
    let outcome = checked(&desk, &case(&little)).expect(1);
    let line = row(&outcome, "consistent tangent");
    assert!(line.starts_with("FAIL") && !line.contains("transpose") && !line.contains("elastic"), "{line}");
    let unequal = "ddsdde(1,2) = 1.0001d0*props(1)\n";
    let Some(by_rows) = umat(&desk, "rows", &law(unequal, "ddsdde = transpose(ddsdde)")) else { return };
    let outcome = checked(&desk, &case(&by_rows)).expect(1);
    let line = row(&outcome, "consistent tangent");
    assert!(line.starts_with("FAIL") && line.contains("transpose"), "{line}");
}

/// Von Mises plasticity in plane strain and space that keeps a backstress of NTENS components and the plastic strain: NTENS + 1 states.
const NTENS_PLUS_ONE: &str = "
  dimension d(6)
  g = props(1)/2/(1 + props(2)); bulk = props(1)/3/(1 - 2*props(2))
  ddsdde = 0
  ddsdde(1:3,1:3) = bulk - 2*g/3
  do i = 1, ntens
    ddsdde(i,i) = merge(bulk + 4*g/3, g, i <= 3)
  end do
  stress = stress + matmul(ddsdde, dstran)
  d = 0; d(1:ntens) = stress - statev(1:ntens)
  d(1:3) = d(1:3) - sum(stress(1:3))/3
  q = sqrt(1.5d0*(sum(d(1:3)**2) + 2*sum(d(4:6)**2)))
  f = q - props(3) - props(4)*statev(ntens+1)
  if (f > 0) then
    dp = f/(3*g + props(4) + props(5)); d = d/q
    stress = stress - 3*g*dp*d(1:ntens)
    statev(1:ntens) = statev(1:ntens) + props(5)*dp*d(1:ntens)
    statev(ntens+1) = statev(ntens+1) + dp
    a = 3*g*dp/q
    ddsdde(1:3,1:3) = ddsdde(1:3,1:3) + 2*g*a/3
    do i = 1, ntens
      ddsdde(i,i) = ddsdde(i,i) - merge(2*g*a, g*a, i <= 3)
      ddsdde(i,:) = ddsdde(i,:) + 9*g*g*(dp/q - 1/(3*g + props(4) + props(5)))*d(i)*d(1:ntens)
    end do
  end if";

/// With six components it would leave STATEV(5): a trial call that does so gives no advice. In fewer states its run ends with the
/// place, though NaN makes its yield condition false, so that it would seem to stay elastic.
#[test]
fn states_for_each_component_are_no_reason_for_six() {
    let desk = Desk::new();
    let Some(library) = umat(&desk, "ntensplusone", NTENS_PLUS_ONE) else { return };
    let case = |mode: &str, nstatv: usize| {
        let material = json!({ "plugin": library, "props": [200e3, 0.3, 250.0, 1000.0, 500.0], "nstatv": nstatv });
        point(material, mode, json!([{ "increments": 10, "target": { "e11": 0.01 } }]))
    };
    let run = super::run(&desk, "enough", &case("plane_strain", 5));
    let warnings = run.summary["warnings"].to_string();
    assert!(!warnings.contains("NTENS"), "{warnings}");
    for (mode, nstatv, words) in [
        ("plane_strain", 4, "reads STATEV(5), which has 4 elements"),
        ("3d", 6, "reads STATEV(7), which has 6 elements"),
        ("3d", 5, "reads STATEV(6), which has 5 elements"),
        ("3d", 0, "reads STATEV(1), which has 0 elements"),
    ] {
        let file = desk.case("few.json", &case(mode, nstatv));
        let outcome = desk.pullout(["run", "--quiet", "--overwrite", file.to_str().expect("UTF-8")]).expect(1);
        assert!(outcome.stderr.contains(words), "{mode}, {nstatv}: {}", outcome.stderr);
    }
}

/// A yield stress that stands after PROPS: with NaN there no stress ever reaches it.
#[test]
fn what_is_read_outside_and_only_compared_ends_a_run() {
    let desk = Desk::new();
    let bar = "ddsdde = props(1)\nstress = stress + props(1)*dstran\n\
         if (stress(1) > props(3)) then\nstress(1) = props(3); ddsdde = 0\nend if";
    let Some(library) = umat(&desk, "bar", bar) else { return };
    let case = |props: &[f64]| {
        let material = json!({ "plugin": library, "props": props, "nstatv": 0 });
        point(material, "1d", json!([{ "increments": 10, "target": { "e11": 0.01 } }]))
    };
    let run = super::run(&desk, "whole", &case(&[200e3, 0.3, 250.0]));
    super::close(run.history.last("s11"), 250.0);
    // in this process too, where nothing ends by a fence
    for manner in [&["--quiet"][..], &["--quiet", "--in-process"]] {
        let file = desk.case("short.json", &case(&[200e3, 0.3]));
        let arguments = ["run", "--overwrite", file.to_str().expect("UTF-8")];
        let outcome = desk.pullout(arguments.iter().chain(manner)).expect(1);
        let words = "increment 1: it reads PROPS(3), which has 2 elements";
        assert!(outcome.stderr.contains(words), "{}", outcome.stderr);
    }
}

/// Linear elasticity, with one statement more.
fn elastic(statement: &str) -> String {
    format!(
        "logical, save :: is_first = .true.\nreal(8), save :: kept\n\
         xmu = props(1)/2/(1 + props(2)); xlambda = 2*xmu*props(2)/(1 - 2*props(2))\nddsdde = 0\n\
         ddsdde(1:ndi,1:ndi) = xlambda\ndo i = 1, ntens\nddsdde(i,i) = merge(xlambda + 2*xmu, xmu, i <= ndi)\nend do\n\
         stress = stress + matmul(ddsdde, dstran)\n{statement}"
    )
}

fn elastic_case(library: &Value) -> Value {
    let material = json!({ "plugin": library, "props": [1000.0, 0.25], "nstatv": 0 });
    point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3, "g12": 4e-4 } }]))
}

#[test]
fn a_constant_that_is_kept_from_the_first_call_is_found() {
    let desk = Desk::new();
    let kept = "if (is_first) then\nkept = props(1); is_first = .false.\nend if\nstress(3) = stress(3)*kept/props(1)";
    for (name, statement, verdict) in [("kept", kept, "FAIL"), ("sound", "", "pass")] {
        let Some(library) = umat(&desk, name, &elastic(statement)) else { return };
        let outcome = checked(&desk, &elastic_case(&library)).expect(i32::from(verdict == "FAIL"));
        let line = row(&outcome, "other PROPS");
        assert!(line.starts_with(verdict), "{line}");
        // ten ninths, the ratio of both moduli
        assert_eq!(line.contains("PROPS(1) = 900 s33 is "), verdict == "FAIL", "{line}");
    }
}

#[test]
fn a_stress_that_depends_on_a_length_that_the_case_lacks_is_reported() {
    let desk = Desk::new();
    let Some(library) = umat(&desk, "length", &elastic("stress(1) = stress(1)*(1 + 0.1d0*celent)")) else { return };
    let mut case = elastic_case(&library);
    for (length, verdict) in [(None, "warn"), (Some(2.0), "info")] {
        if let Some(length) = length {
            case["characteristic_length"] = json!(length);
        }
        let outcome = checked(&desk, &case);
        let line = row(&outcome, "CELENT unusable");
        assert!(line.starts_with(verdict) && line.contains("s11 is "), "{line}");
        let warnings = super::run(&desk, "run", &case).summary["warnings"].to_string();
        assert_eq!(warnings.contains("depends on CELENT"), length.is_none(), "{warnings}");
    }
    let Some(library) = umat(&desk, "none", &elastic("")) else { return };
    let case = elastic_case(&library);
    assert!(row(&checked(&desk, &case), "CELENT unusable").contains("not used"));
    let warnings = super::run(&desk, "none", &case).summary["warnings"].to_string();
    assert!(!warnings.contains("CELENT"), "{warnings}");
}

/// STOP at a strain that most states reach: one row, nothing on stderr, at most one file in the folder.
#[test]
fn one_cause_of_an_end_is_one_row() {
    let desk = Desk::new();
    let stops = elastic("if (maxval(abs(stran + dstran)) > 1.2d-3) stop 3");
    let Some(library) = umat(&desk, "stops", &stops) else { return };
    let outcome = checked(&desk, &elastic_case(&library)).expect(1);
    assert_eq!(
        outcome.stdout.lines().filter(|line| line.contains("ended the process")).count(),
        1,
        "{}",
        outcome.stdout
    );
    assert!(!outcome.stderr.contains("ended the process"), "{}", outcome.stderr);
    let files = std::fs::read_dir(desk.path("")).expect("a folder");
    let replays = files.flatten().filter(|file| file.file_name().to_string_lossy().contains("replay")).count();
    assert!(replays <= 1, "{replays} replay cases");
}

/// Coulomb friction with elastic stick; `statement` at its start, `factor` on DSLIP.
fn friction(statement: &str, factor: &str) -> String {
    format!(
        "subroutine fric(lm,tau,ddtddg,ddtddp,dslip,sed,sfd,ddtddt,pnewdt,statev,dgam,taulm,press,dpress,ddpddh,slip,&\n\
         & kstep,kinc,time,dtime,noel,ciname,slname,msname,npt,node,npatch,coords,rcoord,drot,temp,predef,nfdir,mcrd,&\n\
         & npred,nstatv,chrlngth,props,nprops)\nimplicit real(8) (a-h,o-z)\ncharacter(80) ciname,slname,msname\n\
         dimension tau(nfdir),ddtddg(nfdir,nfdir),ddtddp(nfdir),dslip(nfdir),dgam(nfdir),props(nprops)\n{statement}\nlm = 0\n\
         ddtddg = 0; ddtddp = 0; dslip = 0\ntau = tau + props(2)*dgam\nq = norm2(tau); c = props(1)*press\n\
         do i = 1, nfdir\nddtddg(i,i) = props(2)\nend do\nif (q > c) then\n\
         dslip = (q - c)/props(2)*tau/q*{factor}\nddtddp = props(1)*tau/q\n\
         do i = 1, nfdir\ndo j = 1, nfdir\nddtddg(i,j) = c/q*props(2)*(merge(1, 0, i == j) - tau(i)*tau(j)/q/q)\nend do\nend do\n\
         sfd = sfd + c*(q - c)/props(2)\ntau = c*tau/q\nend if\nsed = sum(tau**2)/2/props(2)\nend subroutine\n"
    )
}

fn friction_case(library: &Value) -> Value {
    let material = json!({ "plugin": library, "entry": "fric", "props": [0.3, 1000.0], "nstatv": 0 });
    let steps = json!([
        { "increments": 2, "target": { "p": 10 } },
        { "increments": 10, "target": { "slip": 0.01, "slip2": 0.004 } },
        { "increments": 2, "target": { "p": 0 } },
        { "increments": 2, "target": { "p": 8, "slip": 0.02 } },
    ]);
    json!({ "kind": "interface", "material": material, "steps": steps })
}

/// ABAQUS's manual: where LM = 2 is returned nothing else is to be set, and that is what to do where a point was open.
#[test]
fn a_fric_that_leaves_an_open_point_to_the_host_is_right() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "open", &friction("if (lm == 2) return", "1")) else { return };
    let outcome = checked(&desk, &friction_case(&library)).expect(0);
    for check in ["tangent entries set", "inelastic slip"] {
        assert!(row(&outcome, check).starts_with("pass"), "{}", row(&outcome, check));
    }
}

/// DSLIP is the slip less what the shear gives back elastically.
#[test]
fn a_doubled_inelastic_slip_is_found() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "doubled", &friction("", "2")) else { return };
    let outcome = checked(&desk, &friction_case(&library));
    let line = row(&outcome, "inelastic slip");
    assert!(line.starts_with("warn") && line.contains("DSLIP"), "{line}");
}

/// E = 1e-8 MPa: the free sides are met to a stress as large as any there is.
#[test]
fn a_tolerance_that_is_not_small_is_reported() {
    let desk = Desk::new();
    for (modulus, warns) in [(1e-8, true), (1e-2, false), (200e3, false)] {
        let material = json!({ "plugin": "linear_elastic", "props": { "E": modulus, "nu": 0.3 } });
        let case = point(material, "3d", json!([{ "increments": 2, "target": { "e11": 0.01 } }]));
        let warnings = super::run(&desk, "run", &case).summary["warnings"].to_string();
        assert_eq!(warnings.contains("smaller unit"), warns, "{modulus}: {warnings}");
    }
}
