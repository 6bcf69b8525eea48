//! Promise: what a newcomer sees first is there and true: every public type and function that a
//! library re-exports has an example, the program in the guide to embedding is the one that is
//! compiled, documents and examples import the prelude and modules of a subject, and errors print
//! as sentences.
//!
//! Why: examples are what is read and copied. The other blocks of the documents are compiled as
//! doctests; a block that needs a window cannot be. It fails when a type becomes public without an
//! example, or when guide and program drift apart.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The published libraries, and how many public items they have at the least.
const LIBRARIES: [(&str, usize); 9] = [
    ("crates/tumble", 40),
    ("crates/tumble-math", 40),
    ("crates/tumble-import", 40),
    ("crates/tumble-record", 15),
    ("crates/tumble-scene", 15),
    ("crates/tumble-sweep", 15),
    ("crates/tumble-vehicle", 15),
    ("crates/tumble-character", 10),
    ("crates/tumble-collide", 15),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

fn sources(directory: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let within = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    within.filter(|path| path.extension().is_some_and(|ending| ending == "rs")).collect()
}

/// All words of the `pub use` lines: the names that are re-exported, and those of the modules on
/// the way.
fn reexported(library: &str) -> BTreeSet<String> {
    let uses = library.split("pub use ").skip(1).filter_map(|rest| rest.split(';').next());
    let words = uses.flat_map(|list| list.split(|c: char| !c.is_alphanumeric() && c != '_'));
    words.filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

/// The public items at the top of a source, with the lines right above each: its documentation and
/// attributes.
fn items(source: &str) -> impl Iterator<Item = (&str, Vec<&str>)> {
    let lines: Vec<&str> = source.lines().collect();
    (0..lines.len()).filter_map(move |i| {
        let item = ["struct ", "enum ", "trait ", "fn "]
            .iter()
            .find_map(|kind| lines[i].strip_prefix("pub ")?.strip_prefix(kind))?;
        let name = item.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
        let above = lines[..i].iter().rev().take_while(|line| !line.is_empty()).copied().collect();
        Some((name, above))
    })
}

/// The names that are public in a library, those in its public modules among them.
fn public_names(library: &str) -> BTreeSet<String> {
    let face = read(&format!("{library}/src/lib.rs"));
    let mut names = reexported(&face);
    for module in face.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')) {
        let path = ["", "/mod"].map(|end| format!("{library}/src/{module}{end}.rs"));
        let source = read(path.iter().find(|path| root().join(path).is_file()).unwrap());
        names.extend(reexported(&source));
        names.extend(items(&source).map(|(name, _)| name.to_owned()));
    }
    names
}

#[test]
fn everything_public_has_an_example() {
    for (library, least) in LIBRARIES {
        let names = public_names(library);
        let mut found = 0;
        for path in sources(&root().join(library).join("src")) {
            let source = std::fs::read_to_string(&path).unwrap();
            for (name, above) in items(&source).filter(|(name, _)| names.contains(*name)) {
                found += 1;
                let has_example = above.iter().any(|line| line.starts_with("/// ```"));
                assert!(has_example, "{}: {name} has no example", path.display());
            }
        }
        assert!(found >= least, "only {found} public items were found in {library}: the search itself is broken");
    }
}

#[test]
fn the_window_of_the_guide_is_the_one_that_is_compiled() {
    let guide = read("docs/embedding.md");
    let blocks: Vec<&str> = guide
        .split("```rs\n")
        .skip(1)
        .filter_map(|rest| rest.split_inclusive("```").next()?.strip_suffix("```"))
        .collect();
    assert_eq!(blocks, [read("examples/first-window/src/main.rs")]);
}

/// Lines that import from the root of the engine instead of its prelude or one of its modules.
fn imports_of_the_root(text: &str) -> Vec<&str> {
    let imported = text.lines().filter_map(|line| line.trim_start().strip_prefix("use tumble::"));
    imported.filter(|path| !path.starts_with(char::is_lowercase) || !path.contains("::")).collect()
}

#[test]
fn documents_and_examples_import_the_prelude_and_modules() {
    let pages = std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = pages.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let programs = ["docking", "first-window", "turret", "yard"];
    let programs = programs.map(|name| sources(&root().join("examples").join(name)));
    for path in pages.chain(programs.into_iter().flatten()).chain([root().join("README.md")]) {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(imports_of_the_root(&text), Vec::<&str>::new(), "{}", path.display());
    }
}

/// A `main` that returns an error prints its `Debug`.
#[test]
fn errors_print_as_sentences() {
    use tumble::prelude::*;
    let printed = |error: Box<dyn std::error::Error>| format!("{error:?}");
    let body = RigidBody::new(Shape::sphere(0.5)).mass(-1.0).build().unwrap_err();
    assert_eq!(printed(body.into()), "mass must be positive, it is -1.0");
    let settings = Simulation::new(Settings::default().with_dt(0.0)).unwrap_err();
    assert_eq!(printed(settings.clone().into()), settings.to_string());
    let collider = Collider::new(&Shape::Point).unwrap_err();
    assert_eq!(printed(collider.into()), "a point cannot be a collider: it has no surface");
    let mut world = hecs::World::new();
    let ground = spawn_ground(&mut world);
    let velocity = set_linear_velocity(&mut world, ground, Vec3::X).unwrap_err();
    assert_eq!(printed(velocity.into()), "entity 0v1 has no Momentum: it is no body that moves");
}

/// The checks above would find what they look for.
#[test]
fn the_checks_themselves_work() {
    assert_eq!(reexported("mod a;\npub use a::{B, c};\n"), ["a", "B", "c"].map(str::to_owned).into());
    let text = "use tumble::Pose;\n    use tumble::{Pose, Ray};\nuse tumble::weld;\nuse tumble::joints::Gear;";
    assert_eq!(imports_of_the_root(text), ["Pose;", "{Pose, Ray};", "weld;"]);
    let source =
        "/// Text.\n/// ```\n/// x();\n/// ```\n#[derive(Debug)]\npub struct B(u8);\n\npub fn c() {}\nfn d() {}\n";
    let found: Vec<(&str, usize)> = items(source).map(|(name, above)| (name, above.len())).collect();
    assert_eq!(found, [("B", 5), ("c", 0)]);
}
