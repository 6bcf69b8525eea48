//! Debug drawing of contact points and normal forces.

use glam::DVec3;
use hecs::World;

use crate::components::Momentum;
use crate::debug_draw::{DebugDraw, DebugView, Pen};
use crate::math::dvec3;
use crate::step::contact_report::Contact;
use crate::step::simulation::Simulation;

impl DebugView {
    /// Draws where bodies touched in the last step of a simulation, and what pushed there:
    /// [`contacts`](Self::contacts) and [`contact_forces`](Self::contact_forces).
    ///
    /// An arrow goes along [`Contact::normal`] and shows how the second of [`Contact::bodies`] is
    /// pushed by the first; where only the first is dynamic, how that is pushed, so that arrows on
    /// the ground point up. It stands for the force of the last substep of contacts, its impulse
    /// over [`Settings::contact_substep`](crate::Settings::contact_substep), without friction; a
    /// hit that was over before, see [`Contact`], is not seen. Where nothing pushes there is no
    /// arrow, and where bodies are about to touch there is nothing. Points are where they were when
    /// the step began, whatever [`alpha`](Self::alpha) is.
    ///
    /// ```
    /// use tumble::{DebugView, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// spawn_ground(&mut world);
    /// RigidBody::new(Shape::sphere(0.5))
    ///     .mass(2.0)
    ///     .position(Vec3::Y * 0.5)
    ///     .build()?
    ///     .spawn(&mut world);
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 60);
    ///
    /// let view =
    ///     DebugView { contacts: Some(0.1), contact_forces: Some(0.05), ..DebugView::nothing() };
    /// let mut lines = Vec::new();
    /// view.draw_contacts(&simulation, &world, &mut |from, to, _| lines.push(to - from));
    /// // A cross, a shaft and four strokes of its head. The ground holds 19.62 N: 0.981 m.
    /// assert_eq!(lines.len(), 2 + 1 + 4);
    /// assert!((lines[0].length() - 0.1).abs() < 1e-6 && (lines[2].y - 0.981).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn draw_contacts(&self, simulation: &Simulation, world: &World, target: &mut dyn DebugDraw) {
        if self.contacts.is_none() && self.contact_forces.is_none() {
            return;
        }
        let mut pen = Pen { target };
        let substep = simulation.settings().contact_substep();
        let moves = |body| world.entity(body).is_ok_and(|body| body.has::<Momentum>());
        for contact in simulation.contacts().filter(Contact::touches) {
            let pushes = if moves(contact.bodies[1]) { contact.normal } else { -contact.normal };
            for point in contact.points() {
                if let Some(width) = self.contacts {
                    pen.cross(dvec3(point.position), dvec3(contact.normal), f64::from(width));
                }
                if let Some(scale) = self.contact_forces {
                    pen.arrow(point.position, pushes * (scale * point.impulse / substep), Self::CONTACT);
                }
            }
        }
    }
}

impl Pen<'_> {
    /// Two strokes across each other in the plane of a unit normal.
    fn cross(&mut self, middle: DVec3, normal: DVec3, width: f64) {
        let (side, other) = normal.any_orthonormal_pair();
        for half in [side, other].map(|stroke| stroke * (0.5 * width)) {
            self.line(middle - half, middle + half, DebugView::CONTACT);
        }
    }
}
