//! The answers that the page draws, asked without a browser.

use serde_json::Value;
use stick_slip_explorer::answer;

/// The answer to a question: the example system, with other fields.
fn ask(fields: &str) -> Value {
    let example = "law=polynomial mu_s=0.4 mu_k=0.25 v_s=0.5 v_b=0.2 beta=0.05 load=1 force=0 \
                   frequency=1 u=0 v=0 time=60 to=0.6 count=60 exact=1";
    let lines = format!("{fields} {example}").replace(' ', "\n");
    serde_json::from_str(&answer(&lines)).unwrap()
}

fn words(answer: &Value) -> String {
    assert_eq!(answer["error"], Value::Null);
    let words = answer["words"].as_array().unwrap();
    words.iter().map(|text| text.as_str().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The series of a class: its points.
fn series(answer: &Value, class: &str) -> Vec<(f64, f64)> {
    let of_class = |series: &&Value| series["class"] == class;
    let all = answer["series"].as_array().unwrap().iter().filter(of_class);
    let list = |values: &Value| values.as_array().unwrap().clone();
    let points = all.flat_map(|series| std::iter::zip(list(&series["x"]), list(&series["y"])));
    points.map(|(x, y)| (x.as_f64().unwrap(), y.as_f64().unwrap_or(f64::NAN))).collect()
}

#[test]
fn the_papers_fifth_figure() {
    let motion = ask("kind=motion");
    let words = words(&motion);
    assert!(words.contains("stable stick-slip: amplitude 0.286209, period 6.79942"), "{words}");
    assert!(words.contains("unstable focus: u = 0.3148"), "{words}");
    // The second release, with all digits, and the cycle's extremes.
    let releases = series(&motion, "time release-event point");
    assert!((releases[1].0 - 9.007120276065).abs() < 1e-12);
    let u = series(&motion, "phase stable").into_iter().map(|point| point.0);
    let (low, high) = u.fold((0.0, 0.0), |(a, b): (f64, f64), u| (a.min(u), b.max(u)));
    assert!((0.5 * (high - low) - 0.286208719046).abs() < 1e-4);
    // It slides backward to −0.286: at sliding speeds up to 0.487.
    let fastest = series(&motion, "law visited").last().unwrap().0;
    assert!((0.48..0.49).contains(&fastest), "{fastest}");
}

#[test]
fn branches_end_at_the_bifurcations() {
    let diagram = ask("kind=diagram");
    let marks = series(&diagram, "diagram mark");
    assert!((marks[0].0 - 0.440958551844).abs() < 1e-12 && marks.len() == 2, "{marks:?}");
    let cycles = series(&diagram, "diagram stable").into_iter().filter(|point| point.1 > 0.0);
    let last = cycles.fold(0.0, |last: f64, point| last.max(point.0));
    assert!(last < marks[0].0 && last > marks[0].0 - 1e-6);
}

#[test]
fn two_fates_side_by_side() {
    let bistable = "law=exponential mu_s=0.6 mu_k=0.3 v_s=0.4 beta=0.01 v_b=1";
    assert!(words(&ask(&format!("kind=motion {bistable}"))).contains("settles to steady sliding"));
    let far = words(&ask(&format!("kind=motion u=1 {bistable}")));
    assert!(far.contains("settles to stable stick-slip: amplitude 1.19164"), "{far}");
    assert!(far.contains("There is also unstable pure slip: amplitude 0.311236"), "{far}");
    // The unstable cycle reaches from u = −0.01 to 0.61.
    let grid = "left=-1 right=1.8 low=-1 high=1 columns=7 rows=5";
    let basins = ask(&format!("kind=basins {grid} {bistable}"));
    assert_eq!(basins["cells"][2], "2200222");
}

#[test]
fn a_force_and_its_resonance_curve() {
    let forced = "mu_s=0.55 mu_k=0.3 v_s=0.7 beta=0.03 load=0.9 v_b=0.25 force=0.2 frequency=0.9";
    let motion = words(&ask(&format!("kind=motion {forced}")));
    let expected = "stable motion of period 2π/Ω: amplitude 0.455983, period 6.98132";
    assert!(motion.contains(expected), "{motion}");
    let curve = ask(&format!("kind=diagram over=frequency to=1 {forced}"));
    assert!(!series(&curve, "diagram mark").is_empty());
    assert!(series(&curve, "diagram unstable").iter().any(|point| point.1 > 0.4));
}

#[test]
fn si_units() {
    let brake = "law=stribeck mu_s=0.45 mu_k=0.35 v_s=0.125 exponent=1 viscous=0 beta=0.005 \
                 v_b=0.075 mass=4 spring=1e6 normal_load=800";
    let words = words(&ask(&format!("kind=motion {brake}")));
    // As the crate's README prints it.
    assert!(words.contains("amplitude 0.111962 mm, period 0.0150738 s, 66.3403 Hz"), "{words}");
    assert!(words.contains("belt 0.0300000 m/s, damper 20.0000 N·s/m"), "{words}");
}

#[test]
fn errors_in_the_words_of_the_crate() {
    for (fields, expected) in [
        ("beta=-1", "MassOnBelt: damping = -1 is not allowed"),
        ("beta=1,5", "beta = “1,5”: invalid float literal"),
        ("law=table points=0,0.4,0.1", "points: the last speed has no coefficient"),
        ("law=table points=0,0.4,0.1,x", "points, “x”"),
        ("law=coulomb mu_k=0.5", "Coulomb: kinetic_coefficient = 0.5 is not allowed"),
        ("time=inf", "duration"),
    ] {
        let error = ask(&format!("kind=motion {fields}"))["error"].to_string();
        assert!(error.contains(expected), "{fields}: {error}");
    }
}
