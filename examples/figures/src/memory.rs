//! Contacts that remember: static friction that rises at rest, and bristles.

use stick_slip::analysis::coulomb;
use stick_slip::analysis::dwell::{DwellOscillator, ExactCycle};
use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Coulomb, Dwell, Error, Exponential, LuGre, MassOnBelt, Segment, Structure,
    Trajectory,
};

use super::clip::Point;
use super::plot::{Axis, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Stroke, VERMILLION};
use super::svg::{Figure, Result, svg};

const STATIC: f64 = 0.6;
const KINETIC: f64 = 0.3;
const DOT: f64 = 3.2;

/// m = k = N = 1.
fn oscillator(law: Dwell<Coulomb>, damping_ratio: f64) -> DwellOscillator {
    DwellOscillator {
        law,
        mass: 1.0,
        stiffness: 1.0,
        damping: 2.0 * damping_ratio,
        load: 1.0,
    }
}

/// Amplitudes of closed forms, over belt velocities up to the largest; densest there.
fn curve(largest: f64, cycle: impl Fn(f64) -> Option<ExactCycle>) -> Vec<Point> {
    let parts = (0..=120).map(|i| 1.0 - (1.0 - f64::from(i) / 120.0).powi(2));
    let velocities = parts.map(|part| largest * (1e-3 + (1.0 - 1e-3 - 1e-9) * part));
    let points = velocities.filter_map(|v| Some((v, cycle(v)?.amplitude)));
    points.collect()
}

/// Amplitudes of motions that have settled from a large swing, if they still stick.
fn settled(of: &DwellOscillator, velocities: &[f64]) -> Result<Vec<Point>> {
    let mut points = Vec::new();
    for &v in velocities {
        let block = Structure::new(&[of.mass])?
            .with_ground_spring(0, of.stiffness)?
            .with_ground_damper(0, of.damping)?
            .with_contact(Contact::new(0, of.law, of.load)?.on_belt(v))?;
        let motion = block.simulate(State::new(&[1.0], &[v]), 2000.0)?;
        let events = motion.events();
        if let [.., from, _, to] = events
            && to.time > 1900.0
        {
            let times = (0..=2000).map(|i| from.time + (to.time - from.time) * f64::from(i) / 2e3);
            let places = motion.sample_at(times).map(|(_, s)| s.displacements[0]);
            let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), q| {
                (low.min(q), high.max(q))
            });
            points.push((v, 0.5 * (high - low)));
        }
    }
    Ok(points)
}

/// A way in which static friction rises, or does not.
struct Form {
    name: &'static str,
    law: Dwell<Coulomb>,
    stroke: Stroke,
    colour: plotters::style::RGBColor,
}

pub(crate) fn dwell() -> Result<Figure> {
    let law = Coulomb::new(KINETIC, KINETIC)?;
    let dry = Coulomb::new(STATIC, KINETIC)?;
    let forms = [
        ("hyperbolic", Dwell::hyperbolic(law, STATIC, 2.0)?, BLUE),
        (
            "exponential",
            Dwell::exponential(law, STATIC, 2.0)?,
            VERMILLION,
        ),
        ("logarithmic", Dwell::logarithmic(law, 0.06, 0.4)?, GREEN),
    ];
    let forms = forms.map(|(name, law, colour)| Form {
        name,
        law,
        stroke: Stroke::solid(colour, 2.2),
        colour,
    });
    let unstable = forms
        .each_ref()
        .map(|f| Stroke::dashed(f.colour, 2.0, [7, 5]));
    let at_once = Stroke::solid(GREY, 2.0);
    let damping = 0.025;

    let without = |damping: f64| {
        move |v: f64| {
            let belt = MassOnBelt::new(dry, v).ok()?.with_damping(damping).ok()?;
            coulomb::stick_slip(&belt)
        }
    };
    let mut folds = String::new();
    for form in &forms {
        let fold = oscillator(form.law, damping).fold().ok_or("no fold")?;
        folds.push_str(&format!(", {:.9} ({})", fold.belt_velocity, form.name));
    }
    let caption = format!(
        "Static friction that rises at rest from μ_k = 0.3: to 0.6 with θ_c = 2, or by 0.06 for \
         each factor e of 1 + θ/0.4; m = k = N = 1. Lines are closed forms, dashed where the cycle \
         is unstable; dots are motions that have settled. Grey: a static coefficient of 0.6 at \
         once. \
         (a) Without damping stick-slip dies out at v_c = 2F_s'(0)/k. (b) With a damping ratio of \
         0.025 it ends at a fold{folds}."
    );
    svg((860, 430), &caption, |area| {
        let halves = area.split_evenly((1, 2));
        let views = [
            ("(a)  no damping", 0.0, 0.0..0.36),
            ("(b)  damping ratio 0.025", damping, 0.0..0.36),
        ];
        for (half, (heading, damping, range)) in halves.iter().zip(views) {
            let axes = [
                Axis::new("belt velocity v_b", range.clone(), 1).ticks(4),
                Axis::new("amplitude (u_{max} − u_{min})/2", 0.0..0.5, 1),
            ];
            let mut panel = Panel::new(half, heading, axes)?;
            panel.line(&curve(range.end, without(damping)), at_once)?;
            for (form, unstable) in forms.iter().zip(unstable) {
                let of = oscillator(form.law, damping);
                let largest = match of.critical_velocity() {
                    Some(velocity) => velocity,
                    None => of.fold().ok_or("no fold")?.belt_velocity,
                };
                if let Some(least) = of.grazing_velocity() {
                    let mut branch = curve(largest, |v| of.unstable_stick_slip(v));
                    branch.retain(|point| point.0 >= least);
                    panel.line(&branch, unstable)?;
                }
                panel.line(&curve(largest, |v| of.stick_slip(v)), form.stroke)?;
                let parts = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97];
                let dots = settled(&of, &parts.map(|part| part * largest))?;
                panel.dots(&dots, DOT, form.colour)?;
            }
            if damping == 0.0 {
                let mut rows: Vec<_> = forms.iter().map(|f| (f.stroke, f.name)).collect();
                rows.push((at_once, "0.6 at once"));
                panel.key((0.1, 0.04), &rows)?;
            }
            panel.finish()?;
        }
        Ok(())
    })
}

