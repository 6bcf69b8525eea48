//! Height fields as collision surfaces: two triangles per grid cell, with validated input.

use std::ops::RangeInclusive;

use thiserror::Error;

use crate::aabb::Aabb;
use crate::query::heights;
use crate::query::line::Line;
use crate::support_map::Vector;
use crate::surface::{Patches, Surface};

/// Ground given by its height at the crossings of a grid, made to be touched from above.
///
/// In its own frame, y is up and the origin is in the middle of the grid at height zero: the height
/// in column `c` and row `r` is at `x = (c - (columns - 1) / 2) spacing_x`,
/// `z = (r - (rows - 1) / 2) spacing_z`. A cell is two triangles that meet on the diagonal from its
/// corner of least x and z.
///
/// ```
/// use tumble_collide::HeightField;
///
/// // A roof: the middle column is a metre above the others.
/// let roof = HeightField::new([0.0, 1.0, 0.0, 0.0, 1.0, 0.0], 3, [2.0, 5.0])?;
/// assert_eq!((roof.columns(), roof.rows()), (3, 2));
/// let error = HeightField::new([0.0, 1.0, 0.0, 0.0], 3, [2.0, 5.0]).unwrap_err();
/// assert_eq!(error.to_string(), "4 heights are no two full rows of 3");
/// # Ok::<(), tumble_collide::HeightFieldError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    points: Vec<Vector>,
    columns: u32,
    rows: u32,
    spacing: [f64; 2],
    aabb: Aabb<f64>,
    patches: Patches,
}

/// Why heights are no ground.
///
/// ```
/// use tumble_collide::{HeightField, HeightFieldError};
/// let error = HeightField::new([0.0, 0.0, f64::NAN, 0.0], 2, [1.0, 1.0]).unwrap_err();
/// assert!(matches!(error, HeightFieldError::Height { index: 2, .. }));
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum HeightFieldError {
    /// There are fewer than two columns or rows, or the last row is not full.
    #[error("{heights} heights are no two full rows of {columns}")]
    Rows {
        /// How many heights were given.
        heights: usize,
        /// How many there are in a row.
        columns: usize,
    },
    /// There are more heights than [`HeightField::MAX`].
    #[error("there are {heights} heights, more than {most}", most = HeightField::MAX)]
    TooMany {
        /// How many were given.
        heights: usize,
    },
    /// A distance of columns or rows is not a length from 1e-6 to 1e6 m.
    #[error("the spacing of {what} must be from 1e-6 to 1e6 m, it is {value:?}")]
    Spacing {
        /// `"columns"` or `"rows"`.
        what: &'static str,
        /// What was given \[m\].
        value: f64,
    },
    /// A height is not finite, or further than 1e6 m from zero.
    #[error("height {index} must be from -1e6 to 1e6 m, it is {value:?}")]
    Height {
        /// Its index, from 0.
        index: usize,
        /// What was given \[m\].
        value: f64,
    },
}

tumble_math::debug_as_display!(HeightFieldError);

impl HeightField {
    /// The most heights.
    pub const MAX: usize = 1 << 26;

    const SPACINGS: RangeInclusive<f64> = 1e-6..=1e6;
    const HEIGHTS: RangeInclusive<f64> = -1e6..=1e6;

    /// From heights \[m\] row by row, how many there are in a row, and the distances of columns
    /// along x and of rows along z \[m\].
    ///
    /// # Errors
    /// [`HeightFieldError`] says what is wrong with the numbers.
    pub fn new(heights: impl AsRef<[f64]>, columns: usize, spacing: [f64; 2]) -> Result<Self, HeightFieldError> {
        let heights = heights.as_ref();
        let count = heights.len();
        if count > Self::MAX {
            return Err(HeightFieldError::TooMany { heights: count });
        }
        if columns < 2 || count < 2 * columns || !count.is_multiple_of(columns) {
            return Err(HeightFieldError::Rows { heights: count, columns });
        }
        for (what, value) in [("columns", spacing[0]), ("rows", spacing[1])] {
            if !Self::SPACINGS.contains(&value) {
                return Err(HeightFieldError::Spacing { what, value });
            }
        }
        if let Some((index, &value)) = heights.iter().enumerate().find(|(_, height)| !Self::HEIGHTS.contains(height)) {
            return Err(HeightFieldError::Height { index, value });
        }
        let rows = count / columns;
        let [wide, deep] = [0.5 * (columns - 1) as f64, 0.5 * (rows - 1) as f64];
        let place = |(index, height): (usize, &f64)| {
            let (column, row) = ((index % columns) as f64, (index / columns) as f64);
            Vector::new((column - wide) * spacing[0], *height, (row - deep) * spacing[1])
        };
        let points: Vec<Vector> = heights.iter().enumerate().map(place).collect();
        let of = |point: Vector| Aabb { low: point, high: point };
        let aabb = points.iter().fold(of(points[0]), |aabb, point| aabb.union(&of(*point)));
        let (columns, rows) = (columns as u32, rows as u32);
        let mut this = Self { points, columns, rows, spacing, aabb, patches: Patches::default() };
        this.patches = Patches::of(&this);
        Ok(this)
    }

