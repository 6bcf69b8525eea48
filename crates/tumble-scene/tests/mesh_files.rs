//! Promise: a mesh in an OBJ or STL file has the mass properties of the solid it bounds, as the
//! body of a scene and in an audit; what keeps it from bounding one is named and counted, and no
//! file, however made, does more than fail soon.
//!
//! Why: meshes come from everywhere, and most that look right are not closed or not wound one way.
//! It would fail by a quad cut into one triangle, a polyline taken for a face, a binary STL taken
//! for text, or a count in a header that is believed.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use tumble_scene::{Audit, AuditedBody, MeshOptions, MeshRepairs, RunOverrides, Scene, SceneTemplate};

/// A unit cube of quads, with what else files have.
const CUBE: &str = "\u{feff}# a cube\nmtllib a.mtl\no cube\nv 0 0 0 # corner\nv 1 0 0 0.5\nv 1 1 0 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
vt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 4/1/1 3/1/1 2/1/1\nf -4//1 -3//1 -2//1 -1//1\nf 1 2 6 5\nf 2 3 \\\n7 6\nl 1 2 3\nf 3 4 8 7\nf 4 1 5 8\n";

struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn audit(&self, name: &str, bytes: impl AsRef<[u8]>, options: MeshOptions) -> Result<Audit, String> {
        let path = self.write(name, bytes);
        let message = |error: tumble_scene::SceneError| error.to_string().replace(&path.display().to_string(), name);
        Audit::open_with(path.to_str().unwrap(), options).map_err(message)
    }

    fn body(&self, name: &str, bytes: impl AsRef<[u8]>) -> AuditedBody {
        self.audit(name, bytes, MeshOptions::default()).unwrap().bodies.remove(0)
    }

    fn refusal(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        self.audit(name, bytes, MeshOptions::default()).unwrap_err()
    }
}

/// The cube's triangles.
fn triangles() -> Vec<[[f32; 3]; 3]> {
    let corner = |i: usize| [f32::from(matches!(i % 4, 1 | 2)), f32::from(i % 4 >= 2), f32::from(i >= 4)];
    let quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).map(|corners| corners.map(corner)).collect()
}

