//! The source keeps its own order: no module knows one above it, no file knows one that knows it,
//! imports inside the crate name the module that owns a thing, and no line is too long to be read
//! beside another.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use stick_slip_tests_common::root;

/// The modules of the crate, from the ground up. One may use those of lower floors; those that
/// share a floor know nothing of each other.
const FLOORS: [&[&str]; 13] = [
    &["state", "clock"],
    &["error"],
    &["scalar"],
    &["series", "numerics"],
    &["drive"],
    &["friction"],
    &["force"],
    &["motion"],
    &["belt", "search"],
    // Made from a belt, too.
    &["structure"],
    &["limit_cycle", "orbit", "analysis", "scaling"],
    &["bifurcation", "schema"],
    &["physical", "guarantees"],
];

/// Columns that a line may have; words that are addresses and rows of tables are not counted.
const COLUMNS: usize = 100;

/// All files below a folder, but for what Cargo and Git put there.
fn files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if !path.is_dir() {
            into.push(path);
        } else if !["target", ".git"].contains(&name) && !name.starts_with("mutants.out") {
            files(&path, into);
        }
    }
}

fn files_of(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(&root().join(folder), &mut found);
    found.sort();
    assert!(!found.is_empty());
    found
}

/// The code without comments, line by line, and the modules that it declares for tests alone.
/// Items behind `#[cfg(test)]` are left out: tests may look up.
fn code(text: &str) -> (String, Vec<&str>) {
    let (mut kept, mut for_tests) = (String::new(), Vec::new());
    let mut lines = text.lines().map(|line| line.split("//").next().unwrap());
    while let Some(line) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept.push_str(line);
            kept.push('\n');
            continue;
        }
        let mut depth = 0;
        for line in lines.by_ref() {
            if let Some((_, declared)) = line.split_once("mod ") {
                for_tests.extend(declared.strip_suffix(';'));
            }
            depth += line.matches('{').count();
            depth -= line.matches('}').count();
            if depth == 0 && line.trim_end().ends_with([';', '}']) {
                break;
            }
        }
    }
    (kept, for_tests)
}

/// What follows each `crate::` in some code: the names of a group in braces, or the one name.
fn used(code: &str) -> Vec<&str> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let first = |path: &'_ str| path.find(|c| !is_name(c)).unwrap_or(path.len());
    let mut names = Vec::new();
    for (at, prefix) in code.match_indices("crate::") {
        if code[..at].ends_with(|c| is_name(c) || c == '$') {
            continue;
        }
        let path = &code[at + prefix.len()..];
        let Some(group) = path.strip_prefix('{') else {
            names.push(&path[..first(path)]);
            continue;
        };
        let mut depth = 0;
        let mut starts = true;
        for (i, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => starts = true,
                c if starts && is_name(c) => {
                    names.push(&group[i..i + first(&group[i..])]);
                    starts = false;
                }
                _ => {}
            }
        }
    }
    names
}

/// The module at the crate's root that a path through `super` leads to, for a file that lies
/// `depth` modules deep.
fn above_root(code: &str, depth: usize) -> Vec<&str> {
    let up = "super::".repeat(depth);
    let deeper = format!("super::{up}");
    code.match_indices(&up)
        .filter(|&(at, _)| !code[..at].ends_with("super::") && !code[at..].starts_with(&deeper))
        .map(|(at, up)| code[at + up.len()..].split(|c: char| c != '_' && !c.is_alphanumeric()))
        .filter_map(|mut names| names.next())
        .filter(|name| floor(name).is_some())
        .collect()
}

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&module))
}

/// The files of `src` that are compiled for users: module path below `src`, and code.
fn modules() -> Vec<(String, String)> {
    let src = root().join("src");
    let mut left_out = BTreeSet::new();
    let mut all = Vec::new();
    for path in files_of("src") {
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(&src).unwrap().with_extension("");
        let name = name.to_str().unwrap().replace('\\', "/");
        let name = name.strip_suffix("/mod").unwrap_or(&name);
        let (code, for_tests) = code(&text);
        left_out.extend(for_tests.iter().map(|inner| format!("{name}/{inner}")));
        all.push((name.to_owned(), code));
    }
    let is_left_out = |name: &str| {
        let ends = name.match_indices('/').map(|(at, _)| at);
        ends.chain([name.len()])
            .any(|end| left_out.contains(&name[..end]))
    };
    all.retain(|(name, _)| name != "lib" && !is_left_out(name));
    all
}

