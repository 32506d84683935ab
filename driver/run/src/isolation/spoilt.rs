//! Changes that a plugin may make to the process that calls it, and that leave this program without its own files.

use rustix::process::{Gid, Resource, Rlimit, Uid, getegid, geteuid, getgid, getrlimit, getuid, setrlimit};
use std::sync::OnceLock;

/// Change of the process after which a run cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Spoilt {
    /// A plugin closed the standard output, or another descriptor that is not its own.
    ClosedOutput = 1,
    /// It changed the user or the group.
    User,
    /// It lowered the limit of open files.
    OpenFiles,
    /// It lowered the limit of the size of files.
    FileSize,
    /// It lowered the limit of memory.
    Memory,
    /// It lowered the limit of processes and threads.
    Processes,
}

/// Limits on which this program depends.
const LIMITS: [(Resource, Spoilt); 5] = [
    (Resource::Nofile, Spoilt::OpenFiles),
    (Resource::Fsize, Spoilt::FileSize),
    (Resource::As, Spoilt::Memory),
    (Resource::Data, Spoilt::Memory),
    (Resource::Nproc, Spoilt::Processes),
];

/// User and limits as this process was given them.
#[derive(Debug)]
struct Given {
    user: ([Uid; 2], [Gid; 2]),
    limits: [Rlimit; LIMITS.len()],
}

static GIVEN: OnceLock<Given> = OnceLock::new();

fn user() -> ([Uid; 2], [Gid; 2]) {
    ([getuid(), geteuid()], [getgid(), getegid()])
}

/// Keeps user and limits, before any plugin is called.
pub(super) fn keep() {
    GIVEN.get_or_init(|| Given { user: user(), limits: LIMITS.map(|(resource, _)| getrlimit(resource)) });
}

impl Spoilt {
    /// Reads the number that a worker left.
    pub(super) fn of_number(number: u64) -> Option<Self> {
        let all = [Self::ClosedOutput, Self::User, Self::OpenFiles, Self::FileSize, Self::Memory, Self::Processes];
        all.into_iter().find(|spoilt| *spoilt as u64 == number)
    }

    /// Returns what a plugin has changed, whether or not it could be undone.
    pub(super) fn present() -> Option<Self> {
        let given = GIVEN.get()?;
        let changed = LIMITS.iter().zip(&given.limits).find(|((resource, _), given)| is_lowered(*resource, given));
        if user() == given.user { changed.map(|((_, spoilt), _)| *spoilt) } else { Some(Self::User) }
    }

    /// Undoes what can be undone; returns what cannot.
    pub(super) fn undone() -> Option<Self> {
        Self::present()?;
        for ((resource, _), given) in LIMITS.iter().zip(&GIVEN.get()?.limits) {
            if is_lowered(*resource, given) && setrlimit(*resource, *given).is_err() {
                let present = getrlimit(*resource);
                let _ = setrlimit(*resource, Rlimit { current: given.current, maximum: present.maximum });
            }
        }
        Self::present()
    }

    /// Says what a plugin did.
    pub(super) fn words(self) -> String {
        let limit = match self {
            Self::ClosedOutput => {
                return "it closed the standard output or another descriptor of the program's; the run was ended before a \
                        file of results takes its place"
                    .into();
            }
            Self::User => {
                return "it changed the user or the group of the process, which may no longer write the results; the run \
                        was ended"
                    .into();
            }
            Self::OpenFiles => "open files (RLIMIT_NOFILE)",
            Self::FileSize => "the size of files (RLIMIT_FSIZE)",
            Self::Memory => "memory (RLIMIT_AS or RLIMIT_DATA)",
            Self::Processes => "processes and threads (RLIMIT_NPROC)",
        };
        format!("it lowered the limit of {limit} of the process, in which results are written; the run was ended")
    }
}

fn is_lowered(resource: Resource, given: &Rlimit) -> bool {
    let present = getrlimit(resource).current;
    present.is_some_and(|present| given.current.is_none_or(|given| present < given))
}