fn binary(header: &[u8], count: u32, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(count.to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn text(triangles: &[[[f32; 3]; 3]]) -> String {
    let facet = |corners: &[[f32; 3]; 3]| {
        let vertices: String = corners.iter().map(|[x, y, z]| format!("      vertex {x:e} {y:e} {z:e}\n")).collect();
        format!("  facet normal 0 0 0\n    outer loop\n{vertices}    endloop\n  endfacet\n")
    };
    format!("solid\n{}endsolid\n", triangles.iter().map(facet).collect::<String>())
}

/// A cube of 1 kg: its moments are 1/6, its centre is its middle.
fn assert_cube(body: &AuditedBody) {
    assert_eq!(body.problems, Vec::<String>::new());
    let close = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-15, "{value} for {expected}");
    close(body.volume.unwrap(), 1.0);
    close(body.mass.unwrap(), 1.0);
    body.center_of_mass.unwrap().iter().for_each(|x| close(*x, 0.5));
    body.principal.unwrap().iter().for_each(|moment| close(*moment, 1.0 / 6.0));
    let mesh = body.mesh.as_ref().unwrap();
    assert_eq!((mesh.triangles, mesh.open_edges, mesh.parts), (12, 0, 1));
}

#[test]
fn a_cube_in_every_format() {
    let files = Files::new();
    let audit = files.audit("cube.obj", CUBE, MeshOptions::default()).unwrap();
    assert_cube(&audit.bodies[0]);
    assert_eq!((audit.bodies[0].name.as_str(), audit.bodies[0].mesh.as_ref().unwrap().vertices), ("cube", 8));
    assert_eq!(audit.notices, ["statements not read: l (1), mtllib (1), usemtl (1)"]);
    let all = triangles();
    assert_cube(&files.body("a.stl", binary(b"a part", 12, &all)));
    // Programs write text's first word into binary headers too.
    assert_cube(&files.body("b.STL", binary(b"solid part", 12, &all)));
    assert_cube(&files.body("c.stl", text(&all)));
    assert_cube(&files.body("d.stl", text(&all).to_uppercase().replace('\n', "\r\n")));
    let two = text(&all[..6]) + &text(&all[6..]);
    let audit = files.audit("e.stl", two, MeshOptions::default()).unwrap();
    assert_cube(&audit.bodies[0]);
    assert_eq!(audit.notices, ["2 solids read as one body"]);
    let mut longer = binary(b"", 12, &all);
    longer.extend([1; 7]);
    let audit = files.audit("f.stl", longer, MeshOptions::default()).unwrap();
    assert_cube(&audit.bodies[0]);
    assert_eq!(audit.notices, ["7 bytes behind the last triangle not read"]);
}

/// A face that is not convex is cut into a fan that folds over itself; what it adds and takes away
/// is the face's.
#[test]
fn a_concave_face_has_the_mass_properties_of_its_area() {
    let outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
    let ring = |z: f64| outline.iter().map(|(x, y)| format!("v {x} {y} {z}\n")).collect::<String>();
    let sides: String =
        (0..6).map(|i| format!("f {} {} {} {}\n", i + 1, (i + 1) % 6 + 1, (i + 1) % 6 + 7, i + 7)).collect();
    // The fan begins at a corner that does not see all of the face.
    let ends = "f 3 2 1 6 5 4\nf 9 10 11 12 7 8\n";
    let body = Files::new().body("l.obj", ring(0.0) + &ring(1.0) + &sides + ends);
    assert_eq!(body.problems, Vec::<String>::new());
    assert!((body.volume.unwrap() - 3.0).abs() < 1e-14);
    for (x, expected) in body.center_of_mass.unwrap().into_iter().zip([5.0 / 6.0, 5.0 / 6.0, 0.5]) {
        assert!((x - expected).abs() < 1e-14, "{x} for {expected}");
    }
}

/// Published and generated meshes whose mass properties are known exactly; one is inside out, one
/// is open.
#[test]
fn meshes_of_the_collection() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data");
    let known: serde_json::Value =
        serde_json::from_slice(&std::fs::read(data.join("inertia_meshes.json")).unwrap()).unwrap();
    let mut problems = Vec::new();
    for mesh in known["meshes"].as_array().unwrap() {
        let path = data.join("meshes").join(mesh["file"].as_str().unwrap());
        let body = Audit::open(path.to_str().unwrap()).unwrap().bodies.remove(0);
        assert_eq!(body.problems.is_empty(), body.mass.is_some(), "{path:?}");
        problems.extend(body.problems.iter().map(|problem| format!("{}: {problem}", body.name)));
        let Some(mut principal) = body.principal else { continue };
        principal.sort_by(f64::total_cmp);
        let moments = mesh["principal_moments"].as_array().unwrap().iter().zip(principal);
        let volume = [(&mesh["volume"], body.volume.unwrap())];
        for (expected, found) in moments.chain(volume) {
            // The tolerance that comes with the figures: sums of up to 1280 terms.
            let expected = expected.as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{path:?}: {found} for {expected}");
        }
    }
    assert_eq!(
        problems,
        [
            "m23_inverted: mesh: 1 part inside out (can be repaired)",
            "m24_open: mesh: 3 open edges (cannot be repaired)"
        ]
    );
}

#[test]
fn a_mesh_that_is_inside_out_has_figures_only_when_repairs_are_asked_for() {
    let files = Files::new();
    let inverted: Vec<_> = triangles().into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let bytes = binary(b"", 12, &inverted);
    let body = files.body("a.stl", &bytes);
    assert_eq!(body.problems, ["mesh: 1 part inside out (can be repaired)"]);
    assert_eq!((body.mass, body.volume, body.principal), (None, None, None));
    assert_eq!(body.mesh.unwrap().volume, -1.0);
    let options = MeshOptions { density: 2.0, repairs: MeshRepairs::Made };
    let audit = files.audit("a.stl", &bytes, options).unwrap();
    assert_eq!(audit.notices, ["repaired: 1 part turned outside out"]);
    assert!((audit.bodies[0].mass.unwrap() - 2.0).abs() < 1e-15);
}

