//! Ranges of parameters in the schema of a case.

use schemars::{Schema, SchemaGenerator, json_schema};

/// A number > 0.
pub(super) fn positive(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "number", "exclusiveMinimum": 0 })
}

/// A number of elements along something.
pub(super) fn count(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "integer", "minimum": 1, "maximum": 100_000 })
}

pub(super) fn two_positive(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": positive(generator), "minItems": 2, "maxItems": 2 })
}

pub(super) fn two_counts(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": count(generator), "minItems": 2, "maxItems": 2 })
}
