//! What plotters draws, made fit for print: smooth curves, formulas in the labels, a description.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::typeset::{escape, typeset};

pub(crate) type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;
pub(crate) type Area<'s> = DrawingArea<SVGBackend<'s>, Shift>;

/// plotters draws at whole pixels. With ten of them to one of the picture, curves are smooth.
pub(crate) const SCALE: i32 = 10;
/// Bytes that plotters writes with every element, and that say nothing.
const IDLE: &str = " opacity=\"1\"";

/// A length in the picture, as plotters counts.
pub(crate) fn pixels(length: f64) -> i32 {
    (length * f64::from(SCALE)).round() as i32
}

/// A figure as the text of an SVG file, and its caption.
pub(crate) struct Figure {
    pub(crate) svg: String,
    pub(crate) caption: String,
}

/// Draws a figure of this size in pixels.
pub(crate) fn svg(
    (width, height): (u32, u32),
    caption: &str,
    draw: impl FnOnce(&Area) -> Result<()>,
) -> Result<Figure> {
    let mut drawn = String::new();
    let size = (width * SCALE as u32, height * SCALE as u32);
    {
        let root = SVGBackend::with_string(&mut drawn, size).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    Ok(Figure {
        svg: for_print(&drawn, (width, height), caption),
        caption: caption.to_string(),
    })
}

/// What plotters has drawn, as the picture it is meant to be.
fn for_print(drawn: &str, (width, height): (u32, u32), caption: &str) -> String {
    let mut text = format!(
        "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" \
         stroke-linejoin=\"round\" \
         xml:space=\"preserve\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<desc>{}</desc>\n",
        width * SCALE as u32,
        height * SCALE as u32,
        escape(caption)
    );
    let mut lines = drawn.lines().skip(1);
    while let Some(line) = lines.next() {
        text.push_str(&line.replace(IDLE, ""));
        if line.starts_with("<text") {
            // On one line, for spaces and line breaks count.
            text.push_str(&typeset(lines.next().unwrap_or_default().trim()));
            text.push_str(lines.next().unwrap_or_default());
        }
        text.push('\n');
    }
    text
}
