//! Ranges of numbers, for the schema of what a case describes.

use schemars::{Schema, SchemaGenerator, json_schema};

/// A number > 0.
pub fn positive(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "number", "exclusiveMinimum": 0 })
}

/// A number > 0 and ≤ 1.
pub fn fraction(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "number", "exclusiveMinimum": 0, "maximum": 1 })
}

/// A whole number between two bounds.
pub fn whole<const LEAST: usize, const GREATEST: usize>(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "integer", "minimum": LEAST, "maximum": GREATEST })
}

/// A number of elements along something.
pub fn count(generator: &mut SchemaGenerator) -> Schema {
    whole::<1, 100_000>(generator)
}

/// Two numbers of elements.
pub fn two_counts(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": count(generator), "minItems": 2, "maxItems": 2 })
}

/// Two numbers > 0.
pub fn two_positive(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": positive(generator), "minItems": 2, "maxItems": 2 })
}
