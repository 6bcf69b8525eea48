//! The free motion of the bodies of a mechanism, four at a time.

use tumble_math::FreeRotation;
use tumble_math::lane::{Quat, Vec3};

use crate::integrators::state::Moments;
use crate::simd::{Four, FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::mechanism_body::MechanismBody;

/// From where bodies drift, and the inertia that they drift with.
#[derive(Clone, Debug)]
pub(crate) struct Drift {
    fours: Vec<FourBodies>,
}

/// Numbers of four bodies side by side.
#[derive(Clone, Copy, Debug)]
struct FourBodies {
    translation: [Four; 3],
    orientation: [Four; 4],
    inverse_mass: Four,
    moments: [Four; 3],
    inverse_moments: [Four; 3],
}

impl FourBodies {
    /// Of bodies that stay where they are.
    const NONE: Self = Self {
        translation: [[0.0; 4]; 3],
        orientation: [[0.0; 4], [0.0; 4], [0.0; 4], [1.0; 4]],
        inverse_mass: [1.0; 4],
        moments: [[1.0; 4]; 3],
        inverse_moments: [[1.0; 4]; 3],
    };

    fn set(&mut self, place: usize, body: &MechanismBody) {
        set(&mut self.translation, place, numbers(body.translation));
        let Quat { x, y, z, w } = body.orientation;
        set(&mut self.orientation, place, [x, y, z, w]);
        // What is not dynamic has velocities for momenta.
        self.inverse_mass[place] = if body.inverse_mass == 0.0 { 1.0 } else { body.inverse_mass };
        if body.turns {
            set(&mut self.moments, place, numbers(body.moments));
            set(&mut self.inverse_moments, place, numbers(body.inverse_moments));
        }
    }

    /// The translations and orientations after `h` \[s\] with linear and angular momenta.
    #[inline(always)]
    fn drift<T: FourLane>(&self, momenta: &[[Four; 3]; 2], h: f64) -> ([Four; 3], [Four; 4]) {
        let h = T::splat(h);
        let [linear, angular] = [vector::<T>(&momenta[0]), vector::<T>(&momenta[1])];
        let translation = vector::<T>(&self.translation) + linear * T::load(&self.inverse_mass) * h;
        let (moments, inverses) = (vector::<T>(&self.moments), vector::<T>(&self.inverse_moments));
        let turned = FreeRotation::new(moments, inverses, None, h).rotate(rotation(&self.orientation), angular);
        let (mut at, mut along) = ([[0.0; 4]; 3], [[0.0; 4]; 4]);
        store(translation, &mut at);
        turned.x.store(&mut along[0]);
        turned.y.store(&mut along[1]);
        turned.z.store(&mut along[2]);
        turned.w.store(&mut along[3]);
        (at, along)
    }
}

impl Drift {
    /// With room for this many bodies.
    pub(crate) fn with_capacity(bodies: usize) -> Self {
        Self { fours: Vec::with_capacity(bodies.div_ceil(4)) }
    }

    /// Takes over where bodies are, and their moments.
    pub(crate) fn begin_at(&mut self, bodies: &[MechanismBody]) {
        self.fours.clear();
        for bodies in bodies.chunks(4) {
            let mut four = FourBodies::NONE;
            bodies.iter().enumerate().for_each(|(place, body)| four.set(place, body));
            self.fours.push(four);
        }
    }

    /// Moves the same bodies from there for `h` \[s\], without what turns with them but their
    /// orientations.
    pub(crate) fn run(&self, bodies: &mut [MechanismBody], h: f64) {
        dispatch_fours(Run { drift: self, bodies, h });
    }

    /// Lets the inverse inertia of the bodies follow their orientations.
    pub(crate) fn end(&self, bodies: &mut [MechanismBody]) {
        dispatch_fours(End { drift: self, bodies });
    }
}

struct End<'a> {
    drift: &'a Drift,
    bodies: &'a mut [MechanismBody],
}

impl FourKernel for End<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        for (four, bodies) in self.drift.fours.iter().zip(self.bodies.chunks_mut(4)) {
            let mut orientation = FourBodies::NONE.orientation;
            for (place, body) in bodies.iter().enumerate() {
                let Quat { x, y, z, w } = body.orientation;
                set(&mut orientation, place, [x, y, z, w]);
            }
            let inverse_moments = vector::<T>(&four.inverse_moments);
            let moments = Moments { moments: inverse_moments, inverse_moments, axes: None };
            let (diagonal, off_diagonal) = moments.inverse_in_world(rotation(&orientation));
            let mut inertia = [[[0.0; 4]; 3]; 2];
            store(diagonal, &mut inertia[0]);
            store(off_diagonal, &mut inertia[1]);
            for (place, body) in bodies.iter_mut().enumerate().filter(|(_, body)| body.turns) {
                body.inverse_inertia = [at(&inertia[0], place), at(&inertia[1], place)];
            }
        }
    }
}

struct Run<'a> {
    drift: &'a Drift,
    bodies: &'a mut [MechanismBody],
    h: f64,
}

impl FourKernel for Run<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { drift, bodies, h } = self;
        for (four, bodies) in drift.fours.iter().zip(bodies.chunks_mut(4)) {
            let mut momenta = [[[0.0; 4]; 3]; 2];
            for (place, body) in bodies.iter().enumerate() {
                set(&mut momenta[0], place, numbers(body.linear));
                if body.turns {
                    set(&mut momenta[1], place, numbers(body.angular));
                }
            }
            let (at, along) = four.drift::<T>(&momenta, h);
            for (place, body) in bodies.iter_mut().enumerate() {
                body.translation = self::at(&at, place);
                if body.turns {
                    let [x, y, z, w] = along;
                    body.orientation = Quat { x: x[place], y: y[place], z: z[place], w: w[place] };
                } else if body.inverse_mass == 0.0 {
                    let [x, y, z, w] = four.orientation;
                    let orientation = Quat { x: x[place], y: y[place], z: z[place], w: w[place] };
                    body.orientation = tumble_math::rotate_exactly(orientation, body.angular, h);
                }
            }
        }
    }
}

#[inline(always)]
fn set<const N: usize>(numbers: &mut [Four; N], place: usize, values: [f64; N]) {
    let mut i = 0;
    while i < N {
        numbers[i][place] = values[i];
        i += 1;
    }
}

#[inline(always)]
fn vector<T: FourLane>([x, y, z]: &[Four; 3]) -> Vec3<T> {
    Vec3::new(T::load(x), T::load(y), T::load(z))
}

#[inline(always)]
fn store<T: FourLane>(v: Vec3<T>, [x, y, z]: &mut [Four; 3]) {
    v.x.store(x);
    v.y.store(y);
    v.z.store(z);
}

#[inline(always)]
fn rotation<T: FourLane>([x, y, z, w]: &[Four; 4]) -> Quat<T> {
    Quat { x: T::load(x), y: T::load(y), z: T::load(z), w: T::load(w) }
}

/// Of one body.
#[inline(always)]
fn at([x, y, z]: &[Four; 3], place: usize) -> Vec3<f64> {
    Vec3::new(x[place], y[place], z[place])
}

#[inline(always)]
fn numbers(v: Vec3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}
