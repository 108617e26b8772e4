//! Questions and answers as text.

use std::{error::Error, fmt::Display, str::FromStr};

use serde::Serialize;
use serde_json::{Value, json};

pub type Fallible<T> = Result<T, Box<dyn Error>>;

/// A question: lines `name=value`.
pub struct Question<'q>(pub &'q str);

impl<'q> Question<'q> {
    /// The value of a name; empty if it is not given.
    pub fn text(&self, name: &str) -> &'q str {
        let mut fields = self.0.lines().filter_map(|line| line.split_once('='));
        fields.find(|field| field.0 == name).map_or("", |field| field.1.trim())
    }

    /// The value of a name as a number.
    pub fn get<T: FromStr<Err: Display>>(&self, name: &str) -> Fallible<T> {
        let text = self.text(name);
        Ok(text.parse().map_err(|error| format!("{name} = “{text}”: {error}"))?)
    }
}

/// What the page shows.
#[derive(Default, Serialize)]
pub struct Answer {
    /// Sentences.
    pub words: Vec<String>,
    /// Curves and sets of dots.
    pub series: Vec<Value>,
    /// Rows of a picture from the bottom up, a character for each cell.
    pub cells: Vec<String>,
    /// What went wrong; the rest holds nevertheless.
    pub error: Option<String>,
}

impl Answer {
    /// Adds a curve, interrupted at NaN, or dots. The class names the plot, and how it is drawn.
    pub fn add(&mut self, class: impl Into<String>, name: &str, x: Vec<f64>, y: Vec<f64>) {
        self.series.push(json!({ "class": class.into(), "name": name, "x": x, "y": y }));
    }
}

/// A number with six digits.
pub fn six(x: f64) -> String {
    if x == 0.0 || !(1e-4..1e6).contains(&x.abs()) {
        return format!("{x:.5e}").replace("0.00000e0", "0");
    }
    format!("{x:.*}", (5 - x.abs().log10().floor() as i32).max(0) as usize)
}
