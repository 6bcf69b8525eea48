use glam::DVec3;
use hecs::Entity;
use tumble::{BodyId, CenterOfMass, Pose, Shape, Velocity};

use super::super::frame::Frame;
use super::geometry::SurfaceSet;
use super::sample::{Sample, double, single};
use crate::looks::{BODY_COLORS, Looks};
use crate::tessellation::POINT_RADIUS;

/// A body without size is drawn as this part of the scene, where that is more than its octahedron has.
const POINT_SHARE: f64 = 1.0 / 200.0;

/// The bodies of the first frame, and what they look like.
#[derive(Debug)]
pub(crate) struct Bodies {
    all: Vec<DrawnBody>,
    pub(crate) geometry: SurfaceSet,
    /// Different pairs of surface and colour among the bodies.
    pub(crate) looks: Vec<Look>,
}

#[derive(Debug)]
pub(crate) struct DrawnBody {
    pub(crate) entity: Entity,
    pub(crate) name: String,
    /// Centre of mass in the body's frame \[m\].
    pub(crate) center: DVec3,
    pub(crate) moves: bool,
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
    /// Of what stands still.
    Grey,
    /// One of [`BODY_COLORS`].
    Bright(usize),
}

impl Bodies {
    pub(crate) fn of(frame: &Frame<'_>, all: &[Looks]) -> Self {
        let of_body = |id| usize::try_from(id).ok().and_then(|id: usize| all.get(id));
        Self::chosen(frame, |id| Some(of_body(id).unwrap_or(&Looks::Shape(Shape::Point))))
    }

    /// The bodies that have looks, which are asked for by their number in the order of the scene.
    pub(crate) fn chosen<'a>(frame: &Frame<'_>, looks: impl Fn(u64) -> Option<&'a Looks>) -> Self {
        let states = frame.world.view::<(&Pose, Option<&BodyId>, Option<&CenterOfMass>, Option<&Velocity>)>();
        let mut bodies = Self { all: Vec::new(), geometry: SurfaceSet::default(), looks: Vec::new() };
        let mut known = std::collections::HashMap::new();
        let mut points = Vec::new();
        for (index, &entity) in frame.order.entities().iter().enumerate() {
            let Some((pose, id, center, velocity)) = states.get(entity) else { continue };
            let id = id.map_or(index as u64, |id| id.0);
            let Some(looks) = looks(id) else { continue };
            let center = center.map_or(DVec3::ZERO, |center| DVec3::from_array(center.0.to_array().map(double)));
            let (surface, factors) = bodies.geometry.insert(looks);
            let color = match velocity {
                Some(_) => Color::Bright(bodies.all.len() % BODY_COLORS.len()),
                None => Color::Grey,
            };
            let look = Look { surface, color };
            let look = *known.entry(look).or_insert_with(|| {
                bodies.looks.push(look);
                bodies.looks.len() - 1
            });
            if matches!(looks, Looks::Shape(Shape::Point)) {
                points.push(bodies.all.len());
            }
            bodies.all.push(DrawnBody {
                entity,
                name: frame.names.of(id).into_owned(),
                center,
                moves: velocity.is_some(),
                look,
                // A size of zero cannot be undone, which viewers need for the normals.
                scale: factors.to_array().map(|factor| single(factor).max(f32::MIN_POSITIVE)),
                sample: Sample::of(pose, center, None)
                    .unwrap_or(Sample { rotation: [0.0, 0.0, 0.0, 1.0], ..Sample::default() }),
            });
        }
        bodies.enlarge(&points);
        bodies
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
