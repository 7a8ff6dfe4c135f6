//! How values are written in the file that they belong in: for remedies.

use super::object::{Position, Property, Value};

/// How what is expected is written in the file that holds `property`.
pub(super) fn spelling(property: &Property, expected: &str) -> String {
    let name = &property.name;
    let is_json = matches!(property.location.position, Position::Path(_));
    if let (true, Value::String(text)) = (is_json, &property.value)
        && (text.parse::<f64>().is_ok() || ["true", "false"].contains(&text.as_str()))
        && expected != "a string"
    {
        return format!("remove the quotes: \"{name}\": {text}");
    }
    let (json, tag, example) = match expected {
        "a finite number" => ("1.5", "float", "value=\"1.5\"/"),
        "an integer" => ("2", "integer", "value=\"2\"/"),
        "a boolean" => ("true", "boolean", "value=\"true\"/"),
        "a string" => ("\"text\"", "string", "value=\"text\"/"),
        "three finite numbers" => ("[1, 2, 3]", "point", "value=\"1, 2, 3\"/"),
        COLOR => ("{\"type\": \"rgb\", \"value\": [0.1, 0.2, 0.3]}", "rgb", "value=\"0.1, 0.2, 0.3\"/"),
        "a transform" => (
            "[{\"type\": \"translate\", \"value\": [1, 2, 3]}]",
            "transform",
            "><translate value=\"1, 2, 3\"/></transform",
        ),
        "an object or a reference" => ("{\"type\": \"ref\", \"id\": \"...\"}", "ref", "id=\"...\"/"),
        _ => return format!("change \"{name}\" to {expected}"),
    };
    match is_json {
        true => format!("write it like \"{name}\": {json}"),
        false => format!("write it like <{tag} name=\"{name}\" {example}>"),
    }
}

/// What a colour is.
pub(super) const COLOR: &str = "a colour (a number, rgb or spectrum) with finite entries >= 0";
