//! The colours that bodies are drawn in.

/// Colours that look different to most eyes, after Okabe and Ito, as red, green, blue in linear
/// light, taken by dynamic bodies cyclically. Their number has no factor in common with the
/// kinds of a scene that repeats every two, four or eight.
pub const BODY_COLORS: [[f32; 3]; 7] = [
    [0.791, 0.347, 0.0],
    [0.093, 0.456, 0.815],
    [0.0, 0.342, 0.171],
    [0.871, 0.776, 0.054],
    [0.0, 0.168, 0.445],
    [0.665, 0.112, 0.0],
    [0.604, 0.191, 0.386],
];

/// The colour of fixed and kinematic bodies, in linear light.
pub const FIXED_COLOR: [f32; 3] = [0.3, 0.3, 0.3];

/// The colour of infinite ground, in linear light.
pub const GROUND_COLOR: [f32; 3] = [0.075, 0.08, 0.095];
