//! Formulas in SVG text: `v_b`, `x_{max}` and `10^{3}` with subscripts and superscripts, variables
//! in italics.

/// Shift and size of a script, in heights of the letters.
const SUBSCRIPT: f64 = 0.25;
const SUPERSCRIPT: f64 = -0.35;
const SIZE: f64 = 0.75;

pub(crate) fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}

/// The content of a text element. The label is escaped already.
pub(crate) fn typeset(label: &str) -> String {
    let mut text = String::new();
    let mut rest = label;
    while let Some(at) = rest.find(['_', '^']) {
        let shift = if rest[at..].starts_with('_') {
            SUBSCRIPT
        } else {
            SUPERSCRIPT
        };
        text.push_str(&italic_variables(&rest[..at]));
        let (script, after) = script(&rest[at + 1..]);
        text.push_str(&format!(
            "<tspan dy=\"{:.2}em\" font-size=\"{SIZE}em\">{script}</tspan>",
            shift / SIZE
        ));
        // Back to the line, with what comes next.
        let (next, after) = after.split_at(after.find(['_', '^']).unwrap_or(after.len()));
        if !next.is_empty() {
            let next = italic_variables(next);
            text.push_str(&format!("<tspan dy=\"{:.2}em\">{next}</tspan>", -shift));
        }
        rest = after;
    }
    text + &italic_variables(rest)
}

/// What stands in the script, `{` to `}` or letters and digits, and what follows it.
fn script(text: &str) -> (&str, &str) {
    let braced = text.strip_prefix('{').and_then(|text| text.split_once('}'));
    let end = text.find(|c: char| !c.is_alphanumeric());
    braced.unwrap_or_else(|| text.split_at(end.unwrap_or(text.len())))
}

/// Single letters are variables, but for the article and for panels: (b).
fn italic_variables(text: &str) -> String {
    // A letter, or the hat on one.
    let letter = |c: char| c.is_alphabetic() || c == '\u{302}';
    let mut set = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(letter) {
        let end = rest[start..].find(|c| !letter(c));
        let (before, word) = rest.split_at(start);
        let (word, after) = word.split_at(end.unwrap_or(word.len()));
        let single = word.chars().filter(|c| c.is_alphabetic()).count() == 1;
        let panel = before.ends_with('(') && after.starts_with(')');
        set.push_str(before);
        if single && !panel && word != "a" {
            set.push_str(&format!("<tspan font-style=\"italic\">{word}</tspan>"));
        } else {
            set.push_str(word);
        }
        rest = after;
    }
    set + rest
}
