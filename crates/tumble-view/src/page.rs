//! The page around the window in a browser: which scene it asks for, and what it shows of it.

#[cfg(target_family = "wasm")]
#[expect(unsafe_code, reason = "what a page has is imported, which the language calls unsafe")]
mod imported {
    // SAFETY: `web/page.js` defines them so, and reads no more than the bytes of a text.
    unsafe extern "C" {
        /// Tells the page the name of a built-in scene, as an address and a length in bytes, in the
        /// order of names.
        pub(super) safe fn tumble_add_scene(name: *const u8, bytes: usize);
        /// The number of the scene that was chosen since the last call, from one in the order of
        /// their names; zero if none was.
        pub(super) safe fn tumble_take_choice() -> u32;
        /// The number of the scene, the step, the halves of the state's hash, and whether nothing
        /// has been done to the scene.
        pub(super) safe fn tumble_show(scene: u32, step: f64, upper: u32, lower: u32, is_untouched: bool);
        /// Shows a message, as an address and a length in bytes.
        pub(super) safe fn tumble_fail(text: *const u8, bytes: usize);
    }
}

/// Whether there is a page.
pub(crate) const IS_THERE: bool = cfg!(target_family = "wasm");

/// Tells the page which scenes there are, and gives the command line that the window begins with.
#[cfg(target_family = "wasm")]
pub(crate) fn begin() -> [&'static str; 4] {
    for name in tumble_scene::builtin_names() {
        imported::tumble_add_scene(name.as_ptr(), name.len());
    }
    ["tumble-view", "bowling", "--show", "springs,trails,grid,water,shadows,ledger"]
}

/// The index of the built-in scene that the page asks for; without a page it asks for none.
pub(crate) fn chosen_scene() -> Option<usize> {
    #[cfg(target_family = "wasm")]
    return (imported::tumble_take_choice() as usize).checked_sub(1);
    #[cfg(not(target_family = "wasm"))]
    None
}

/// Lets the page show a step of a scene and the hash of the state after it.
pub(crate) fn show(scene: &str, step: u64, hash: u64, is_untouched: bool) {
    #[cfg(target_family = "wasm")]
    {
        let number = tumble_scene::builtin_names().position(|name| name == scene).map_or(0, |index| index + 1);
        imported::tumble_show(number as u32, step as f64, (hash >> 32) as u32, hash as u32, is_untouched);
    }
    #[cfg(not(target_family = "wasm"))]
    let _ = (scene, step, hash, is_untouched);
}

/// Lets the page show what went wrong, where there is no terminal for it.
#[cfg(target_family = "wasm")]
pub(crate) fn fail(text: &str) {
    imported::tumble_fail(text.as_ptr(), text.len());
}