#[test]
fn bad_files_name_the_line() {
    let files = Files::new();
    let cases = [
        ("a.obj", "", "a mesh needs at least one triangle"),
        ("a.obj", "v 0 0\n", "a vertex has three coordinates, at line 1"),
        ("a.obj", "\nv 0 zero 0\n", "\"zero\" is not a number, at line 2"),
        ("a.obj", "v 0 nan 0\n", "nan is not a finite number, at line 1"),
        ("a.obj", "v 0 0 0\nf 1 1\n", "a face has three corners at least, at line 2"),
        ("a.obj", "v 0 0 0\nf 0 1 1\n", "a face names vertex 0, after 1 vertices, at line 2"),
        ("a.obj", "v 0 0 0\nf -2 1 1\n", "a face names vertex -2, after 1 vertices, at line 2"),
        ("a.obj", "f 1 2 9\nv 0 0 0\n", "a face names vertex 9, but there are only 1, at line 1"),
        (
            "a.obj",
            "f 1 2 9223372036854775807\n",
            "a face names vertex 9223372036854775807, after 0 vertices, at line 1",
        ),
        (
            "a.obj",
            "f 1 2 -9223372036854775808\n",
            "a face names vertex -9223372036854775808, after 0 vertices, at line 1",
        ),
        ("a.obj", "f a b c\n", "\"a\" is no corner of a face, at line 1"),
        (
            "a.stl",
            "",
            "neither text that begins with \"solid\" nor long enough for the header of a binary file: 0 bytes",
        ),
        ("a.stl", "solid a\nendsolid", "a mesh needs at least one triangle"),
        ("a.stl", "solid\nvertex 1 2 inf", "inf is not a finite number, at line 2"),
        ("a.stl", "solid\nvertex 1 2 3\nendloop", "a facet has three corners, this one 1, at line 3"),
        ("a.stl", "solid\nvertex 1 2 3\n", "the file ends in the middle of a facet"),
        ("a.stl", "solid\nvertex 1 2 3\nfacet", "\"facet\" does not belong there, at line 3"),
        ("a.stl", "solid\nhello", "\"hello\" does not belong there, at line 2"),
    ];
    for (name, text, expected) in cases {
        assert_eq!(files.refusal(name, text), format!("{name}: {expected}"), "{text:?}");
    }
    let boast = binary(b"", u32::MAX, &triangles());
    let expected =
        "a.stl: the file says that it has 4294967295 triangles, which take 214748364834 bytes, but it has 684";
    assert_eq!(files.refusal("a.stl", boast), expected);
    let nan = binary(b"", 1, &[[[f32::NAN; 3]; 3]]);
    assert!(files.refusal("a.stl", nan).starts_with("a.stl: vertex 0 at "));
}

/// A face of millions of corners makes as many triangles, a word each; there is an end to them.
#[test]
fn hostile_files_fail_soon() {
    let files = Files::new();
    let started = std::time::Instant::now();
    let fan = format!("v 0 0 0\nf{}\n", " 1".repeat(20_000_010));
    assert!(files.refusal("fan.obj", fan).ends_with("more than 20000000 triangles, at line 2"));
    let words = format!("solid{}\n", " a".repeat(20_000_000));
    assert!(files.refusal("words.stl", words).ends_with("a mesh needs at least one triangle"));
    // A second or two, on a machine that has other things to do.
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
}

