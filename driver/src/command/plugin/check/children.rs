//! Runs each group of checks in its own process: what ends one does not end the others.

use super::{Checks, TIME_LIMIT, header, no_plugin};
use crate::command::{DONE, Refusal, complain, isolated, say};
use clap::ValueEnum;
use pullout_check::conformance::{CheckGroup, CheckRow, Event, Judged, Judgement, Verdict};
use pullout_engine::{CaseSource, Message};
use pullout_run::isolation::{self, End, Need, Passage, Watch, WorkerFailure};
use serde::Deserialize;
use std::borrow::Cow;
use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time limit of all groups together, so that a check ends within twenty seconds unless it must wait for a processor.
const TIME_OF_ALL: Duration = Duration::from_secs(19);
/// How often the sample is drawn again after a state ended the process, without that state.
const MOST_ENDS: usize = 16;
/// The row that every group has.
const BOUNDS: &str = "array bounds";

/// Output read of a group.
#[derive(Default)]
struct GroupOutput {
    /// Check and entry point.
    begun: Option<(Cow<'static, str>, Cow<'static, str>)>,
    /// The state that was being drawn, and whether it is far from the case's path.
    drawn: Option<(usize, bool)>,
}

/// Message of a group.
#[derive(Deserialize)]
#[serde(untagged)]
enum Heard {
    Event(Event),
    Message(Message),
}

/// Findings of all groups.
struct Tally {
    /// Whether rows are printed as they come.
    prints_rows: bool,
    /// The case, if there is one.
    case: CaseSource,
    judged: Vec<Judged>,
    /// Writes past the ends of arrays, by law and entry point: the finding of the first group that found any.
    bounds: Vec<(usize, CheckRow)>,
    /// Calls that did not return, one entry for each law and cause.
    ended: Vec<Ended>,
}

/// Calls that did not return for one cause: the first of them, and what came later.
struct Ended {
    law: usize,
    cause: String,
    row: CheckRow,
    /// Checks of the later calls, and the number of these.
    later: Vec<Cow<'static, str>>,
    count: usize,
}

/// Makes all groups.
pub(super) fn run(
    mut checks: Checks,
    library: &Path,
    mut need: Need,
    prints_rows: bool,
) -> Result<Result<Judgement, u8>, Refusal> {
    isolated::warn_about_in_process(checks.case.as_ref().map_or(library, |case| &case.file), &need, false);
    for limit in need.libraries.values_mut().filter(|limit| **limit == isolation::CALL_TIME_LIMIT) {
        *limit = TIME_LIMIT;
    }
    let case = checks.case.clone().unwrap_or_else(|| CaseSource::file(Path::new("")));
    let mut tally = Tally { prints_rows, case, judged: Vec::new(), bounds: Vec::new(), ended: Vec::new() };
    let mut spent = Duration::ZERO;
    let groups = CheckGroup::value_variants();
    for (index, group) in groups.iter().enumerate() {
        loop {
            // the first is what the others rest on
            let part = 2.0 / (1 + groups.len() - index) as f64;
            let time_limit = TIME_OF_ALL.saturating_sub(spent).mul_f64(part);
            (checks.group, checks.seconds) = (Some(*group), Some(time_limit.as_secs_f64()));
            let time = Cell::new(Duration::ZERO);
            let wishes = Watch { time_limit: Some(time_limit), spent: Some(&time), ..Watch::default() };
            let ended = Passage::new(&checks).and_then(|mut passage| {
                let end = isolation::supervise(&mut passage, &wishes, &need)?;
                Ok((end, passage.heard()))
            });
            spent += time.get();
            let (end, events) = match ended {
                Ok(ended) => ended,
                Err(error) => {
                    let message = format!("{}: no process can be started for it: {error}", library.display());
                    return Err(Refusal::input(message));
                }
            };
            let output = tally.read(events);
            let failure = match end {
                End::Done(DONE) => break,
                End::Done(code) => return Ok(Err(code)),
                End::Failed(failure) if failure.report.at_loading => return Err(no_plugin(failure.report.message)),
                End::Failed(failure) => failure,
            };
            if failure.is_out_of_time {
                tally.leave(library, *group, &output, &failure, time_limit);
                break;
            }
            // a call that the plugin never survives is reported once
            if checks.longest_path == Some(0) && output.begun.as_ref().is_some_and(|(check, _)| check == "virgin state")
            {
                return Ok(Ok(tally.conclude(&checks.of.plugin)));
            }
            tally.end(library, *group, &output, &failure);
            let is_first = *group == CheckGroup::States;
            match (&output.begun, output.drawn) {
                (_, Some((state, _))) if is_first && checks.skip.len() < MOST_ENDS => checks.skip.push(state),
                (Some((check, _)), _) if is_first && check == "case's path" && checks.longest_path.is_none() => {
                    checks.longest_path = Some(failure.calls_of_check);
                }
                (_, Some(_)) | (Some(_), _) if is_first && output.is_in_the_sample() => {
                    complain(format!("{}: no sample can be drawn: nothing else is checked", library.display()));
                    return Ok(Ok(tally.conclude(&checks.of.plugin)));
                }
                _ => break,
            }
            // the rows of what was looked at before are made again
            tally.forget_passes();
        }
    }
    Ok(Ok(tally.conclude(&checks.of.plugin)))
}

