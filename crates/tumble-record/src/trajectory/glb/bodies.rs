//! The bodies of a glTF animation, with their surfaces, colours and display sizes.

use std::collections::HashMap;

use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::{BodyId, CenterOfMass, Momentum, Pose, Shape, Velocity};
use tumble_import::{Appearance, POINT_RADIUS};

use crate::colors::BODY_COLORS;
use crate::ground_patches::ground_patches;
use crate::trajectory::frame::Frame;
use crate::trajectory::glb::geometry::SurfaceSet;
use crate::trajectory::glb::sample::{Sample, double, single};

/// A body without size is drawn as this part of the scene, where that is more than its octahedron
/// has.
const POINT_SHARE: f64 = 1.0 / 200.0;

/// Infinite ground is a disc of this many radii of what stands on it.
const GROUND: f64 = 1.6;

/// The bodies of the first frame, and what they look like.
#[derive(Debug)]
pub(crate) struct Bodies {
    all: Vec<DrawnBody>,
    pub(crate) geometry: SurfaceSet,
    /// Different pairs of surface and colour among the bodies.
    pub(crate) appearance: Vec<Look>,
}

#[derive(Debug)]
pub(crate) struct DrawnBody {
    pub(crate) entity: Entity,
    pub(crate) name: String,
    /// Centre of mass in the body's frame \[m\].
    pub(crate) center: DVec3,
    pub(crate) moves: bool,
    /// Whether it is seen from outside only, as ground is.
    pub(crate) one_sided: bool,
    /// Index into the looks.
    pub(crate) look: usize,
    pub(crate) scale: [f32; 3],
    /// The last one; the first one until frames are recorded.
    pub(crate) sample: Sample,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Look {
    pub(crate) surface: usize,
    pub(crate) color: Color,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Color {
    /// Of what no force moves.
    Grey,
    /// Of infinite ground.
    Ground,
    /// One of [`BODY_COLORS`].
    Bright(usize),
}

impl Bodies {
    pub(crate) fn of(frame: &Frame<'_>, all: &[Appearance]) -> Self {
        let of_body = |id| usize::try_from(id).ok().and_then(|id: usize| all.get(id));
        Self::chosen(frame, |id| Some(of_body(id).unwrap_or(&Appearance::Shape(Shape::Point))))
    }

    /// The bodies that have looks, which are asked for by their number in the order of the scene.
    pub(crate) fn chosen<'a>(frame: &Frame<'_>, appearance: impl Fn(u64) -> Option<&'a Appearance>) -> Self {
        let states =
            frame.world.view::<(&Pose, Option<&BodyId>, Option<&CenterOfMass>, Option<&Velocity>, Option<&Momentum>)>();
        let mut bodies = Self { all: Vec::new(), geometry: SurfaceSet::default(), appearance: Vec::new() };
        let mut known = HashMap::new();
        let (mut points, mut endless) = (Vec::new(), Vec::new());
        for (index, &entity) in frame.order.entities().iter().enumerate() {
            let Some((pose, id, center, velocity, momentum)) = states.get(entity) else { continue };
            let id = id.map_or(index as u64, |id| id.0);
            let Some(appearance) = appearance(id) else { continue };
            let center = center.map_or(DVec3::ZERO, |center| DVec3::from_array(center.0.to_array().map(double)));
            let color = match momentum {
                Some(_) => Color::Bright(bodies.all.len() % BODY_COLORS.len()),
                None => Color::Grey,
            };
            match appearance {
                Appearance::Shape(Shape::Point) => points.push(bodies.all.len()),
                Appearance::HalfSpace => endless.push(bodies.all.len()),
                _ => {}
            }
            bodies.all.push(DrawnBody {
                entity,
                name: frame.names.of(id).into_owned(),
                center,
                moves: velocity.is_some(),
                one_sided: *appearance == Appearance::HalfSpace,
                look: 0,
                scale: [1.0; 3],
                sample: Sample::of(pose, center, None)
                    .unwrap_or(Sample { rotation: [0.0, 0.0, 0.0, 1.0], ..Sample::default() }),
            });
            if *appearance != Appearance::HalfSpace {
                bodies.put_on(bodies.all.len() - 1, appearance, color, &mut known);
            }
        }
        bodies.enlarge(&points);
        bodies.lay(&endless, &mut known);
        bodies
    }

    /// Gives a body its surface and colour.
    fn put_on(&mut self, index: usize, appearance: &Appearance, color: Color, known: &mut HashMap<Look, usize>) {
        let (surface, factors) = self.geometry.insert(appearance);
        let look = Look { surface, color };
        let Self { all, appearance, .. } = self;
        if let Some(body) = all.get_mut(index) {
            body.look = *known.entry(look).or_insert_with(|| {
                appearance.push(look);
                appearance.len() - 1
            });
            // A size of zero cannot be undone, which viewers need for the normals.
            body.scale = factors.to_array().map(|factor| single(factor).max(f32::MIN_POSITIVE));
        }
    }

    /// Infinite ground is drawn as large as suits the others.
    fn lay(&mut self, endless: &[usize], known: &mut HashMap<Look, usize>) {
        let (middle, radius) = self.ball_around();
        let place = |index: &usize| {
            let sample = self.all.get(*index).map_or_else(Sample::default, |body| body.sample);
            (DVec3::from_array(sample.translation.map(f64::from)), DQuat::from_array(sample.rotation.map(f64::from)))
        };
        let places: Vec<_> = endless.iter().map(place).collect();
        for (&index, plate) in endless.iter().zip(ground_patches(&places, middle, GROUND * radius)) {
            // Where nothing of it is seen, there is still to be a node for the body.
            let appearance = plate.unwrap_or(Appearance::Shape(Shape::Point));
            self.put_on(index, &appearance, Color::Ground, known);
        }
    }

    /// A ball that holds the bodies that have an end; those that move, if any does.
    fn ball_around(&self) -> (DVec3, f64) {
        let any_moves = self.all.iter().any(|body| body.moves);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for body in self.all.iter().filter(|body| !body.one_sided && body.moves == any_moves) {
            let surface = self.appearance.get(body.look).and_then(|look| self.geometry.surfaces.get(look.surface));
            let Some(surface) = surface else { continue };
            let corners = [surface.min, surface.max].map(|corner| DVec3::from_array(corner.map(f64::from)).abs());
            let reach = (corners[0].max(corners[1]) * DVec3::from_array(body.scale.map(f64::from))).length();
            let place = DVec3::from_array(body.sample.translation.map(f64::from));
            (low, high) = (low.min(place - reach), high.max(place + reach));
        }
        let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
        if middle.is_finite() && radius > 0.0 { (middle, radius) } else { (DVec3::ZERO, 1.0) }
    }

    /// Gives points a size at which they are seen beside the others.
    fn enlarge(&mut self, points: &[usize]) {
        let places = || self.all.iter().map(|body| DVec3::from_array(body.sample.translation.map(f64::from)));
        let (low, high) = (places().fold(DVec3::MAX, DVec3::min), places().fold(DVec3::MIN, DVec3::max));
        let factor = single((POINT_SHARE * (high - low).length() / POINT_RADIUS).max(1.0));
        for &index in points {
            if let Some(body) = self.all.get_mut(index) {
                body.scale = [factor; 3];
            }
        }
    }

    pub(crate) fn len(&self) -> u64 {
        self.all.len() as u64
    }

    pub(crate) fn all(&self) -> &[DrawnBody] {
        &self.all
    }

    pub(crate) fn all_mut(&mut self) -> &mut [DrawnBody] {
        &mut self.all
    }

    pub(crate) fn moving(&mut self) -> impl Iterator<Item = &mut DrawnBody> {
        self.all.iter_mut().filter(|body| body.moves)
    }

    pub(crate) fn moving_count(&self) -> u64 {
        self.all.iter().filter(|body| body.moves).count() as u64
    }
}
