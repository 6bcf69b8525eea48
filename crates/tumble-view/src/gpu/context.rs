//! The way to the graphics card, and the only unsafe code of this crate.

use macroquad::miniquad::RenderingBackend;
use macroquad::window::get_internal_gl;

/// The graphics card of the window that is open. There is one, made where the window is.
#[derive(Debug)]
pub(crate) struct Gpu(());

impl Gpu {
    /// For the code that runs in the window, once.
    pub(crate) fn of_the_window() -> Self {
        Self(())
    }

    /// Lends the graphics card, after what macroquad has kept back for it is drawn.
    #[expect(unsafe_code, reason = "macroquad lends its graphics context in no other way")]
    pub(crate) fn with<R>(&mut self, draw: impl FnOnce(&mut dyn RenderingBackend) -> R) -> R {
        // SAFETY: macroquad checks window and thread. The reference stays the only one: `draw` runs
        // under `&mut self`, of which there is one, and is given no function of macroquad to call.
        let mut lent = unsafe { get_internal_gl() };
        lent.flush();
        draw(lent.quad_context)
    }
}
