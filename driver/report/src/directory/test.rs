use super::*;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn opened(path: &Path, access: Access<'_>) -> ResultDirectory {
    ResultDirectory::open(path, Kind::Run, access).unwrap()
}

fn refused(path: &Path, kind: Kind, access: Access<'_>) -> String {
    ResultDirectory::open(path, kind, access).unwrap_err().to_string()
}

/// A finished run with these files.
fn results(path: &Path, files: &[(&str, &str)]) {
    let mut directory = opened(path, Access::default());
    directory.begin(&[]).unwrap();
    fs::write(path.join("history.csv"), "rows").unwrap();
    files.iter().for_each(|(name, content)| drop(directory.write(name, content).unwrap()));
    directory.remove_earlier().unwrap();
    directory.finish().unwrap();
}

fn files(path: &Path) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    let mut folders = vec![path.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            if entry.path().is_dir() {
                folders.push(entry.path());
            } else {
                let name = entry.path().strip_prefix(path).unwrap().to_string_lossy().into_owned();
                all.insert(name, fs::read_to_string(entry.path()).unwrap());
            }
        }
    }
    all.remove(MANIFEST);
    all
}

fn names(path: &Path) -> Vec<String> {
    files(path).into_keys().collect()
}

#[test]
fn earlier_results_go_when_new_ones_stand_and_nothing_else_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    results(path, &[("summary.json", "1"), ("plots/a.svg", "a"), ("plots/b.svg", "b")]);
    for user in ["notes.txt", "plots/notes.txt", "fields/notes.txt"] {
        fs::create_dir_all(path.join(user).parent().unwrap()).unwrap();
        fs::write(path.join(user), "mine").unwrap();
    }
    let mut directory = opened(path, Access::default());
    directory.begin(&[]).unwrap();
    assert!(!path.join("history.csv").exists() && !path.join("plots/a.svg").exists());
    let aside = ["history.csv", "plots/a.svg", "plots/b.svg", "summary.json"];
    assert!(aside.iter().all(|name| path.join("previous").join(name).exists()), "{:?}", names(path));
    directory.write("summary.json", "2").unwrap();
    directory.write("plots/b.svg", "b").unwrap();
    directory.remove_earlier().unwrap();
    directory.finish().unwrap();
    drop(directory);
    let expected = ["fields/notes.txt", "notes.txt", "plots/b.svg", "plots/notes.txt", "summary.json"];
    assert_eq!(names(path), expected);
    assert!(!path.join("previous").exists());
}

#[test]
fn what_a_killed_run_left_is_set_aside_with_what_was_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    results(path, &[("summary.json", "1")]);
    for kill in 1..4 {
        let mut killed = opened(path, Access::default());
        killed.begin(&[]).unwrap();
        fs::write(path.join("history.csv"), format!("rows {kill}")).unwrap();
        fs::create_dir_all(path.join("fields")).unwrap();
        fs::write(path.join("fields/000000.vtu"), "field").unwrap();
        fs::write(path.join("fields/000001.partial"), "fie").unwrap();
        killed.write("plots/a.svg", "a").unwrap();
        // no finish
    }
    let rows: Vec<String> =
        files(path).into_iter().filter(|(name, _)| name.ends_with("history.csv")).map(|(_, rows)| rows).collect();
    assert_eq!(rows, ["rows 3", "rows 1", "rows 2", "rows"], "by folder: ., previous-2, previous-3, previous");
    let mut next = opened(path, Access::default());
    next.begin(&[]).unwrap();
    next.write("summary.json", "4").unwrap();
    next.remove_earlier().unwrap();
    next.finish().unwrap();
    drop(next);
    assert_eq!(names(path), ["summary.json"]);
}

#[test]
fn what_the_user_changed_or_put_there_is_refused_and_replaced_on_demand() {
    for (name, content) in
        [("report.html", "mine"), ("plots/mine.svg", "mine"), ("fields/x.vtu", "mine"), ("history.csv", "ROWS")]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        results(path, &[("summary.json", "1"), ("report.html", "page")]);
        fs::create_dir_all(path.join(name).parent().unwrap()).unwrap();
        fs::write(path.join(name), content).unwrap();
        let before = files(path);
        let message = refused(path, Kind::Run, Access::default());
        assert!(message.contains(name) && message.contains("--overwrite"), "{message}");
        assert_eq!(files(path), before);
        let mut directory = opened(path, Access { overwrite: true, ..Access::default() });
        assert!(directory.notes()[0].contains(name), "{:?}", directory.notes());
        assert_eq!(files(path).len(), before.len() + 1, "the lock");
        directory.begin(&[]).unwrap();
        assert_eq!(fs::read_to_string(path.join("previous").join(name)).unwrap(), content);
        directory.remove_earlier().unwrap();
        directory.finish().unwrap();
        drop(directory);
        assert_eq!(names(path), [""; 0]);
    }
}

