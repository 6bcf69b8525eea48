//! Bodies as the graphics card takes them, and which of them cast shadows.

use tumble::glam::DVec3;

use crate::bodies::Placed;
use crate::camera::View;
use crate::convert::single3;
use crate::framing;
use crate::gpu::BodyInstance;
use crate::viewport::{SEEN, Viewport};

/// How bright a body that sleeps is, of what it is otherwise.
const ASLEEP: f32 = 0.35;

impl Viewport {
    /// The bodies that cast shadows, as the balls around them.
    pub(super) fn shadow_casters<'a>(
        &'a self,
        view: &'a View,
        places: &'a [Placed],
    ) -> impl Iterator<Item = (DVec3, f64)> + 'a {
        let bodies = &self.playback.bodies.all;
        let cast = bodies.iter().zip(places).filter(|(body, _)| !body.endless);
        cast.map(move |(body, placed)| {
            let enlarged = framing::enlargement(view, placed.center, body.reach, bodies.len());
            (placed.center, enlarged * body.reach)
        })
    }

    /// The bodies by their surface.
    pub(super) fn instances(&self, view: &View, places: &[Placed]) -> Vec<Vec<BodyInstance>> {
        let bodies = &self.playback.bodies;
        let mut by_surface = vec![Vec::new(); bodies.surface_count];
        let eye = view.target + view.towards * view.unit;
        for (index, (body, placed)) in bodies.all.iter().zip(places).enumerate() {
            // Ground is not seen from below, so that walls on this side do not hide what is between
            // them.
            if body.endless && (eye - placed.origin).dot(placed.rotation * DVec3::Y) <= 0.0 {
                continue;
            }
            let enlarged = framing::enlargement(view, placed.center, body.reach, bodies.all.len());
            let lit = match (body.endless, self.picked == Some(index)) {
                (true, _) => -SEEN * self.start.radius / view.unit,
                (false, picked) => f64::from(u8::from(picked)),
            } as f32;
            let is_asleep = self.playback.simulation.is_asleep(body.entity);
            let [red, green, blue] = body.color.map(|part| if is_asleep { ASLEEP * part } else { part });
            for piece in &body.pieces {
                if let Some(instances) = by_surface.get_mut(piece.surface) {
                    let origin = placed.origin + placed.rotation * piece.position * enlarged;
                    instances.push(BodyInstance {
                        place: single3(view.relative(origin)),
                        turn: (placed.rotation * piece.rotation).as_quat().to_array(),
                        size: single3(piece.factors * (enlarged / view.unit)),
                        paint: [red, green, blue, lit],
                    });
                }
            }
        }
        // What is hidden by what was drawn before costs little.
        let towards = view.towards.as_vec3();
        let near = |body: &BodyInstance| towards.dot(body.place.into());
        by_surface.iter_mut().for_each(|bodies| bodies.sort_by(|a, b| near(b).total_cmp(&near(a))));
        by_surface
    }
}
