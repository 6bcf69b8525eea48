//! Promise: ground of heights is where the scene says it is, looks as it is touched, and is rolled
//! over as if it had no edges; and bodies touch those that their groups say.
//!
//! Why: a row of heights for a column, a grid that is off by half a cell, or a bit for a number,
//! and bodies float above the ground that is drawn, or fall through it.

use glam::DVec3;
use hecs::World;
use tumble::{BodyOrder, Pose, Simulation};
use tumble_import::Appearance;
use tumble_scene::{MAX_HEIGHTS, Scene};

/// Where the bodies are after a number of steps, in the order of the scene.
#[allow(clippy::useless_conversion, reason = "it is f64 already in one of the two builds")]
fn run(scene: Scene, steps: u32) -> Vec<DVec3> {
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    simulation.step_many(&mut world, steps);
    let place = |entity| DVec3::from_array(world.get::<&Pose>(entity).unwrap().position.to_array().map(f64::from));
    BodyOrder::of(&world).entities().iter().map(|entity| place(*entity)).collect()
}

/// Three columns two metres apart and two rows ten metres apart, about a point that is not the
/// origin.
const ROOF: &str = r#"{ "bodies": [ { "name": "roof", "fixed": true, "position": [10, 1, 0], "collider": {},
    "shape": { "height_field": { "heights": [[0, 1, 0], [0, 1, 0.5]], "spacing": [2, 10] } } } ] }"#;

#[test]
fn heights_are_seen_where_they_are() {
    let ron = "( bodies: [ ( name: \"roof\", fixed: true, position: (10, 1, 0), collider: (),
        shape: height_field(heights: [[0, 1, 0], [0, 1, 0.5]], spacing: (2, 10)) ) ] )";
    for scene in [Scene::from_json(ROOF, "roof.json").unwrap(), Scene::from_ron(ron, "roof.ron").unwrap()] {
        let appearance = scene.appearance().unwrap();
        let [Appearance::HeightField(roof)] = &appearance[..] else { panic!("{appearance:?}") };
        let mesh = roof.triangles();
        let corners: Vec<[f64; 3]> = mesh.positions().iter().map(DVec3::to_array).collect();
        let back = [[-2.0, 0.0, -5.0], [0.0, 1.0, -5.0], [2.0, 0.0, -5.0]];
        let front = [[-2.0, 0.0, 5.0], [0.0, 1.0, 5.0], [2.0, 0.5, 5.0]];
        assert_eq!(corners, [back, front].concat());
        assert_eq!(mesh.triangles().len(), 4);
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|corner| mesh.positions()[corner as usize]);
            assert!((b - a).cross(c - a).y > 0.0, "seen from above: {triangle:?}");
        }
    }
}

/// A ball comes down on each of the roof's slopes, on the side that it is on, where there are
/// heights and not beside them.
#[test]
fn heights_are_touched_where_they_are_seen() {
    let ball = |x: f64, z: f64| {
        format!(
            r#"{{ "shape": {{ "sphere": {{ "radius": 0.25 }} }}, "mass": 1, "position": [{x}, 4, {z}], "collider": {{}} }}"#
        )
    };
    let balls = [ball(8.2, -4.5), ball(11.8, -4.5), ball(7.5, 0.0), ball(9.0, 5.5)];
    let text = ROOF.replace(" ] }", &format!(", {} ] }}", balls.join(", ")));
    // Half a second after they would have hit the roof's foot.
    let places = run(Scene::from_json(&text, "roof.json").unwrap(), 75);
    assert!(places[1].x < 8.2 - 0.05 && places[2].x > 11.8 + 0.05, "they roll off to either side: {places:?}");
    let fallen = 4.0 - 0.5 * 9.81 * 1.25 * 1.25;
    for (beside, x) in [(places[3], 7.5), (places[4], 9.0)] {
        assert!(
            (beside.y - fallen).abs() < 0.1 && (beside.x - x).abs() < 1e-6,
            "beside it nothing is touched: {places:?}"
        );
    }
}

