//! The page around the window in a browser: which scene it asks for, and what it shows of it.

#[cfg(target_family = "wasm")]
#[expect(unsafe_code, reason = "what a page has is imported, which the language calls unsafe")]
mod imported {
    // SAFETY: `web/page.js` defines them so, and reads no more than the bytes of a name.
    unsafe extern "C" {
        /// A built-in scene, by its name as so many bytes at an address of this memory, and whether
        /// it is the one that is shown first.
        pub(super) safe fn tumble_scene(name: *const u8, bytes: usize, is_first: bool);
        /// The number of the scene that was chosen since the last call, from one in the order of
        /// their names; zero if none was.
        pub(super) safe fn tumble_chosen() -> u32;
        /// What is seen: the step, and the halves of the state's hash.
        pub(super) safe fn tumble_shows(step: f64, upper: u32, lower: u32);
    }
}

/// The scene that a page begins with.
#[cfg(target_family = "wasm")]
pub(crate) const FIRST_SCENE: &str = "bowling";

/// Tells the page which scenes there are, and gives the command line that the window begins with.
#[cfg(target_family = "wasm")]
pub(crate) fn begin() -> [&'static str; 4] {
    for name in tumble_scene::builtin_names() {
        imported::tumble_scene(name.as_ptr(), name.len(), name == FIRST_SCENE);
    }
    ["tumble-view", FIRST_SCENE, "--show", "springs,trails,grid,water,shadows,ledger"]
}

/// The index of the built-in scene that the page asks for; without a page it asks for none.
pub(crate) fn chosen_scene() -> Option<usize> {
    #[cfg(target_family = "wasm")]
    return (imported::tumble_chosen() as usize).checked_sub(1);
    #[cfg(not(target_family = "wasm"))]
    None
}

/// Whether there is a page.
pub(crate) const IS_THERE: bool = cfg!(target_family = "wasm");

/// Lets the page show a step and the hash of the state after it.
pub(crate) fn show(step: u64, hash: u64) {
    #[cfg(target_family = "wasm")]
    imported::tumble_shows(step as f64, (hash >> 32) as u32, hash as u32);
    #[cfg(not(target_family = "wasm"))]
    let _ = (step, hash);
}
