//! Surface materials: friction, restitution, rolling resistance, surface velocity, combine rules.

use crate::collision::collider_error::ColliderError;
use crate::math::{Real, Vec3};

/// Friction, restitution and rolling resistance of a [`Collider`](crate::Collider). Rules and
/// fields are those of KHR_physics_rigid_bodies, and resistance to rolling.
///
/// ```
/// use tumble::{Collider, Material, Shape};
///
/// let ice = Material {
///     friction_combine: tumble::CombineRule::Minimum,
///     ..Material::default().with_friction(0.02)
/// };
/// let puck = Collider::new(&Shape::cuboid([0.04, 0.04, 0.04]))?.with_material(ice)?;
/// assert_eq!(puck.material().dynamic_friction, 0.02);
/// # Ok::<(), tumble::ColliderError>(())
/// ```
#[doc(alias("friction", "restitution", "bounciness", "physics material"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Coefficient of friction while nothing slides: it begins to at a force of this times the
    /// normal force.
    pub static_friction: Real,
    /// Coefficient of friction of what slides.
    pub dynamic_friction: Real,
    /// Speed after a bounce over speed before it, from 0 to 1.
    pub restitution: Real,
    /// Resistance to rolling as a length \[m\]: the torque it resists with is this times the normal
    /// force. Of two surfaces the greater counts.
    pub rolling_resistance: Real,
    /// Velocity of the surface relative to the body, in the frame of the collider \[m/s\]: that of
    /// a conveyor belt. Friction drags bodies in contact along with it; the part along the normal
    /// does nothing.
    ///
    /// ```
    /// use tumble::{Material, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let belt = Material::default().with_surface_velocity(Vec3::X * 2.0);
    /// RigidBody::ground().material(belt).build()?.spawn(&mut world);
    /// let parcel = RigidBody::new(Shape::cuboid([0.5, 0.2, 0.5])).mass(3.0);
    /// let parcel = parcel.position(Vec3::Y * 0.2).build()?.spawn(&mut world);
    ///
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 120);
    /// assert!((world.get::<&Velocity>(parcel)?.linear.x - 2.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub surface_velocity: Vec3,
    /// How the coefficients of friction of two surfaces become one.
    pub friction_combine: CombineRule,
    /// How the restitutions of two surfaces become one.
    pub restitution_combine: CombineRule,
}

/// No surface is faster \[m/s\].
pub(crate) const MAX_SURFACE_SPEED: Real = 1e6;

impl Default for Material {
    /// Friction of one half, no bounce.
    fn default() -> Self {
        Self::new(0.5, 0.0)
    }
}

impl Material {
    /// A surface with one coefficient of friction, and a restitution.
    ///
    /// ```
    /// # use tumble::Material;
    /// let rubber = Material::default().with_friction(0.8).with_restitution(0.3);
    /// assert_eq!(rubber, Material::new(0.8, 0.3));
    /// ```
    #[must_use]
    pub fn new(friction: Real, restitution: Real) -> Self {
        Self {
            static_friction: friction,
            dynamic_friction: friction,
            restitution,
            rolling_resistance: 0.0,
            surface_velocity: Vec3::ZERO,
            friction_combine: CombineRule::Average,
            restitution_combine: CombineRule::Average,
        }
    }

    /// The same with one coefficient of friction, at rest and while it slides.
    #[must_use]
    pub fn with_friction(self, friction: Real) -> Self {
        Self { static_friction: friction, dynamic_friction: friction, ..self }
    }

    /// The same with another restitution: speed after a bounce over speed before it, from 0 to 1.
    #[doc(alias("bounciness", "elasticity"))]
    #[must_use]
    pub fn with_restitution(self, restitution: Real) -> Self {
        Self { restitution, ..self }
    }

    /// The same with another resistance to rolling, a length \[m\].
    #[must_use]
    pub fn with_rolling_resistance(self, rolling_resistance: Real) -> Self {
        Self { rolling_resistance, ..self }
    }

    /// The same with a surface that moves relative to the body, in the frame of the collider [m/s].
    #[doc(alias = "conveyor belt")]
    #[must_use]
    pub fn with_surface_velocity(self, surface_velocity: Vec3) -> Self {
        Self { surface_velocity, ..self }
    }

    pub(crate) fn check(&self) -> Result<(), ColliderError> {
        let numbers = [
            ("static_friction", self.static_friction, Real::MAX),
            ("dynamic_friction", self.dynamic_friction, Real::MAX),
            ("restitution", self.restitution, 1.0),
            ("rolling_resistance", self.rolling_resistance, Real::MAX),
            ("surface_velocity", self.surface_velocity.length(), MAX_SURFACE_SPEED),
        ];
        match numbers.into_iter().find(|(_, value, most)| !(0.0..=*most).contains(value)) {
            Some((field, value, most)) => Err(ColliderError::Material { field, value, most }),
            None => Ok(()),
        }
    }
}

/// How two coefficients become one. Where two surfaces ask for different ways, the first of them in
/// this order counts.
///
/// ```
/// use tumble::CombineRule;
///
/// assert_eq!(CombineRule::of((0.5, CombineRule::Multiply), (0.25, CombineRule::Minimum)), 0.25);
/// assert_eq!(CombineRule::of((0.5, CombineRule::Multiply), (0.25, CombineRule::Multiply)), 0.125);
/// ```
#[doc(alias = "CoefficientCombine")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum CombineRule {
    /// Their mean.
    #[default]
    Average,
    /// The smaller.
    Minimum,
    /// The larger.
    Maximum,
    /// Their product.
    Multiply,
}

impl CombineRule {
    /// One coefficient out of two surfaces'.
    #[must_use]
    pub fn of((a, way_a): (Real, Self), (b, way_b): (Real, Self)) -> Real {
        match way_a.min(way_b) {
            Self::Average => 0.5 * (a + b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Multiply => a * b,
        }
    }
}

/// Two surfaces that touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub(crate) static_friction: Real,
    pub(crate) dynamic_friction: Real,
    pub(crate) restitution: Real,
    pub(crate) rolling_resistance: Real,
}

impl Surface {
    pub(crate) fn between(a: &Material, b: &Material) -> Self {
        // Infinite it would hold, with no impulse at all, what does not touch.
        let friction = |of: fn(&Material) -> Real| {
            CombineRule::of((of(a), a.friction_combine), (of(b), b.friction_combine)).min(Real::MAX)
        };
        let dynamic_friction = friction(|material| material.dynamic_friction);
        Self {
            // What is easier to start than to keep going would be neither.
            static_friction: friction(|material| material.static_friction).max(dynamic_friction),
            dynamic_friction,
            restitution: CombineRule::of(
                (a.restitution, a.restitution_combine),
                (b.restitution, b.restitution_combine),
            ),
            rolling_resistance: a.rolling_resistance.max(b.rolling_resistance),
        }
    }
}