fn scene(shape: &str) -> String {
    format!(r#"{{ "bodies": [ {{ "name": "part", "shape": {shape}, "density": 8000 }} ] }}"#)
}

/// A cube of a metre in a file in millimetres weighs eight tons; from the same file twice, as a
/// part and as a hull.
#[test]
fn meshes_are_shapes_in_scenes() {
    let files = Files::new();
    let millimetres: Vec<_> =
        triangles().into_iter().map(|corners| corners.map(|corner| corner.map(|x| 1000.0 * x))).collect();
    files.write("cube.stl", binary(b"", 12, &millimetres));
    let mesh = r#"{ "mesh": { "file": "cube.stl", "scale": 0.001 } }"#;
    let compound = format!(r#"{{ "compound": {{ "parts": [ {{ "shape": {mesh}, "density": 8000 }} ] }} }}"#);
    let hull = r#"{ "convex_hull": { "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1],[1,1,1],[0.5,0.5,0.5]] } }"#;
    for shape in [mesh, &compound, hull] {
        let path = files.write("scene.json", scene(shape));
        let audit = Audit::open(path.to_str().unwrap()).unwrap();
        assert_eq!(audit.bodies[0].problems, Vec::<String>::new());
        // Coordinates in metres are rounded, three of them in a volume.
        assert!((audit.bodies[0].mass.unwrap() / 8000.0 - 1.0).abs() < 1e-15, "{shape}");
        let scene = Scene::load(&path).unwrap();
        assert_eq!(scene.appearance().unwrap().len(), 1);
        let mut world = hecs::World::new();
        scene.spawn(&mut world).unwrap();
    }
    let ron = files.write("scene.ron", r#"( bodies: [ ( shape: mesh(file: "cube.stl"), mass: 1 ) ] )"#);
    assert_eq!(Scene::load(&ron).unwrap().body_count(), 1);
}

#[test]
fn a_bad_mesh_of_a_scene_is_named_with_file_body_and_field() {
    let files = Files::new();
    let path = files.write("scene.json", scene(r#"{ "mesh": { "file": "part.stl" } }"#));
    let refused = || Scene::load(&path).unwrap_err().to_string().replace(files.0.path().to_str().unwrap(), "D");
    let at = "D/scene.json: body \"part\" (bodies[0]), field shape.file: D/part.stl: ";
    assert!(refused().starts_with(&format!("{at}cannot be read: ")), "{}", refused());
    let inverted: Vec<_> = triangles().into_iter().map(|[a, b, c]| [a, c, b]).collect();
    files.write("part.stl", binary(b"", 12, &inverted));
    assert_eq!(refused(), format!("{at}the mesh bounds no solid: 1 part inside out; \"repair\": true mends it"));
    let path = files.write("scene.json", scene(r#"{ "mesh": { "file": "part.stl", "repair": true } }"#));
    assert_eq!(Scene::load(&path).unwrap().notices, ["part.stl: repaired: 1 part turned outside out"]);
    files.write("part.stl", binary(b"", 11, &triangles()[..11]));
    let error = Scene::load(&path).unwrap_err().to_string();
    assert!(error.ends_with("part.stl: the mesh bounds no solid: 3 open edges"), "{error}");
    let path = files.write("scene.json", scene(r#"{ "mesh": { "file": "part.ply" } }"#));
    assert!(
        Scene::load(&path)
            .unwrap_err()
            .to_string()
            .ends_with("part.ply: a mesh file ends in .obj, .stl, .gltf or .glb")
    );
    let path = files.write("scene.json", scene(r#"{ "mesh": { "file": "part.stl", "scale": 0 } }"#));
    let error = Scene::load(&path).unwrap_err().to_string();
    assert!(error.ends_with("field shape.scale: must be positive and finite, not 0"), "{error}");
    let path =
        files.write("scene.json", scene(r#"{ "convex_hull": { "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]] } }"#));
    let error = Scene::load(&path).unwrap_err().to_string();
    assert!(error.contains("field shape.points: all 4 points lie in one plane"), "{error}");
}

/// A sweep reads a mesh once: the file may be gone when its worlds are made. Another mesh is
/// another sweep.
#[test]
#[allow(clippy::useless_conversion, reason = "a mass is f64 already in one of the two builds")]
fn a_scene_of_many_worlds_reads_its_mesh_once() {
    let files = Files::new();
    let mesh = files.write("part.obj", CUBE);
    let path = files.write("scene.json", scene(r#"{ "mesh": { "file": "part.obj" } }"#));
    let template = SceneTemplate::open(path.to_str().unwrap(), RunOverrides::default()).unwrap();
    let fields = ["bodies.part.density", "bodies.part.angular_velocity.0"].map(|path| template.field(path).unwrap());
    let scene = template.varied(fields.to_vec());
    std::fs::remove_file(mesh).unwrap();
    for values in [[1.25, 1.5], [1.75, 1.0], [2.0, 2.0]] {
        let mut world = scene.build(&values).unwrap();
        world.trial.step_many(3);
        let mass = world.trial.world.query::<&tumble::Mass>().iter().next().unwrap().kilograms();
        // Single precision.
        assert!((f64::from(mass) / values[0] - 1.0).abs() < 1e-7, "{mass} for {}", values[0]);
    }
}

proptest! {
    // Each case writes a file.
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_meshes(
        seed in prop::sample::select(vec![("m.obj", CUBE.as_bytes().to_vec()), ("m.stl", text(&triangles()).into_bytes()), ("m.stl", binary(b"solid", 12, &triangles()))]),
        edits in prop::collection::vec((0.0..1.0, 0_usize..8, prop_oneof![
            prop::collection::vec(any::<u8>(), 0..5),
            prop::sample::select(vec!["-1", "0", "1e999", "nan", "\n", "4294967297", "f", "v 1 1", "-9223372036854775808/-9/-9"]).prop_map(|text| text.as_bytes().to_vec()),
        ]), 1..5),
    ) {
        let (name, mut bytes) = seed;
        for (at, length, with) in edits {
            let start = (at * bytes.len() as f64) as usize;
            bytes.splice(start..(start + length).min(bytes.len()), with);
        }
        for repairs in [MeshRepairs::Refused, MeshRepairs::Made] {
            match Files::new().audit(name, &bytes, MeshOptions { density: 1.0, repairs }) {
                Ok(audit) => prop_assert_eq!(audit.bodies.len(), 1),
                Err(message) => prop_assert!(message.starts_with(name) && !message.chars().any(char::is_control), "{message:?}"),
            }
        }
    }

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), stl: bool) {
        let name = if stl { "m.stl" } else { "m.obj" };
        drop(Files::new().audit(name, &bytes, MeshOptions::default()));
    }
}
