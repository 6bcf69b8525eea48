//! Quick range checks of bodies side by side. Where one fails, the check of each body decides.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::response_range::{MASSES, MAX_RESPONSES};
use crate::integrators::state::{Constants, Moments, State};
use crate::math::Real;
use crate::range::{MAX_DISTANCE_OF_CONTACTS, MAX_IMPULSE, MAX_SPEED};
use crate::simd::Tile;

/// Whether bodies with points at most this far from their centres \[m\] are where contacts can be
/// found, and answer to impulses by numbers in range: sums are in the place of largest numbers, so
/// that what is at the limit may not be, nor is what is not a number.
#[inline(always)]
pub(crate) fn are_clearly_in_range<T: Tile>(constants: &Constants<T>, state: &State<T>, radius: T) -> T::Mask {
    let (mass, linear, angular) = (constants.mass, size(state.linear), size(state.angular));
    let mut in_range = below(size(state.position), MAX_DISTANCE_OF_CONTACTS)
        * rotates(state.orientation)
        * between(mass, *MASSES.start(), *MASSES.end())
        * below(linear * (T::splat(1.0) / mass), MAX_SPEED)
        * below(angular, MAX_IMPULSE);
    if let Some(Moments { inverse_moments: Vec3 { x, y, z }, axes, .. }) = constants.inertia {
        let most = x + y + z;
        in_range = in_range
            * between(x.min(y).min(z), 0.0, MAX_RESPONSES[1])
            * below(most, MAX_RESPONSES[1])
            * below(radius * most * radius, MAX_RESPONSES[0])
            * below(angular * most, MAX_SPEED);
        if let Some(axes) = axes {
            in_range = in_range * rotates(axes);
        }
    }
    T::splat(0.0).lt(in_range)
}

/// The sum of the absolute values of the coordinates: no less than any of them, and not a number
/// where one of them is not.
#[inline(always)]
pub(crate) fn size<T: Tile>(v: Vec3<T>) -> T {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// One where a number is below the limit, else zero.
#[inline(always)]
pub(crate) fn below<T: Tile>(number: T, most: Real) -> T {
    T::select(number.lt(T::splat(most.into())), T::splat(1.0), T::splat(0.0))
}

/// One where a number is between the limits, else zero.
#[inline(always)]
fn between<T: Tile>(number: T, least: Real, most: Real) -> T {
    T::select(T::splat(least.into()).lt(number), below(number, most), T::splat(0.0))
}

/// One for what is clearly a rotation, else zero.
#[inline(always)]
fn rotates<T: Tile>(q: Quat<T>) -> T {
    between(q.length_squared(), 0.25, 4.0)
}
