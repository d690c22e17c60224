//! JSON schemas of the few words that ours use.

use serde_json::Value;

/// Whether a value is as a schema says, and has no field that the schema does not name.
pub(crate) fn conforms(value: &Value, schema: &Value) -> bool {
    part_conforms(value, schema, schema)
}

/// The same for a part of the schema `root`.
fn part_conforms(value: &Value, schema: &Value, root: &Value) -> bool {
    if let Some(name) = schema["$ref"].as_str().and_then(|name| name.strip_prefix("#/$defs/")) {
        return part_conforms(value, &root["$defs"][name], root);
    }
    let of_type = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("no such type: {other}"),
    };
    let types = match &schema["type"] {
        Value::String(name) => of_type(name),
        Value::Array(names) => names.iter().any(|name| of_type(name.as_str().unwrap())),
        _ => true,
    };
    let listed = schema["enum"].as_array().is_none_or(|values| values.contains(value));
    let empty = serde_json::Map::new();
    let properties = schema["properties"].as_object().unwrap_or(&empty);
    let fields = value.as_object().unwrap_or(&empty);
    let required =
        schema["required"].as_array().into_iter().flatten().all(|name| fields.contains_key(name.as_str().unwrap()));
    let known = |(name, field)| properties.get(name).is_some_and(|schema| part_conforms(field, schema, root));
    let mut items = value.as_array().into_iter().flatten();
    types
        && listed
        && required
        && fields.iter().all(known)
        && items.all(|item| part_conforms(item, &schema["items"], root))
}
