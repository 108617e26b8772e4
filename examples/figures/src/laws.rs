//! Figs. 2 and 3: the friction coefficient over the relative velocity.

use stick_slip::{Exponential, FrictionLaw, Polynomial};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

const VELOCITY: &str = "relative velocity v_r";
const COEFFICIENT: &str = "friction coefficient μ(v_r)";
const THIN: Stroke = Stroke::dashed(GREY, 1.0, [3, 3]);

const POLYNOMIAL: &str = "Fig. 2. The polynomial law, Eqs. 3 to 5, μ_s = 0.4, μ_m = 0.25: it falls \
    from μ_s to its minimum μ_m at the relative velocity v_m, then rises. In stick the coefficient \
    has any value between −μ_s and μ_s.";

pub(crate) fn polynomial() -> Result<Figure> {
    svg((860, 380), POLYNOMIAL, |area| {
        let halves = area.split_evenly((1, 2));
        for (half, (name, v_m)) in halves.iter().zip([("(a)", 0.4), ("(b)", 0.6)]) {
            let law = Polynomial::new(0.4, 0.25, v_m)?;
            let heading = format!("{name}  v_m = {v_m}");
            let axes = [
                Axis::new(VELOCITY, -0.85..0.85, 1),
                Axis::new(COEFFICIENT, -0.7..0.7, 1),
            ];
            let mut panel = Panel::new(half, &heading, axes)?;
            for (y, text) in [(0.4, "μ_s"), (0.25, "μ_m")] {
                panel.line(&[(-0.85, y), (v_m, y)], THIN)?;
                panel.label(text, (-0.85, y), (8.0, -10.0), BLACK)?;
            }
            panel.line(&[(v_m, -0.7), (v_m, 0.25)], THIN)?;
            panel.label("v_m", (v_m, -0.7), (8.0, -12.0), BLACK)?;
            odd(&mut panel, &law, 0.85, (0.04, 0.06))?;
            panel.finish()?;
        }
        Ok(())
    })
}

const EXPONENTIAL: &str = "Fig. 3. (a) The exponential law, Eq. 6, μ_s = 0.4, μ_k = 0.25, v_s = \
    0.5. It changes its concavity at v_s/√2 (the paper says, at v_s). (b) Beside the polynomial \
    law with the same numbers: it never rises (the paper says that it does), and it is level at \
    v_r = 0.";

pub(crate) fn exponential() -> Result<Figure> {
    svg((860, 380), EXPONENTIAL, |area| {
        let (v_s, mu_k) = (0.5, 0.25);
        let law = Exponential::new(0.4, mu_k, v_s)?;
        let inflection = v_s / 2_f64.sqrt();
        let halves = area.split_evenly((1, 2));

        let axes = [
            Axis::new(VELOCITY, -1.5..1.5, 1),
            Axis::new(COEFFICIENT, -0.6..0.6, 1),
        ];
        let mut panel = Panel::new(&halves[0], "(a)  exponential law", axes)?;
        for (y, text) in [(0.4, "μ_s"), (mu_k, "μ_k")] {
            panel.line(&[(-1.5, y), (1.5, y)], THIN)?;
            panel.label(text, (-1.5, y), (8.0, -10.0), BLACK)?;
        }
        odd(&mut panel, &law, 1.5, (0.62, 0.78))?;
        panel.finish()?;

        let axes = [
            Axis::new("sliding speed |v_r|", 0.0..1.0, 1),
            Axis::new("friction coefficient μ̂", 0.2..0.5, 2),
        ];
        let mut panel = Panel::new(&halves[1], "(b)  both laws", axes)?;
        for (speed, text) in [(inflection, "v_s/√2"), (v_s, "v_s = v_m")] {
            panel.line(&[(speed, 0.2), (speed, law.kinetic(speed))], THIN)?;
            panel.label(text, (speed, 0.2), (6.0, -12.0), BLACK)?;
        }
        let exponential = curve(0.0, 1.0, |s| law.kinetic(s));
        let other = Polynomial::new(0.4, mu_k, v_s)?;
        let polynomial = curve(0.0, 1.0, |s| other.kinetic(s));
        let strokes = [
            Stroke::solid(BLUE, 2.5),
            Stroke::dashed(VERMILLION, 2.5, [8, 4]),
        ];
        panel.line(&polynomial, strokes[1])?;
        panel.line(&exponential, strokes[0])?;
        panel.dots(&[(inflection, law.kinetic(inflection))], 4.0, BLUE)?;
        panel.key(
            (0.3, 0.06),
            &[
                (strokes[0], "exponential, Eq. 6"),
                (strokes[1], "polynomial, Eq. 3"),
            ],
        )?;
        panel.finish()
    })
}

/// A law on both sides of zero: it slips, and sticks in between.
fn odd<L: FrictionLaw>(panel: &mut Panel, law: &L, end: f64, key: Point) -> Result<()> {
    let slip = Stroke::solid(BLUE, 2.5);
    let stick = Stroke::solid(VERMILLION, 2.5);
    for side in [-1.0, 1.0] {
        // v_r = 0 belongs to stick; the least number beyond it does not.
        let start = side * f64::MIN_POSITIVE;
        panel.line(&curve(start, side * end, |v_r| law.coefficient(v_r)), slip)?;
    }
    let mu_s = law.static_coefficient();
    panel.line(&[(0.0, -mu_s), (0.0, mu_s)], stick)?;
    panel.key(key, &[(slip, "slip"), (stick, "stick")])
}

fn curve(start: f64, end: f64, f: impl Fn(f64) -> f64) -> Vec<Point> {
    (0..=100)
        .map(|i| start + (end - start) * f64::from(i) / 100.0)
        .map(|x| (x, f(x)))
        .collect()
}