#[test]
fn a_copy_of_results_is_still_ours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    results(path, &[("summary.json", "1")]);
    let history = path.join("history.csv");
    let rewrite = |content: &str| {
        fs::remove_file(&history).unwrap();
        fs::write(&history, content).unwrap();
    };
    let is_known_by_its_hash = || {
        rewrite("rows");
        opened(path, Access::default());
        rewrite("sowr");
        assert!(refused(path, Kind::Run, Access::default()).contains("history.csv"));
    };
    is_known_by_its_hash();
    // earlier programs wrote SHA-256
    let mut manifest: serde_json::Value = serde_json::from_slice(&fs::read(path.join(MANIFEST)).unwrap()).unwrap();
    let entry = manifest["files"]["history.csv"].as_object_mut().unwrap();
    entry.remove("xxh64").unwrap();
    entry.insert("sha256".into(), "bc51e9e65d79e1c90ba544ab2eae1044ccdf8c1af7a559ba375cba4276f7d99e".into());
    fs::write(path.join(MANIFEST), manifest.to_string()).unwrap();
    is_known_by_its_hash();
}

#[test]
fn inputs_are_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    results(path, &[("summary.json", "1"), ("replay.json", "case")]);
    let link = path.join("link.json");
    std::os::unix::fs::symlink(path.join("replay.json"), &link).unwrap();
    for input in [path.join("replay.json"), link] {
        for overwrite in [false, true] {
            let inputs = [input.clone()];
            let message = refused(path, Kind::Run, Access { inputs: &inputs, overwrite, is_locked: false });
            assert!(message.contains("replay.json") && !message.contains("--overwrite"), "{message}");
        }
    }
    // an input of another name is in nobody's way
    let inputs = [path.join("table.csv")];
    fs::write(&inputs[0], "0").unwrap();
    opened(path, Access { inputs: &inputs, ..Access::default() });
    // neither is one of those that were set aside
    opened(path, Access::default()).begin(&[]).unwrap();
    let inputs = [path.join("previous/replay.json")];
    assert!(refused(path, Kind::Run, Access { inputs: &inputs, ..Access::default() }).contains("previous/replay.json"));
}

#[test]
fn results_of_another_kind_and_a_manifest_of_another_program_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    results(path, &[("summary.json", "1")]);
    assert!(refused(path, Kind::Study, Access::default()).contains("holds the results of a run"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join(MANIFEST), "{\"name\": \"an app\"}").unwrap();
    assert!(refused(path, Kind::Run, Access::default()).contains(MANIFEST));
    let mut directory = opened(path, Access { overwrite: true, ..Access::default() });
    directory.begin(&[]).unwrap();
    assert!(fs::read_to_string(path.join("previous").join(MANIFEST)).unwrap().contains("an app"));
}

#[test]
fn one_writer_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a").join("b");
    let first = opened(&path, Access::default());
    let message = refused(&path, Kind::Run, Access::default());
    assert!(message.contains(&format!("process {} on ", std::process::id())), "{message}");
    opened(&path, Access { is_locked: true, ..Access::default() });
    drop(first);
    // nothing began: nothing stays
    assert!(!folder.path().join("a").exists());
    // a file that a killed process left locks nothing
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join(".pullout.lock"), "1 elsewhere\n").unwrap();
    opened(&path, Access::default());
    assert_eq!(names(&path), [""; 0]);
}

proptest! {
    /// Whatever is in a directory: unasked, nothing of the user's goes.
    #[test]
    fn the_user_s_files_stay(
        ours in proptest::collection::btree_set(0_usize..8, 0..8),
        theirs in proptest::collection::btree_set(0_usize..8, 0..8),
        kills in 0_usize..3,
    ) {
        let names = ["summary.json", "report.html", "plots/a.svg", "plots/b.svg", "run.json", "a.txt", "plots/a.png", "umat.msg"];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        results(path, &ours.iter().map(|&k| (names[k], "ours")).collect::<Vec<_>>());
        for &k in &theirs {
            fs::create_dir_all(path.join(names[k]).parent().unwrap()).unwrap();
            fs::write(path.join(names[k]), "theirs").unwrap();
        }
        for _ in 0..kills {
            if let Ok(mut directory) = ResultDirectory::open(path, Kind::Run, Access::default()) {
                directory.begin(&[]).unwrap();
            }
        }
        if let Ok(mut directory) = ResultDirectory::open(path, Kind::Run, Access::default()) {
            directory.begin(&[]).unwrap();
            directory.write("summary.json", "new").unwrap();
            directory.remove_earlier().unwrap();
            directory.finish().unwrap();
        }
        for &k in &theirs {
            prop_assert_eq!(fs::read_to_string(path.join(names[k])).unwrap(), "theirs");
        }
    }
}

