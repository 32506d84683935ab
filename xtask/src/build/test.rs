use super::*;

#[test]
fn artifacts_are_read_from_cargos_messages() {
    let suffix = std::env::consts::DLL_SUFFIX;
    let messages = format!(
        r##"{{"reason":"compiler-artifact","package_id":"registry+r#s@1","target":{{"kind":["lib"]}},"filenames":["/t/libserde.rlib"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"registry+r#q@1","target":{{"kind":["cdylib","rlib"],"crate_types":["cdylib","rlib"]}},"filenames":["/t/libq{suffix}"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/models/plugins/a#1","target":{{"kind":["cdylib"],"crate_types":["cdylib"]}},"filenames":["/t/deps/liba{suffix}","/t/deps/liba.debug"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/p#1","target":{{"kind":["bin"],"name":"pullout"}},"filenames":["/t/pullout"],"executable":"/t/pullout"}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/models/plugins/a#1","target":{{"kind":["example"],"crate_types":["cdylib"]}},"filenames":["/t/examples/libb{suffix}"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/tests/faulty/c#1","target":{{"kind":["cdylib"],"crate_types":["cdylib"]}},"filenames":["/t/deps/libc{suffix}"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/python#1","target":{{"kind":["cdylib"],"name":"_core"}},"filenames":["/t/lib_core{suffix}"],"executable":null}}
{{"reason":"compiler-artifact","package_id":"path+file:///w/b#1","target":{{"kind":["bin"],"name":"pullout-bench"}},"filenames":["/t/pullout-bench"],"executable":"/t/pullout-bench"}}
{{"reason":"build-finished","success":true}}"##
    );
    let expected = Products {
        program: "/t/pullout".into(),
        libraries: vec![format!("/t/deps/liba{suffix}").into()],
        kratos: vec![format!("/t/examples/libb{suffix}").into()],
    };
    assert_eq!(products(&messages, PROGRAM[1]), Ok(expected));
    let of_wheel = products(&messages, EXTENSION[1]).expect("an extension");
    assert_eq!(of_wheel.program, PathBuf::from(format!("/t/lib_core{suffix}")));
    let nothing = products(r#"{"reason":"build-finished"}"#, PROGRAM[1]);
    assert_eq!(nothing, Err("the build made no pullout".to_owned()));
    assert!(products("no JSON", PROGRAM[1]).is_err());
}
