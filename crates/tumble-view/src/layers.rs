//! What is shown beside the bodies.

use std::str::FromStr;

use macroquad::input::KeyCode;
use tumble::DebugView;

/// Something that can be shown or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layer {
    Momentum,
    AngularMomentum,
    AngularVelocity,
    Axes,
    Ellipsoids,
    Forces,
    Springs,
    Contacts,
    Colliders,
    Trails,
    BodyNames,
    Grid,
    Water,
    Shadows,
    Ledger,
    Settings,
    Times,
    Legend,
}

/// How a layer is called, and the key for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerInfo {
    pub(crate) layer: Layer,
    /// In options.
    pub(crate) name: &'static str,
    /// In the legend.
    pub(crate) title: &'static str,
    pub(crate) key: KeyCode,
    pub(crate) letter: char,
    /// Of its lines.
    pub(crate) color: [f32; 3],
}

const WHITE: [f32; 3] = [0.85, 0.87, 0.90];

const fn info(
    layer: Layer,
    name: &'static str,
    title: &'static str,
    (key, letter): (KeyCode, char),
    color: [f32; 3],
) -> LayerInfo {
    LayerInfo { layer, name, title, key, letter, color }
}

/// All layers, in the order of the legend.
pub(crate) const LAYERS: [LayerInfo; 18] = [
    info(Layer::Momentum, "momentum", "momentum", (KeyCode::M, 'M'), DebugView::MOMENTUM),
    info(
        Layer::AngularMomentum,
        "angular-momentum",
        "angular momentum",
        (KeyCode::L, 'L'),
        DebugView::ANGULAR_MOMENTUM,
    ),
    info(
        Layer::AngularVelocity,
        "angular-velocity",
        "angular velocity",
        (KeyCode::W, 'W'),
        DebugView::ANGULAR_VELOCITY,
    ),
    info(Layer::Axes, "axes", "principal axes", (KeyCode::A, 'A'), DebugView::AXES[0]),
    info(Layer::Ellipsoids, "ellipsoids", "inertia ellipsoid", (KeyCode::I, 'I'), DebugView::ELLIPSOID),
    info(Layer::Forces, "forces", "forces", (KeyCode::F, 'F'), DebugView::FORCE),
    info(Layer::Springs, "springs", "springs", (KeyCode::S, 'S'), DebugView::SPRING),
    info(Layer::Contacts, "contacts", "contacts", (KeyCode::X, 'X'), DebugView::CONTACT),
    info(Layer::Colliders, "colliders", "colliders", (KeyCode::B, 'B'), DebugView::COLLIDER),
    info(Layer::Trails, "trails", "trails", (KeyCode::T, 'T'), WHITE),
    info(Layer::BodyNames, "names", "names", (KeyCode::N, 'N'), WHITE),
    info(Layer::Grid, "grid", "grid", (KeyCode::G, 'G'), WHITE),
    info(Layer::Water, "water", "water", (KeyCode::U, 'U'), [0.35, 0.65, 0.85]),
    info(Layer::Shadows, "shadows", "shadows", (KeyCode::K, 'K'), WHITE),
    info(Layer::Ledger, "ledger", "energy and momentum", (KeyCode::E, 'E'), WHITE),
    info(Layer::Settings, "settings", "settings", (KeyCode::P, 'P'), WHITE),
    info(Layer::Times, "times", "times of a frame", (KeyCode::D, 'D'), WHITE),
    info(Layer::Legend, "legend", "keys", (KeyCode::H, 'H'), WHITE),
];

/// The layers that are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layers(u32);

impl Layers {
    pub(crate) fn of(layers: impl IntoIterator<Item = Layer>) -> Self {
        layers.into_iter().fold(Self::default(), Self::with)
    }

    /// Of a scene by its number of moving bodies and of those that turn: arrows and names of a few
    /// explain, those of many hide.
    pub(crate) fn fitting(moving: usize, turning: usize) -> Self {
        let mut all = vec![Layer::Springs, Layer::Trails, Layer::Grid, Layer::Water];
        all.extend([Layer::Shadows, Layer::Ledger, Layer::Legend]);
        if (2..=10).contains(&moving) {
            all.push(Layer::BodyNames);
        }
        if (1..=3).contains(&turning) {
            all.extend([Layer::AngularMomentum, Layer::AngularVelocity, Layer::Axes]);
        }
        Self::of(all)
    }

    pub(crate) fn has(self, layer: Layer) -> bool {
        self.0 & 1 << layer as u32 != 0
    }

    pub(crate) fn with(self, layer: Layer) -> Self {
        Self(self.0 | 1 << layer as u32)
    }

    pub(crate) fn toggle(&mut self, layer: Layer) {
        self.0 ^= 1 << layer as u32;
    }
}

/// `none`, or names with commas between them.
impl FromStr for Layers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "none" {
            return Ok(Self::default());
        }
        let layer = |name: &str| {
            let known = LAYERS.iter().find(|info| info.name == name).map(|info| info.layer);
            known.ok_or_else(|| {
                let names: Vec<&str> = LAYERS.iter().map(|info| info.name).collect();
                format!("{name:?} cannot be shown; there are {} and none", names.join(", "))
            })
        };
        Ok(Self::of(text.split(',').map(layer).collect::<Result<Vec<_>, _>>()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_named() {
        let both: Layers = "axes,momentum".parse().unwrap();
        assert_eq!(both, Layers::of([Layer::Momentum, Layer::Axes]));
        assert_eq!("none".parse(), Ok(Layers::default()));
        let error = "axes,mass".parse::<Layers>().unwrap_err();
        assert!(error.starts_with("\"mass\" cannot be shown; there are momentum, "), "{error}");
    }

    #[test]
    fn every_layer_has_its_own_name_and_key() {
        for (index, info) in LAYERS.iter().enumerate() {
            assert_eq!(info.name.parse(), Ok(Layers::of([info.layer])));
            let others = &LAYERS[index + 1..];
            assert!(others.iter().all(|other| other.key != info.key && other.layer != info.layer), "{info:?}");
        }
    }

    #[test]
    fn a_layer_is_switched() {
        let mut layers = Layers::fitting(1, 1);
        assert!(layers.has(Layer::Axes) && !Layers::fitting(100, 100).has(Layer::Axes));
        layers.toggle(Layer::Axes);
        assert!(!layers.has(Layer::Axes) && layers.has(Layer::Grid) && layers.has(Layer::Springs));
    }
}
