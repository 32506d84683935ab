use super::*;

#[test]
fn expressions_are_weighed_as_spdx_has_them() {
    let allowed =
        allowed("[licenses]\nallow = [\"MIT\", \"Zlib\", \"Unicode-3.0\",\n \"Apache-2.0 WITH LLVM-exception\"]\n");
    let allowed = allowed.expect("a list");
    for expression in [
        "MIT",
        "GPL-3.0 OR MIT",
        "MIT/GPL-3.0",
        "(GPL-3.0 OR MIT) AND Unicode-3.0",
        "GPL-3.0 AND MPL-2.0 OR Zlib",
        "Apache-2.0 WITH LLVM-exception OR GPL-3.0",
    ] {
        assert!(is_allowed(expression, &allowed), "{expression}");
    }
    for expression in
        ["", "GPL-3.0", "MIT AND GPL-3.0", "Apache-2.0", "MIT OR", "(MIT", "GPL-3.0 AND (MIT OR Zlib)", "MIT Zlib"]
    {
        assert!(!is_allowed(expression, &allowed), "{expression}");
    }
}

/// All licences of this workspace are allowed, and have their texts.
#[test]
fn what_is_linked_may_be_given_away() {
    let packages = packages(&crate::workspace()).expect("all are allowed");
    let has = |name: &str| packages.iter().any(|package| package.name == name);
    assert!(has("faer") && has("pyo3") && has("resvg") && !has("proptest") && !has("syn") && !has("umat-abi"));
    let with_texts = packages.iter().filter(|package| !package.texts.is_empty()).count();
    assert!(10 * with_texts > 9 * packages.len(), "{with_texts} of {} have a text", packages.len());
    let text = collected(&packages);
    assert!(text.contains("Permission is hereby granted") && text.contains("Apache License"));
    let bill: Value = serde_json::from_str(&bill(&packages, "1.2.3")).expect("JSON");
    assert_eq!(bill["components"].as_array().map(Vec::len), Some(packages.len()));
    assert_eq!(bill["metadata"]["component"]["version"], "1.2.3");
}
