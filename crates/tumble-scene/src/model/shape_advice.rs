//! What to write where a shape is only named, or named as other programs have it.

use serde_path_to_error::Segment;

use crate::model::parse::Format;

/// Names that other programs have for shapes.
const OTHER_NAMES: [(&str, &str); 18] = [
    ("ball", "sphere"),
    ("box", "cuboid"),
    ("brick", "cuboid"),
    ("cube", "cuboid"),
    ("block", "cuboid"),
    ("pill", "capsule"),
    ("rod", "cylinder"),
    ("tube", "cylinder"),
    ("shell", "hollow_sphere"),
    ("plane", "half_space"),
    ("halfspace", "half_space"),
    ("ground", "half_space"),
    ("heightfield", "height_field"),
    ("terrain", "height_field"),
    ("hull", "convex_hull"),
    ("convex", "convex_hull"),
    ("trimesh", "mesh"),
    ("type", "sphere"),
];

/// Each shape that has fields, in JSON and in RON.
const EXAMPLES: [(&str, &str, &str); 12] = [
    ("sphere", r#"{ "sphere": { "radius": 0.5 } }"#, "sphere(radius: 0.5)"),
    ("hollow_sphere", r#"{ "hollow_sphere": { "radius": 0.5 } }"#, "hollow_sphere(radius: 0.5)"),
    ("cuboid", r#"{ "cuboid": { "half_extents": [0.5, 0.5, 0.5] } }"#, "cuboid(half_extents: (0.5, 0.5, 0.5))"),
    ("cylinder", r#"{ "cylinder": { "radius": 0.5, "half_height": 1 } }"#, "cylinder(radius: 0.5, half_height: 1)"),
    ("capsule", r#"{ "capsule": { "radius": 0.5, "half_height": 1 } }"#, "capsule(radius: 0.5, half_height: 1)"),
    ("cone", r#"{ "cone": { "radius": 0.5, "half_height": 1 } }"#, "cone(radius: 0.5, half_height: 1)"),
    ("ellipsoid", r#"{ "ellipsoid": { "radii": [0.5, 1, 2] } }"#, "ellipsoid(radii: (0.5, 1, 2))"),
    (
        "compound",
        r#"{ "compound": { "parts": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 1 } ] } }"#,
        "compound(parts: [(shape: sphere(radius: 0.5), mass: 1)])",
    ),
    ("mesh", r#"{ "mesh": { "file": "part.obj" } }"#, r#"mesh(file: "part.obj")"#),
    (
        "convex_hull",
        r#"{ "convex_hull": { "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] } }"#,
        "convex_hull(points: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])",
    ),
    ("half_space", r#"{ "half_space": {} }"#, "half_space()"),
    (
        "height_field",
        r#"{ "height_field": { "heights": [[0, 0], [0, 1]] } }"#,
        "height_field(heights: [[0, 0], [0, 1]])",
    ),
];

/// The problem that a parser has at this path, said with what to write, if it is a shape's name
/// alone or no shape's name.
pub(crate) fn advised(path: &[&Segment], problem: &str, format: Format) -> Option<String> {
    let named = match path {
        [.., Segment::Map { key }, Segment::Enum { variant }] if key == "shape" => Some(variant.as_str()),
        [.., Segment::Map { key }] if key == "shape" => None,
        [.., Segment::Map { key }, Segment::Unknown] if key == "shape" => None,
        _ => return None,
    };
    let begins = |begin: &str| problem.strip_prefix(begin).and_then(|rest| rest.split('`').next());
    let unknown = begins("unknown variant `").or_else(|| begins("Unexpected variant named `"));
    let is_alone = problem.starts_with("invalid type: unit variant") || problem.starts_with("Expected opening `(`");
    let (what, name) = match (unknown, named) {
        (Some("type"), _) => ("a shape is written by its name".to_owned(), "type"),
        (Some(name), _) => (format!("there is no shape {name:?}"), name),
        (None, Some(name)) if is_alone => (format!("a {name} has its fields with it"), name),
        _ => return None,
    };
    let lower = name.to_lowercase().replace('-', "_");
    let other = OTHER_NAMES.iter().find(|(other, _)| *other == lower).map(|(_, name)| *name);
    let (_, json, ron) = EXAMPLES.iter().find(|(known, ..)| *known == other.unwrap_or(&lower))?;
    let example = match format {
        Format::Json => json,
        Format::Ron => ron,
    };
    let place = problem.rfind(" at line ").and_then(|at| problem.get(at..)).unwrap_or_default();
    Some(format!("{what}: write {example}{place}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::parse::parse;

    fn json(shape: &str) -> String {
        format!("{{ \"bodies\": [ {{ \"name\": \"a\", \"mass\": 1, \"shape\": {shape} }} ] }}")
    }

    fn ron(shape: &str) -> String {
        format!("( bodies: [ ( name: \"a\", mass: 1, shape: {shape} ) ] )")
    }

    #[test]
    fn the_examples_are_read() {
        for (name, in_json, in_ron) in EXAMPLES.into_iter().filter(|(name, ..)| *name != "mesh") {
            for (text, format) in [(json(in_json), Format::Json), (ron(in_ron), Format::Ron)] {
                let model = parse(&text, format, "scene").unwrap();
                assert_eq!(model.bodies[0].shape.as_ref().unwrap().name(), name);
            }
        }
    }

    #[test]
    fn a_name_alone_is_answered_by_what_to_write() {
        let begin = "scene: body \"a\" (bodies[0]), field shape";
        for (name, _, _) in EXAMPLES {
            for (text, format) in [(json(&format!("{name:?}")), Format::Json), (ron(name), Format::Ron)] {
                let said = parse(&text, format, "scene").unwrap_err().to_string();
                let example = EXAMPLES.iter().find(|(known, ..)| *known == name).unwrap();
                let example = if format == Format::Json { example.1 } else { example.2 };
                assert!(said.starts_with(begin) && said.contains(&format!("write {example} at line 1")), "{said}");
            }
        }
    }

    #[test]
    fn names_of_other_programs_are_answered_by_ours() {
        for (other, name) in OTHER_NAMES {
            let example = EXAMPLES.iter().find(|(known, ..)| *known == name).unwrap();
            for text in [json(&format!("{other:?}")), json(&format!("{{ {other:?}: {{ \"size\": 1 }} }}"))] {
                let said = parse(&text, Format::Json, "scene").unwrap_err().to_string();
                assert!(said.contains(&format!("write {}", example.1)), "{said}");
            }
            let said = parse(&ron(&format!("{other}(size: 1)")), Format::Ron, "scene").unwrap_err().to_string();
            assert!(other == "type" || said.contains(&format!("write {}", example.2)), "{said}");
        }
        let said = parse(&json("\"Cube\""), Format::Json, "scene").unwrap_err().to_string();
        assert!(said.contains("there is no shape \"Cube\": write { \"cuboid\""), "{said}");
        // What is like nothing is answered by all that there is.
        let said = parse(&json("\"teapot\""), Format::Json, "scene").unwrap_err().to_string();
        assert!(said.contains("`hollow_sphere`"), "{said}");
    }
}