#[test]
fn no_module_knows_one_above_it() {
    let mut arrows = BTreeSet::new();
    for (name, code) in modules() {
        let from = name.split('/').next().unwrap();
        let own = floor(from).unwrap_or_else(|| panic!("{from}: on which of FLOORS is it?"));
        let depth = name.split('/').count();
        for to in used(&code).into_iter().chain(above_root(&code, depth)) {
            if let Some(other) = floor(to) {
                assert!(other < own || to == from, "src/{name} looks up to {to}");
                arrows.insert((from.to_owned(), to.to_owned()));
            }
        }
    }
    // The files were found and read.
    for (from, to) in [("belt", "friction"), ("bifurcation", "limit_cycle")] {
        assert!(arrows.contains(&(from.to_owned(), to.to_owned())));
    }
}

/// The one circle that is wanted: each law of the crate tells which `AnyLaw` it is.
const ANY_OF_ALL: &str = "friction/any";

/// The single paths of a path with groups: `a::{b, c::{self, D}}` are three.
fn single(path: &str) -> Vec<String> {
    let Some((before, group)) = path.split_once('{') else {
        let path = path.split(" as ").next().unwrap().trim();
        return vec![path.strip_suffix("::self").unwrap_or(path).to_owned()];
    };
    let inner = &group[..group.rfind('}').unwrap()];
    let mut depth = 0;
    let parts = inner.split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    let parts = parts.map(str::trim).filter(|part| !part.is_empty());
    let before = before.trim_start();
    parts
        .flat_map(|part| single(&format!("{before}{part}")))
        .collect()
}

/// The paths that some code imports or names, and those that it re-exports. Texts are left out,
/// such as the name of a written form in an attribute of `serde`.
fn paths(code: &str) -> (Vec<String>, Vec<String>) {
    let without_texts = |line| {
        str::split(line, '"')
            .step_by(2)
            .collect::<Vec<_>>()
            .join("\"\"")
    };
    let code: Vec<String> = code.lines().map(without_texts).collect();
    let is_of_path = |c: char| c.is_alphanumeric() || "_:".contains(c);
    let (mut known, mut passed_on) = (Vec::new(), Vec::new());
    for statement in code.join("\n").split(';') {
        let mut rest = statement;
        let imports = statement.rmatch_indices("use ");
        let mut imports = imports.filter(|&(at, _)| !statement[..at].ends_with(is_of_path));
        if let Some((at, prefix)) = imports.next() {
            let before = statement[..at].lines().next_back().unwrap_or_default();
            let into = match before.trim_start().starts_with("pub") {
                true => &mut passed_on,
                false => &mut known,
            };
            into.extend(single(&statement[at + prefix.len()..]));
            rest = &statement[..at];
        }
        let words = rest.split(|c| !is_of_path(c));
        let words = words.map(|word| word.trim_matches(':'));
        known.extend(words.filter(|word| word.contains("::")).map(str::to_owned));
    }
    (known, passed_on)
}

