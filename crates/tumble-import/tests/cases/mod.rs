//! The folder of scenes that others wrote for KHR_physics_rigid_bodies and OMI_physics_body, and
//! what is expected of each.

use std::path::{Path, PathBuf};

use serde_json::Value;

/// The folder, if it is there.
pub(crate) fn cases() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases/gltf");
    let folder = std::env::var_os("TUMBLE_GLTF_CASES").map_or_else(beside, PathBuf::from);
    if folder.join("expected.json").is_file() {
        return Some(folder);
    }
    println!("skipped: no scenes at {}", folder.display());
    None
}

/// Every case with its file and what is expected of it.
pub(crate) fn expected(folder: &Path) -> Vec<(PathBuf, Value)> {
    let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
    let cases: serde_json::Map<String, Value> = serde_json::from_str(&text).unwrap();
    cases.into_iter().filter(|(name, _)| name != "_notes").map(|(name, case)| (folder.join(name), case)).collect()
}
