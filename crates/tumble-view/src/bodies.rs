//! The bodies of a scene as they are drawn.

use std::collections::HashMap;

use hecs::{Entity, World};
use tumble::glam::{DQuat, DVec3};
use tumble::math::Real;
use tumble::{
    BodyId, BodyOrder, CenterOfMass, Collider, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Shape,
    Velocity, equivalent_ellipsoid,
};
use tumble_import::Appearance;
use tumble_record::{BODY_COLORS, FIXED_COLOR, GROUND_COLOR, SurfaceSet, ground_patches};
use tumble_scene::BodyNames;

use crate::colliders;
use crate::convert::{dquat, dvec3};
use crate::framing::Frame;
use crate::pick::Bounds;

/// Infinite ground is drawn this many radii of the frame wide, either way.
const GROUND: f64 = 12.0;
/// Colour of balls that are shot, in linear light.
const BALL_COLOR: [f32; 3] = [0.62, 0.60, 0.52];

/// What never changes of a body's picture.
#[derive(Debug)]
pub(crate) struct DrawnBody {
    pub(crate) entity: Entity,
    pub(crate) name: String,
    pub(crate) pieces: Vec<Piece>,
    /// Centre of mass in the body's frame \[m\].
    center: DVec3,
    /// Middle and half the size of the box around all pieces, in the body's frame \[m\].
    middle: DVec3,
    half_extents: DVec3,
    /// Red, green, blue in linear light.
    pub(crate) color: [f32; 3],
    pub(crate) moves: bool,
    /// Whether it is infinite ground, of which a piece is drawn.
    pub(crate) endless: bool,
    /// Whether it touches others with something else than what is seen of it.
    pub(crate) touches_unseen: bool,
    pub(crate) turns: bool,
    /// Zero for fixed and kinematic bodies \[kg\].
    pub(crate) mass: f64,
    /// How far the surface reaches from the centre of mass \[m\].
    pub(crate) reach: f64,
}

/// A surface in a body's frame. Compounds and capsules are made of several, so that all bodies of a
/// scene share a few surfaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Index into the surfaces.
    pub(crate) surface: usize,
    /// The surface is stretched by these, turned and shifted \[m\].
    pub(crate) factors: DVec3,
    pub(crate) rotation: DQuat,
    pub(crate) position: DVec3,
}

/// Where a body is at the moment of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// Origin of the body's frame \[m\].
    pub(crate) origin: DVec3,
    /// Centre of mass \[m\].
    pub(crate) center: DVec3,
    /// Turns the body's frame into the world.
    pub(crate) rotation: DQuat,
}

/// All bodies, in the order of the scene.
#[derive(Debug)]
pub(crate) struct Bodies {
    pub(crate) all: Vec<DrawnBody>,
    pub(crate) surfaces: SurfaceSet,
    pub(crate) surface_count: usize,
    /// The surface of balls that may be shot, and its factors for a radius of a metre.
    ball: (usize, DVec3),
}

