//! Colours and lines.

use plotters::prelude::*;

use super::svg::pixels;

// The palette of Okabe and Ito, which colour-blind readers can tell apart.
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const PURPLE: RGBColor = RGBColor(204, 121, 167);
pub(crate) const GREY: RGBColor = RGBColor(110, 110, 110);
pub(crate) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(crate) const GRID: RGBColor = RGBColor(228, 228, 228);

/// A colour mixed with white, for areas that lie under lines.
pub(crate) const fn pale(colour: RGBColor, share: f64) -> RGBColor {
    const fn mix(c: u8, share: f64) -> u8 {
        (255.0 - share * (255.0 - c as f64) + 0.5) as u8
    }
    RGBColor(
        mix(colour.0, share),
        mix(colour.1, share),
        mix(colour.2, share),
    )
}

/// How a line is drawn: colour, width in pixels, lengths of dash and gap.
#[derive(Clone, Copy)]
pub(crate) struct Stroke {
    colour: RGBColor,
    width: f64,
    pub(crate) dash: Option<[i32; 2]>,
}

impl Stroke {
    pub(crate) const fn solid(colour: RGBColor, width: f64) -> Self {
        let dash = None;
        Self {
            colour,
            width,
            dash,
        }
    }

    pub(crate) const fn dashed(colour: RGBColor, width: f64, dash: [i32; 2]) -> Self {
        let dash = Some(dash);
        Self {
            colour,
            width,
            dash,
        }
    }

    pub(crate) fn style(self) -> ShapeStyle {
        self.colour.stroke_width(pixels(self.width) as u32)
    }
}
