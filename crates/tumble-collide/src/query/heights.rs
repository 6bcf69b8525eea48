//! Which cells of a height field are along a line, and around a point.

use crate::height_field::HeightField;
use crate::mesh;
use crate::query::line::{Line, component, in_slab};
use crate::support_map::Vector;
use crate::surface::Surface;

/// What is nearer than this part of a cell to the next one is in both.
const BESIDE: f64 = 1e-9;
/// Part of a distance that rounding may be, and more.
const ROUNDING: f64 = 1e-12;
/// The axes that columns and rows are counted along.
const AXES: [usize; 2] = [0, 2];

/// As [`Surface::along`], slice by slice along the axis on which the line crosses more cells.
pub(crate) fn along(field: &HeightField, line: &Line, half: Vector, mut most: f64, visit: &mut dyn FnMut(u32) -> f64) {
    // Triangles decide what is met; their box must not, by rounding.
    let far = line.point.dot(line.point).sqrt() + field.aabb().low.dot(field.aabb().low).sqrt();
    let reach = half + Vector::splat(ROUNDING * far);
    let (low, high) = (field.aabb().low - reach, field.aabb().high + reach);
    let slab = |axis: usize| in_slab(line, axis, [component(low, axis), component(high, axis)]);
    let all = slab(0).and_then(|span| span.and(slab(2)?)?.and(slab(1)?));
    let Some((from, to)) = all.map(|span| (span.from.max(0.0), span.to.min(most))) else { return };
    if from > to {
        return;
    }
    let cells = field.cells();
    let spacing = field.spacing();
    let [major, minor] = if component(line.along, 2).abs() / spacing[1] > component(line.along, 0).abs() / spacing[0] {
        [1, 0]
    } else {
        [0, 1]
    };
    let (point, direction) = (component(line.point, AXES[major]), component(line.along, AXES[major]));
    let first_edge = component(field.aabb().low, AXES[major]);
    let slices = cells_between(field, line, half, (major, [from, to]));
    for slice in in_order(slices, direction >= 0.0) {
        // The part of the way on which the box is over the slice.
        let edge = |number: usize| first_edge + number as f64 * spacing[major];
        let reach = component(half, AXES[major]);
        let bounds = [edge(slice) - reach, edge(slice + 1) + reach].map(|edge| (edge - point) / direction);
        let (enter, leave) = (bounds[0].min(bounds[1]).max(from), bounds[0].max(bounds[1]).min(to));
        // Along the slices, all of the way is in one.
        let (enter, leave) = if enter <= leave { (enter, leave) } else { (from, to) };
        if enter > most {
            break;
        }
        let heights = [enter, leave].map(|distance| line.at(distance).y);
        let heights = [heights[0].min(heights[1]) - half.y, heights[0].max(heights[1]) + half.y];
        for cell in cells_between(field, line, half, (minor, [enter, leave])) {
            let [column, row] = if major == 0 { [slice, cell] } else { [cell, slice] };
            let first = 2 * (row * cells[0] + column) as u32;
            let aabbs = [first, first + 1].map(|triangle| (triangle, mesh::around(&field.triangle(triangle))));
            // Rounding of the heights is less than this.
            let slack = 1e-9 * (1.0 + heights[0].abs() + heights[1].abs());
            for (triangle, aabb) in aabbs {
                if aabb.low.y <= heights[1] + slack && heights[0] - slack <= aabb.high.y {
                    most = visit(triangle);
                }
            }
        }
    }
}

/// Columns or rows over which a box is that reaches `half` \[m\] from a line, on a part of its way.
fn cells_between(
    field: &HeightField,
    line: &Line,
    half: Vector,
    (which, way): (usize, [f64; 2]),
) -> std::ops::RangeInclusive<usize> {
    let (axis, cells) = (AXES[which], field.cells()[which]);
    let places = way.map(|distance| component(line.at(distance), axis) - component(field.aabb().low, axis));
    let spacing = field.spacing()[which];
    let cell = |place: f64| ((place / spacing).max(0.0) as usize).min(cells - 1);
    let reach = component(half, axis) + BESIDE * spacing;
    cell(places[0].min(places[1]) - reach)..=cell(places[0].max(places[1]) + reach)
}

fn in_order(range: std::ops::RangeInclusive<usize>, is_upward: bool) -> impl Iterator<Item = usize> {
    let (low, high) = range.into_inner();
    (0..=high - low).map(move |step| if is_upward { low + step } else { high - step })
}

/// As [`Surface::around`], in rings about the cell nearest to the point.
pub(crate) fn around(field: &HeightField, point: Vector, mut most: f64, visit: &mut dyn FnMut(u32) -> f64) {
    let cells = field.cells().map(|cells| cells as i64);
    let spacing = field.spacing();
    let nearest = |which: usize| {
        let place = component(point, AXES[which]) - component(field.aabb().low, AXES[which]);
        // A number out of range becomes the nearest that is in it.
        ((place / spacing[which]).max(0.0) as i64).min(cells[which] - 1)
    };
    let center = [nearest(0), nearest(1)];
    let is_far = |steps: i64, which: usize, most: f64| (steps - 1).max(0) as f64 * spacing[which] > most;
    for ring in 0..cells[0].max(cells[1]) {
        if is_far(ring, 0, most) && is_far(ring, 1, most) {
            break;
        }
        for row in (center[1] - ring).max(0)..=(center[1] + ring).min(cells[1] - 1) {
            let is_end = (row - center[1]).abs() == ring;
            let step = if is_end { 1 } else { (2 * ring).max(1) };
            for column in (center[0] - ring..=center[0] + ring).step_by(step as usize) {
                let is_outside = !(0..cells[0]).contains(&column);
                if is_outside || is_far((column - center[0]).abs(), 0, most) || is_far((row - center[1]).abs(), 1, most)
                {
                    continue;
                }
                let first = 2 * (row * cells[0] + column) as u32;
                for triangle in [first, first + 1] {
                    if mesh::around(&field.triangle(triangle)).distance(point) <= most {
                        most = visit(triangle);
                    }
                }
            }
        }
    }
}