impl Bodies {
    pub(crate) fn of(world: &World, order: &BodyOrder, names: &BodyNames, appearance: &[Appearance]) -> Self {
        let mut surfaces = SurfaceSet::default();
        let ball = surfaces.insert(&Appearance::Shape(Shape::sphere(1.0)));
        let mut bodies = Self { all: Vec::with_capacity(order.len()), surfaces, surface_count: 0, ball };
        for (index, &entity) in order.entities().iter().enumerate() {
            let Ok(body) = world.entity(entity) else { continue };
            let id = body.get::<&BodyId>().map_or(index as u64, |id| id.0);
            let its_appearance = usize::try_from(id).ok().and_then(|id| appearance.get(id));
            let center = body.get::<&CenterOfMass>().map_or(DVec3::ZERO, |center| dvec3(center.0));
            let mut pieces = Vec::new();
            match its_appearance {
                None | Some(Appearance::Shape(Shape::Point)) => {
                    let (shape, rotation) = inertia_ellipsoid(body).unwrap_or((Shape::Point, DQuat::IDENTITY));
                    bodies.add_pieces(&shape, (center, rotation), &mut pieces);
                }
                Some(Appearance::HalfSpace) => {}
                Some(Appearance::Shape(shape)) => bodies.add_pieces(shape, (DVec3::ZERO, DQuat::IDENTITY), &mut pieces),
                Some(other) => bodies.add_piece(other, (DVec3::ZERO, DQuat::IDENTITY), &mut pieces),
            }
            let moves = body.get::<&Velocity>().is_some();
            let unlike =
                |collider: &Collider| its_appearance.is_none_or(|appearance| colliders::differs(collider, appearance));
            let endless = matches!(its_appearance, Some(Appearance::HalfSpace));
            bodies.all.push(DrawnBody {
                entity,
                name: names.of(id).into_owned(),
                pieces,
                center,
                middle: DVec3::ZERO,
                half_extents: DVec3::ZERO,
                color: match (body.has::<Momentum>(), endless) {
                    (true, _) => BODY_COLORS[index % BODY_COLORS.len()],
                    (false, true) => GROUND_COLOR,
                    (false, false) => FIXED_COLOR,
                },
                moves,
                endless,
                touches_unseen: body.get::<&Collider>().is_some_and(|collider| unlike(&collider)),
                turns: moves && body.has::<Inertia>(),
                mass: body.get::<&Mass>().map_or(0.0, |mass| f64::from(mass.kilograms())),
                reach: 0.0,
            });
        }
        bodies.measure();
        bodies.lay(world);
        bodies
    }

    /// A ball that was not there at the start.
    pub(crate) fn add_ball(&mut self, entity: Entity, name: String, radius: f64, mass: f64) {
        let (surface, factors) = self.ball;
        let piece = Piece { surface, factors: factors * radius, rotation: DQuat::IDENTITY, position: DVec3::ZERO };
        self.all.push(DrawnBody {
            entity,
            name,
            pieces: vec![piece],
            center: DVec3::ZERO,
            middle: DVec3::ZERO,
            half_extents: DVec3::splat(radius),
            color: BALL_COLOR,
            moves: true,
            endless: false,
            touches_unseen: false,
            turns: true,
            mass,
            reach: radius,
        });
    }

    /// Mean density of the dynamic bodies in the boxes around them, if they have one [kg/m^3].
    pub(crate) fn density(&self) -> Option<f64> {
        let dynamic = || self.all.iter().filter(|body| body.mass > 0.0);
        let volume: f64 = dynamic().map(|body| 8.0 * body.half_extents.element_product()).sum();
        let density = dynamic().map(|body| body.mass).sum::<f64>() / volume;
        (density.is_finite() && density > 0.0).then_some(density)
    }

    /// A shape at a place in the body's frame.
    fn add_pieces(&mut self, shape: &Shape, (position, rotation): (DVec3, DQuat), pieces: &mut Vec<Piece>) {
        let mut add = |shape: &Shape, at: DVec3, turn: DQuat| {
            self.add_pieces(shape, (position + rotation * at, (rotation * turn).normalize()), pieces);
        };
        match *shape {
            Shape::Compound(ref parts) => {
                for part in parts {
                    add(&part.shape, part.position, part.orientation);
                }
            }
            Shape::Capsule { radius, half_height } => {
                add(&Shape::cylinder(radius, half_height), DVec3::ZERO, DQuat::IDENTITY);
                for end in [half_height, -half_height] {
                    add(&Shape::sphere(radius), DVec3::Y * end, DQuat::IDENTITY);
                }
            }
            _ => self.add_piece(&Appearance::Shape(shape.clone()), (position, rotation), pieces),
        }
    }

    fn add_piece(&mut self, appearance: &Appearance, (position, rotation): (DVec3, DQuat), pieces: &mut Vec<Piece>) {
        let (surface, factors) = self.surfaces.insert(appearance);
        pieces.push(Piece { surface, factors, rotation, position });
    }