/// The arrows from each file to those that it knows. A name that a folder re-exports is that of
/// the file which owns it, and a folder's `mod.rs` does not know what it only re-exports.
fn arrows(modules: &[(String, String)]) -> BTreeMap<&str, BTreeSet<&str>> {
    let paths: BTreeMap<&str, _> = modules
        .iter()
        .map(|(name, code)| (&name[..], paths(code)))
        .collect();
    let module = |name: &str| paths.get_key_value(name).map(|(&name, _)| name);
    let below = |at: &str, name: &str| match at {
        "" => name.to_owned(),
        at => format!("{at}/{name}"),
    };
    let owner = |from: &str, path: &str| {
        let (mut at, mut path) = (from.to_owned(), path.to_owned());
        // A name may be passed on by several folders.
        for _ in 0..8 {
            let is_of_crate = path.starts_with("crate::");
            let mut names = path.split("::").peekable();
            let starts_above =
                names.next_if(|&name| name == "self").is_some() || path.starts_with("super::");
            if is_of_crate {
                names.next();
                at.clear();
            }
            while names.next_if(|&name| name == "super").is_some() {
                at.truncate(at.rfind('/').unwrap_or(0));
            }
            let mut is_module = is_of_crate || starts_above;
            while let Some(inner) = names.peek().and_then(|name| module(&below(&at, name))) {
                at = inner.to_owned();
                is_module = true;
                names.next();
            }
            let at_module = module(&at).filter(|_| is_module)?;
            let Some(name) = names.next() else {
                return Some(at_module);
            };
            let ends = format!("::{name}");
            let passed_on = &paths[at_module].1;
            let Some(next) = passed_on.iter().find(|path| path.ends_with(&ends)) else {
                return Some(at_module);
            };
            path = next.clone();
        }
        None
    };
    let known = modules.iter().map(|(name, _)| {
        let known = paths[&name[..]].0.iter();
        let known = known.filter_map(|path| owner(name, path));
        (&name[..], known.filter(|other| other != name).collect())
    });
    known.collect()
}

/// The files in circles, and what each knows of its own circle.
fn circles<'m>(
    arrows: &BTreeMap<&'m str, BTreeSet<&'m str>>,
) -> BTreeMap<&'m str, BTreeSet<&'m str>> {
    let leads_to = |from: &'m str, to: &str| {
        let (mut seen, mut next) = (BTreeSet::from([from]), vec![from]);
        while let Some(name) = next.pop() {
            if name == to {
                return true;
            }
            let others = arrows.get(name).into_iter().flatten();
            next.extend(others.filter(|&&other| seen.insert(other)));
        }
        false
    };
    let in_circles = arrows.iter().map(|(&name, others)| {
        let others = others.iter().filter(|&&other| leads_to(other, name));
        (name, others.copied().collect::<BTreeSet<_>>())
    });
    in_circles
        .filter(|(_, others)| !others.is_empty())
        .collect()
}

/// No file knows one that knows it, directly or through others.
#[test]
fn no_file_knows_one_that_knows_it() {
    let modules = modules();
    let mut arrows = arrows(&modules);
    assert!(arrows["orbit/pseudo_arclength"].contains("orbit/branch_equations"));
    assert!(arrows.values().map(BTreeSet::len).sum::<usize>() > 800);
    let wanted = arrows.remove(ANY_OF_ALL);
    assert!(wanted.is_some_and(|laws| laws.contains("friction/coulomb")));
    let found = circles(&arrows);
    assert!(found.is_empty(), "circles of files: {found:#?}");
}

#[test]
fn imports_name_the_module() {
    for (name, code) in modules() {
        for module in used(&code) {
            assert!(
                floor(module).is_some(),
                "src/{name}: crate::{module} is no module; name the one that owns it"
            );
        }
    }
}

#[test]
fn no_line_is_too_long() {
    let mut too_long = Vec::new();
    for path in files_of("") {
        let name = path.strip_prefix(root()).unwrap();
        let is_script =
            name.extension().is_none() && (name.ends_with("run") || name.ends_with("full"));
        let is_written = name
            .extension()
            .is_some_and(|extension| ["rs", "md", "toml"].iter().any(|e| extension == *e));
        if !is_script && !is_written {
            continue;
        }
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let text = line
                .trim_start()
                .trim_start_matches(['/', '!'])
                .trim_start();
            let words = line.split(' ').filter(|word| !word.contains("://"));
            let columns: usize = words.map(|word| word.chars().count() + 1).sum();
            if columns > COLUMNS + 1 && !text.starts_with('|') {
                too_long.push(format!("{}:{}", name.display(), number + 1));
            }
        }
    }
    assert!(too_long.is_empty(), "over {COLUMNS} columns: {too_long:#?}");
}

