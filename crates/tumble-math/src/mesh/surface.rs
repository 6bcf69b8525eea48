//! The triangles of a mesh over welded vertices, without those that add nothing.

/// What is left of a mesh's triangles once vertices are welded.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    /// Corners as the vertices that stay.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Triangles left out because two of their corners are one.
    pub(crate) degenerate: usize,
    /// Triangles left out because an earlier one has the same corners.
    pub(crate) duplicates: usize,
}

impl Surface {
    /// `stays` names the vertex that each vertex is welded to.
    pub(crate) fn welded(triangles: &[[u32; 3]], stays: &[u32]) -> Self {
        let mut kept: Vec<[u32; 3]> = triangles.iter().map(|corners| corners.map(|c| stays[c as usize])).collect();
        kept.retain(|[a, b, c]| a != b && b != c && c != a);
        let degenerate = triangles.len() - kept.len();

        let mut keys: Vec<([u32; 3], u32)> =
            kept.iter().zip(0..).map(|(corners, index)| (ascending(*corners), index)).collect();
        keys.sort_unstable();
        let mut superfluous = vec![false; kept.len()];
        for pair in keys.windows(2) {
            if let [(earlier, _), (later, index)] = pair {
                superfluous[*index as usize] = earlier == later;
            }
        }
        let duplicates = superfluous.iter().filter(|gone| **gone).count();
        let mut gone = superfluous.into_iter();
        kept.retain(|_| !gone.next().unwrap_or(false));
        Self { triangles: kept, degenerate, duplicates }
    }
}

fn ascending(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}
