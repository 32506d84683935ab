use super::*;
use rustix::fs::{CWD, mknodat};
use std::fs;
use std::io::Write;
use std::thread;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn fifo(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("fifo");
    mknodat(CWD, &path, rustix::fs::FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
    path
}

fn refused(path: &Path, input: Input) -> String {
    read(path, input).unwrap_err().to_string()
}

#[test]
fn what_came_out_of_a_pipe_is_there_for_the_next_reader() {
    let folder = folder();
    let path = fifo(&folder);
    let writer = {
        let path = path.clone();
        thread::spawn(move || {
            let mut file = File::options().write(true).open(path).unwrap();
            for piece in ["{\"a\":", " 1}"] {
                file.write_all(piece.as_bytes()).unwrap();
                thread::sleep(Duration::from_millis(50));
            }
        })
    };
    assert_eq!(text(&path, Input::Case).unwrap(), "{\"a\": 1}");
    writer.join().unwrap();
    assert_eq!(text(&path, Input::Case).unwrap(), "{\"a\": 1}");
    assert!(is_stream(&path) && streams().contains(&(path, b"{\"a\": 1}".to_vec())));
}

#[test]
fn a_pipe_into_which_nobody_writes_is_given_up_once() {
    let folder = folder();
    let path = fifo(&folder);
    let start = Instant::now();
    for _ in 0..20 {
        assert_eq!(refused(&path, Input::Table), "nothing came out of it for 1 s: it is a pipe or a device");
    }
    assert!(start.elapsed() < 10 * PATIENCE);
}

#[test]
fn what_is_no_file_is_refused_in_words() {
    let folder = folder();
    assert_eq!(refused(folder.path(), Input::Case), "it is a folder, not a file");
    let socket = folder.path().join("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    assert_eq!(refused(&socket, Input::Mesh), "it is a socket, not a file");
    let path = fifo(&folder);
    for input in [Input::Source, Input::Library, Input::Result, Input::Checkpoint] {
        assert_eq!(refused(&path, input), "it is a pipe or a device, not a file");
    }
    assert_eq!(open(&path).unwrap_err().to_string(), "it is a pipe or a device, not a file");
    let words = refused(Path::new("/dev/zero"), Input::Case);
    assert_eq!(words, "it has more than 32 MB, the most that a case or study may have");
}

#[test]
fn a_file_is_read_up_to_its_limit() {
    let folder = folder();
    let path = folder.path().join("case.json");
    let file = File::create(&path).unwrap();
    file.set_len(Input::Case.limit()).unwrap();
    assert_eq!(read(&path, Input::Case).unwrap().len() as u64, Input::Case.limit());
    file.set_len(Input::Case.limit() + 1).unwrap();
    assert!(refused(&path, Input::Case).contains("more than 32 MB"));
    // no memory is asked for
    file.set_len(1 << 40).unwrap();
    assert!(refused(&path, Input::Mesh).contains("more than 2000 MB, the most that a mesh may have"));
}

#[test]
fn text_that_is_not_utf_8_is_named_with_its_line() {
    let folder = folder();
    let path = folder.path().join("case.json");
    let said = |content: &[u8]| {
        fs::write(&path, content).unwrap();
        text(&path, Input::Case).map_err(|error| error.to_string())
    };
    assert_eq!(said(b"\xef\xbb\xbf{}\r\n").as_deref(), Ok("{}\r\n"));
    for utf_16 in [b"\xff\xfe{\0".as_slice(), b"\xfe\xff\0{"] {
        assert_eq!(said(utf_16), Err("it is in UTF-16: save it as text in UTF-8".to_owned()));
    }
    assert_eq!(said(b"{\n\"a\": \"\xe9\"}"), Err("line 2 is not UTF-8: save it as text in UTF-8".to_owned()));
    assert_eq!(said(b"{}\n\n\0"), Err("line 3 has a NUL byte: it is no text in UTF-8".to_owned()));
}

#[test]
fn paths_in_a_file_are_relative_to_its_folder_or_to_the_working_directory() {
    for (path, folder) in [("a/b.json", "a"), ("b.json", ""), ("/dev/stdin", ""), ("/dev/fd/63", ""), ("/a/b", "/a")] {
        assert_eq!(folder_of(Path::new(path)), Path::new(folder), "{path}");
    }
}
