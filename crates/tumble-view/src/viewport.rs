//! What is seen: a scene that is being run, from a camera, with layers on or off.

mod acts;
mod scenery;
mod surfaces;

use std::time::Duration;

use macroquad::miniquad::RenderPass;
use tumble::glam::{DVec2, DVec3};
use tumble::{DebugView, Totals};
use tumble_scene::Scene;

use crate::arrows::{self, Largest};
use crate::bodies::Placed;
use crate::camera::{Camera, DISTANCES, View};
use crate::clock::Instant;
use crate::convert::{dvec3, single3};
use crate::failure::Failure;
use crate::framing::{self, Frame};
use crate::gpu::{Background, Gpu, Picture, Renderer};
use crate::hand::Hand;
use crate::layers::{Layer, Layers};
use crate::lines::{Line, Marks};
use crate::options::ViewOptions;
use crate::overlay::{Label, Overlay};
use crate::page;
use crate::playback::Playback;
use crate::readout::{self, Row};
use crate::sunlight::{ShadowFrame, Sun};
use crate::timing::FrameTimes;
use crate::tuning::Tuning;

/// A camera that stays lets the bodies go so far from the middle, in radii of the frame, before it
/// moves with them.
const LEEWAY: f64 = 0.12;
/// Names of more bodies cover each other.
const MAX_NAMES: usize = 300;
/// Infinite ground is seen up to this many radii of the frame.
const SEEN: f64 = 6.0;
/// Up to this many lines of contacts and colliders are seen through bodies: some two hundred
/// points. More would hide the bodies.
const MAX_THROUGH: usize = 1500;

/// What stays in the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Follow {
    /// A place.
    Nothing,
    /// The common centre of mass of the bodies, with some leeway.
    All,
    /// One body, by its index.
    Body(usize),
}

/// Everything but the window.
pub(crate) struct Viewport {
    pub(crate) playback: Playback,
    pub(crate) layers: Layers,
    pub(crate) camera: Camera,
    sun: Sun,
    pub(crate) follow: Follow,
    pub(crate) picked: Option<usize>,
    hand: Option<Hand>,
    pub(crate) tuning: Tuning,
    /// What went wrong and is to be read in the window.
    pub(crate) notice: Option<String>,
    pub(crate) times: FrameTimes,
    title: String,
    /// The name of a built-in scene, or a file.
    origin: String,
    /// What was in the frame at the start, and with the longest arrows.
    start: Frame,
    whole: Frame,
    /// Where the centre of mass was at the start.
    center: DVec3,
    /// Where it is in the last picture in which it was anywhere.
    center_now: DVec3,
    /// What is followed, which the camera's target is a shift away from.
    anchor: DVec3,
    shift: DVec3,
    largest: Largest,
    arrow_length: f64,
    /// How often the ledger takes its sums: they take time where many bodies attract each other.
    pub(crate) books_every: Duration,
    books: Option<(Instant, Books)>,
}

/// Sums over all bodies, and the hash of their state.
#[derive(Clone, Copy, Debug)]
struct Books {
    totals: Totals,
    hash: u64,
}

/// Where a picture is drawn to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Canvas {
    /// `None` for the window.
    pub(crate) pass: Option<RenderPass>,
    /// In points.
    pub(crate) size: DVec2,
    pub(crate) background: Background,
}

impl Viewport {
    pub(crate) fn new(scene: Scene, options: &ViewOptions) -> Result<Self, Failure> {
        let origin = scene.origin.clone();
        let title = scene.name.clone().unwrap_or_else(|| scene.origin.clone());
        let gravity = dvec3(scene.settings.gravity);
        let playback = Playback::of(scene)?;
        let places = playback.place();
        let start = Frame::of(&playback.bodies, &places);
        let up = options.up.unwrap_or_else(|| framing::up(gravity, playback.bodies.all.len(), &playback.start));
        let moving = || playback.bodies.all.iter().filter(|body| body.moves);
        let turning = moving().filter(|body| body.turns).count();
        let layers = options.show.unwrap_or_else(|| Layers::fitting(moving().count(), turning));
        let arrow_length = arrows::length(moving().map(|body| body.reach), start.radius);
        let whole = Frame { radius: start.radius.max(arrow_length), ..start };
        let mut camera = whole.camera(up, options.size.points());
        if let Some(angles) = options.camera {
            angles.apply(&mut camera);
        }
        let center = center_of_mass(&playback, &places).unwrap_or(start.middle);
        let mut viewport = Self {
            sun: Sun::new(up, camera.yaw),
            camera,
            layers,
            follow: Follow::All,
            picked: None,
            hand: None,
            tuning: Tuning::of(&playback),
            notice: None,
            times: FrameTimes::default(),
            title,
            origin,
            center,
            center_now: center,
            anchor: center,
            shift: start.middle - center,
            start,
            whole,
            largest: Largest::default(),
            arrow_length,
            books_every: Duration::ZERO,
            books: None,
            playback,
        };
        if let Some(name) = &options.pick {
            let found = viewport.playback.bodies.all.iter().position(|body| body.name == *name);
            let found = found.ok_or_else(|| Failure::Input(format!("--pick: no body is called {name:?}")))?;
            viewport.picked = Some(found);
            if options.follow {
                viewport.set_follow(Follow::Body(found));
            }
        }
        Ok(viewport)
    }