/// A slope of one in four, in cells of half a metre: a ball that rolls goes `5/7 g sin(a) t^2/2`,
/// and does not feel where cells meet.
#[test]
fn a_ball_rolls_down_heights_as_down_a_plane() {
    let row: Vec<String> = (0..41).map(|column| (-0.125 * f64::from(column)).to_string()).collect();
    let row = format!("[{}]", row.join(", "));
    let slope = 0.25_f64.atan();
    // The middle of the grid is 2.5 m below its first column; the ball touches it there.
    let (x, y) = (0.25 * slope.sin() - 9.0, 0.25 * slope.cos() + 9.0 * 0.25 - 2.5);
    let text = format!(
        r#"{{ "bodies": [
            {{ "fixed": true, "shape": {{ "height_field": {{ "heights": [{row}, {row}, {row}], "spacing": [0.5, 0.5] }} }},
               "collider": {{}} }},
            {{ "shape": {{ "sphere": {{ "radius": 0.25 }} }}, "mass": 1, "position": [{x}, {y}, 0.1], "collider": {{}} }} ] }}"#
    );
    let place = run(Scene::from_json(&text, "slope.json").unwrap(), 180)[1];
    let way = (place - DVec3::new(x, y, 0.1)).dot(DVec3::new(slope.cos(), -slope.sin(), 0.0));
    let expected = 5.0 / 7.0 * 9.81 * slope.sin() * 9.0 / 2.0;
    assert!((way / expected - 1.0).abs() < 0.005, "{way} of {expected}");
    // It stays on its line, and on the ground.
    assert!((place.z - 0.1).abs() < 0.01, "{place}");
    let above = (place - DVec3::new(x, y, 0.1)).dot(DVec3::new(slope.sin(), slope.cos(), 0.0));
    assert!(above.abs() < 2e-3, "{above}");
}

/// A floor of heights that goes up at two metres a second lifts what lies on it.
#[test]
fn heights_move_as_given() {
    let text = r#"{ "bodies": [
        { "kinematic": true, "linear_velocity": [0, 2, 0], "shape": { "height_field": { "heights": [[0, 0], [0, 0]], "spacing": [8, 8] } },
          "collider": {} },
        { "shape": { "cuboid": { "half_extents": [0.5, 0.5, 0.5] } }, "mass": 1, "position": [1, 0.5, 1], "linear_velocity": [0, 2, 0],
          "collider": {} } ] }"#;
    let places = run(Scene::from_json(text, "lift.json").unwrap(), 60);
    assert!((places[0].y - 2.0).abs() < 1e-5 && (places[1].y - 2.5).abs() < 1e-3, "{places:?}");
}

#[test]
fn more_heights_than_are_sensible_are_refused() {
    let row = format!("[0{}]", ", 0".repeat(MAX_HEIGHTS / 2));
    let text = format!(
        r#"{{ "bodies": [ {{ "fixed": true, "shape": {{ "height_field": {{ "heights": [{row}, {row}] }} }} }} ] }}"#
    );
    let error = Scene::from_json(&text, "large.json").unwrap_err().to_string();
    assert!(error.contains("field shape.height_field.heights: are 4000002, more than 4000000"), "{error}");
}

/// A ghost falls through the table, which it does not touch, and what the table does not touch
/// falls through it too; both end on the ground.
#[test]
fn bodies_touch_what_their_groups_say() {
    let text = r#"{ "bodies": [
        { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": { "groups": [0] } },
        { "name": "table", "shape": { "cuboid": { "half_extents": [5, 0.25, 5] } }, "fixed": true, "position": [0, 2, 0],
          "collider": { "groups": [1], "touches": [0, 31] } },
        { "name": "ghost", "shape": { "cuboid": { "half_extents": [0.5, 0.5, 0.5] } }, "mass": 1, "position": [-3, 3, 0],
          "collider": { "groups": [31], "touches": [0] } },
        { "name": "stranger", "shape": { "cuboid": { "half_extents": [0.5, 0.5, 0.5] } }, "mass": 1, "position": [0, 3, 0],
          "collider": { "groups": [30] } },
        { "name": "guest", "shape": { "cuboid": { "half_extents": [0.5, 0.5, 0.5] } }, "mass": 1, "position": [3, 3, 0],
          "collider": { "groups": [30, 31] } } ] }"#;
    let heights: Vec<f64> =
        run(Scene::from_json(text, "groups.json").unwrap(), 240).iter().map(|place| place.y).collect();
    for (height, expected) in heights[2..].iter().zip([0.5, 0.5, 2.75]) {
        assert!((height - expected).abs() < 1e-3, "{heights:?}");
    }
}
