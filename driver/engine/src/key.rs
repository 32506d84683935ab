//! Key of a run: a hash of everything that its rows depend on. Runs that are there are known by it, in studies and sweeps.

use pullout_run::input;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Members of a case that no number depends on.
const WORDS: [&str; 3] = ["title", "description", "$schema"];

/// A key under construction.
#[derive(Clone, Debug)]
pub struct RunKey(Sha256);

impl RunKey {
    /// Begins the key of a run with the identity of the executable ([`super::identity`]).
    pub fn new(engine: [u8; 32]) -> Self {
        Self(Sha256::new().chain_update(engine))
    }

    /// Adds bytes, such as the hash of a file.
    #[must_use]
    pub fn with(self, bytes: impl AsRef<[u8]>) -> Self {
        Self(self.0.chain_update(bytes))
    }

    /// Adds a value, whatever the order of its members.
    #[must_use]
    pub fn with_value(self, value: &Value) -> Self {
        let mut text = String::new();
        canonical(value, &mut text);
        self.with(text)
    }

    /// Adds a case without its descriptive texts, which change no row.
    #[must_use]
    pub fn with_case(self, mut document: Value) -> Self {
        if let Some(members) = document.as_object_mut() {
            members.retain(|name, _| !WORDS.contains(&name.as_str()));
        }
        self.with_value(&document)
    }

    /// Returns the key in hexadecimal digits.
    pub fn digits(self) -> String {
        input::hexadecimal(self.0)
    }
}

/// Appends the canonical text of a value, the same for the same content: members in the order of their names, 1 and 1.0
/// alike.
fn canonical(value: &Value, text: &mut String) {
    match value {
        Value::Object(members) => {
            let sorted: BTreeMap<&String, &Value> = members.iter().collect();
            text.push('{');
            for (name, member) in sorted {
                text.push_str(&Value::from(name.as_str()).to_string());
                text.push(':');
                canonical(member, text);
                text.push(',');
            }
            text.push('}');
        }
        Value::Array(entries) => {
            text.push('[');
            for entry in entries {
                canonical(entry, text);
                text.push(',');
            }
            text.push(']');
        }
        Value::Number(number) => text.push_str(&number.as_f64().unwrap_or_default().to_string()),
        other => text.push_str(&other.to_string()),
    }
}
