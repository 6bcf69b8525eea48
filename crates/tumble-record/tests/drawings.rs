//! Promise: the drawing of a body is a well-formed picture, whatever mesh the body has.
//!
//! Why: a mesh is drawn to see what is wrong with it, so the worst ones are drawn most. It would
//! fail by an index that is not there, an extent of zero that is divided by, or a name that is not
//! escaped.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use proptest::prelude::*;
use roxmltree::Document;
use tumble_record::body_drawing;
use tumble_scene::{Audit, MeshOptions, MeshRepairs, builtin_names};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn the_bodies_of_built_in_scenes_are_drawn() {
    for name in builtin_names() {
        let audit = Audit::open(name).unwrap();
        Document::parse(&body_drawing(&audit.bodies[0])).unwrap();
    }
}

proptest! {
    // Each case writes a file.
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_meshes_are_drawn(
        edits in prop::collection::vec((0.0..1.0, 0_usize..8, prop::sample::select(vec!["", "-1", "0", "1e300", "\n", "f 1 2 3\n", "v 1 1 1\n"])), 1..5),
    ) {
        let mut text = TETRAHEDRON.to_owned();
        for (at, length, with) in edits {
            let start = (at * text.len() as f64) as usize;
            text.replace_range(start..(start + length).min(text.len()), with);
        }
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("<m>.obj");
        std::fs::write(&path, text).unwrap();
        for repairs in [MeshRepairs::Refused, MeshRepairs::Made] {
            if let Ok(audit) = Audit::open_with(path.to_str().unwrap(), MeshOptions { density: 1.0, repairs }) {
                let drawing = body_drawing(&audit.bodies[0]);
                prop_assert!(Document::parse(&drawing).is_ok(), "{drawing}");
            }
        }
    }
}
