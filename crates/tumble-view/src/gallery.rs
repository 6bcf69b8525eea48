//! Which scene is shown: the one that was asked for, and the built-in ones; and whether its file
//! has changed.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use tumble_scene::Scene;

use crate::clock::Instant;
use crate::failure::Failure;
use crate::options::{Options, ViewOptions};
use crate::playback::pace;
use crate::tuning::Change;
use crate::viewport::Viewport;

/// How often the file of a scene is checked.
const EVERY: Duration = Duration::from_millis(500);

/// The scenes, and the file of the one that is shown.
#[derive(Debug)]
pub(crate) struct Gallery {
    options: Options,
    /// The scene that was asked for is among them.
    names: Vec<String>,
    at: usize,
    file: Option<Watched>,
}

/// A file as it was last seen.
#[derive(Debug)]
struct Watched {
    path: PathBuf,
    seen: Option<(SystemTime, u64)>,
    next: Instant,
}

impl Gallery {
    pub(crate) fn of(options: Options) -> Self {
        let mut names: Vec<String> = tumble_scene::builtin_names().map(str::to_owned).collect();
        let at = names.iter().position(|name| *name == options.scene).unwrap_or_else(|| {
            names.insert(0, options.scene.clone());
            0
        });
        let mut gallery = Self { options, names, at, file: None };
        gallery.watch();
        gallery
    }

    /// The scene after or before, around in a circle.
    pub(crate) fn turn(&mut self, change: Change) -> Result<(Viewport, f64), Failure> {
        let count = self.names.len();
        self.at = match change {
            Change::More => (self.at + 1) % count,
            Change::Less => (self.at + count - 1) % count,
        };
        self.watch();
        self.open()
    }

    /// The built-in scene of this index in the order of names, if there is one.
    pub(crate) fn show(&mut self, builtin: usize) -> Result<(Viewport, f64), Failure> {
        let name = tumble_scene::builtin_names().nth(builtin);
        self.at = self.names.iter().position(|known| Some(known.as_str()) == name).unwrap_or(self.at);
        self.watch();
        self.open()
    }

    /// The scene of the present name, with what the command line says of it, and the simulated
    /// seconds to a second.
    pub(crate) fn open(&self) -> Result<(Viewport, f64), Failure> {
        let name = &self.names[self.at];
        let is_asked_for = *name == self.options.scene;
        let scene = if is_asked_for { self.options.scene()? } else { Scene::open(name)? };
        let pace = self.options.speed.filter(|_| is_asked_for).unwrap_or_else(|| pace(&scene));
        let view = match is_asked_for {
            true => self.options.view.clone(),
            false => ViewOptions { pick: None, follow: false, camera: None, up: None, ..self.options.view.clone() },
        };
        Ok((Viewport::new(scene, &view)?, pace))
    }

    /// Whether the file of the scene is another than it was; not more often than twice a second.
    pub(crate) fn has_changed(&mut self, now: Instant) -> bool {
        let Some(file) = self.file.as_mut().filter(|file| file.next <= now) else { return false };
        file.next = now + EVERY;
        let seen = stamp(&file.path);
        // A file that is away for a moment is being written.
        seen.is_some() && std::mem::replace(&mut file.seen, seen) != seen
    }

    fn watch(&mut self) {
        let path = PathBuf::from(&self.names[self.at]);
        let is_file = !tumble_scene::builtin_names().any(|name| name == self.names[self.at]);
        self.file = is_file.then(|| Watched { seen: stamp(&path), path, next: Instant::now() + EVERY });
    }
}

/// When a file was written and how long it is.
fn stamp(path: &std::path::Path) -> Option<(SystemTime, u64)> {
    let known = std::fs::metadata(path).ok()?;
    Some((known.modified().ok()?, known.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::tests::options;

    fn gallery(arguments: &[&str]) -> Gallery {
        Gallery::of(options(arguments).unwrap())
    }

    #[test]
    fn scenes_are_in_a_circle() {
        let mut gallery = gallery(&["raft", "--dt", "0.005", "--pick", "box-0-0"]);
        let dt = |viewport: &Viewport| viewport.playback.dt();
        assert!((dt(&gallery.open().unwrap().0) - 0.005).abs() < 1e-9);
        let count = tumble_scene::builtin_names().count();
        assert_eq!(gallery.names.len(), count);
        // Options of one scene are not those of another, which has no such body.
        let next = gallery.turn(Change::More).unwrap().0;
        assert!((dt(&next) - 0.005).abs() > 1e-4 && next.picked.is_none(), "{}", gallery.names[gallery.at]);
        assert_eq!(gallery.turn(Change::Less).unwrap().0.picked, Some(0));
        let raft = gallery.at;
        (0..count).for_each(|_| gallery.at = (gallery.at + 1) % count);
        assert_eq!(gallery.at, raft);
        assert!(!gallery.has_changed(Instant::now() + 2 * EVERY), "a built-in scene has no file");
    }

    #[test]
    fn a_file_that_changes_is_seen() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("balls.json");
        let scene = |mass: &str| {
            format!(r#"{{ "bodies": [ {{ "shape": {{ "sphere": {{ "radius": 0.2 }} }}, "mass": {mass} }} ] }}"#)
        };
        std::fs::write(&path, scene("1")).unwrap();
        let mut gallery = gallery(&[path.to_str().unwrap()]);
        assert_eq!(gallery.names.len(), tumble_scene::builtin_names().count() + 1);
        let mut later = Instant::now();
        let mut changed = |gallery: &mut Gallery| {
            later += 2 * EVERY;
            gallery.has_changed(later)
        };
        assert!(!changed(&mut gallery));
        std::fs::write(&path, scene("20")).unwrap();
        assert!(changed(&mut gallery) && !changed(&mut gallery));
        assert_eq!(gallery.open().unwrap().0.playback.bodies.all[0].mass, 20.0);
        std::fs::write(&path, scene("-100")).unwrap();
        assert!(changed(&mut gallery));
        assert!(gallery.open().err().unwrap().to_string().contains("mass"));
        std::fs::remove_file(&path).unwrap();
        assert!(!changed(&mut gallery), "nothing can be opened");
        std::fs::write(&path, scene("3000")).unwrap();
        assert!(changed(&mut gallery) && gallery.open().is_ok());
    }
}
