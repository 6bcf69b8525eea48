//! Promise: the workspace keeps the rules it is built by: dependencies point one way, unsafe code
//! is in a listed place only, files stay small, nothing is left to do or skipped, and every path
//! that the documents name exists.
//!
//! Why: rules that no one checks are broken by the third change. Each test fails with the file and
//! line that breaks its rule.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what is not as the rule needs it is a failed test")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What may have unsafe code, from the root: records and their rows, the vector code, and the call
/// by which the window gets at the graphics card.
const UNSAFE_ALLOWED: [&str; 8] = [
    "crates/tumble/src/simd/intrinsics.rs",
    "crates/tumble/src/simd/record.rs",
    "crates/tumble/src/simd/row_blocks.rs",
    "crates/tumble/src/simd/rows.rs",
    "crates/tumble/src/simd/x86_64/mod.rs",
    "crates/tumble/src/simd/x86_64/blocks.rs",
    "crates/tumble/src/simd/x86_64/wide.rs",
    "crates/tumble-view/src/gpu/context.rs",
];
/// Lines of a source, test or document.
const MAX_LINES: usize = 500;
/// Columns of a comment.
const MAX_COMMENT: usize = 100;
/// Folders and files of a crate's root, from the ground up: each imports only from those before it.
const ORDERS: [(&str, &str); 6] = [
    (
        "crates/tumble/src",
        "scope event_log math lane range rotation integrator joint_solver settings clock threads components simd \
         integrators storage forces joints collision body queries solver step energy snapshot batch \
         debug_draw lib",
    ),
    (
        "crates/tumble-import/src",
        "terminal error limits checked combine_rule read_file named_files bodies tessellation \
         inertia_repair gltf mesh_file urdf lib",
    ),
    (
        "crates/tumble-scene/src",
        "error limits alike written values bodies model convert builtin scene audit fields lib",
    ),
    (
        "crates/tumble-record/src",
        "svg csv_cell colors pending_file ground_patches momentum_scale energy_scale kept summary drift \
         plot energy_plots body_drawing trajectory report_page lib",
    ),
    (
        "crates/tumble-sweep/src",
        "distribution_error distribution parameter observation shard run_status error sweep_plan sweep series row \
         identity file_error reader sweep_file series_file merge_error merge lib",
    ),
    (
        "crates/tumble-vehicle/src",
        "precision error settings state slip_curve drive_torque rigid vehicle probe light_bodies \
         wheel_step solve drive_vehicles plan jointed lib",
    ),
];
/// Words that mean something here only.
const DIALECT: [&str; 11] = [
    "so many",
    "so often",
    "so much",
    "looked at",
    "anew",
    "is told",
    "are told",
    "without end",
    "in turns",
    "by chance",
    "what touches",
];

/// What a crate may depend on: other members of the workspace and, where it is to stay small,
/// crates from outside.
struct Rule {
    member: &'static str,
    members: &'static [&'static str],
    outside: Option<&'static [&'static str]>,
}

