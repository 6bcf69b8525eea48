//! The numbers of a force, by what follows `forces.I` in a path.

use crate::fields::field_path::{component, from_zero};
use crate::model::force_model::{ForceModel, HullModel, PerAxis};

/// The number that a path such as `["drag", "linear"]` leads to, if the force has it.
pub(crate) fn in_force<'a>(force: &'a mut ForceModel, path: &[&str]) -> Option<&'a mut f64> {
    use ForceModel as F;
    let (name, path) = path.split_first()?;
    if *name != force.name() {
        return None;
    }
    match (force, path) {
        (F::GravityScale(number), []) => Some(number),
        (F::Wind(vector), [axis]) => component(vector, axis),
        (F::Damping { linear, .. }, ["linear"]) => Some(linear),
        (F::Damping { angular, .. }, ["angular"]) => Some(angular),
        (F::Drag { linear, .. }, ["linear", rest @ ..]) => per_axis(linear, rest),
        (F::Drag { angular, .. }, ["angular", rest @ ..]) => per_axis(angular, rest),
        (F::Magnus { coefficient }, ["coefficient"]) => Some(coefficient),
        (F::Thruster { throttle, .. }, ["throttle"]) => Some(throttle.get_or_insert(1.0)),
        (F::Thruster { force, .. }, ["force", axis]) => component(force, axis),
        (F::Thruster { point, .. }, ["point", axis]) => from_zero(point, axis),
        (F::ConstantWrench { force, .. }, ["force", axis]) => from_zero(force, axis),
        (F::ConstantWrench { torque, .. }, ["torque", axis]) => from_zero(torque, axis),
        (F::SpringToPoint { anchor, .. }, ["anchor", axis]) => component(anchor, axis),
        (F::SpringToPoint { attachment, .. } | F::Spring { attachment, .. }, ["attachment", axis]) => {
            from_zero(attachment, axis)
        }
        (F::Spring { attachment_to, .. }, ["attachment_to", axis]) => from_zero(attachment_to, axis),
        (F::SpringToPoint { rest_length, .. }, ["rest_length"]) => Some(rest_length),
        (F::Spring { rest_length, .. }, ["rest_length"]) => Some(rest_length.get_or_insert(0.0)),
        (F::SpringToPoint { stiffness, .. } | F::Spring { stiffness, .. }, ["stiffness"]) => Some(stiffness),
        (F::SpringToPoint { damping, .. } | F::Spring { damping, .. }, ["damping"]) => Some(damping),
        (F::PointGravity { center, .. } | F::Buoyancy { center, .. }, ["center", axis]) => from_zero(center, axis),
        (F::PointGravity { mu, .. }, ["mu"]) => Some(mu),
        (F::GravityMass { mu, .. }, ["mu"]) => Some(mu.get_or_insert(0.0)),
        (F::PointGravity { softening, .. } | F::GravityMass { softening, .. }, ["softening"]) => Some(softening),
        (F::Buoyancy { density, .. }, ["density"]) => Some(density.get_or_insert(0.0)),
        (F::Buoyancy { level, .. }, ["level"]) => Some(level),
        (F::Buoyancy { hull, .. }, ["hull", rest @ ..]) => in_hull(hull.as_mut()?, rest),
        (F::AngularVelocityServo { target, .. }, ["target", axis]) => component(target, axis),
        (F::AngularVelocityServo { max_torque, .. }, ["max_torque"]) => Some(max_torque.get_or_insert(0.0)),
        _ => None,
    }
}

/// One number for all axes, or that of one axis; which of both is as in the file.
fn per_axis<'a>(numbers: &'a mut Option<PerAxis>, path: &[&str]) -> Option<&'a mut f64> {
    match (numbers.get_or_insert(PerAxis::All(0.0)), path) {
        (PerAxis::All(number), []) => Some(number),
        (PerAxis::Each(numbers), [axis]) => component(numbers, axis),
        _ => None,
    }
}

