//! A chart: axes, lines, areas, labels and keys.

use std::ops::Range;

use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::clip::{Point, inside};
use super::style::{BLACK, GRID, Stroke};
use super::svg::{Area, Result, SCALE, pixels};

const TEXT: f64 = 15.0;
const SMALL: f64 = 13.0;

/// Title, range, and the number of decimals of the numbers at the ticks.
pub(crate) struct Axis {
    title: &'static str,
    range: Range<f64>,
    ticks: usize,
    format: fn(f64, usize) -> String,
    decimals: usize,
}

impl Axis {
    pub(crate) fn new(title: &'static str, range: Range<f64>, decimals: usize) -> Self {
        Self {
            title,
            range,
            ticks: 7,
            format: number,
            decimals,
        }
    }

    /// The axis of a quantity that is given by its decimal logarithm.
    pub(crate) fn logarithmic(title: &'static str, range: Range<f64>) -> Self {
        let format = |x, _| format!("10^{{{}}}", number(x, 0));
        Self {
            format,
            ..Self::new(title, range, 0)
        }
    }

    pub(crate) fn ticks(self, ticks: usize) -> Self {
        Self { ticks, ..self }
    }
}

/// A chart with a frame, a thin grid and a heading.
pub(crate) struct Panel<'a, 's> {
    chart: ChartContext<'a, SVGBackend<'s>, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    range: [Range<f64>; 2],
}

impl<'a, 's> Panel<'a, 's> {
    pub(crate) fn new(area: &'a Area<'s>, heading: &str, [x, y]: [Axis; 2]) -> Result<Self> {
        let mut builder = ChartBuilder::on(area);
        builder
            .margin(pixels(8.0))
            .margin_right(pixels(18.0))
            .x_label_area_size(pixels(if x.title.is_empty() { 8.0 } else { 46.0 }))
            .y_label_area_size(pixels(62.0));
        if !heading.is_empty() {
            builder.caption(heading, font(TEXT));
        }
        let mut chart = builder.build_cartesian_2d(x.range.clone(), y.range.clone())?;
        chart
            .configure_mesh()
            .x_desc(x.title)
            .y_desc(y.title)
            .x_labels(x.ticks)
            .y_labels(y.ticks)
            .x_label_formatter(&|value| match x.title {
                "" => String::new(),
                _ => (x.format)(*value, x.decimals),
            })
            .y_label_formatter(&|value| (y.format)(*value, y.decimals))
            .set_all_tick_mark_size(pixels(4.0))
            .axis_desc_style(font(TEXT))
            .label_style(font(SMALL))
            .bold_line_style(GRID.stroke_width(SCALE as u32))
            .light_line_style(TRANSPARENT)
            .axis_style(BLACK.stroke_width(SCALE as u32))
            .draw()?;
        let range = [x.range, y.range];
        Ok(Self { chart, range })
    }

    /// The frame, over everything else.
    pub(crate) fn finish(mut self) -> Result<()> {
        let [x, y] = self.range.clone();
        let corners = vec![
            (x.start, y.start),
            (x.end, y.start),
            (x.end, y.end),
            (x.start, y.end),
            (x.start, y.start),
        ];
        self.draw(corners, Stroke::solid(BLACK, 1.0))
    }

    /// The part of a line that lies inside the frame.
    pub(crate) fn line(&mut self, points: &[Point], stroke: Stroke) -> Result<()> {
        let [x, y] = self.range.clone();
        for part in inside(points, |point| point.0, &x) {
            for part in inside(&part, |point| point.1, &y) {
                self.draw(part, stroke)?;
            }
        }
        Ok(())
    }

    fn draw(&mut self, points: Vec<Point>, stroke: Stroke) -> Result<()> {
        match stroke.dash {
            None => {
                let line = LineSeries::new(points, stroke.style());
                self.chart.draw_series(line)?;
            }
            Some([dash, gap]) => {
                let [dash, gap] = [dash, gap].map(|length| length * SCALE);
                let line = DashedLineSeries::new(points, dash, gap, stroke.style());
                self.chart.draw_series(line)?;
            }
        }
        Ok(())
    }

    pub(crate) fn horizontal(&mut self, y: f64, stroke: Stroke) -> Result<()> {
        let x = self.range[0].clone();
        self.line(&[(x.start, y), (x.end, y)], stroke)
    }

    pub(crate) fn vertical(&mut self, x: f64, stroke: Stroke) -> Result<()> {
        let y = self.range[1].clone();
        self.line(&[(x, y.start), (x, y.end)], stroke)
    }