    /// What the camera sees in a picture of this size.
    pub(crate) fn view(&self, size: DVec2) -> View {
        self.camera.view(size, 4.0 * self.extent())
    }

    /// How far from the camera's target there is something to see: to the frame of the start, moved
    /// along with the centre of mass \[m\].
    fn extent(&self) -> f64 {
        let middle = self.center_now + (self.start.middle - self.center);
        (self.camera.target - middle).length() + self.start.radius
    }

    /// The view that shows everything again, from a side: yaw and pitch.
    pub(crate) fn look_from(&mut self, yaw: f64, pitch: f64, size: DVec2) {
        self.camera = Camera { target: self.camera.target, ..self.whole.camera(self.camera.up, size) };
        self.camera.yaw = yaw;
        self.camera.pitch = 0.0;
        self.camera.turn(0.0, pitch);
        if self.follow != Follow::Nothing {
            self.set_follow(self.follow);
        }
    }

    pub(crate) fn set_follow(&mut self, follow: Follow) {
        let places = self.playback.place();
        self.follow = follow;
        (self.anchor, self.shift) = match follow {
            Follow::Nothing => (DVec3::ZERO, self.camera.target),
            Follow::All => {
                (center_of_mass(&self.playback, &places).unwrap_or(self.center), self.start.middle - self.center)
            }
            Follow::Body(index) => match found(&places, index) {
                Some(place) => (place, DVec3::ZERO),
                None => (self.anchor, self.shift),
            },
        };
    }

    /// Moves the target of the camera by this many points of the picture.
    pub(crate) fn pan(&mut self, by: DVec2, size: DVec2) {
        let view = self.view(size);
        let metres = view.metres_per_point(view.target);
        self.shift += (view.above * by.y - view.right * by.x) * metres;
    }

    /// Moves the camera nearer or farther by a factor.
    pub(crate) fn zoom(&mut self, factor: f64, size: DVec2) {
        let whole = self.whole.camera(self.camera.up, size).distance;
        let [nearest, farthest] = [DISTANCES.start(), DISTANCES.end()].map(|part| part * whole);
        self.camera.distance = (self.camera.distance * factor).clamp(nearest, farthest);
    }

    /// Draws the moment that is shown.
    pub(crate) fn draw(&mut self, gpu: &mut Gpu, renderer: &mut Renderer, canvas: &Canvas, status: String) -> Overlay {
        let places = self.playback.place();
        self.aim(&places);
        let view = self.view(canvas.size);
        let bodies = self.instances(&view, &places);
        let mut marks = self.marks();
        marks.lines.extend(self.hand.and_then(|hand| hand.line(&places)));
        marks.lines.extend(self.frame_of_picked(&view, &places));
        let mut scenery = self.scenery(&places);
        let mut contact_lines = self.contact_lines();
        let lines = if contact_lines.len() <= MAX_THROUGH { &mut marks.lines } else { &mut scenery };
        lines.append(&mut contact_lines);
        let water = self.water();
        let picture = Picture {
            view: &view,
            up: single3(self.camera.up.axis()),
            sun: self.sun,
            shadows: self
                .layers
                .has(Layer::Shadows)
                .then(|| ShadowFrame::new(self.sun, &view, self.shadow_casters(&view, &places))),
            background: canvas.background,
            bodies: &bodies,
            scenery: &scenery,
            marks: &marks.lines,
            water: &water,
        };
        renderer.draw(gpu, canvas.pass, &picture);
        self.overlay(&view, &places, &marks, status)
    }