/// The lines of a manifest that say what the crate depends on, and which features it has.
fn needs(manifest: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(manifest)).unwrap();
    let sections = text.split("\n[").skip(1);
    let sections = sections.filter(|section| {
        let name = section.split_once(']').unwrap().0;
        name == "features" || name.starts_with("dependencies") || name.starts_with("target")
    });
    let lines = sections.flat_map(str::lines);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(str::to_owned).collect()
}

/// The unit tests are the source of the crate in a package of its own.
#[test]
fn unit_tests_have_the_dependencies_and_features_of_the_crate() {
    let of_crate = needs("Cargo.toml");
    assert!(of_crate.len() > 5, "{of_crate:?}");
    assert_eq!(of_crate, needs("tests/unit/Cargo.toml"));
}

/// The programs of tests.
const PROGRAMS: [&str; 6] = [
    "analysis",
    "belt",
    "contract",
    "cycles",
    "orbit",
    "structures",
];

/// Each promise, an item with a bold head or a row about a search, names a test that holds it.
#[test]
fn each_promise_names_a_test() {
    let page = fs::read_to_string(root().join("src/guarantees.rs")).unwrap();
    let mut promises: Vec<String> = Vec::new();
    for line in page.lines().filter_map(|line| line.strip_prefix("//!")) {
        let text = line.trim();
        let (head, rest) = text.split_once(' ').unwrap_or((text, ""));
        let is_item = head == "*" || head.trim_end_matches('.').parse::<u32>().is_ok();
        let is_row = text.starts_with("| [`") || text.starts_with("| functions");
        if (is_item && rest.starts_with("**")) || is_row || text.starts_with("**") {
            promises.push(text.to_owned());
        } else if text.is_empty() || text.starts_with('#') || is_item {
            promises.push(String::new());
        } else if let Some(last) = promises.last_mut().filter(|last| !last.is_empty()) {
            last.push_str(text);
        }
    }
    promises.retain(|promise| !promise.is_empty());
    assert!(promises.len() > 25, "{promises:#?}");
    for promise in promises {
        let names = PROGRAMS.map(|program| format!("`{program}::"));
        let is_held = names.iter().any(|name| promise.contains(name));
        assert!(is_held, "no test: {promise}");
    }
}

/// The pages that name tests and files.
#[test]
fn pages_name_what_exists() {
    let (mut tests, mut paths) = (0, 0);
    for page in ["ARCHITECTURE.md", "CONTRIBUTING.md", "src/guarantees.rs"] {
        let text = fs::read_to_string(root().join(page)).unwrap();
        for name in text.split('`').skip(1).step_by(2) {
            if let [program, module, test] = name.split("::").collect::<Vec<_>>()[..]
                && PROGRAMS.contains(&program)
            {
                let file = root().join(format!("tests/{program}/{module}.rs"));
                let code = fs::read_to_string(&file)
                    .unwrap_or_else(|_| panic!("{page}: {name} has no file"));
                let is_test = code.contains(&format!("fn {test}()"));
                assert!(is_test, "{page}: no test {name}");
                tests += 1;
            }
            if (name.starts_with("src/") || name.starts_with("tests/")) && !name.contains('<') {
                assert!(root().join(name).exists(), "{page}: no file {name}");
                paths += 1;
            }
        }
    }
    assert!(tests > 40 && paths > 60, "{tests} tests, {paths} paths");
}

/// Names and the file that a page places them in: `a` and `b` in `src/c.rs`, or `a` (`src/c.rs`).
fn placed(page: &str) -> Vec<(&str, &str)> {
    let parts: Vec<&str> = page.split('`').collect();
    let mut found = Vec::new();
    for at in (1..parts.len()).step_by(2) {
        let file = parts[at];
        if !file.ends_with(".rs") || file.contains('<') {
            continue;
        }
        let mut from = at;
        while from > 2 && [" in ", " and ", ", ", " ("].contains(&parts[from - 1]) {
            from -= 2;
            if parts[from].contains(['/', '.', ' ']) {
                break;
            }
            found.push((parts[from], file));
        }
    }
    found
}