    /// A filled area; corners beyond the frame are moved to it.
    pub(crate) fn polygon(&mut self, points: &[Point], colour: RGBColor) -> Result<()> {
        let [x, y] = self.range.clone();
        let points = points.iter();
        let corners = points.map(|p| (p.0.clamp(x.start, x.end), p.1.clamp(y.start, y.end)));
        let polygon = Polygon::new(corners.collect::<Vec<_>>(), colour.filled());
        self.chart.draw_series([polygon])?;
        Ok(())
    }

    /// A band over the whole height.
    pub(crate) fn band(&mut self, x: Range<f64>, colour: RGBColor) -> Result<()> {
        let y = self.range[1].clone();
        let corners = [
            (x.start, y.start),
            (x.end, y.start),
            (x.end, y.end),
            (x.start, y.end),
        ];
        self.polygon(&corners, colour)
    }

    pub(crate) fn dots(&mut self, points: &[Point], size: f64, colour: RGBColor) -> Result<()> {
        let dots = points
            .iter()
            .map(|&point| Circle::new(point, pixels(size), colour.filled()));
        self.chart.draw_series(dots)?;
        Ok(())
    }

    /// A dot with a white centre: what is unstable.
    pub(crate) fn ring(&mut self, point: Point, colour: RGBColor) -> Result<()> {
        self.dots(&[point], 4.5, colour)?;
        self.dots(&[point], 2.8, WHITE)
    }

    /// Text beside a point, shifted by pixels to the right and downwards; it grows away from the
    /// point.
    pub(crate) fn label(
        &mut self,
        text: &str,
        point: Point,
        (right, down): (f64, f64),
        colour: RGBColor,
    ) -> Result<()> {
        let side = if right > 0.0 {
            HPos::Left
        } else if right < 0.0 {
            HPos::Right
        } else {
            HPos::Center
        };
        let style = font(SMALL).color(&colour).pos(Pos::new(side, VPos::Center));
        let label = EmptyElement::at(point)
            + Text::new(text.to_string(), (pixels(right), pixels(down)), style);
        self.chart.draw_series([label])?;
        Ok(())
    }

    /// A point in an area too small for its name, which stands at the end of a line, shifted by
    /// pixels.
    pub(crate) fn pointer(&mut self, text: &str, point: Point, shift: Point) -> Result<()> {
        let end = (pixels(shift.0), pixels(shift.1));
        let style = Stroke::solid(BLACK, 0.8).style();
        let line = EmptyElement::at(point) + PathElement::new([(0, 0), end], style);
        self.chart.draw_series([line])?;
        self.dots(&[point], 2.0, BLACK)?;
        let beyond = shift.0 + 4.0_f64.copysign(shift.0);
        self.label(text, point, (beyond, shift.1), BLACK)
    }

    /// A key whose upper left corner lies at these fractions of width and height.
    pub(crate) fn key(&self, (across, down): Point, rows: &[(Stroke, &str)]) -> Result<()> {
        let area = self.chart.plotting_area().strip_coord_spec();
        let (width, height) = area.dim_in_pixel();
        let left = (across * f64::from(width)) as i32;
        let style = font(SMALL)
            .color(&BLACK)
            .pos(Pos::new(HPos::Left, VPos::Center));
        for (row, (stroke, text)) in (0..).zip(rows) {
            let y = (down * f64::from(height)) as i32 + pixels(20.0) * row;
            let ends = [(left, y), (left + pixels(30.0), y)];
            match stroke.dash {
                None => area.draw(&PathElement::new(ends, stroke.style()))?,
                Some([dash, gap]) => {
                    let [dash, gap] = [dash, gap].map(|length| length * SCALE);
                    area.draw(&DashedPathElement::new(ends, dash, gap, stroke.style()))?;
                }
            }
            let place = (left + pixels(38.0), y);
            area.draw(&Text::new((*text).to_string(), place, style.clone()))?;
        }
        Ok(())
    }
}

/// A number with a minus sign, not a hyphen, and with no sign at zero.
fn number(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.contains(|c| ('1'..='9').contains(&c)) => format!("−{size}"),
        Some(zero) => zero.to_string(),
        None => text,
    }
}

/// plotters writes a font size that is smaller by a factor of 1.24.
fn font(size: f64) -> TextStyle<'static> {
    (
        "Helvetica, Arial, sans-serif",
        1.24 * size * f64::from(SCALE),
    )
        .into_text_style(&(1, 1))
}