    /// How many heights there are along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns as usize
    }

    /// How many heights there are along z.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows as usize
    }

    /// The points of the surface \[m\], row by row.
    #[must_use]
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// The ends \[m\] of each side of the triangles, of two that are next to each other once.
    pub fn edges(&self) -> impl Iterator<Item = [Vector; 2]> + '_ {
        Surface::edges(self)
    }

    /// The box along the axes that holds it.
    pub(crate) fn aabb(&self) -> Aabb<f64> {
        self.aabb
    }

    /// The distances of columns and of rows \[m\].
    pub(crate) fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// How many cells there are along x and along z.
    pub(crate) fn cells(&self) -> [usize; 2] {
        [self.columns as usize - 1, self.rows as usize - 1]
    }

    /// Column and row of a triangle's cell, and which of the two it is.
    fn cell(&self, triangle: u32) -> (u32, u32, bool) {
        let (cell, wide) = (triangle / 2, self.columns - 1);
        (cell % wide, cell / wide, triangle % 2 == 1)
    }
}

impl Surface for HeightField {
    fn count(&self) -> u32 {
        2 * (self.columns - 1) * (self.rows - 1)
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        let (column, row, second) = self.cell(triangle);
        let here = row * self.columns + column;
        let (along_z, opposite, along_x) = (here + self.columns, here + self.columns + 1, here + 1);
        if second { [here, opposite, along_x] } else { [here, along_z, opposite] }
    }

    fn point(&self, number: u32) -> Vector {
        self.points[number as usize]
    }

    fn across(&self, triangle: u32, side: usize) -> Option<u32> {
        let (column, row, second) = self.cell(triangle);
        let wide = self.columns - 1;
        match (second, side) {
            (false, 0) => (column > 0).then(|| triangle - 1),
            (false, 1) => (row + 2 < self.rows).then(|| triangle + 2 * wide + 1),
            (false, _) => Some(triangle + 1),
            (true, 0) => Some(triangle - 1),
            (true, 1) => (column + 1 < wide).then(|| triangle + 1),
            (true, _) => (row > 0).then(|| triangle - 2 * wide - 1),
        }
    }

    fn corners_beside(&self, corner: u32, visit: &mut dyn FnMut(u32)) {
        let (column, row) = (corner % self.columns, corner / self.columns);
        let (left, right) = (column > 0, column + 1 < self.columns);
        let (back, front) = (row > 0, row + 1 < self.rows);
        let step = self.columns;
        for (exists, end) in [
            (left, corner.wrapping_sub(1)),
            (right, corner + 1),
            (back, corner.wrapping_sub(step)),
            (front, corner + step),
            (left && back, corner.wrapping_sub(step + 1)),
            (right && front, corner + step + 1),
        ] {
            if exists {
                visit(end);
            }
        }
    }

    fn near(&self, aabb: &Aabb<f64>, visit: &mut dyn FnMut(u32)) {
        if !self.aabb.meets(aabb) {
            return;
        }
        // A number out of range becomes the nearest that is in it.
        let range = |low: f64, high: f64, first: f64, spacing: f64, cells: u32| {
            let cell = |x: f64| (((x - first) / spacing).max(0.0) as u32).min(cells - 1);
            cell(low)..=cell(high)
        };
        let (low, high) = (aabb.low, aabb.high);
        for row in range(low.z, high.z, self.aabb.low.z, self.spacing[1], self.rows - 1) {
            for column in range(low.x, high.x, self.aabb.low.x, self.spacing[0], self.columns - 1) {
                let first = 2 * (row * (self.columns - 1) + column);
                for triangle in [first, first + 1] {
                    if crate::mesh::around(&self.triangle(triangle)).meets(aabb) {
                        visit(triangle);
                    }
                }
            }
        }
    }

    fn along(&self, line: &Line, half: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        heights::along(self, line, half, most, visit);
    }

    fn around(&self, point: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        heights::around(self, point, most, visit);
    }

    fn patches(&self) -> &Patches {
        &self.patches
    }
}
