//! Data that a plain UMAT keeps between calls: its writable memory, compared before and after.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::Subject;
use object::{Object, ObjectSymbol, SymbolKind};
use pullout_run::input::{self, Input};
use std::collections::BTreeSet;
use std::path::Path;
use umat_abi::host::{Alteration, DataSnapshot};

/// States called.
const STATES: usize = 12;

/// Variables that change from call to call. What was set up once, in the calls so far, does not.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("data between calls");
    if subject.described() {
        return;
    }
    let mut changed = BTreeSet::new();
    let mut before = DataSnapshot::of(&subject.plugin.library);
    for state in sample.iter().take(STATES) {
        subject.call(&state.from, &state.step, 0.0, Alteration::None);
        let after = DataSnapshot::of(&subject.plugin.library);
        changed.extend(before.differences(&after));
        before = after;
    }
    if changed.is_empty() {
        return ledger.add(Verdict::Pass, "none", "");
    }
    let names = variables(subject.plugin.library.path(), &changed);
    let detail = format!(
        "changes {}: scratch, or memory that other points, repeated increments and replays do not find",
        names.into_iter().collect::<Vec<_>>().join(", ")
    );
    ledger.add(Verdict::Warn, format!("{} bytes", changed.len()), detail);
}

/// Names of what lies at these addresses of a library's file.
fn variables(library: &Path, addresses: &BTreeSet<u64>) -> BTreeSet<String> {
    let content = input::read(library, Input::Library).unwrap_or_default();
    let Ok(file) = object::File::parse(&*content) else { return BTreeSet::new() };
    let symbols: Vec<(u64, u64, String)> = file
        .symbols()
        .chain(file.dynamic_symbols())
        .filter(|symbol| symbol.kind() == SymbolKind::Data && symbol.size() > 0)
        .filter_map(|symbol| Some((symbol.address(), symbol.size(), spoken(symbol.name().ok()?))))
        .collect();
    let at = |address: u64| symbols.iter().find(|(start, size, _)| (*start..start + size).contains(&address));
    addresses
        .iter()
        .map(|&address| at(address).map_or_else(|| "data without a name".to_owned(), |(.., name)| name.clone()))
        .collect()
}

/// `count.0` is a variable of a routine; `kshare_` a COMMON block.
fn spoken(name: &str) -> String {
    match (name.split_once('.'), name.strip_suffix('_')) {
        (Some((variable, _)), _) => format!("variable {variable}"),
        (None, Some(block)) => format!("COMMON /{}/", block.to_uppercase()),
        (None, None) => format!("variable {name}"),
    }
}
