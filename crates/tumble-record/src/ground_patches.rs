//! Pieces of infinite ground, for files and pictures.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::TriangleMesh;

use tumble_import::Appearance;

/// Corners of a plate that nothing cuts.
const CORNERS: usize = 48;
/// The arm of a unit circle's next corner: `(1 - t^2)/(1 + t^2)` and `2 t/(1 + t^2)` with t =
/// tan(pi/48), so that no sine is needed.
const TANGENT: f64 = 0.065_543_462_815_238_23;

/// For each half-space, given by the place and the orientation of its frame, a flat piece of its
/// surface: a disc of the radius about the place nearest to `middle`, cut off where it would be
/// inside of another half-space. So ground alone is a disc, and five that look inward are an open
/// box.
///
/// Coordinates are in the half-space's own frame, seen from its outside anticlockwise. `None` where
/// nothing is left.
///
/// ```
/// use tumble::glam::{DQuat, DVec3};
/// use tumble_import::Appearance;
/// use tumble_record::ground_patches;
///
/// let ground = (DVec3::ZERO, DQuat::IDENTITY);
/// let plate = ground_patches(&[ground], DVec3::new(7.0, 5.0, 0.0), 2.0).remove(0);
/// let Some(Appearance::Mesh(disc)) = plate else { return };
/// assert!(disc.positions().iter().all(|corner| corner.y == 0.0 && (corner.x - 7.0).abs() < 2.01));
/// ```
#[must_use]
pub fn ground_patches(half_spaces: &[(DVec3, DQuat)], middle: DVec3, radius: f64) -> Vec<Option<Appearance>> {
    let plate = |(index, (origin, rotation)): (usize, &(DVec3, DQuat))| {
        let others = half_spaces.iter().enumerate().filter(|(other, _)| *other != index);
        let nearest = rotation.conjugate() * (middle - *origin);
        let mut corners = disc(DVec3::new(nearest.x, 0.0, nearest.z), radius);
        for (_, (other, turn)) in others {
            let normal = rotation.conjugate() * (*turn * DVec3::Y);
            let height = (rotation.conjugate() * (*other - *origin)).dot(normal);
            // What lies in nearly the same plane would be cut along a line of rounding.
            if normal.x.hypot(normal.z) > 1e-6 {
                corners = above(&corners, normal, height);
            }
        }
        let count = corners.len() as u32;
        let triangles: Vec<[u32; 3]> = (2..count).map(|corner| [0, corner - 1, corner]).collect();
        if triangles.is_empty() {
            return None;
        }
        TriangleMesh::new(corners, triangles).ok().map(|mesh| Appearance::Mesh(Arc::new(mesh)))
    };
    half_spaces.iter().enumerate().map(plate).collect()
}

fn disc(middle: DVec3, radius: f64) -> Vec<DVec3> {
    let square = TANGENT * TANGENT;
    let (cos, sin) = ((1.0 - square) / (1.0 + square), 2.0 * TANGENT / (1.0 + square));
    let next = |arm: &DVec3| Some(DVec3::new(arm.x * cos + arm.z * sin, 0.0, arm.z * cos - arm.x * sin));
    std::iter::successors(Some(DVec3::X * radius), next).take(CORNERS).map(|arm| middle + arm).collect()
}

/// The part of a convex polygon where `normal . x` is at least `height` (Sutherland and Hodgman,
/// 1974).
fn above(corners: &[DVec3], normal: DVec3, height: f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (corner, next) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let [here, there] = [corner, next].map(|point| normal.dot(*point) - height);
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            let cut = *corner + (*next - *corner) * (here / (here - there));
            kept.push(DVec3::new(cut.x, 0.0, cut.z));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn mesh(appearance: &Option<Appearance>) -> &TriangleMesh {
        match appearance {
            Some(Appearance::Mesh(mesh)) => mesh,
            other => panic!("{other:?} is no plate"),
        }
    }

    /// With its sign: above zero as all corners are seen anticlockwise from above.
    fn area(mesh: &TriangleMesh) -> f64 {
        let corner = |index: u32| mesh.positions()[index as usize];
        mesh.triangles().iter().map(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).y / 2.0).sum()
    }

    #[test]
    fn ground_alone_is_a_disc_below_the_middle() {
        let turn = DQuat::from_rotation_x(0.3);
        let ground_patches = ground_patches(&[(DVec3::new(1.0, 2.0, 3.0), turn)], DVec3::new(5.0, 9.0, -4.0), 2.0);
        let disc = mesh(&ground_patches[0]);
        // A regular polygon of 48 corners.
        let expected = 0.5 * 48.0 * 4.0 * (2.0 * PI / 48.0).sin();
        assert!((area(disc) / expected - 1.0).abs() < 1e-12, "{} {expected}", area(disc));
        let center = disc.positions().iter().sum::<DVec3>() / disc.positions().len() as f64;
        let below = turn.conjugate() * DVec3::new(4.0, 7.0, -7.0);
        assert!((center - DVec3::new(below.x, 0.0, below.z)).length() < 1e-12, "{center}");
    }

    #[test]
    fn five_that_look_inward_are_an_open_box() {
        let wall = |place: DVec3, turn: DQuat| (place, turn);
        let half_spaces = [
            wall(DVec3::ZERO, DQuat::IDENTITY),
            wall(DVec3::X * 2.0, DQuat::from_rotation_z(FRAC_PI_2)),
            wall(DVec3::X * -2.0, DQuat::from_rotation_z(-FRAC_PI_2)),
            wall(DVec3::Z * 3.0, DQuat::from_rotation_x(-FRAC_PI_2)),
            wall(DVec3::Z * -3.0, DQuat::from_rotation_x(FRAC_PI_2)),
        ];
        let ground_patches = ground_patches(&half_spaces, DVec3::Y, 50.0);
        assert!((area(mesh(&ground_patches[0])) - 24.0).abs() < 1e-9, "{}", area(mesh(&ground_patches[0])));
        for (plate, (place, turn)) in ground_patches.iter().zip(&half_spaces).skip(1) {
            let corners: Vec<DVec3> = mesh(plate).positions().iter().map(|corner| *place + *turn * *corner).collect();
            assert!(corners.iter().all(|at| at.x.abs() < 2.0 + 1e-9 && at.y > -1e-9 && at.z.abs() < 3.0 + 1e-9));
            assert!(corners.iter().any(|at| at.y > 40.0), "walls have no upper end");
            assert!(area(mesh(plate)) > 0.0);
        }
    }

    #[test]
    fn ground_under_ground_is_not_seen() {
        let steep = DQuat::from_rotation_x(0.2);
        let half_spaces = [(DVec3::ZERO, steep), (DVec3::Y * 30.0, DQuat::IDENTITY)];
        let ground_patches = ground_patches(&half_spaces, DVec3::ZERO, 10.0);
        assert_eq!(ground_patches[0], None);
        assert!(ground_patches[1].is_some());
    }
}