    /// Turns the camera to what it follows; what is lost leaves it where it is.
    fn aim(&mut self, places: &[Placed]) {
        self.center_now = center_of_mass(&self.playback, places).unwrap_or(self.center_now);
        match self.follow {
            Follow::Nothing => {}
            // A camera that went with what is in the hand would take the hand along.
            _ if self.hand.is_some() => return,
            Follow::All => {
                let off = self.center_now - self.anchor;
                let leeway = LEEWAY * self.start.radius;
                if off.length() > leeway {
                    self.anchor = self.center_now - off.normalize() * leeway;
                }
            }
            Follow::Body(index) => {
                self.anchor = found(places, index).unwrap_or(self.anchor);
            }
        }
        self.camera.target = self.anchor + self.shift;
    }

    /// What the engine draws.
    fn marks(&mut self) -> Marks {
        let mut marks = Marks::default();
        let (layers, length, alpha) = (self.layers, self.arrow_length, self.playback.alpha());
        let largest = &mut self.largest;
        let mut draw = |world: &hecs::World| {
            largest.look(world);
            let view: DebugView = largest.view(layers, length, alpha);
            view.draw(world, &mut marks);
        };
        if layers.has(Layer::Forces) {
            let gravity = self.playback.simulation.settings().gravity;
            arrows::with_forces(&mut self.playback.world, gravity, draw);
        } else {
            draw(&self.playback.world);
        }
        marks
    }

    /// What the engine draws of contacts, and of colliders that differ from what is seen.
    fn contact_lines(&mut self) -> Vec<Line> {
        let mut marks = Marks::default();
        let Playback { simulation, world, bodies, .. } = &self.playback;
        let alpha = self.playback.alpha();
        if self.layers.has(Layer::Contacts) {
            self.largest.look_at_contacts(simulation);
            self.largest.view(self.layers, self.arrow_length, alpha).draw_contacts(simulation, world, &mut marks);
        }
        if self.layers.has(Layer::Colliders) {
            let view = DebugView { colliders: true, alpha, ..DebugView::nothing() };
            for body in bodies.all.iter().filter(|body| body.touches_unseen) {
                view.draw_body(world, body.entity, &mut marks);
            }
        }
        marks.lines
    }

    /// Energy, momentum and hash, not long ago.
    fn books(&mut self) -> Books {
        if let Some((made, books)) = self.books
            && made.elapsed() < self.books_every
        {
            return books;
        }
        let books = Books { totals: self.playback.totals(), hash: self.playback.hash() };
        let playback = &self.playback;
        page::show(&self.origin, playback.simulation.steps(), books.hash, playback.is_untouched());
        self.books = Some((Instant::now(), books));
        books
    }

    fn overlay(&mut self, view: &View, places: &[Placed], marks: &Marks, status: String) -> Overlay {
        let shows_books = self.layers.has(Layer::Ledger);
        let books = (shows_books || page::IS_THERE).then(|| self.books());
        let bodies = &self.playback.bodies.all;
        let mut labels: Vec<Label> = marks
            .labels
            .iter()
            .filter_map(|label| Some((view.project(label.at)?, label.text.clone(), label.color)))
            .collect();
        if self.layers.has(Layer::BodyNames) {
            let named = bodies.iter().zip(places).take(MAX_NAMES).filter_map(|(body, placed)| {
                let at = view.project(placed.center)?;
                let away = body.reach * framing::enlargement(view, placed.center, body.reach, bodies.len());
                let above = (0.7 * away / view.metres_per_point(placed.center)).min(60.0);
                Some((at + DVec2::new(0.3 * above + 4.0, -above - 4.0), body.name.clone(), [0.9, 0.92, 0.95]))
            });
            labels.extend(named);
        }
        let body = self.picked.and_then(|index| bodies.get(index));
        Overlay {
            title: self.title.clone(),
            status,
            layers: self.layers,
            ledger: books.filter(|_| shows_books).map_or_else(Vec::new, |now| self.ledger(&now)),
            settings: if self.layers.has(Layer::Settings) {
                self.tuning.sliders(self.playback.simulation.settings())
            } else {
                Vec::new()
            },
            body: body.map_or_else(Vec::new, |body| readout::body(&self.playback, body)),
            labels,
            notice: self.notice.clone(),
            times: if self.layers.has(Layer::Times) { self.times.clone() } else { FrameTimes::default() },
        }
    }

    fn ledger(&self, Books { totals: now, hash }: &Books) -> Vec<Row> {
        let lost = self.playback.bodies.all.iter().find(|body| now.non_finite == Some(body.entity));
        let lost = lost.map(|body| body.name.as_str());
        let mut rows = readout::ledger(&self.playback.start, (self.playback.scale, self.playback.kept), now, lost);
        rows.push((format!("state {hash:016x}"), String::new()));
        rows
    }
}