#[test]
fn patterns() {
    for (pattern, name, expected) in [
        ("fields/#.vtu", "fields/000012.vtu", true),
        ("fields/#.vtu", "fields/.vtu", false),
        ("fields/#.vtu", "fields/12a.vtu", false),
        ("fields/*.vtu", "fields/a.vtu", true),
        ("fields/*.vtu", "fields/a/b.vtu", false),
        ("history.csv", "history.csv", true),
        ("history.csv", "history_csv", false),
    ] {
        assert_eq!(names::fits(pattern, name), expected, "{pattern} {name}");
    }
}

/// Makes a result directory and a folder next to it, whose files nobody may touch.
fn with_neighbour(folder: &Path) -> (PathBuf, PathBuf) {
    let (path, elsewhere) = (folder.join("out"), folder.join("elsewhere"));
    fs::create_dir_all(&elsewhere).unwrap();
    for name in ["a.svg", "000000.vtu", "000001.vtu", "victim"] {
        fs::write(elsewhere.join(name), "mine").unwrap();
    }
    results(&path, &[("summary.json", "1"), ("plots/a.svg", "a")]);
    (path, elsewhere)
}

#[test]
fn a_forged_manifest_names_nothing_outside() {
    let folder = tempfile::tempdir().unwrap();
    let (path, elsewhere) = with_neighbour(folder.path());
    let victim = elsewhere.join("victim").to_str().unwrap().to_owned();
    for name in ["../elsewhere/victim", &victim, "plots/../../elsewhere/victim", "", ".."] {
        let forged = [
            format!("{{\"files\": {{{name:?}: null}}, \"earlier\": {{}}"),
            format!("{{\"files\": {{}}, \"earlier\": {{{name:?}: [\"victim\"]}}"),
            format!("{{\"files\": {{}}, \"earlier\": {{\"previous\": [{name:?}]}}"),
        ];
        for text in forged {
            fs::write(path.join(MANIFEST), text + ", \"pullout\": \"0.1.0\", \"kind\": \"run\"}").unwrap();
            assert!(refused(&path, Kind::Run, Access::default()).contains(MANIFEST));
            assert!(ResultDirectory::join(&path, Kind::Run).is_err());
            let mut directory = opened(&path, Access { overwrite: true, ..Access::default() });
            directory.begin(&[]).unwrap();
            directory.remove_earlier().unwrap();
            directory.finish().unwrap();
        }
    }
    assert_eq!(names(&elsewhere).len(), 4);
}

/// Nor anything in it that no result is called.
#[test]
fn a_forged_manifest_claims_no_file_of_the_users() {
    for name in ["thesis.tex", "data/history.csv", "plots/data.csv", "fields/notes.txt", "case.json"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::create_dir_all(path.join(name).parent().unwrap()).unwrap();
        fs::write(path.join(name), "mine").unwrap();
        for text in [
            format!("{{\"files\": {{{name:?}: null}}, \"earlier\": {{}}"),
            format!("{{\"files\": {{}}, \"earlier\": {{\"previous\": [{name:?}]}}"),
            "{\"files\": {}, \"earlier\": {\"data\": [\"history.csv\"]}".to_owned(),
        ] {
            fs::write(path.join(MANIFEST), text + ", \"pullout\": \"0.1.0\", \"kind\": \"run\"}").unwrap();
            assert!(refused(path, Kind::Run, Access::default()).contains(MANIFEST));
            let mut directory = opened(path, Access { overwrite: true, ..Access::default() });
            directory.begin(&[]).unwrap();
            directory.remove_earlier().unwrap();
            directory.finish().unwrap();
            assert_eq!(fs::read_to_string(path.join(name)).unwrap(), "mine");
        }
    }
}

#[test]
fn nothing_is_written_or_removed_through_a_link() {
    for link in ["plots", "fields", "previous", ".pullout.lock", ".pullout.partial", "history.csv", "manifest.json"] {
        let folder = tempfile::tempdir().unwrap();
        let (path, elsewhere) = with_neighbour(folder.path());
        let _ = fs::remove_dir_all(path.join(link)).or_else(|_| fs::remove_file(path.join(link)));
        let is_folder = ["plots", "fields", "previous"].contains(&link);
        let target = if is_folder { elsewhere.clone() } else { elsewhere.join("victim") };
        std::os::unix::fs::symlink(target, path.join(link)).unwrap();
        for overwrite in [false, true] {
            let Ok(mut directory) = ResultDirectory::open(&path, Kind::Run, Access { overwrite, ..Access::default() })
            else {
                continue;
            };
            directory.begin(&[]).unwrap();
            directory.write("plots/a.svg", "new").unwrap();
            directory.remove_earlier().unwrap();
            directory.finish().unwrap();
        }
        assert!(files(&elsewhere).values().all(|content| content == "mine"), "{link}");
        assert_eq!(names(&elsewhere).len(), 4, "{link}");
    }
}

#[test]
fn a_lock_with_any_text_locks_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["0 host", "4294967296 host", "-1 host", "99999999999999999999 h", "1", "", "\u{0}", "1 \u{1b}[2J"] {
        fs::write(folder.path().join(".pullout.lock"), text).unwrap();
        drop(opened(folder.path(), Access::default()));
    }
}
