//! The README says what the crate does: its program is compiled and run, and its numbers are
//! compared.

use std::cell::RefCell;
use std::path::Path;

use serde_json::Value;
use stick_slip::{EventKind, MassOnBelt, Polynomial, limit_cycle};
use stick_slip_tests_common::root;

const README: &str = include_str!("../../README.md");
const PROGRAM: &str = include_str!("readme/program.rs");
const MANIFEST: &str = include_str!("../../Cargo.toml");

/// The program of the README, with `println!` writing to [`program::PRINTED`](PRINTED).
mod program {
    macro_rules! println {
        ($($argument:tt)*) => {{
            let line = format!($($argument)*) + "\n";
            super::PRINTED.with_borrow_mut(|text| text.push_str(&line));
        }};
    }
    include!("readme/program.rs");

    pub(super) fn run() {
        main().unwrap();
    }
}

thread_local! {
    static PRINTED: RefCell<String> = const { RefCell::new(String::new()) };
}

/// The first block of code with that language after `heading`.
fn block<'r>(heading: &str, language: &str) -> &'r str {
    let after = README.split_once(heading).unwrap().1;
    let fence = format!("```{language}\n");
    let block = after.split_once(&fence).unwrap().1;
    block.split_once("```").unwrap().0
}

/// Value of a key of the manifest, without its quotation marks.
fn manifest(key: &str) -> &'static str {
    let line = MANIFEST
        .lines()
        .find(|line| line.starts_with(&format!("{key} = ")));
    line.unwrap().split('"').nth(1).unwrap()
}

/// A first reader sees how to run it without turning a page.
#[test]
fn the_readme_is_short() {
    assert!(README.lines().count() <= 150);
    let place = |command: &str| README.lines().position(|line| line.starts_with(command));
    for command in [
        "cargo run -p quickstart --example quickstart",
        "cargo test --release",
    ] {
        assert!(place(command).is_some_and(|line| line < 60), "{command}");
    }
}

#[test]
fn program_is_compiled_here_and_short() {
    assert_eq!(block("# stick-slip", "rust"), PROGRAM);
    assert!(PROGRAM.lines().count() <= 25);
}

#[test]
fn program_prints_what_the_readme_says() {
    program::run();
    PRINTED.with_borrow(|printed| assert_eq!(block("It prints", "text"), printed));
}

#[test]
fn durations_are_the_ones_printed_and_accurate_to_4e15() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, 0.2)
        .unwrap()
        .with_damping(0.05)
        .unwrap();
    let motion = system
        .simulate(system.release_state().unwrap(), 7.0)
        .unwrap();
    let [_, stick, release] = motion.events() else {
        panic!("{:?}", motion.events());
    };
    assert_eq!(stick.kind, EventKind::Stick);
    let cycle = limit_cycle::stick_slip(&system).unwrap().unwrap();
    // 25 digits, rounded to f64 by the compiler.
    let (slips, sticks) = (5.169862999532133977881022, 1.629558444940023626973190);
    for (actual, expected, printed) in [
        (stick.time, slips, "5.169862999532134"),
        (release.time - stick.time, sticks, "1.629558444940024"),
        (
            cycle.period() - cycle.stick_duration(),
            slips,
            "5.169862999532134",
        ),
        (cycle.stick_duration(), sticks, "1.629558444940024"),
    ] {
        let error: f64 = actual - expected;
        assert!(error.abs() <= 4e-15, "{actual:e} is not {expected:e}");
        assert_eq!(
            printed.parse::<f64>().unwrap(),
            (expected * 1e15_f64).round() / 1e15
        );
        assert!(README.contains(printed), "{printed}");
    }
    assert!(README.contains("within 4e-15"));
}