/// Of the dynamic bodies; the others have no mass, and those that are lost no place \[m\].
fn center_of_mass(playback: &Playback, places: &[Placed]) -> Option<DVec3> {
    let bodies = playback.bodies.all.iter().zip(places).filter(|(_, placed)| placed.center.is_finite());
    let (mass, moment) = bodies.fold((0.0, DVec3::ZERO), |(mass, moment), (body, placed)| {
        (mass + body.mass, moment + placed.center * body.mass)
    });
    let center = moment / mass;
    (mass > 0.0 && center.is_finite()).then_some(center)
}

/// Where a body is, if it is anywhere \[m\].
fn found(places: &[Placed], index: usize) -> Option<DVec3> {
    places.get(index).map(|placed| placed.center).filter(|center| center.is_finite())
}

#[cfg(test)]
mod tests {
    use tumble::Pose;
    use tumble::math::{Real, Vec3};

    use super::*;
    use crate::options::tests::options;

    pub(super) const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    pub(super) fn viewport(arguments: &[&str]) -> Viewport {
        let options = options(arguments).unwrap();
        Viewport::new(options.scene().unwrap(), &options.view).unwrap()
    }

    fn lose(viewport: &mut Viewport, index: usize) {
        let entity = viewport.playback.bodies.all[index].entity;
        viewport.playback.world.get::<&mut Pose>(entity).unwrap().position = Vec3::splat(Real::NAN);
    }

    fn aim(viewport: &mut Viewport) -> DVec3 {
        viewport.aim(&viewport.playback.place());
        viewport.camera.target
    }

    #[test]
    fn a_lost_body_does_not_throw_the_camera_back() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("falling.json");
        let ball =
            |x| format!(r#"{{ "shape": {{ "sphere": {{ "radius": 0.2 }} }}, "mass": 1, "position": [{x}, 0, 0] }}"#);
        let scene = format!(r#"{{ "gravity": [0, -9.81, 0], "dt": 0.01, "bodies": [ {}, {} ] }}"#, ball(-1), ball(1));
        std::fs::write(&file, scene).unwrap();
        let mut viewport = viewport(&[file.to_str().unwrap()]);
        viewport.playback.go_to(2.0);
        let before = aim(&mut viewport);
        let fallen = before.distance(viewport.start.middle);
        assert!(fallen > 2.0 * viewport.start.radius, "{fallen}");
        lose(&mut viewport, 0);
        // From between the two to the other one, a metre beside.
        let after = aim(&mut viewport);
        assert!(after.distance(before) < 1.1, "{before} {after}");
        lose(&mut viewport, 1);
        assert_eq!(aim(&mut viewport), after);
    }

    #[test]
    fn a_camera_stays_where_the_body_it_followed_was_lost() {
        let mut viewport = viewport(&["raft", "--pick", "box-0-0", "--follow"]);
        viewport.playback.go_to(1.0);
        let last = aim(&mut viewport);
        lose(&mut viewport, 0);
        assert_eq!(aim(&mut viewport), last);
        viewport.set_follow(Follow::Body(0));
        assert_eq!(aim(&mut viewport), last);
        let rows = viewport.ledger(&Books { totals: viewport.playback.totals(), hash: 1 });
        let [.., (named, _), (state, _)] = &rows[..] else { panic!("{rows:?}") };
        assert_eq!([named.as_str(), state], ["not finite: box-0-0", "state 0000000000000001"]);
    }

    /// What is drawn goes as far as the bodies are, also where the camera follows none of them.
    #[test]
    fn a_camera_that_stays_sees_as_far() {
        let mut viewport = viewport(&["satellite"]);
        let follows = viewport.extent();
        assert!(viewport.center.length() > 2.0 * follows, "{} {follows}", viewport.center);
        viewport.set_follow(Follow::Nothing);
        aim(&mut viewport);
        assert_eq!(viewport.extent(), follows);
    }

    #[test]
    fn a_restart_forgets_the_largest_arrows() {
        let mut viewport = viewport(&["t-handle"]);
        viewport.marks();
        assert_ne!(viewport.largest, Largest::default());
        viewport.restart().unwrap();
        assert_eq!(viewport.largest, Largest::default());
    }

    #[test]
    fn the_wheel_goes_as_far_as_the_option() {
        let mut viewport = viewport(&["raft", "--camera", "0,0,1e6"]);
        let farthest = viewport.camera.distance;
        viewport.zoom(1.1, SIZE);
        // A rounding of the product with 1e6.
        assert!((viewport.camera.distance / farthest - 1.0).abs() < 1e-15, "{farthest}");
        viewport.zoom(1e-30, SIZE);
        assert!((viewport.camera.distance / farthest / 1e-12 - 1.0).abs() < 1e-15);
    }
}
