//! The camera behind the hero's shoulder or the car.

use macroquad::prelude as mq;
use tumble::prelude::*;
use tumble_character::CharacterState;

use crate::draw::screen;
use crate::game::{Game, direction, head_height};
use crate::hand::shoulder;

/// Radians for each pixel of the mouse.
const MOUSE: Real = 0.0025;

#[derive(Default)]
pub(crate) struct Camera {
    pub(crate) yaw: Real,
    pub(crate) pitch: Real,
    mouse: Option<(f32, f32)>,
    /// Height of the head, which follows steps smoothly, and how far back it is \[m\].
    height: Option<Real>,
    back: Real,
    /// What it follows, and how far it is from there yet since that was another \[m\].
    driving: bool,
    pivot: Vec3,
    behind: Vec3,
}

impl Camera {
    /// Turns as the mouse moves, where the window has it.
    pub(crate) fn turn(&mut self, grabbed: bool) {
        let now = mq::mouse_position();
        if let (Some(last), true) = (self.mouse.replace(now), grabbed) {
            self.yaw -= Real::from(now.0 - last.0) * MOUSE;
            self.pitch = (self.pitch - Real::from(now.1 - last.1) * MOUSE).clamp(-1.3, 1.3);
        }
    }

    /// Where it is for a frame, as far as there is room behind.
    pub(crate) fn follow(&mut self, game: &Game, alpha: Real, seconds: Real) -> mq::Camera3D {
        let (yard, driving) = (&game.yard, game.player.driving);
        let body = game.drawn(if driving { yard.car } else { yard.hero }, alpha);
        let crouches = game.world.get::<&CharacterState>(yard.hero).is_ok_and(|state| state.is_crouching);
        let wanted = body.position.y + if driving { 1.1 } else { head_height(crouches) };
        let near = |rate: Real| 1.0 - (-rate * seconds).exp();
        let reach = if driving { 6.5 } else { 3.2 };
        if self.height.is_none() {
            self.back = reach;
        }
        let height = self.height.unwrap_or(wanted);
        let height = height + (wanted - height) * near(16.0);
        self.height = Some(height);
        if driving {
            let ahead = body.orientation * Vec3::Z;
            let turn = Real::atan2(-ahead.x, -ahead.z) - self.yaw;
            self.yaw += Real::atan2(turn.sin(), turn.cos()) * near(2.0);
        }

        let queries = game.simulation.queries(&game.world);
        let head = Vec3::new(body.position.x, height, body.position.z);
        let pivot = if driving { head } else { shoulder(&queries, yard, head, self.yaw) };
        if std::mem::replace(&mut self.driving, driving) != driving {
            self.behind = self.pivot - pivot;
        }
        self.behind -= self.behind * near(8.0);
        self.pivot = pivot + self.behind;
        let way = direction(self.yaw, self.pitch);
        let ray = Ray::new(self.pivot, -way).with_max_distance(self.back.max(reach) + 0.3);
        // What moves does not push the camera about.
        let filter = QueryFilter::new().without_dynamic().without_kinematic();
        let room = queries.cast_ray(&ray, &filter).map_or(Real::INFINITY, |hit| (hit.distance - 0.3).max(0.1));
        self.back = (self.back + (reach - self.back) * near(6.0)).min(room);
        mq::Camera3D {
            position: screen(self.pivot - way * self.back),
            target: screen(self.pivot + way * 10.0),
            up: mq::Vec3::Y,
            fovy: 1.05,
            z_near: 0.1,
            z_far: 300.0,
            ..Default::default()
        }
    }
}