    /// Boxes around the bodies, and how far they reach.
    fn measure(&mut self) {
        let boxes: Vec<[DVec3; 2]> =
            self.surfaces.tessellations().map(|surface| around(&mut surface.positions.iter().copied())).collect();
        self.surface_count = boxes.len();
        for body in &mut self.all {
            let corners = |piece: &Piece| {
                let [low, high] = boxes.get(piece.surface).copied().unwrap_or_default();
                let (piece, size) = (*piece, high - low);
                (0..8_u8).map(move |corner| {
                    let part = |bit: u8| f64::from(u8::from(corner & bit != 0));
                    let at = low + size * DVec3::new(part(1), part(2), part(4));
                    piece.position + piece.rotation * (at * piece.factors)
                })
            };
            let [low, high] = around(&mut body.pieces.iter().flat_map(corners));
            if (high - low).is_finite() {
                body.middle = 0.5 * (low + high);
                body.half_extents = 0.5 * (high - low);
                body.reach = (body.middle - body.center).length() + body.half_extents.length();
            }
        }
    }

    /// Ground is as large as anyone will see of it from where the others are at the start. Its
    /// surfaces come after all others.
    fn lay(&mut self, world: &World) {
        let places = self.place(world, 1.0);
        let frame = Frame::of(self, &places);
        let endless: Vec<usize> = (0..self.all.len()).filter(|&index| self.all[index].endless).collect();
        let frames: Vec<_> = endless.iter().map(|&index| (places[index].origin, places[index].rotation)).collect();
        for (&index, plate) in endless.iter().zip(ground_patches(&frames, frame.middle, GROUND * frame.radius)) {
            let Some(Appearance::Mesh(mesh)) = &plate else { continue };
            let [low, high] = around(&mut mesh.positions().iter().copied());
            let mut pieces = Vec::new();
            self.add_piece(&Appearance::Mesh(mesh.clone()), (DVec3::ZERO, DQuat::IDENTITY), &mut pieces);
            let body = &mut self.all[index];
            (body.middle, body.half_extents) = (0.5 * (low + high), 0.5 * (high - low));
            body.reach = body.half_extents.length();
            body.pieces = pieces;
        }
        self.surface_count = self.surfaces.tessellations().count();
    }

    /// Bodies and where they are.
    pub(crate) fn by_entity<'a>(&'a self, places: &'a [Placed]) -> HashMap<Entity, (&'a DrawnBody, &'a Placed)> {
        self.all.iter().zip(places).map(|(body, placed)| (body.entity, (body, placed))).collect()
    }

    /// Where all bodies are, `alpha` of the way from the step before to the last one.
    pub(crate) fn place(&self, world: &World, alpha: Real) -> Vec<Placed> {
        let states = world.view::<(&Pose, Option<&PreviousPose>)>();
        let pose = |body: &DrawnBody| match states.get(body.entity) {
            Some((pose, Some(previous))) if alpha < 1.0 => previous.0.interpolate(pose, alpha),
            Some((pose, _)) => *pose,
            None => Pose::default(),
        };
        self.all.iter().map(|body| body.placed(&pose(body))).collect()
    }
}

impl DrawnBody {
    /// Where it is with a pose.
    pub(crate) fn placed(&self, pose: &Pose) -> Placed {
        let (center, orientation) = (dvec3(pose.position), dquat(pose.orientation));
        Placed { origin: center - orientation * self.center, center, rotation: orientation }
    }

    /// The box around the body, made larger by a factor.
    pub(crate) fn bounds(&self, placed: &Placed, factor: f64) -> Bounds {
        Bounds {
            center: placed.origin + placed.rotation * self.middle * factor,
            rotation: placed.rotation,
            half_extents: self.half_extents * factor,
        }
    }
}

/// The lowest and the highest corner of the box around points.
fn around(points: &mut dyn Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], point| [low.min(point), high.max(point)])
}

