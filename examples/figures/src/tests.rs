//! The figures of README and documentation are those that the example draws today, number by
//! number.

use super::{FIGURES, Figure, beam, bolted_beam, escape};

/// Largest difference of two numbers.
const TOLERANCE: f64 = 1e-6;

fn drawn(name: &str) -> Figure {
    let (_, draw) = FIGURES.iter().find(|figure| figure.0 == name).unwrap();
    draw().unwrap()
}

/// The text between the numbers, signs included, and the numbers: digits with a point or without.
fn split(svg: &str) -> (Vec<&str>, Vec<f64>) {
    let (mut texts, mut numbers) = (Vec::new(), Vec::new());
    let mut rest = svg;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let end = rest[start..]
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .map_or(rest.len(), |length| start + length);
        let end = start + rest[start..end].trim_end_matches('.').len();
        texts.push(&rest[..start]);
        numbers.push(rest[start..end].parse().unwrap());
        rest = &rest[end..];
    }
    texts.push(rest);
    (texts, numbers)
}

/// Where two figures differ first.
fn difference(expected: &str, actual: &str) -> Option<String> {
    let (texts, numbers) = split(expected);
    let (new_texts, new_numbers) = split(actual);
    for (i, (text, new)) in texts.iter().zip(&new_texts).enumerate() {
        if text != new {
            return Some(format!("text {i}: {text:?} is now {new:?}"));
        }
    }
    for (i, (number, new)) in numbers.iter().zip(&new_numbers).enumerate() {
        if (number - new).abs() > TOLERANCE {
            return Some(format!(
                "number {i}, after {:?}: {number} is now {new}",
                texts[i]
            ));
        }
    }
    let counts = (numbers.len(), new_numbers.len());
    (counts.0 != counts.1).then(|| format!("{} numbers are now {}", counts.0, counts.1))
}

fn is_reproduced(name: &str, committed: &str) {
    let figure = drawn(name);
    if let Some(difference) = difference(committed, &figure.svg) {
        panic!("the kept figure {name} is not what the example draws: {difference}");
    }
    assert!(committed.contains(&escape(&figure.caption)));
    assert!(committed.len() < 100_000);
    assert!(split(committed).1.len() > 1000);
}

const AMPLITUDE: &str = include_str!("../fig6_amplitude.svg");
const REGIMES: &str = include_str!("../../../src/figures/regimes.svg");

#[test]
fn amplitude_is_reproduced() {
    is_reproduced("fig6_amplitude", AMPLITUDE);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn figures_of_the_documentation_are_reproduced() {
    is_reproduced("regimes", REGIMES);
    for (name, kept) in [
        (
            "bistability",
            include_str!("../../../src/figures/bistability.svg"),
        ),
        ("errors", include_str!("../../../src/figures/errors.svg")),
        ("fault", include_str!("../../../src/figures/fault.svg")),
        (
            "mode_coupling",
            include_str!("../../../src/figures/mode_coupling.svg"),
        ),
        (
            "resonance",
            include_str!("../../../src/figures/resonance.svg"),
        ),
    ] {
        is_reproduced(name, kept);
        // A blank line would end the picture in a page of the documentation.
        assert!(!kept.contains("\n\n"));
    }
}

/// The borders in the caption, from 25-digit computations.
#[test]
fn caption_has_the_exact_borders() {
    for border in ["0.395790289", "0.394405319", "0.440958552"] {
        assert!(AMPLITUDE.contains(border), "{border}");
    }
}

/// Steps of each curve of the beam that are computed again; the example computes one curve whole.
const SHOWN: usize = 6;

/// The kept curves of the beam are those that the example computes today: the beginning of each.
#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn curves_of_the_beam_are_reproduced() {
    for (force, kept) in bolted_beam::FORCES
        .into_iter()
        .zip(&beam::curves().unwrap())
    {
        let today = bolted_beam::resonance(force, bolted_beam::WHOLE, SHOWN).unwrap();
        let today: Vec<_> = bolted_beam::points(&today).collect();
        assert_eq!(today.len(), SHOWN + 1);
        for (old, new) in kept.iter().rev().zip(today.into_iter().rev()) {
            for (old, new) in [(old.0, new.0), (old.1, new.1)] {
                assert!(
                    (new / old - 1.0).abs() < TOLERANCE,
                    "{force} N: {old}, now {new}"
                );
            }
        }
        // Wide folds at the largest force.
        let folds = beam::between_folds(kept);
        assert!(force < 4.0 || folds.is_some_and(|(low, high)| high - low > 3.0));
    }
    // Its lines have few points.
    assert!(points_in_the_picture(&drawn("bolted_beam").svg) > 200);
}

/// The number of points of the lines, all of which lie in the picture.
fn points_in_the_picture(svg: &str) -> usize {
    let size = svg
        .split_once("viewBox=\"")
        .unwrap()
        .1
        .split('"')
        .next()
        .unwrap();
    let (_, size) = split(size);
    let mut points = 0;
    for list in svg.split(" points=\"").skip(1) {
        let list = list.split('"').next().unwrap();
        for point in list.split_whitespace() {
            let (x, y) = point.split_once(',').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!(
                (0.0..=size[2]).contains(&x) && (0.0..=size[3]).contains(&y),
                "{point}"
            );
            points += 1;
        }
    }
    points
}

#[test]
fn every_coordinate_lies_in_the_picture() {
    let others = ["chain", "mode_coupling", "joint"].map(|name| drawn(name).svg);
    for svg in [AMPLITUDE, REGIMES, &others[0], &others[1], &others[2]] {
        assert!(points_in_the_picture(svg) > 500);
    }
}

#[test]
fn a_change_is_noticed() {
    let svg = "<text x=\"10\">0.395790289 − 1.</text>";
    assert_eq!(split(svg).1, [10.0, 0.395790289, 1.0]);
    assert_eq!(difference(svg, svg), None);
    assert_eq!(difference(svg, &svg.replace("0289", "0290")), None);
    let tampered = AMPLITUDE.replacen("0.395790289", "0.395792289", 1);
    assert!(difference(AMPLITUDE, &tampered).is_some());
    for (from, to) in [
        ("0289", "2289"),
        ("10", "11"),
        (" − 1", " − 1 2"),
        ("−", "+"),
        ("0.39", "−0.39"),
        ("text", "tspan"),
        ("</text>", ""),
        (" − 1.", ""),
    ] {
        assert!(
            difference(svg, &svg.replace(from, to)).is_some(),
            "{from} to {to}"
        );
    }
}