impl GroupOutput {
    /// Returns whether all groups would end here.
    fn is_in_the_sample(&self) -> bool {
        self.begun.as_ref().is_none_or(|(check, _)| ["case's path", "typical size", "answers"].contains(&&**check))
    }
}

impl Tally {
    /// Reads the messages of a group.
    fn read(&mut self, heard: Vec<Heard>) -> GroupOutput {
        let mut output = GroupOutput::default();
        let mut law = 0;
        for heard in heard {
            let event = match heard {
                Heard::Event(event) => event,
                // the process that started this one receives the messages as well
                Heard::Message(message) => {
                    isolation::send(&message);
                    continue;
                }
            };
            match event {
                Event::Law(name, library) => law = self.law(&name, &library),
                Event::Begins(check, entry) => output = GroupOutput { begun: Some((check, entry)), drawn: None },
                Event::Draws(state, is_far) => output.drawn = Some((state, is_far)),
                Event::Row(row) => self.add(law, row),
            }
        }
        output
    }

    fn law(&mut self, name: &str, library: &Path) -> usize {
        if let Some(law) = self.judged.iter().position(|law| law.name == name) {
            return law;
        }
        if self.prints_rows {
            say(&header(name, library));
        }
        let library = library.display().to_string();
        self.judged.push(Judged { name: name.to_owned(), library, ..Judged::default() });
        self.judged.len() - 1
    }

    /// The law that was reported last; the library's name if none was.
    fn present_law(&mut self, library: &Path) -> usize {
        match self.judged.len() {
            0 => self.law(&library.file_stem().unwrap_or_default().to_string_lossy(), library),
            count => count - 1,
        }
    }

    fn add(&mut self, law: usize, row: CheckRow) {
        if row.check == BOUNDS {
            let known = self.bounds.iter_mut().find(|(of, other)| *of == law && other.stress_state == row.stress_state);
            match known {
                None => self.bounds.push((law, row)),
                Some((_, other)) if other.verdict == Verdict::Pass => *other = row,
                Some(_) => {}
            }
            return;
        }
        let rows = &mut self.judged[law].report.rows;
        // a sample that is drawn again repeats what came before
        let is_known = rows.iter().any(|other| {
            (&other.check, &other.stress_state, &other.detail) == (&row.check, &row.stress_state, &row.detail)
        });
        if is_known {
            return;
        }
        if self.prints_rows {
            say(&format!("{row}\n"));
        }
        rows.push(row);
    }

    /// A repeated group replaces what the same check said before, unless that was a failure.
    fn forget_passes(&mut self) {
        self.bounds.retain(|(_, row)| row.verdict == Verdict::Fail);
    }

    /// Reports the checks for which a group had no time.
    fn leave(
        &mut self,
        library: &Path,
        group: CheckGroup,
        output: &GroupOutput,
        failure: &WorkerFailure,
        time_limit: Duration,
    ) {
        let law = self.present_law(library);
        let (check, stress_state) = output.begun.clone().unwrap_or(("start".into(), "-".into()));
        let detail = format!(
            "not tested: no time left after {:.1} s, in call {} of this check: the plugin's calls take long; left out with \
             what follows of {}",
            time_limit.as_secs_f64(),
            failure.calls_of_check,
            group.words()
        );
        let figure = "out of time".into();
        self.add(law, CheckRow { check, stress_state, verdict: Verdict::NotTested, figure, detail });
    }

