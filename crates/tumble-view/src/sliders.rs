//! The panel of sliders: where it is, and what a press in it means.

use tumble::glam::DVec2;

use crate::overlay::{LETTER, LINE, PADDING};

/// Letters from the left edge to a slider's track, of the track, and of a row.
const BEFORE: f32 = 17.0;
const TRACK: f32 = 14.0;
const ROW: f32 = 41.0;

/// A setting in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slider {
    pub(crate) name: &'static str,
    pub(crate) value: String,
    /// From 0 to 1.
    pub(crate) place: f64,
    /// Whether keys change it.
    pub(crate) is_chosen: bool,
}

/// Where the panel is, from the upper left corner of the picture \[points\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Panel {
    pub(crate) left: f32,
    pub(crate) top: f32,
    pub(crate) rows: usize,
}

/// What a press in the panel holds until the mouse button is released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grip {
    /// The slider of a row.
    Slider(usize),
    /// The panel beside its sliders, where nothing is dragged.
    Panel,
}

impl Panel {
    pub(crate) const WIDTH: f32 = 2.0 * PADDING + ROW * LETTER;

    /// Below the top, at a right edge.
    pub(crate) fn new(right: f32, top: f32, rows: usize) -> Self {
        Self { left: right - Self::WIDTH, top, rows }
    }

    pub(crate) fn height(&self) -> f32 {
        2.0 * PADDING + LINE * self.rows as f32
    }

    /// Where letters of a row begin, by their number.
    pub(crate) fn column(&self, letters: f32) -> f32 {
        self.left + PADDING + letters * LETTER
    }

    /// The upper edge of a row.
    pub(crate) fn row(&self, row: usize) -> f32 {
        self.top + PADDING + LINE * row as f32
    }

    /// The ends of all tracks.
    pub(crate) fn track(&self) -> [f32; 2] {
        [self.column(BEFORE), self.column(BEFORE + TRACK)]
    }

    /// Where a slider at a place from 0 to 1 is drawn.
    pub(crate) fn across(&self, place: f64) -> f32 {
        let [left, right] = self.track();
        left + place as f32 * (right - left)
    }

    /// The place of a slider that is dragged there, which does not leave its track.
    pub(crate) fn place(&self, across: f64) -> f64 {
        let [left, right] = self.track().map(f64::from);
        ((across - left) / (right - left)).clamp(0.0, 1.0)
    }

    /// What a press holds; nothing outside of the panel. The ends of a track may be missed by a
    /// letter.
    pub(crate) fn press(&self, at: DVec2) -> Option<Grip> {
        let (x, y) = (at.x as f32, at.y as f32);
        let is_inside =
            (self.left..self.left + Self::WIDTH).contains(&x) && (self.top..self.top + self.height()).contains(&y);
        if !is_inside {
            return None;
        }
        let [left, right] = self.track();
        let on_track = (left - LETTER..=right + LETTER).contains(&x);
        let row = (0..self.rows).find(|&row| on_track && (self.row(row)..self.row(row + 1)).contains(&y));
        Some(row.map_or(Grip::Panel, Grip::Slider))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel() -> Panel {
        Panel::new(1266.0, 186.0, 5)
    }

    fn middle(row: usize, place: f64) -> DVec2 {
        DVec2::new(f64::from(panel().across(place)), f64::from(panel().row(row) + 0.5 * LINE))
    }

    #[test]
    fn a_slider_is_pressed_where_it_is_drawn() {
        let panel = panel();
        for row in 0..5 {
            for stop in 0..=12 {
                let place = f64::from(stop) / 12.0;
                let at = middle(row, place);
                assert_eq!(panel.press(at), Some(Grip::Slider(row)));
                // Roundings of single precision.
                assert!((panel.place(at.x) - place).abs() < 1e-5, "{place} {}", panel.place(at.x));
            }
        }
        let [left, right] = panel.track();
        assert!(panel.left < left && right < panel.left + Panel::WIDTH, "tracks are in the panel");
    }

    #[test]
    fn a_press_beside_the_sliders_holds_the_panel_and_outside_nothing() {
        let panel = panel();
        let inside = DVec2::new(f64::from(panel.left) + 2.0, f64::from(panel.top) + 2.0);
        assert_eq!(panel.press(inside), Some(Grip::Panel));
        assert_eq!(panel.press(DVec2::new(inside.x, middle(2, 0.0).y)), Some(Grip::Panel));
        let (wide, high) = (f64::from(Panel::WIDTH), f64::from(panel.height()));
        for off in [DVec2::X * -4.0, DVec2::Y * -4.0, DVec2::X * wide, DVec2::Y * high] {
            assert_eq!(panel.press(inside + off), None, "{off}");
        }
        assert_eq!(panel.press(DVec2::NAN), None);
    }

    #[test]
    fn a_drag_past_the_end_stays_at_the_end() {
        let [left, right] = panel().track().map(f64::from);
        assert_eq!([left - 500.0, left, right, right + 500.0].map(|x| panel().place(x)), [0.0, 0.0, 1.0, 1.0]);
    }
}
