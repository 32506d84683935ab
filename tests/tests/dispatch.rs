//! `libpullout_laws.so`: one `umat_` for all laws; CMNAME selects one.

use end_to_end_tests::{LAWS, PointMemory, Sample, plugin, sample, shipped_laws, strain_path};
use umat_abi::batch::UmatBatch;
use umat_abi::host::Library;
use umat_abi::law::StressState;
use umat_abi::metadata::{Plugin, kinds};

fn library() -> Library {
    end_to_end_tests::open(&plugin("pullout_laws"))
}

/// A point after some increments, with CMNAME as given.
fn run(library: &Library, law: &Sample, name: Option<&[u8]>) -> PointMemory {
    run_symbol(library, law, "umat_", name)
}

/// Runs such a point by another entry point.
fn run_symbol(library: &Library, law: &Sample, symbol: &str, name: Option<&[u8]>) -> PointMemory {
    let umat = library.umat(Some(symbol)).expect("the entry point");
    let mut point = PointMemory::new(law, StressState::ThreeD);
    for increment in strain_path(23, 6, law.strain, 20) {
        point.dstran = increment;
        let mut arguments = point.arguments();
        if let Some(name) = name {
            arguments.cmname = name.as_ptr().cast();
            arguments.cmname_length = name.len();
        }
        // SAFETY: the point's own memory, and a name that is padded, NUL-terminated or unlike every law's.
        unsafe { arguments.call(umat) };
        for k in 0..6 {
            point.stran[k] += increment[k];
        }
    }
    point
}

fn padded(name: &str) -> Vec<u8> {
    format!("{name:80}").into_bytes()
}

/// Programs that link the library of all laws call each by its own name, whatever the material's.
#[test]
fn each_law_has_its_own_symbols() {
    let library = library();
    // SAFETY: a library of ours.
    let all = unsafe { libloading::Library::new(plugin("pullout_laws")) }.expect("a plugin that Cargo built");
    for law in LAWS {
        // SAFETY: as above.
        let own = unsafe { libloading::Library::new(plugin(law.name)) }.expect("a plugin that Cargo built");
        for library in [&all, &own] {
            let symbol = format!("{}_plugin_v1", law.name);
            // SAFETY: the symbol has this type.
            let plugin =
                unsafe { library.get::<extern "C" fn() -> *const Plugin>(symbol.as_bytes()) }.expect("it is there");
            // SAFETY: the description and its text are static.
            let name = unsafe { std::ffi::CStr::from_ptr((*plugin()).law.as_ptr()) };
            assert_eq!(name.to_str(), Ok(law.name));
            let symbol = format!("{}_umat_batch_v1", law.name);
            // SAFETY: as above.
            assert!(unsafe { library.get::<UmatBatch>(symbol.as_bytes()) }.is_ok(), "{symbol}");
        }
        let own = end_to_end_tests::open(&plugin(law.name));
        let blank = [b' '; 80];
        for kind in ["umat_", "umat_kratos_"] {
            let symbol = format!("{}_{kind}", law.name);
            let expected = run_symbol(&own, law, &symbol, None).output_bits();
            assert_eq!(run_symbol(&library, law, &symbol, Some(&blank)).output_bits(), expected, "{symbol}");
            let by_name = run_symbol(&library, law, kind, Some(&padded(law.name)));
            assert_eq!(by_name.output_bits(), expected, "{kind} by CMNAME {}", law.name);
        }
    }
}

#[test]
fn each_name_runs_its_own_law() {
    let library = library();
    for law in LAWS {
        let own = end_to_end_tests::open(&plugin(law.name));
        let expected = run(&own, law, None).output_bits();
        let name = law.name;
        let upper = name.to_uppercase();
        let mixed: String =
            name.chars().enumerate().map(|(i, c)| if i % 2 == 0 { c.to_ascii_uppercase() } else { c }).collect();
        let spellings = [
            padded(name),
            padded(&upper),
            padded(&mixed),
            padded(&format!("{upper}-MATRIX_2")),
            padded(&format!("  {upper}")),
            format!("{upper}\0").into_bytes(),
            upper.clone().into_bytes(), // a length gives the end, and nothing follows
        ];
        for spelling in spellings {
            let found = run(&library, law, Some(&spelling)).output_bits();
            assert_eq!(found, expected, "{}", String::from_utf8_lossy(&spelling));
        }
    }
}

#[test]
fn each_law_has_a_library_of_its_own() {
    let mut names = models::NAMES.to_vec();
    names.sort_unstable();
    assert_eq!(shipped_laws(), names);
}

/// With its defaults, along a path that stays elastic in most laws and one that does not.
#[test]
fn every_law_of_a_solid_answers_by_its_name() {
    let library = library();
    let solids: Vec<_> = library.laws().iter().filter(|law| law.kinds & kinds::UMAT != 0).collect();
    assert!(solids.len() >= LAWS.len());
    for law in solids {
        let props: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
        for strain in [1e-6, 1e-3] {
            let sample = Sample {
                name: law.name.clone().leak(),
                props: props.clone().leak(),
                states: law.states.len(),
                strain,
                inadmissible: (0, 0.0),
            };
            let point = run(&library, &sample, Some(&padded(&law.name)));
            assert!(point.stress.iter().chain(&point.ddsdde).all(|x| x.is_finite()), "{} at {strain}", law.name);
            assert!(
                point.stress.iter().any(|stress| *stress != 0.0) && point.pnewdt >= 1.0,
                "{} at {strain}",
                law.name
            );
        }
    }
}

#[test]
fn the_description_holds_every_law_once() {
    let library = library();
    for law in LAWS {
        let described: Vec<_> = library.laws().iter().filter(|other| other.name == law.name).collect();
        assert_eq!(described.len(), 1, "{}", law.name);
        assert_eq!(described[0].states.len(), law.states);
    }
}

#[test]
fn an_unknown_name_is_refused() {
    let library = library();
    let law = sample("j2_plasticity");
    let umat = library.umat(None).expect("umat_");
    let refused = |name: Option<&[u8]>| {
        let mut point = PointMemory::new(law, StressState::ThreeD);
        point.pnewdt = 1e36;
        let before = point.clone();
        let mut arguments = point.arguments();
        arguments.cmname = name.map_or(std::ptr::null(), |name| name.as_ptr().cast());
        arguments.cmname_length = name.map_or(0, <[u8]>::len);
        // SAFETY: the point's own memory; a name without the end of a law's name is not read beyond its mismatch.
        unsafe { arguments.call(umat) };
        assert!(point.stress.iter().chain(&point.ddsdde).all(|x| x.is_nan()), "{name:?}");
        assert_eq!(point.pnewdt, 0.5, "{name:?}");
        assert_eq!((point.statev, point.energies), (before.statev, before.energies), "{name:?}");
    };
    refused(None);
    refused(Some(b"X"));
    refused(Some(b" \0"));
    refused(Some(b"\0"));
    for name in ["", "J", "J2", "J2_PLASTICIT", "MY_J2_PLASTICITY", "STEEL", "LINEAR ELASTIC"] {
        refused(Some(&padded(name)));
    }
}
