//! Parts of a surface: what hangs together through edges, which way round its triangles go, and the
//! volume within.

use glam::DVec3;

use super::edges::{Across, Edges};
use super::local_frame::LocalFrame;
use super::moments::{SignedVolume, signed_volume};

/// Triangles that hang together through shared edges.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) triangles: Vec<u32>,
    /// No edge is open or overfull.
    pub(crate) closed: bool,
    /// Triangles can be turned so that all neighbours agree.
    pub(crate) two_sided: bool,
    /// Edges across which triangles disagree.
    pub(crate) reversed: usize,
    /// Volume once neighbours agree with the part's first triangle, in local units.
    pub(crate) volume: SignedVolume,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

/// The parts of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) parts: Vec<Part>,
    /// The part each triangle belongs to.
    pub(crate) of_triangle: Vec<u32>,
    /// Triangles to be turned to agree with the first triangle of their part.
    pub(crate) flipped: Vec<bool>,
}

impl Parts {
    pub(crate) fn of(positions: &[DVec3], triangles: &[[u32; 3]], edges: &Edges, frame: &LocalFrame) -> Self {
        let mut sheets = Sheets::of(triangles.len(), edges);
        let mut parts: Vec<Part> = Vec::new();
        let mut number = vec![None; sheets.count];
        let mut of_triangle = vec![0; triangles.len()];
        for triangle in 0..triangles.len() as u32 {
            let root = sheets.root_of(triangle);
            let part = *number[root as usize].get_or_insert_with(|| {
                parts.push(Part::empty());
                parts.len() as u32 - 1
            });
            of_triangle[triangle as usize] = part;
            let part = &mut parts[part as usize];
            part.triangles.push(triangle);
            part.two_sided &= sheets.two_sided[sheets.of_triangle[triangle as usize] as usize];
        }
        for part in &mut parts {
            part.measure(positions, triangles, edges, &sheets.flipped, frame);
        }
        Self { parts, of_triangle, flipped: sheets.flipped }
    }
}

impl Part {
    fn empty() -> Self {
        Self {
            triangles: Vec::new(),
            closed: true,
            two_sided: true,
            reversed: 0,
            volume: SignedVolume::default(),
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        }
    }

    /// Everything but which triangles there are.
    fn measure(
        &mut self,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        edges: &Edges,
        flipped: &[bool],
        frame: &LocalFrame,
    ) {
        let mut disagreements = 0;
        for &triangle in &self.triangles {
            for corner in 0..3 {
                match edges.across(triangle, corner) {
                    Across::Triangle { agrees, .. } => disagreements += usize::from(!agrees),
                    Across::Hole | Across::Crowd { .. } => self.closed = false,
                }
            }
            for corner in triangles[triangle as usize] {
                self.low = self.low.min(positions[corner as usize]);
                self.high = self.high.max(positions[corner as usize]);
            }
        }
        self.reversed = disagreements / 2; // seen from both sides
        let wound = self.triangles.iter().map(|&triangle| {
            let corners = triangles[triangle as usize].map(|corner| positions[corner as usize]);
            turned(corners, flipped[triangle as usize])
        });
        self.volume = signed_volume(wound, frame);
    }

    /// Whether there is an inside to speak of.
    pub(crate) fn is_solid(&self) -> bool {
        self.closed && self.two_sided && !self.volume.is_lost_in_rounding()
    }
}

/// Corners in the opposite order if asked for.
pub(crate) fn turned<T>([a, b, c]: [T; 3], flip: bool) -> [T; 3] {
    if flip { [a, c, b] } else { [a, b, c] }
}

/// What hangs together through edges with exactly two triangles, and so has a way round.
struct Sheets {
    count: usize,
    of_triangle: Vec<u32>,
    flipped: Vec<bool>,
    two_sided: Vec<bool>,
    /// Sheets that meet in an overfull edge, as a forest of disjoint sets.
    parents: Vec<u32>,
}

impl Sheets {
    fn of(triangles: usize, edges: &Edges) -> Self {
        const NONE: u32 = u32::MAX;
        let mut of_triangle = vec![NONE; triangles];
        let mut flipped = vec![false; triangles];
        let mut two_sided = Vec::new();
        let mut waiting = Vec::new();
        for start in 0..triangles as u32 {
            if of_triangle[start as usize] != NONE {
                continue;
            }
            let sheet = two_sided.len() as u32;
            two_sided.push(true);
            of_triangle[start as usize] = sheet;
            waiting.push(start);
            while let Some(triangle) = waiting.pop() {
                for corner in 0..3 {
                    let Across::Triangle { triangle: other, agrees } = edges.across(triangle, corner) else { continue };
                    // Turned as this one is, if they agree; otherwise the other way.
                    let wanted = flipped[triangle as usize] == agrees;
                    if of_triangle[other as usize] == NONE {
                        of_triangle[other as usize] = sheet;
                        flipped[other as usize] = wanted;
                        waiting.push(other);
                    } else if flipped[other as usize] != wanted {
                        two_sided[sheet as usize] = false;
                    }
                }
            }
        }
        let count = two_sided.len();
        let mut sheets = Self { count, of_triangle, flipped, two_sided, parents: (0..count as u32).collect() };
        sheets.join_at_crowds(edges);
        sheets
    }

    fn join_at_crowds(&mut self, edges: &Edges) {
        if edges.overfull == 0 {
            return;
        }
        for triangle in 0..self.of_triangle.len() as u32 {
            for corner in 0..3 {
                if let Across::Crowd { next: Some(next) } = edges.across(triangle, corner) {
                    let (a, b) = (self.root_of(triangle), self.root_of(next));
                    self.parents[a.max(b) as usize] = a.min(b);
                }
            }
        }
        // Parents have smaller numbers, so one pass makes every sheet point to its root.
        for sheet in 0..self.count {
            self.parents[sheet] = self.parents[self.parents[sheet] as usize];
        }
    }

    /// Shortens the way for those who come later, so that long chains do not make the whole
    /// quadratic.
    fn root_of(&mut self, triangle: u32) -> u32 {
        let mut sheet = self.of_triangle[triangle as usize];
        while self.parents[sheet as usize] != sheet {
            let above = self.parents[self.parents[sheet as usize] as usize];
            self.parents[sheet as usize] = above;
            sheet = above;
        }
        sheet
    }
}