/// C. Canudas de Wit et al. (1995), Table I, seen from the pulling end.
fn pulled<L: ContactLaw + Send + Sync + 'static>(
    law: L,
    damper: f64,
) -> std::result::Result<Trajectory<State>, Error> {
    Structure::new(&[1.0])?
        .with_ground_spring(0, 2.0)?
        .with_ground_damper(0, damper)?
        .with_force(0, -0.1 * damper)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(-0.1))?
        .simulate(State::new(&[0.0], &[-0.1]), 30.0)
}

/// Force of the spring and velocity over the ground, densely.
fn states(motion: &Trajectory<State>) -> Vec<(f64, f64, f64)> {
    let mut states = Vec::new();
    for step in motion.steps() {
        let pieces = 1 + (step.duration() / 0.03) as u32;
        for i in 0..=pieces {
            let t = step.duration() * f64::from(i) / f64::from(pieces);
            let state = step.state_at(t);
            let force = -2.0 * state.displacements[0];
            states.push((step.start_time() + t, force, state.velocities[0] + 0.1));
        }
    }
    states
}

pub(crate) fn lugre() -> Result<Figure> {
    let g = Exponential::new(1.5, 1.0, 0.001)?;
    let bristles = states(&pulled(LuGre::new(g, 1e5, 1e5_f64.sqrt(), 0.4)?, 0.0)?);
    // The limit of stiff bristles: friction g + σ2 v without memory.
    let dry = states(&pulled(g, 0.4)?);
    let lines = [
        (Stroke::solid(GREY, 2.0), "dry friction", &dry),
        (Stroke::solid(BLUE, 2.2), "bristles", &bristles),
    ];
    // When slip reaches 0.1 m/s each time.
    let period = |states: &[(f64, f64, f64)]| {
        let pairs = states.windows(2);
        let rises = pairs.filter(|pair| pair[0].2 < 0.1 && pair[1].2 >= 0.1);
        let crossing =
            |a: (f64, f64, f64), b: (f64, f64, f64)| a.0 + (b.0 - a.0) * (0.1 - a.2) / (b.2 - a.2);
        let times: Vec<f64> = rises.map(|pair| crossing(pair[0], pair[1])).collect();
        match times[..] {
            [_, first, .., last] => (last - first) / (times.len() - 2) as f64,
            _ => f64::NAN,
        }
    };
    let periods = [&bristles, &dry].map(|states| period(states));
    let caption = format!(
        "A mass of 1 kg is pulled over the ground by a spring of 2 N/m whose end moves at 0.1 m/s, \
         after Canudas de Wit et al. (1995), Table I: LuGre's bristles, and dry friction with the \
         same law, 1 to 1.5 N. Bristles creep before they let go, and let go earlier: their period \
         is {:.2} s, that of dry friction {:.2} s.",
        periods[0], periods[1]
    );
    svg((860, 430), &caption, |area| {
        let halves = area.split_evenly((1, 2));
        let axes = [
            Axis::new("time in s", 0.0..30.0, 0),
            Axis::new("force of the spring in N", 0.0..1.6, 1),
        ];
        let mut panel = Panel::new(&halves[0], "(a)", axes)?;
        for (stroke, _, states) in lines {
            let points: Vec<Point> = states.iter().map(|s| (s.0, s.1)).collect();
            panel.line(&points, stroke)?;
        }
        panel.key((0.5, 0.8), &lines.map(|(stroke, name, _)| (stroke, name)))?;
        panel.finish()?;
        let axes = [
            Axis::new("force of the spring in N", 0.6..1.6, 1),
            Axis::new("velocity over the ground in m/s", -0.05..0.45, 1).ticks(5),
        ];
        let mut panel = Panel::new(&halves[1], "(b)", axes)?;
        panel.horizontal(0.1, Stroke::dashed(BLACK, 1.0, [3, 3]))?;
        panel.label("of the pulling end", (1.12, 0.1), (0.0, -10.0), BLACK)?;
        for (stroke, _, states) in lines {
            // From the second slip on the motion is periodic.
            let late = states.iter().filter(|s| s.0 > 12.0);
            let points: Vec<Point> = late.map(|s| (s.1, s.2)).collect();
            panel.line(&points, stroke)?;
        }
        panel.finish()
    })
}