/// That they are met within 1e-13 is asserted beside the data, in `tests/belt/reference.rs` and
/// `tests/structures`.
#[test]
fn reference_motions_are_counted() {
    let count = |text: &str| {
        let data: Value = text.parse().unwrap();
        data["cases"].as_array().unwrap().len()
    };
    let of_belts = count(include_str!("../data/trajectories.json"));
    let of_structures = [
        include_str!("../data/driven_trajectories.json"),
        include_str!("../data/structure_trajectories.json"),
        include_str!("../data/dwell_trajectories.json"),
        include_str!("../data/bristle_trajectories.json"),
        include_str!("../data/contact_trajectories.json"),
        include_str!("../data/joint_trajectories.json"),
        include_str!("../data/stiff_joint_trajectories.json"),
        include_str!("../data/force_trajectories.json"),
    ]
    .map(count)
    .iter()
    .sum::<usize>();
    let limits: Value = include_str!("../data/limits_trajectories.json")
        .parse()
        .unwrap();
    let limits = limits["cases"].as_array().unwrap().iter();
    // Not those with rigid stops.
    let is_read = |case: &&Value| case["system"].get("stops").is_none();
    let of_structures = of_structures + limits.filter(is_read).count();
    let text = format!("{of_belts} reference motions of a belt and {of_structures} of structures");
    assert!(README.contains(&text), "{text}");
    assert!(include_str!("../belt/reference.rs").contains("const ACCURACY: f64 = 1e-13;"));
    assert!(README.contains("1e-13·max(1, |value|)"));
}

#[test]
fn version_and_rust_version_are_those_of_the_manifest() {
    let version = manifest("version");
    assert!(README.contains(&format!("stick-slip {version}")));
    assert!(README.contains(&format!("Rust {} or later", manifest("rust-version"))));
    assert!(include_str!("../../CHANGELOG.md").contains(&format!("## [{version}]")));
}

#[test]
fn every_feature_is_described() {
    let features = MANIFEST.split_once("[features]\n").unwrap().1;
    let features = features.split("\n[").next().unwrap();
    let names = features.lines().filter_map(|line| line.split_once(" = "));
    for (name, _) in names.filter(|(name, _)| !name.starts_with('#') && *name != "default") {
        assert!(README.contains(&format!("| `{name}` |")), "{name}");
        assert!(
            include_str!("../../src/lib.rs").contains(&format!("//! * `{name}`: ")),
            "{name}"
        );
    }
}

/// Whether a page of the documentation, such as `/latest/stick_slip/limit_cycle/fn.find.html`, is
/// that of a public item of `src`. (The module of an item may not be the one that exports it.)
fn documents_an_item(page: &str) -> bool {
    let Some(page) = page.strip_prefix("/latest/stick_slip/") else {
        return page.is_empty();
    };
    let src = root().join("src");
    let (folder, file) = page.rsplit_once('/').unwrap_or(("", page));
    if file == "index.html" {
        let folder = src.join(folder);
        return folder.is_dir() || folder.with_extension("rs").exists();
    }
    let (file, method) = file.split_once("#method.").unwrap_or((file, ""));
    let item = file.strip_suffix(".html").unwrap().replace('.', " ");
    let method = (!method.is_empty()).then(|| format!("pub fn {method}"));
    [Some(format!("pub {item}")), method]
        .into_iter()
        .flatten()
        .all(|item| declares(&src, &item))
}

/// Whether a file in a folder declares an item, as in `pub struct Name`.
fn declares(folder: &Path, item: &str) -> bool {
    let ends = |c: char| c != '_' && !c.is_alphanumeric();
    std::fs::read_dir(folder).unwrap().any(|entry| {
        let path = entry.unwrap().path();
        if path.is_dir() {
            return declares(&path, item);
        }
        let text = std::fs::read_to_string(&path).unwrap();
        text.match_indices(item)
            .any(|(at, item)| text[at + item.len()..].starts_with(ends))
    })
}

#[test]
fn files_linked_to_exist_and_examples_are_listed() {
    let root = root();
    let inline = README
        .split("](")
        .skip(1)
        .map(|rest| rest.split(')').next().unwrap());
    let references = README
        .lines()
        .filter_map(|line| line.strip_prefix("[`")?.split_once("`]: "));
    let references = references.map(|(_, target)| target);
    for target in inline
        .chain(references)
        .filter(|target| !target.starts_with('#'))
    {
        match target.strip_prefix("https://docs.rs/stick-slip") {
            Some(page) => assert!(documents_an_item(page), "{target}"),
            None => assert!(root.join(target).exists(), "{target}"),
        }
    }
    let listed = include_str!("../../examples/README.md");
    for entry in std::fs::read_dir(root.join("examples")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".rs") {
            assert!(listed.contains(&format!("({name})")), "{name}");
        }
    }
}
