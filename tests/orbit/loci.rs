//! Curves of bifurcations in two parameters, known to 25 digits.

use serde_json::Value;
use stick_slip::Structure;

use crate::common::{list, text};
use crate::reading::{cases, remembering, structure};

/// A reference curve.
pub(crate) fn curve(id: &str) -> Value {
    let cases = cases(include_str!("../data/loci.json"));
    cases
        .into_iter()
        .find(|case| text(&case["id"]) == id)
        .unwrap()
}

/// A system of a reference curve.
pub(crate) fn member(system: &Value, first: f64, second: f64) -> Structure {
    let mut system = system.clone();
    put(&mut system, [first, second]);
    let dwells = |contact: &Value| contact.get("dwell").is_some();
    if list(&system["contacts"]).iter().any(dwells) {
        remembering(&system)
    } else {
        structure(&system, f64::NAN)
    }
}

/// Puts numbers in place of the names of the parameters.
fn put(value: &mut Value, parameters: [f64; 2]) {
    match value {
        Value::String(text) => {
            for (name, number) in [("PARAM1", parameters[0]), ("PARAM2", parameters[1])] {
                if text == name {
                    *text = number.to_string();
                } else if text.strip_prefix("-1*") == Some(name) {
                    *text = (-number).to_string();
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| put(item, parameters)),
        Value::Object(fields) => fields.values_mut().for_each(|item| put(item, parameters)),
        _ => {}
    }
}