/// The workspace from the bottom up. The engine and those above it add a mathematics crate.
const RULES: [Rule; 18] = [
    Rule { member: "crates/tumble-math", members: &[], outside: Some(&["glam", "libm", "serde", "thiserror"]) },
    Rule { member: "crates/tumble-collide", members: &["tumble-math"], outside: Some(&["thiserror"]) },
    Rule {
        member: "crates/tumble",
        members: &["tumble-collide", "tumble-math"],
        outside: Some(&["glam", "hecs", "libm", "profiling", "rayon", "serde", "thiserror", "tracing"]),
    },
    Rule { member: "crates/tumble-character", members: &["tumble"], outside: None },
    Rule { member: "crates/tumble-import", members: &["tumble", "tumble-math"], outside: None },
    Rule { member: "crates/tumble-vehicle", members: &["tumble"], outside: Some(&["libm", "thiserror"]) },
    Rule { member: "crates/tumble-scene", members: &["tumble", "tumble-import", "tumble-math"], outside: None },
    Rule { member: "crates/tumble-record", members: &["tumble", "tumble-import", "tumble-scene"], outside: None },
    Rule {
        member: "crates/tumble-sweep",
        members: &["tumble", "tumble-import", "tumble-math", "tumble-record", "tumble-scene"],
        outside: Some(&["csv", "libm", "serde", "serde_json", "thiserror"]),
    },
    Rule {
        member: "crates/tumble-cli",
        members: &["tumble", "tumble-import", "tumble-record", "tumble-scene", "tumble-sweep"],
        outside: None,
    },
    Rule { member: "examples/first-window", members: &["tumble"], outside: None },
    Rule {
        member: "crates/tumble-view",
        members: &["tumble", "tumble-import", "tumble-record", "tumble-scene"],
        outside: Some(&["clap", "gif", "hecs", "macroquad", "png", "thiserror"]),
    },
    Rule {
        member: "benches",
        members: &["tumble", "tumble-character", "tumble-collide", "tumble-math", "tumble-scene"],
        outside: None,
    },
    Rule { member: "examples/docking", members: &["tumble"], outside: Some(&["hecs", "macroquad"]) },
    Rule { member: "examples/turret", members: &["tumble"], outside: Some(&["hecs", "macroquad"]) },
    Rule {
        member: "examples/yard",
        members: &["tumble", "tumble-character", "tumble-import", "tumble-vehicle"],
        outside: None,
    },
    Rule {
        member: "tests",
        members: &[
            "tumble",
            "tumble-benches",
            "tumble-character",
            "tumble-import",
            "tumble-math",
            "tumble-record",
            "tumble-scene",
            "tumble-sweep",
            "tumble-vehicle",
        ],
        outside: None,
    },
    Rule {
        member: "tests/determinism",
        members: &["tumble", "tumble-benches", "tumble-record", "tumble-scene", "tumble-tests"],
        outside: None,
    },
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// All files of the workspace with one of the endings, but for what is built or hidden.
fn files(endings: &[&str]) -> Vec<PathBuf> {
    fn visit(directory: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if path.is_dir() && name != "target" && name != "node_modules" && !name.starts_with('.') {
                visit(&path, endings, found);
            } else if path.extension().is_some_and(|ending| endings.iter().any(|e| ending == *e)) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    visit(&root(), endings, &mut found);
    found.sort();
    assert!(!found.is_empty(), "the search itself is broken");
    found
}

fn from_root(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/")
}

fn manifest(member: &str) -> toml::Table {
    std::fs::read_to_string(root().join(member).join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Names of the packages under a key such as `dependencies`, for every platform.
fn dependencies(manifest: &toml::Table, key: &str) -> BTreeSet<String> {
    let mut tables = vec![manifest];
    if let Some(targets) = manifest.get("target").and_then(toml::Value::as_table) {
        tables.extend(targets.values().filter_map(toml::Value::as_table));
    }
    let lists = tables.into_iter().filter_map(|table| table.get(key)?.as_table());
    // A renamed dependency counts under its package's name.
    lists
        .flatten()
        .map(|(name, value)| value.get("package").and_then(toml::Value::as_str).unwrap_or(name).to_owned())
        .collect()
}

/// Every member has a rule, and what it depends on, for building and running, is in it. Tests of a
/// crate may use more from outside, but nothing above the crate.
#[test]
fn dependencies_point_one_way() {
    let directories = ["crates", "examples"].map(|directory| std::fs::read_dir(root().join(directory)).unwrap());
    let entries = directories.into_iter().flatten().map(|entry| from_root(&entry.unwrap().path()));
    let mut members: BTreeSet<String> = entries.filter(|path| root().join(path).is_dir()).collect();
    members.extend(["tests", "tests/determinism", "benches"].map(String::from));
    assert_eq!(members, RULES.iter().map(|rule| rule.member.to_owned()).collect(), "each member needs a rule here");

    let names: BTreeSet<String> =
        RULES.iter().map(|rule| manifest(rule.member)["package"]["name"].as_str().unwrap().to_owned()).collect();
    for rule in &RULES {
        let manifest = manifest(rule.member);
        for key in ["dependencies", "build-dependencies", "dev-dependencies"] {
            for dependency in dependencies(&manifest, key) {
                let inside = names.contains(&dependency);
                let allowed = match rule.outside {
                    _ if inside => rule.members.contains(&dependency.as_str()),
                    Some(outside) if key != "dev-dependencies" => outside.contains(&dependency.as_str()),
                    _ => true,
                };
                assert!(allowed, "{}/Cargo.toml: {dependency} is not to be among the {key}", rule.member);
            }
        }
    }
}

/// Code with comments and the contents of strings taken out, so that words in them do not count.
fn code(text: &str) -> String {
    let mut result = String::new();
    for line in text.lines() {
        let mut inside_string = false;
        let mut previous = ' ';
        for (i, c) in line.char_indices() {
            if !inside_string && line[i..].starts_with("//") {
                break;
            }
            if c == '"' && previous != '\\' && previous != '\'' {
                inside_string = !inside_string;
            } else if !inside_string {
                result.push(c);
            }
            previous = c;
        }
        result.push('\n');
    }
    result
}

/// Lines in the Rust files where the word stands in code, as `file:line`.
fn lines_with(word: &str) -> Vec<String> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    for path in files(&["rs"]) {
        for (number, line) in code(&std::fs::read_to_string(&path).unwrap()).lines().enumerate() {
            let stands = line
                .match_indices(word)
                .any(|(i, _)| !line[..i].ends_with(is_part) && !line[i + word.len()..].starts_with(is_part));
            if stands {
                found.push(format!("{}:{}", from_root(&path), number + 1));
            }
        }
    }
    found
}

#[test]
fn unsafe_code_is_where_it_is_allowed() {
    let all = lines_with("unsafe");
    let is_in = |place: &String, allowed: &str| place.starts_with(allowed);
    let found: Vec<_> =
        all.iter().filter(|place| !UNSAFE_ALLOWED.iter().any(|allowed| is_in(place, allowed))).collect();
    assert!(found.is_empty(), "unsafe code in {found:?}");
    for allowed in UNSAFE_ALLOWED {
        assert!(all.iter().any(|place| is_in(place, allowed)), "no unsafe code in {allowed}: the rule is out of date");
    }
}

/// A fused multiply-add gives other bits where the processor has it.
#[test]
fn nothing_is_fused() {
    for word in ["mul_add", "fma", "fmaf"] {
        assert_eq!(lines_with(word), Vec::<String>::new(), "{word}");
    }
}

#[test]
fn nothing_is_left_to_do_or_skipped() {
    for word in ["todo!", "unimplemented!", "dbg!", "#[ignore"] {
        let found: Vec<String> = files(&["rs"])
            .into_iter()
            .filter(|path| code(&std::fs::read_to_string(path).unwrap()).contains(word))
            .map(|path| from_root(&path))
            .collect();
        assert!(found.is_empty(), "{word} in {found:?}");
    }
}

#[test]
fn files_stay_small() {
    for path in files(&["rs", "toml", "md"]) {
        let (lines, place) = (std::fs::read_to_string(&path).unwrap().lines().count(), from_root(&path));
        assert!(lines <= MAX_LINES, "{place} has {lines} lines");
    }
}

/// What `crate::` is followed by in code, for every path and every name of an import.
fn paths_in(code: &str) -> Vec<String> {
    let words = |text: &str| {
        let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
        text[..end].to_owned()
    };
    let mut found = Vec::new();
    for (at, path) in code.match_indices("crate::") {
        let rest = &code[at + path.len()..];
        match rest.strip_prefix('{') {
            Some(list) => {
                found.extend(list.split('}').next().unwrap_or_default().split(',').map(|it| words(it.trim())));
            }
            None => found.push(words(rest)),
        }
    }
    found.retain(|name| !name.is_empty());
    found
}

/// Where the public items of a crate's root come from, by the first segment of their path.
fn origins(root_file: &str) -> std::collections::BTreeMap<String, String> {
    let mut origins = std::collections::BTreeMap::new();
    for import in code(root_file).split("pub use ").skip(1) {
        let import = import.split(';').next().unwrap_or_default();
        let Some((first, rest)) = import.split_once("::") else { continue };
        let names = rest.rsplit("::").next().unwrap_or_default();
        for name in names.trim_matches(['{', '}', '\n', ' ']).split(',') {
            origins.insert(name.trim().to_owned(), first.trim().to_owned());
        }
    }
    origins
}

/// Every import within a crate that points up in the order of its folders, as `file imports name`.
fn imports_that_point_up(source: &str, order: &[&str]) -> Vec<String> {
    let origins = origins(&std::fs::read_to_string(root().join(source).join("lib.rs")).unwrap());
    let rank = |name: &str| order.iter().position(|known| *known == name);
    let mut up = Vec::new();
    for path in files(&["rs"]) {
        let place = from_root(&path);
        let Some(inside) = place.strip_prefix(&format!("{source}/")) else { continue };
        let own = inside.split(['/', '.']).next().unwrap_or_default();
        let own_rank = rank(own).unwrap_or_else(|| panic!("{place}: {own} has no place in the order"));
        let text = std::fs::read_to_string(&path).unwrap();
        let without_tests = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for name in paths_in(&code(without_tests)) {
            let from = origins.get(&name).unwrap_or(&name);
            if rank(from).is_some_and(|rank| rank > own_rank) && !inside.ends_with("_tests.rs") {
                up.push(format!("{place} imports {name}"));
            }
        }
    }
    up
}

#[test]
fn folders_import_one_way() {
    for (source, order) in ORDERS {
        let order: Vec<&str> = order.split_whitespace().collect();
        assert_eq!(imports_that_point_up(source, &order), Vec::<String>::new());
    }
}

/// Numbers of the lines of comments that are too long.
fn long_comments(text: &str) -> Vec<usize> {
    let is_long = |line: &str| line.trim_start().starts_with("//") && line.chars().count() > MAX_COMMENT;
    text.lines().enumerate().filter(|(_, line)| is_long(line)).map(|(number, _)| number + 1).collect()
}

#[test]
fn comments_are_narrow_and_files_have_a_head() {
    for path in files(&["rs"]) {
        let (text, place) = (std::fs::read_to_string(&path).unwrap(), from_root(&path));
        let long = long_comments(&text);
        assert!(long.is_empty(), "{place}: comments of more than {MAX_COMMENT} columns in lines {long:?}");
        assert!(text.starts_with("//"), "{place} has no head line that says what is in it");
    }
}

#[test]
fn names_and_words_are_those_of_the_field() {
    for path in files(&["rs", "md", "py"]) {
        let (text, place) = (std::fs::read_to_string(&path).unwrap(), from_root(&path));
        if place.ends_with("house_rules.rs") {
            continue;
        }
        for name in ["MOST_", "LEAST_"] {
            let is_code = place.ends_with(".rs") && code(&text).contains(name);
            assert!(!is_code, "{place}: {name} is MAX_ or MIN_");
        }
        // Words may stand on two lines, and in names.
        let text =
            text.to_lowercase().replace(['/', '!', '#', '_'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
        for words in DIALECT {
            let is_inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
            let stands = text.match_indices(words).any(|(i, _)| {
                !is_inside(text[..i].chars().next_back()) && !is_inside(text[i + words.len()..].chars().next())
            });
            assert!(!stands, "{place}: {words:?}");
        }
    }
}

/// What a document names as a path: the targets of its links, and what it sets in code that begins
/// with a directory of the root or is the name of a source, manifest or document.
fn named_paths(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let is_path = |word: &str| word.chars().all(|c| c.is_ascii_alphanumeric() || "._-/".contains(c));
    let in_code = text.split("```").step_by(2).flat_map(|prose| prose.split('`').skip(1).step_by(2));
    for word in in_code {
        let first = word.split('/').next().unwrap_or_default();
        let of_ours = word.contains('/') && !first.is_empty() && first != "target" && root().join(first).exists();
        let a_file = [".rs", ".toml", ".md"].iter().any(|ending| word.len() > ending.len() && word.ends_with(ending));
        if is_path(word) && (of_ours || a_file) {
            found.insert(word.to_owned());
        }
    }
    for link in text.split("](").skip(1) {
        let target = link.split([')', '#', ' ']).next().unwrap_or_default();
        if !target.is_empty() && !target.contains("://") {
            found.insert(target.to_owned());
        }
    }
    found
}

/// A path is one from the root or from the document; a file may also be named by the end of its
/// path, as in a map of a crate.
#[test]
fn documents_name_paths_that_exist() {
    let everything: Vec<PathBuf> = files(&["rs", "toml", "md"]);
    for required in ["ARCHITECTURE.md", "README.md"] {
        assert!(root().join(required).is_file(), "{required} is missing");
    }
    for document in files(&["md"]) {
        let text = std::fs::read_to_string(&document).unwrap();
        for named in named_paths(&text) {
            let end_of_one = everything.iter().any(|path| path.ends_with(&named));
            let exists = end_of_one || root().join(&named).exists() || document.with_file_name(&named).exists();
            assert!(exists, "{} names {named}, which does not exist", from_root(&document));
        }
    }
}

/// The checks above would find what they look for.
#[test]
fn the_checks_themselves_work() {
    let text = "let a = \"unsafe\"; // unsafe\n/// unsafe\nunsafe { b }";
    assert_eq!(code(text).lines().filter(|line| line.contains("unsafe")).count(), 1);
    let named = named_paths("`crates/nowhere.rs`, `gone.md`, `m/s`, `a b.rs`, [x](docs/y.md#z) and <https://a.b/c>");
    let expected = ["crates/nowhere.rs", "gone.md", "docs/y.md"].map(str::to_owned);
    assert_eq!(named, BTreeSet::from(expected));
    assert_eq!(paths_in("use crate::solver::x; use crate::{Rng, step::y};"), ["solver", "Rng", "step"]);
    let roots = origins("pub use step::simulation::Simulation;\npub use energy::totals::{Totals, Other};");
    assert_eq!(roots["Simulation"], "step");
    assert_eq!(roots["Other"], "energy");
    let long = format!("/// {}\n/// short\nlet x = 1;\n", "word ".repeat(20));
    assert_eq!(long_comments(&long), [1]);
    let table: toml::Table =
        "[target.'cfg(unix)'.dependencies]\nx = '1'\n[dependencies]\ny = { package = 'z' }".parse().unwrap();
    assert_eq!(dependencies(&table, "dependencies"), BTreeSet::from(["x".to_owned(), "z".to_owned()]));
}