/// A body without a shape is shown as the homogeneous ellipsoid with its mass and moments; and the
/// rotation from its axes to the body's frame.
fn inertia_ellipsoid(body: hecs::EntityRef<'_>) -> Option<(Shape, DQuat)> {
    let mass = f64::from(body.get::<&Mass>()?.kilograms());
    let radii = equivalent_ellipsoid(mass, dvec3(body.get::<&Inertia>()?.moments()));
    // What is flat is seen from its edge as well.
    let radii = radii.max(DVec3::splat(1e-3 * radii.max_element()));
    let turn = body.get::<&PrincipalAxes>().map_or(DQuat::IDENTITY, |axes| dquat(axes.0));
    radii.is_finite().then(|| (Shape::ellipsoid(radii), turn))
}

#[cfg(test)]
mod tests {
    use tumble::prelude::*;
    use tumble_scene::Scene;

    use super::*;

    fn bodies(scene: &str) -> (World, Bodies) {
        let scene = Scene::open(scene).unwrap();
        let (appearance, mut world) = (scene.appearance().unwrap(), World::new());
        let names = scene.spawn(&mut world).unwrap();
        let order = BodyOrder::of(&world);
        let bodies = Bodies::of(&world, &order, &names, &appearance);
        (world, bodies)
    }

    #[test]
    fn a_box_reaches_as_far_as_its_corners() {
        let (world, bodies) = bodies("mujoco-box");
        let body = &bodies.all[0];
        // Half extents 0.1, 0.2, 0.3.
        assert!((body.reach - 0.14_f64.sqrt()).abs() < 1e-12, "{}", body.reach);
        let placed = bodies.place(&world, 1.0)[0];
        let bounds = body.bounds(&placed, 2.0);
        assert!((bounds.half_extents - DVec3::new(0.2, 0.4, 0.6)).length() < 1e-12);
        assert_eq!(placed.center, placed.origin);
    }

    /// The station has no shape. Its ellipsoid has its moments: I_x = m/5 (b^2 + c^2).
    #[test]
    fn a_body_without_a_shape_is_its_ellipsoid() {
        let (world, bodies) = bodies("iss");
        let body = &bodies.all[0];
        let (mass, moments) = world
            .query_one::<(&Mass, &Inertia)>(body.entity)
            .get()
            .map(|(mass, inertia)| (f64::from(mass.kilograms()), dvec3(inertia.moments())))
            .unwrap();
        let factors = body.pieces[0].factors;
        let squares = factors * factors;
        let back = mass / 5.0 * (DVec3::splat(squares.element_sum()) - squares);
        // Roundings of double precision, of moments that were rounded before.
        assert!(((back - moments) / moments).length() < 1e-12, "{back} {moments}");
        assert_eq!(bodies.place(&world, 1.0)[0].center, bodies.place(&world, 1.0)[0].origin);
    }

    /// The surface of a capsule is that of a cylinder and two balls; all 10 000 bodies share a few.
    #[test]
    fn bodies_are_made_of_few_surfaces() {
        let (_, bodies) = bodies("stress");
        assert_eq!((bodies.all.len(), bodies.surface_count), (10_000, 4));
        let pieces: usize = bodies.all.iter().map(|body| body.pieces.len()).sum();
        // An eighth are capsules of three pieces, an eighth compounds of two.
        assert!((13_500..=14_000).contains(&pieces), "{pieces}");
    }

    #[test]
    fn a_compound_turns_about_its_centre_of_mass() {
        let (world, bodies) = bodies("t-handle");
        let body = &bodies.all[0];
        let before = bodies.place(&world, 1.0)[0];
        let offset = world.get::<&CenterOfMass>(body.entity).map_or(DVec3::ZERO, |center| dvec3(center.0));
        assert!((before.rotation * offset - (before.center - before.origin)).length() < 1e-12);
        world.get::<&mut Pose>(body.entity).unwrap().orientation = Quat::from_rotation_y(1.0);
        let after = bodies.place(&world, 1.0)[0];
        assert_eq!(before.center, after.center);
        let off = after.rotation * DVec3::X - DQuat::from_rotation_y(1.0) * DVec3::X;
        // Roundings of single precision.
        assert!(off.length() < 1e-6, "{off}");
    }
}