/// With or without the hull's name, as for shapes.
fn in_hull<'a>(hull: &'a mut HullModel, path: &[&str]) -> Option<&'a mut f64> {
    let path = match path.split_first() {
        Some((name, rest)) if *name == hull.name() => rest,
        _ => path,
    };
    match (hull, path) {
        (HullModel::Sphere { radius }, ["radius"]) => Some(radius),
        (HullModel::Cuboid { half_extents }, ["half_extents", axis]) => component(half_extents, axis),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::parse::{Format, parse};

    /// Forces, and the paths of all their numbers. The first force leaves out what can be.
    const FORCES: [(&str, &str); 18] = [
        (r#"{ "damping": {} }"#, "damping.linear damping.angular"),
        (r#"{ "gravity_scale": 1 }"#, "gravity_scale"),
        (r#"{ "drag": { "linear": 1, "angular": 2 } }"#, "drag.linear drag.angular"),
        (r#"{ "drag": { "linear": [1, 2, 3] } }"#, "drag.linear.0 drag.linear.2 drag.angular"),
        (r#"{ "wind": [1, 2, 3] }"#, "wind.0 wind.1 wind.2"),
        (r#"{ "magnus": { "coefficient": 1 } }"#, "magnus.coefficient"),
        (r#"{ "thruster": { "force": [1, 2, 3] } }"#, "thruster.force.0 thruster.point.1 thruster.throttle"),
        (r#"{ "constant_wrench": {} }"#, "constant_wrench.force.0 constant_wrench.torque.2"),
        (
            r#"{ "spring_to_point": { "anchor": [1, 2, 3], "stiffness": 1 } }"#,
            "spring_to_point.anchor.1 spring_to_point.attachment.0 spring_to_point.rest_length spring_to_point.stiffness \
             spring_to_point.damping",
        ),
        (
            r#"{ "spring": { "to": "b", "stiffness": 1 } }"#,
            "spring.attachment.0 spring.attachment_to.1 spring.rest_length spring.stiffness spring.damping",
        ),
        (r#"{ "spring": { "to": "b", "stiffness": 1, "rest_length": 2 } }"#, "spring.rest_length"),
        (r#"{ "point_gravity": { "mu": 1 } }"#, "point_gravity.center.2 point_gravity.mu point_gravity.softening"),
        (r#"{ "gravity_mass": {} }"#, "gravity_mass.mu gravity_mass.softening"),
        (r#"{ "buoyancy": {} }"#, "buoyancy.density buoyancy.level buoyancy.center.1"),
        (r#"{ "buoyancy": { "hull": { "sphere": { "radius": 1 } } } }"#, "buoyancy.hull.sphere.radius"),
        (r#"{ "buoyancy": { "hull": { "cuboid": { "half_extents": [1, 2, 3] } } } }"#, "buoyancy.hull.half_extents.2"),
        (
            r#"{ "angular_velocity_servo": { "target": [1, 2, 3] } }"#,
            "angular_velocity_servo.target.0 angular_velocity_servo.max_torque",
        ),
        (
            r#"{ "angular_velocity_servo": { "target": [1, 2, 3], "max_torque": 4 } }"#,
            "angular_velocity_servo.max_torque",
        ),
    ];

    fn force(text: &str) -> ForceModel {
        let scene = format!(r#"{{ "bodies": [ {{ "forces": [{text}] }} ] }}"#);
        parse(&scene, Format::Json, "scene").unwrap().bodies.remove(0).forces.remove(0)
    }

    fn is_found(text: &str, path: &str) -> bool {
        in_force(&mut force(text), &path.split('.').collect::<Vec<_>>()).is_some()
    }

    #[test]
    fn every_number_of_a_force_has_a_path() {
        for (text, paths) in FORCES {
            let mut seen = std::collections::BTreeSet::new();
            for path in paths.split_whitespace() {
                let mut force = force(text);
                let path: Vec<&str> = path.split('.').collect();
                *in_force(&mut force, &path).unwrap() = 4321.0;
                let text = format!("{force:?}");
                assert_eq!(text.matches("4321").count(), 1, "{path:?}: {text}");
                assert!(seen.insert(text), "{path:?} is the same number as another path");
            }
        }
    }

    #[test]
    fn what_is_no_number_has_none() {
        for (text, path) in [
            (r#"{ "drag": { "linear": [1, 2, 3] } }"#, "drag.linear"),
            (r#"{ "drag": { "linear": 1 } }"#, "drag.linear.0"),
            (r#"{ "drag": { "linear": 1 } }"#, "linear"),
            (r#"{ "wind": [1, 2, 3] }"#, "wind"),
            (r#"{ "wind": [1, 2, 3] }"#, "wind.3"),
            (r#"{ "wind": [1, 2, 3] }"#, "drag.0"),
            (r#"{ "buoyancy": {} }"#, "buoyancy.hull.radius"),
            (r#"{ "buoyancy": { "hull": { "sphere": { "radius": 1 } } } }"#, "buoyancy.hull.cuboid.half_extents.0"),
            (r#"{ "spring": { "to": "b", "stiffness": 1 } }"#, "spring.to"),
        ] {
            assert!(!is_found(text, path), "{path} in {text}");
        }
    }
}
