//! A few colours that stand for all those of some pictures.

/// Colours are distinguished by this many bits of red, green and blue.
const BITS: u32 = 5;
const SHIFT: u32 = 8 - BITS;
const CELLS: usize = 1 << (3 * BITS);

/// Colours, and which of them is nearest to any other.
#[derive(Debug)]
pub(crate) struct Palette {
    pub(crate) colors: Vec<[u8; 3]>,
    nearest: Vec<u8>,
}

/// How often there are the colours of a cell, and their sum.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    count: u64,
    sum: [u64; 3],
}

/// Counts colours.
#[derive(Debug)]
pub(crate) struct Histogram {
    cells: Vec<Cell>,
}

impl Histogram {
    pub(crate) fn new() -> Self {
        Self { cells: vec![Cell::default(); CELLS] }
    }

    /// Counts the colours of a picture: red, green, blue, and so on.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for color in colors(bytes) {
            if let Some(cell) = self.cells.get_mut(cell_of(color)) {
                cell.count += 1;
                for (sum, part) in cell.sum.iter_mut().zip(color) {
                    *sum += u64::from(part);
                }
            }
        }
    }

    /// `most` colours or fewer, chosen by median cut: the box of colours with the largest spread is
    /// halved, again and again (P. Heckbert, Color Image Quantization for Frame Buffer Display,
    /// SIGGRAPH 1982).
    pub(crate) fn palette(&self, most: u8) -> Palette {
        let used: Vec<Cell> = self.cells.iter().copied().filter(|cell| cell.count > 0).collect();
        let mut boxes = vec![used];
        while boxes.len() < usize::from(most) {
            let widest = boxes.iter().enumerate().map(|(index, cells)| (widest(cells), index));
            let Some(((_, axis, weight), index)) = widest.max_by(|a, b| a.0.2.total_cmp(&b.0.2)) else { break };
            if weight <= 0.0 {
                break;
            }
            let mut cells = boxes.swap_remove(index);
            cells.sort_by(|a, b| mean(a)[axis].total_cmp(&mean(b)[axis]));
            let upper = cells.split_off(median(&cells));
            boxes.extend([cells, upper]);
        }
        let colors: Vec<[u8; 3]> = boxes.iter().filter(|cells| !cells.is_empty()).map(|cells| mixed(cells)).collect();
        let nearest = self.cells.iter().map(|cell| if cell.count > 0 { nearest(&colors, mean(cell)) } else { 0 });
        Palette { nearest: nearest.collect(), colors }
    }
}

impl Palette {
    /// The numbers of the colours of a picture whose colours were counted.
    pub(crate) fn indices(&self, bytes: &[u8]) -> Vec<u8> {
        colors(bytes).map(|color| self.nearest.get(cell_of(color)).copied().unwrap_or(0)).collect()
    }
}

fn colors(bytes: &[u8]) -> impl Iterator<Item = [u8; 3]> {
    bytes.chunks_exact(3).filter_map(|color| color.try_into().ok())
}

fn cell_of([red, green, blue]: [u8; 3]) -> usize {
    let part = |part: u8| usize::from(part >> SHIFT);
    part(red) << (2 * BITS) | part(green) << BITS | part(blue)
}

fn mean(cell: &Cell) -> [f64; 3] {
    cell.sum.map(|sum| sum as f64 / cell.count.max(1) as f64)
}

fn mixed(cells: &[Cell]) -> [u8; 3] {
    let all = cells.iter().fold(Cell::default(), |mut all, cell| {
        all.count += cell.count;
        for (sum, part) in all.sum.iter_mut().zip(cell.sum) {
            *sum += part;
        }
        all
    });
    mean(&all).map(|part| part.round() as u8)
}

/// The width of a box of colours, along which axis, and how much that weighs. A colour that is
/// seldom counts too, or small things would lose theirs.
fn widest(cells: &[Cell]) -> (f64, usize, f64) {
    let width = |axis: usize| {
        let parts = || cells.iter().map(|cell| mean(cell)[axis]);
        parts().fold(f64::NEG_INFINITY, f64::max) - parts().fold(f64::INFINITY, f64::min)
    };
    let (axis, width) = (0..3).map(|axis| (axis, width(axis))).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let count: u64 = cells.iter().map(|cell| cell.count).sum();
    (width, axis, width * (count as f64).powf(0.25))
}

/// Where half of the count is reached, with at least one cell on either side.
fn median(cells: &[Cell]) -> usize {
    let weight = |cell: &Cell| (cell.count as f64).sqrt();
    let half = 0.5 * cells.iter().map(weight).sum::<f64>();
    let mut sum = 0.0;
    let before = cells.iter().take_while(|cell| {
        sum += weight(cell);
        sum < half
    });
    before.count().clamp(1, cells.len().saturating_sub(1).max(1))
}

fn nearest(colors: &[[u8; 3]], to: [f64; 3]) -> u8 {
    let distance = |color: &[u8; 3]| -> f64 {
        color.iter().zip(to).map(|(&part, to)| (f64::from(part) - to) * (f64::from(part) - to)).sum()
    };
    let best = colors.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    best.map_or(0, |(index, _)| index as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_are_kept_as_they_are() {
        let bytes = [10, 20, 30, 200, 100, 0, 10, 20, 30, 255, 255, 255];
        let mut histogram = Histogram::new();
        histogram.add(&bytes);
        let palette = histogram.palette(255);
        let indices = palette.indices(&bytes);
        let back: Vec<u8> = indices.iter().flat_map(|&index| palette.colors[usize::from(index)]).collect();
        assert_eq!((back.as_slice(), palette.colors.len()), (bytes.as_slice(), 3));
    }

    #[test]
    fn many_colours_come_near() {
        // All greys and a ramp of red, in 64 colours.
        let bytes: Vec<u8> = (0..=255_u8).flat_map(|level| [level, level, level, level, 0, 0]).collect();
        let mut histogram = Histogram::new();
        histogram.add(&bytes);
        let palette = histogram.palette(64);
        assert!(palette.colors.len() <= 64);
        let indices = palette.indices(&bytes);
        let worst = bytes.chunks_exact(3).zip(&indices).map(|(color, &index)| {
            let stands = palette.colors[usize::from(index)];
            color.iter().zip(stands).map(|(&a, b)| a.abs_diff(b)).max().unwrap()
        });
        // 64 colours for two ramps of 32 cells of 8 levels each: half a cell, or a whole one where
        // two share a colour.
        assert!(worst.max().unwrap() <= 12);
    }
}
