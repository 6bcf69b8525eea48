//! Built-in scenes of bodies that touch: models as files would give them, made in plain arithmetic,
//! so the same bits on every platform.

pub(crate) mod body;
pub(crate) mod bowling;
pub(crate) mod cradle;
pub(crate) mod dominoes;
pub(crate) mod drum;
pub(crate) mod hills;
pub(crate) mod pile;
pub(crate) mod pyramid;
pub(crate) mod spheres;
pub(crate) mod wall;

use crate::model::scene_model::SceneModel;

/// A scene that is generated on each request.
pub(crate) struct ContactScene {
    pub(crate) name: &'static str,
    /// How many bodies that are not scenery, unless one is given; `None` where the number is part
    /// of the scene.
    pub(crate) bodies: Option<usize>,
    /// Whether chance has a part in it.
    pub(crate) is_seeded: bool,
    pub(super) description: &'static str,
    source: &'static str,
    make: fn(usize, u64) -> SceneModel,
}

/// All of them, in the order of their names.
pub(crate) const CONTACT_SCENES: [ContactScene; 9] = [
    ContactScene {
        name: "bowling",
        bodies: None,
        is_seeded: false,
        description: "A ball into the pocket of ten pins.",
        source: "Spots of the pins, weight and size of the ball: USBC Equipment Specifications; pins have a pin's height and weight, and a foot, a neck and a head.",
        make: |_, _| bowling::scene(),
    },
    ContactScene {
        name: "cradle",
        bodies: None,
        is_seeded: false,
        description: "Newton's cradle: one ball comes down, the last one goes up.",
        source: "Central impact of equal masses with restitution 1: velocities are exchanged (any textbook of mechanics).",
        make: |_, _| cradle::scene(),
    },
    ContactScene {
        name: "dominoes",
        bodies: Some(56),
        is_seeded: false,
        description: "Dominoes along an S, of which the first is pushed.",
        source: "Our own; twice as high as wide, ten times as high as thick, half their height apart.",
        make: |bodies, _| dominoes::scene(bodies),
    },
    ContactScene {
        name: "drum",
        bodies: Some(120),
        is_seeded: true,
        description: "A drum of eight panels that turns and tumbles what is in it.",
        source: "Our own; the drum turns so fast that w^2 r/g is 0.3, where what is lifted rolls and slides down again.",
        make: drum::scene,
    },
    ContactScene {
        name: "hills",
        bodies: Some(242),
        is_seeded: true,
        description: "Balls, boxes and pills fall on hills and gather in the hollows.",
        source: "Our own; a height field of 49 by 49 heights, products of parabolas with a rim.",
        make: hills::scene,
    },
    ContactScene {
        name: "pile",
        bodies: Some(400),
        is_seeded: true,
        description: "Boxes, planks, balls, drums, pills and cones of many sizes fall on a heap.",
        source: "Our own.",
        make: pile::scene,
    },
    ContactScene {
        name: "pyramid",
        bodies: Some(2870),
        is_seeded: false,
        description: "A square pyramid of boxes, 20 by 20 at its base.",
        source: "A usual benchmark of physics engines: unit boxes of 1 kg with a pitch of 1.1 m, friction 0.5.",
        make: |bodies, _| pyramid::scene(bodies),
    },
    ContactScene {
        name: "spheres",
        bodies: Some(5000),
        is_seeded: true,
        description: "Balls in layers of 18 by 18 fall into a box 20 m wide.",
        source: "A usual benchmark of physics engines: balls of radius 0.5 m and 1 kg with a pitch of 1.1 m, friction 0.5.",
        make: spheres::scene,
    },
    ContactScene {
        name: "wall",
        bodies: Some(264),
        is_seeded: false,
        description: "A brick wall that a heavy ball strikes after half a second.",
        source: "Our own; bricks of 0.4 by 0.2 by 0.2 m and 1800 kg/m3, a ball of 650 kg at 15 m/s.",
        make: |bodies, _| wall::scene(bodies),
    },
];

/// The scene of that name, if it is one.
pub(crate) fn named(name: &str) -> Option<&'static ContactScene> {
    CONTACT_SCENES.iter().find(|scene| scene.name == name)
}

impl ContactScene {
    /// With this many bodies, and scenery.
    pub(crate) fn model(&self, bodies: Option<usize>, seed: Option<u64>) -> SceneModel {
        let bodies = bodies.or(self.bodies).unwrap_or_default();
        let model = (self.make)(bodies, seed.unwrap_or(0));
        SceneModel {
            name: Some(self.name.to_owned()),
            description: Some(self.description.to_owned()),
            source: Some(self.source.to_owned()),
            ..model
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn every_scene_can_be_opened_with_few_and_many_bodies() {
        for scene in &CONTACT_SCENES {
            for bodies in [1, 2, 7, 100, 1000] {
                if let Some(usual) = scene.bodies {
                    let model = scene.model(Some(bodies), Some(3));
                    let made = Scene::from_model(&model, scene.name).unwrap();
                    let scenery = scene.model(None, None).bodies.len() - usual;
                    assert_eq!(made.body_count(), bodies + scenery, "{}", scene.name);
                }
            }
            let model = scene.model(None, None);
            assert!(model.bodies.iter().all(|body| body.collider.is_some()), "{}", scene.name);
            let other = scene.model(None, Some(1));
            assert_eq!(format!("{model:?}") != format!("{other:?}"), scene.is_seeded, "{}", scene.name);
        }
    }
}