#[test]
fn places_hold_what_they_decide() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    // A line of text may break between a name and its file.
    let page = page.replace("\n   ", "").replace('\n', " ");
    let placed = placed(&page);
    assert!(placed.len() > 40, "{placed:#?}");
    for (name, file) in placed {
        let code = fs::read_to_string(root().join(file)).unwrap();
        let last = name.rsplit("::").next().unwrap();
        assert!(code.contains(last), "ARCHITECTURE.md: no {name} in {file}");
    }
}

#[test]
fn the_guards_see_what_they_shall() {
    let page = "`f` and `B::g` in `src/a.rs`; `h` (`src/b.rs`), of `x` as `src/c.rs`; `src/d.rs`";
    let expected = [("B::g", "src/a.rs"), ("f", "src/a.rs"), ("h", "src/b.rs")];
    assert_eq!(placed(page), expected);

    let text = "use crate::{state::State, motion::{Event, Mode}, error};\n\
                use crate::MassOnBelt; // crate::nothing\n\
                let a = crate::belt::f(super::super::scaling::g());\n\
                #[cfg(test)]\nuse crate::bifurcation::{\n    A, B,\n};\n\
                #[cfg(test)]\nmod tests;\n\
                #[cfg(test)]\nmod more {\n    fn f() {}\n    use crate::analysis::C;\n}\n\
                use crate::series::D;\n";
    let (code, for_tests) = code(text);
    assert_eq!(for_tests, ["tests"]);
    assert_eq!(
        used(&code),
        ["state", "motion", "error", "MassOnBelt", "belt", "series"]
    );
    assert_eq!(above_root(&code, 2), ["scaling"]);
    assert_eq!(above_root(&code, 1), [""; 0]);
    assert!(floor("state") < floor("belt") && floor("belt") < floor("bifurcation"));
}

#[test]
fn the_guard_sees_circles() {
    assert_eq!(
        single("super::{a, b::{self, C as D}, E}"),
        ["super::a", "super::b", "super::b::C", "super::E"]
    );
    let found = |files: &[(&str, &str)]| -> Vec<String> {
        let owned = files
            .iter()
            .map(|&(name, code)| (name.to_owned(), code.to_owned()));
        let files: Vec<_> = owned.collect();
        circles(&arrows(&files))
            .into_keys()
            .map(str::to_owned)
            .collect()
    };
    let nothing = [""; 0];
    let folder = ("a", "mod b;\nmod c;\npub(crate) use b::B;\npub struct A;");
    let b = (
        "a/b",
        "use crate::{d, a::c::{self, C}};\nuse super::A;\nfn f() {}",
    );
    // Through the name that the folder re-exports; by its module; in an expression.
    let closing = [
        "use super::B;",
        "pub struct C;\nuse crate::a::b;",
        "fn g() { super::b::f(); }",
    ];
    for code in closing {
        assert_eq!(
            found(&[folder, b, ("a/c", code), ("d", "")]),
            ["a/b", "a/c"],
            "{code}"
        );
    }
    assert_eq!(
        found(&[folder, b, ("a/c", "use super::A;"), ("d", "")]),
        nothing
    );
    assert_eq!(
        found(&[folder, b, ("a/c", "#[s(\"super::b::B\")]"), ("d", "")]),
        nothing
    );
    // A folder that itself knows a file which knows it; a circle of three.
    let knowing = ("a", "use c::C;\nstruct A;");
    assert_eq!(found(&[knowing, ("a/c", "use super::A;")]), ["a", "a/c"]);
    let [x, y] = [("x", "use crate::y::Y;"), ("y", "use crate::z::Z;")];
    let bridge = ("w", "use crate::x::X;");
    assert_eq!(
        found(&[bridge, x, y, ("z", "use crate::x::X;")]),
        ["x", "y", "z"]
    );
    assert_eq!(found(&[x, y, ("z", "")]), nothing);
}
