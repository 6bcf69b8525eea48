//! The page around the window in a browser: which scene it asks for, and what it shows of it.
//!
//! Both send each other texts by the clipboard of the window library, which `web/page.js` keeps for
//! that, in the place of functions that are imported from the page.

use macroquad::miniquad::window::{clipboard_get, clipboard_set};

/// Whether there is a page.
pub(crate) const IS_THERE: bool = cfg!(target_family = "wasm");
/// The scene that a page begins with, and what it shows, as options of the command line.
pub(crate) const SCENE: &str = "bowling";
pub(crate) const SHOWN: &str = "springs,trails,grid,water,shadows,ledger";

/// What has been heard from the page.
#[derive(Debug, Default)]
pub(crate) struct Page {
    last: String,
}

impl Page {
    /// Tells the page which scenes there are, once there is a window.
    pub(crate) fn begin() -> Self {
        tell("scenes", &tumble_scene::builtin_names().collect::<Vec<_>>().join("\n"));
        Self::default()
    }

    /// The index of the built-in scene that was chosen since the last call; without a page none is.
    pub(crate) fn chosen_scene(&mut self) -> Option<usize> {
        // Without a page it would be everybody's.
        let said = if IS_THERE { clipboard_get() } else { None }.filter(|said| *said != self.last)?;
        let chosen = chosen(&said);
        self.last = said;
        chosen
    }
}

/// `scene INDEX COUNT`, where the count makes each choice another text.
fn chosen(said: &str) -> Option<usize> {
    said.strip_prefix("scene ")?.split(' ').next()?.parse().ok()
}

/// Lets the page show a step of a scene and the hash of the state after it.
pub(crate) fn show(scene: &str, step: u64, hash: u64, is_untouched: bool) {
    if IS_THERE {
        let index = tumble_scene::builtin_names().position(|name| name == scene);
        let index = index.map_or(-1, |index| index as i64);
        tell("state", &format!("{index} {step} {hash:016x} {is_untouched}"));
    }
}

/// Lets the page show what went wrong in the window, for it has no terminal.
pub(crate) fn fail(text: &str) {
    tell("failure", text);
}

fn tell(what: &str, text: &str) {
    if IS_THERE {
        clipboard_set(&format!("{what}\n{text}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_and_other_texts_are_not() {
        assert_eq!(chosen("scene 12 3"), Some(12));
        for other in ["", "scene", "scene ", "scene -1 3", "scene x 3", "a text that was pasted"] {
            assert_eq!(chosen(other), None, "{other}");
        }
    }
}