    /// Notes a call that did not return.
    fn end(&mut self, library: &Path, group: CheckGroup, output: &GroupOutput, failure: &WorkerFailure) {
        let message = &failure.report.message;
        let law = self.present_law(library);
        let (check, stress_state) = output.begun.clone().unwrap_or(("loading".into(), "-".into()));
        let mut detail = match output.drawn {
            Some((state, true)) => format!("a long step away from the case's path, state {state}: {message}"),
            Some((state, false)) => format!("state {state}: {message}"),
            None if check == "case's path" => message.clone(),
            None => format!("call {} of this check: {message}", failure.calls_of_check),
        };
        // what makes no sense, or what the case never does, may end the analysis
        let is_senseless = group == CheckGroup::BadInput || output.drawn.is_some_and(|(_, is_far)| is_far);
        let verdict = if is_senseless { Verdict::Warn } else { Verdict::Fail };
        let cause = &failure.report.cause;
        if let Some(known) = self.ended.iter_mut().find(|known| known.law == law && known.cause == *cause) {
            known.count += 1;
            if !known.later.contains(&check) {
                known.later.push(check);
            }
            if verdict == Verdict::Fail {
                known.row.verdict = verdict;
            }
            return;
        }
        // one is enough to begin with: the current folder is the user's
        if let Some(case) = isolated::replay(failure, &self.case)
            && self.judged.iter().all(|law| law.replays.is_empty())
        {
            detail += &match keep(&format!("{case:#}\n")) {
                Ok(path) => format!(" (replay case: {})", path.display()),
                Err(error) => format!(" (no replay case could be written: {error})"),
            };
            self.judged[law].replays.push(case);
        }
        let row = CheckRow { check, stress_state, verdict, figure: "ended".into(), detail };
        self.ended.push(Ended { law, cause: cause.clone(), row, later: Vec::new(), count: 0 });
    }

    /// Reports the rows that concern all groups, and the conclusion.
    fn conclude(mut self, plugin: &str) -> Judgement {
        if self.judged.is_empty() {
            complain(format!("{plugin}: no check reported a result"));
        }
        for Ended { law, mut row, later, count, .. } in std::mem::take(&mut self.ended) {
            match count {
                0 => {}
                1 => row.detail += &format!("; likewise in another call ({})", later.join(", ")),
                _ => row.detail += &format!("; likewise in {count} other calls ({})", later.join(", ")),
            }
            self.add(law, row);
        }
        for (law, row) in std::mem::take(&mut self.bounds) {
            if self.prints_rows {
                say(&format!("{row}\n"));
            }
            self.judged[law].report.rows.push(row);
        }
        let judgement = Judgement::of(self.judged);
        if self.prints_rows {
            judgement.laws.iter().for_each(|law| say(&format!("{}\n\n", law.conclusion)));
        }
        judgement
    }
}

/// Writes a replay case into the current folder under the first free name, and returns the name. An existing file may be the
/// user's, or a replay that they changed: it is kept, and its name is returned if the content is the same.
fn keep(text: &str) -> io::Result<PathBuf> {
    let mut number = 1;
    loop {
        let path = match number {
            1 => PathBuf::from("plugin-check-replay.json"),
            _ => format!("plugin-check-replay-{number}.json").into(),
        };
        match File::create_new(&path) {
            Ok(mut file) => {
                let written = file.write_all(text.as_bytes());
                if written.is_err() {
                    let _ = fs::remove_file(&path);
                }
                return written.map(|()| path);
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                // no pipe is opened, and nothing large is read
                let is_as_long = fs::metadata(&path).is_ok_and(|it| it.is_file() && it.len() == text.len() as u64);
                if is_as_long && fs::read(&path).is_ok_and(|content| content == text.as_bytes()) {
                    return Ok(path);
                }
            }
            Err(error) => return Err(error),
        }
        number += 1;
    }
}
