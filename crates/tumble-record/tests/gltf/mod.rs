//! Binary glTF read back, with all that the specification asks of what is in it checked.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use serde_json::Value;

/// A file taken apart.
pub(crate) struct Gltf {
    pub(crate) json: Value,
    buffer: Vec<u8>,
}

/// The animation of one body.
#[derive(Debug, PartialEq)]
pub(crate) struct Track {
    pub(crate) node: usize,
    pub(crate) translations: Vec<[f32; 3]>,
    pub(crate) rotations: Vec<[f32; 4]>,
}

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

fn number(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

impl Gltf {
    /// Takes a file apart and checks it.
    pub(crate) fn read(bytes: &[u8]) -> Self {
        assert_eq!((&bytes[..4], word(bytes, 4), word(bytes, 8)), (&b"glTF"[..], 2, bytes.len()));
        let json_bytes = word(bytes, 12);
        assert_eq!((&bytes[16..20], json_bytes % 4), (&b"JSON"[..], 0));
        let json: Value = serde_json::from_slice(&bytes[20..20 + json_bytes]).unwrap();
        let rest = &bytes[20 + json_bytes..];
        let buffer = if rest.is_empty() {
            Vec::new()
        } else {
            assert_eq!((word(rest, 0), &rest[4..8]), (rest.len() - 8, &b"BIN\0"[..]));
            rest[8..].to_vec()
        };
        let gltf = Self { json, buffer };
        gltf.check();
        gltf
    }

    fn check(&self) {
        let json = &self.json;
        assert_eq!(json["asset"]["version"], "2.0");
        for (key, value) in json.as_object().unwrap() {
            assert!(value.as_array().is_none_or(|list| !list.is_empty()), "{key} is empty");
        }
        assert_eq!(list(&json["buffers"]).len(), usize::from(!self.buffer.is_empty()));
        if !self.buffer.is_empty() {
            assert_eq!(number(&json["buffers"][0]["byteLength"]), self.buffer.len());
        }
        for view in list(&json["bufferViews"]) {
            assert!(
                view["byteOffset"].as_u64().unwrap_or(0) as usize + number(&view["byteLength"]) <= self.buffer.len()
            );
        }
        for index in 0..list(&json["accessors"]).len() {
            self.check_accessor(index);
        }
        for mesh in list(&json["meshes"]) {
            let primitive = &mesh["primitives"][0];
            let vertices = self.numbers(number(&primitive["attributes"]["POSITION"])).len();
            let normals = self.numbers(number(&primitive["attributes"]["NORMAL"]));
            assert_eq!(vertices, normals.len());
            for normal in normals.chunks_exact(3) {
                assert!((normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-6);
            }
            let indices = self.numbers(number(&primitive["indices"]));
            assert!(indices.len().is_multiple_of(3) && indices.iter().all(|index| (*index as usize) < vertices / 3));
            assert!(number(&primitive["material"]) < list(&json["materials"]).len());
        }
        let nodes = list(&json["nodes"]);
        assert!(nodes.iter().all(|node| number(&node["mesh"]) < list(&json["meshes"]).len()));
        let roots: Vec<usize> = list(&json["scenes"][0]["nodes"]).iter().map(number).collect();
        assert_eq!(roots, (0..nodes.len()).collect::<Vec<_>>());
    }

    /// Inside its view, aligned, and with the bounds it states, which times and positions must.
    fn check_accessor(&self, index: usize) {
        let accessor = &self.json["accessors"][index];
        let numbers = self.numbers(index);
        assert!(!numbers.is_empty() && numbers.iter().all(|number| number.is_finite()), "{accessor}");
        let width = numbers.len() / number(&accessor["count"]);
        for (bound, of) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
            let stated: Vec<f64> =
                list(&accessor[bound]).iter().map(|x| f64::from(x.as_f64().unwrap() as f32)).collect();
            for (axis, stated) in stated.iter().enumerate() {
                let least = numbers.iter().skip(axis).step_by(width).copied().reduce(of).unwrap();
                assert_eq!(least, *stated, "{bound} of {accessor}");
            }
        }
    }

    /// The numbers of an accessor.
    pub(crate) fn numbers(&self, index: usize) -> Vec<f64> {
        let accessor = &self.json["accessors"][index];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let view = &self.json["bufferViews"][number(&accessor["bufferView"])];
        let offset = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let (view_at, count) = (view["byteOffset"].as_u64().unwrap_or(0) as usize, width * number(&accessor["count"]));
        let size = if accessor["componentType"] == 5123 { 2 } else { 4 };
        assert!(offset + size * count <= number(&view["byteLength"]), "{accessor} leaves its view");
        assert!((view_at + offset).is_multiple_of(size));
        let bytes = self.buffer[view_at + offset..][..size * count].chunks_exact(size);
        bytes
            .map(|bytes| match accessor["componentType"].as_u64().unwrap() {
                5126 => f64::from(f32::from_le_bytes(bytes.try_into().unwrap())),
                5125 => f64::from(u32::from_le_bytes(bytes.try_into().unwrap())),
                _ => f64::from(u16::from_le_bytes(bytes.try_into().unwrap())),
            })
            .collect()
    }

    /// The times of the animation and the tracks of the bodies, checked for increase, length, and
    /// the shortest way.
    pub(crate) fn animation(&self) -> (Vec<f32>, Vec<Track>) {
        let Some(animation) = list(&self.json["animations"]).first() else { return (Vec::new(), Vec::new()) };
        let times: Vec<f32> = self.numbers(0).into_iter().map(|time| time as f32).collect();
        assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
        let sampled = |channel: &Value| {
            let sampler = &animation["samplers"][number(&channel["sampler"])];
            assert_eq!((&sampler["input"], sampler.get("interpolation")), (&Value::from(0), None));
            let numbers = self.numbers(number(&sampler["output"]));
            numbers.into_iter().map(|number| number as f32).collect::<Vec<f32>>()
        };
        let tracks = list(&animation["channels"]).chunks_exact(2).map(|pair| {
            let (translation, rotation) = (&pair[0], &pair[1]);
            assert_eq!(
                (&translation["target"]["path"], &rotation["target"]["path"]),
                (&"translation".into(), &"rotation".into())
            );
            assert_eq!(translation["target"]["node"], rotation["target"]["node"]);
            Track {
                node: number(&translation["target"]["node"]),
                translations: sampled(translation).chunks_exact(3).map(|v| v.try_into().unwrap()).collect(),
                rotations: sampled(rotation).chunks_exact(4).map(|q| q.try_into().unwrap()).collect(),
            }
        });
        let tracks: Vec<Track> = tracks.collect();
        for track in &tracks {
            assert_eq!((track.translations.len(), track.rotations.len()), (times.len(), times.len()));
            let dot = |a: [f32; 4], b: [f32; 4]| a.into_iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
            // Four squares rounded in single precision.
            assert!(track.rotations.iter().all(|&q| (dot(q, q) - 1.0).abs() < 3e-7));
            assert!(track.rotations.windows(2).all(|pair| dot(pair[0], pair[1]) >= 0.0), "not the shortest way");
        }
        (times, tracks)
    }
}
