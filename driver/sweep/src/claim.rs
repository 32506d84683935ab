//! Claim of a worker: the runs that it has taken with the rows that they came to, in a file of the store that outlives
//! it. The worker holds a lock on the file. A file found unlocked was left by a worker that has ended: its rows are
//! kept, and the run that it was computing is lost. What others have claimed a worker does not take.
//!
//! On a file system without locks, nothing is taken over: those runs have no row, and are run anew once nothing has been
//! added to the claim for some minutes.

use crate::run::Measured;
use crate::store::Store;
use pullout_report::at;
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::time::Duration;

/// A claim of another machine counts as left only if nothing was added for so long: some file systems lock within one
/// machine alone.
const PATIENCE: Duration = Duration::from_secs(600);

/// A run that is to be run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PendingRun {
    /// Number.
    pub run: usize,
    pub key: String,
    /// Number of the attempt.
    pub attempt: u32,
}

/// Owner of a claim, and the runs that it has taken. Its machine stands in the file's name: a worker that is ended while it makes
/// the file leaves no head.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct ClaimHeader {
    /// The program, in hexadecimal: rows of another may have another form.
    pub engine: String,
    pub runs: Vec<PendingRun>,
}

/// The keys in the head of a claim.
fn keys(file: &mut File) -> Option<HashSet<String>> {
    let mut length = [0; 4];
    file.read_exact(&mut length).ok()?;
    let mut head = vec![0; usize::try_from(u32::from_le_bytes(length)).ok()?];
    file.read_exact(&mut head).ok()?;
    Some(serde_json::from_slice::<ClaimHeader>(&head).ok()?.runs.into_iter().map(|due| due.key).collect())
}

/// The file, which is there as long as this is.
pub(crate) struct Claim {
    file: File,
    /// The file, to which children add rows.
    pub path: PathBuf,
    /// Bytes of the head.
    head: u64,
}

impl Claim {
    /// Takes runs.
    pub fn new(store: &Store, host: &str, head: &ClaimHeader) -> io::Result<Self> {
        let head = framed(&serde_json::to_vec(head)?)?;
        let (file, path) = store.running(host, &head)?;
        Ok(Self { file, path, head: head.len() as u64 })
    }

    /// Adds a row.
    pub fn add(&mut self, row: &Measured) -> io::Result<()> {
        self.file.write_all(&framed(&encoded(row)?)?).map_err(at(&self.path))
    }

    /// Says that a run begins.
    pub fn begin(&mut self) -> io::Result<()> {
        self.file.write_all(&BEGINS).map_err(at(&self.path))
    }

