//! Joints as they are written in scene files, in both formats.

use hecs::World;
use tumble_scene::Scene;

/// How a list of named values is written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Json,
    Ron,
}

impl Format {
    pub(crate) fn object(self, fields: &[(&str, String)]) -> String {
        let field = |(name, value): &(&str, String)| match self {
            Self::Json => format!("\"{name}\": {value}"),
            Self::Ron => format!("{name}: {value}"),
        };
        let fields: Vec<_> = fields.iter().map(field).collect();
        let [open, close] = if self == Self::Json { ["{", "}"] } else { ["(", ")"] };
        format!("{open} {} {close}", fields.join(", "))
    }

    pub(crate) fn word(self, word: &str) -> String {
        if self == Self::Json { format!("\"{word}\"") } else { word.to_owned() }
    }

    pub(crate) fn list(self, values: &[String]) -> String {
        let [open, close] = if self == Self::Json { ["[", "]"] } else { ["(", ")"] };
        format!("{open}{}{close}", values.join(", "))
    }

    pub(crate) fn scene(self, joint: &str) -> String {
        let body = |name: &str| {
            let radius = self.object(&[("radius", "0.1".to_owned())]);
            let shape = match self {
                Self::Json => self.object(&[("sphere", radius)]),
                Self::Ron => format!("sphere{radius}"),
            };
            self.object(&[("name", format!("\"{name}\"")), ("shape", shape), ("mass", "1".to_owned())])
        };
        let bodies = format!("[{}, {}]", body("a"), body("b"));
        self.object(&[("bodies", bodies), ("joints", format!("[{joint}]"))])
    }

    pub(crate) fn open(self, joint: &str) -> Result<World, String> {
        let text = self.scene(joint);
        let scene = match self {
            Self::Json => Scene::from_json(&text, "scene.x"),
            Self::Ron => Scene::from_ron(&text, "scene.x"),
        };
        let mut world = World::new();
        scene.and_then(|scene| scene.spawn(&mut world)).map_err(|error| error.to_string())?;
        Ok(world)
    }
}