    /// The rows so far. Half a row, of a child that was ended, goes.
    pub fn rows(&mut self) -> io::Result<Vec<Measured>> {
        let mut content = Vec::new();
        self.file.seek(SeekFrom::Start(self.head))?;
        self.file.read_to_end(&mut content)?;
        let (rows, _, length) = rows(&content);
        self.file.set_len(self.head + length as u64)?;
        Ok(rows)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Stands before a run in place of a row's length.
pub(crate) const BEGINS: [u8; 4] = [0; 4];

pub(crate) fn encoded(row: &Measured) -> io::Result<Vec<u8>> {
    postcard::to_stdvec(row).map_err(io::Error::other)
}

/// Something with its length before it.
pub(crate) fn framed(content: &[u8]) -> io::Result<Vec<u8>> {
    let length = u32::try_from(content.len()).map_err(io::Error::other)?;
    Ok([&length.to_le_bytes()[..], content].concat())
}

/// Returns the content of the frame at the beginning, and the bytes after it.
fn unframed(content: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = content.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// Returns the complete rows, whether another run has begun after them, and the number of their bytes.
fn rows(content: &[u8]) -> (Vec<Measured>, bool, usize) {
    let (mut rows, mut has_begun, mut rest) = (Vec::new(), false, content);
    while let Some((frame, behind)) = unframed(rest) {
        if frame.is_empty() {
            has_begun = true;
        } else {
            let Ok(row) = postcard::from_bytes(frame) else { break };
            rows.push(row);
            has_begun = false;
        }
        rest = behind;
    }
    (rows, has_begun, content.len() - rest.len())
}

/// Rows and claim left by a worker that has ended.
pub(crate) struct OrphanedClaim {
    /// Machine of the worker.
    pub host: String,
    pub head: ClaimHeader,
    /// Rows in the order of the runs.
    pub rows: Vec<Measured>,
    /// Whether it had begun the run after them.
    pub has_begun: bool,
    /// Removed once this is dropped: the rows are to be kept before.
    _claim: Claim,
}

/// Keys of runs that workers are at, by their claims.
pub(crate) type ClaimedKeys = HashMap<PathBuf, HashSet<String>>;

/// Takes over what workers have left, of which only one of several that ask gets it, and brings up to date what the others
/// are at.
pub(crate) fn left_behind(
    store: &Store,
    engine: &str,
    host: &str,
    taken: &mut ClaimedKeys,
) -> io::Result<Vec<OrphanedClaim>> {
    let mut found = Vec::new();
    let mut before = std::mem::take(taken);
    for path in store.claims()? {
        let Ok(mut file) = File::options().read(true).append(true).open(&path) else { continue };
        let maker = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_recent = file.metadata()?.modified()?.elapsed().unwrap_or_default() < PATIENCE;
        let has_worker = match file.try_lock() {
            // another was faster, and has removed it meanwhile
            Ok(()) if !path.exists() => continue,
            Ok(()) => maker != host && is_recent,
            Err(TryLockError::WouldBlock) => true,
            Err(TryLockError::Error(_)) if is_recent => true,
            // nobody can know
            Err(TryLockError::Error(_)) => continue,
        };
        if has_worker {
            if let Some(keys) = before.remove(&path).or_else(|| keys(&mut file)) {
                taken.insert(path, keys);
            }
            continue;
        }
        let mut content = Vec::new();
        file.read_to_end(&mut content)?;
        let claim = Claim { file, path, head: 0 };
        let Some((head, behind)) = unframed(&content) else { continue };
        let Ok(head) = serde_json::from_slice::<ClaimHeader>(head) else { continue };
        if head.engine == engine {
            let (rows, has_begun, _) = rows(behind);
            found.push(OrphanedClaim { host: maker, head, rows, has_begun, _claim: claim });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod test {
    use super::*;

    fn head(count: usize) -> ClaimHeader {
        let due = |run| PendingRun { run, key: format!("key {run}"), attempt: 1 };
        ClaimHeader { engine: "e".into(), runs: (0..count).map(due).collect() }
    }

    #[test]
    fn what_a_worker_that_is_gone_has_left_is_taken_over_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let store = Store::new(folder.path());
        let mut claim = Claim::new(&store, "h", &head(3)).expect("a claim");
        let mut taken = ClaimedKeys::new();
        let mut left_behind = |host: &str| {
            let left = left_behind(&store, "e", host, &mut taken).expect("read");
            (left, taken.values().map(HashSet::len).sum::<usize>())
        };
        claim.begin().expect("written");
        claim.add(&Measured { message: Some("one".into()), ..Measured::default() }).expect("written");
        claim.begin().expect("written");
        assert!(matches!(left_behind("h"), (left, 3) if left.is_empty()), "its worker is there");
        // half a row
        claim.file.write_all(&[9, 0, 0, 0, 1]).expect("written");
        // the lock goes with the process; the file stays
        claim.file.unlock().expect("unlocked");
        std::mem::forget(claim);
        assert!(matches!(left_behind("another"), (left, 3) if left.is_empty()), "too early to say from elsewhere");
        let (left, taken) = left_behind("h");
        assert_eq!(taken, 0);
        assert_eq!(left.len(), 1);
        assert_eq!((left[0].rows.len(), left[0].has_begun, left[0].head.runs.len()), (1, true, 3));
        assert_eq!(left[0].rows[0].message.as_deref(), Some("one"));
        assert!(left_behind("h").0.is_empty(), "taken already");
        drop(left);
        assert!(store.claims().expect("read").is_empty());
    }

    #[test]
    fn what_a_worker_left_that_was_ended_before_it_wrote_a_head_goes() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let store = Store::new(folder.path());
        let left_behind = |host: &str| left_behind(&store, "e", host, &mut ClaimedKeys::new());
        let (file, path) = store.running("h", b"").expect("made");
        assert!(left_behind("h").expect("read").is_empty() && path.exists(), "its worker is there");
        file.unlock().expect("unlocked");
        assert!(left_behind("another").expect("read").is_empty() && path.exists(), "too early to say");
        assert!(left_behind("h").expect("read").is_empty() && !path.exists());
    }

    #[test]
    fn half_a_row_goes_and_what_begins_is_no_row() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let store = Store::new(folder.path());
        let mut claim = Claim::new(&store, "h", &head(2)).expect("a claim");
        claim.begin().expect("written");
        claim.file.write_all(&[200, 0, 0, 0, 1, 2, 3]).expect("written");
        assert!(claim.rows().expect("read").is_empty());
        claim.add(&Measured::default()).expect("written");
        assert_eq!(claim.rows().expect("read").len(), 1);
    }
}
