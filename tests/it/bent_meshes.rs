//! Files of meshes and scenes that are bent in many places are read or refused, and nothing else.

use std::path::Path;

use merlkit_scene::{MeshFormat, Shading, Sides, TriangleMesh, parse_mesh, read_scene};

/// Numbers that look random.
struct Bits(u64);

impl Bits {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

/// What numbers of a text file are replaced by.
const WORDS: [&str; 12] = [
    "0",
    "-1",
    "1",
    "99999999999",
    "4294967295",
    "-2147483648",
    "nan",
    "inf",
    "1e308",
    "",
    "1e-320",
    "18446744073709551615",
];

/// Changes a file in one to four places: a bit, a byte, a piece that is cut out or doubled, an end that is missing, a number.
fn bend(bytes: &[u8], bits: &mut Bits) -> Vec<u8> {
    let mut bent = bytes.to_vec();
    for _ in 0..1 + bits.below(4) {
        let place = bits.below(bent.len());
        let end = (place + 1 + bits.below(16)).min(bent.len());
        match bits.below(6) {
            0 if !bent.is_empty() => bent[place] ^= 1 << bits.below(8),
            1 if !bent.is_empty() => bent[place] = bits.below(256) as u8,
            2 => drop(bent.drain(place..end)),
            3 => {
                let piece = bent[place..end].to_vec();
                bent.splice(place..place, piece);
            }
            4 => bent.truncate(place),
            _ => {
                let digits = bent[place..]
                    .iter()
                    .take_while(|b| b.is_ascii_digit())
                    .count();
                let word = WORDS[bits.below(WORDS.len())].bytes();
                bent.splice(place..place + digits, word);
            }
        }
    }
    bent
}

fn obj() -> Vec<u8> {
    let mut text = String::from("mtllib a.mtl\no cube\n");
    for i in 0..8 {
        text += &format!(
            "v {} {} {}\nvt 0.5 0.25\nvn 0 0 1\n",
            i & 1,
            i >> 1 & 1,
            i >> 2
        );
    }
    text += "g a\ns 1\nusemtl b\nf 1/1/1 2/2/2 4/4/4 3/3/3\nf 5//1 7//2 8//3 6//4\nf 1 5 6 2\nf -6 -5 -1 -2\nl 1 2\np 1\n";
    text.into_bytes()
}

fn ply_text() -> Vec<u8> {
    b"ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
      property float nx\nproperty float ny\nproperty float nz\nelement face 2\nproperty list uchar int vertex_indices\n\
      element edge 1\nproperty int vertex1\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n4 0 1 2 3\n7\n"
        .to_vec()
}

fn ply_binary() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty double y\n\
                      property float z\nelement face 2\nproperty list uchar uint vertex_index\nproperty uchar flag\nend_header\n"
        .to_vec();
    for i in 0..4u8 {
        bytes.extend(f32::from(i & 1).to_le_bytes());
        bytes.extend(f64::from(i >> 1).to_le_bytes());
        bytes.extend(0.5f32.to_le_bytes());
    }
    for corners in [[0u32, 1, 2], [1, 3, 2]] {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
        bytes.push(1);
    }
    bytes
}

/// A binary file with two nodes and a buffer.
fn glb() -> Vec<u8> {
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"translation":[1,2,3],"children":[2]},{"mesh":0,"scale":[1,1,-1]},{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12},{"buffer":0,"byteOffset":36,"byteLength":8}],
"buffers":[{"byteLength":44}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut content = Vec::new();
    for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        content.extend(number.to_le_bytes());
    }
    for corner in [0u16, 1, 2, 0] {
        content.extend(corner.to_le_bytes());
    }
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    let total = 12 + 8 + json.len() + 8 + content.len();
    bytes.extend((total as u32).to_le_bytes());
    for (kind, part) in [(b"JSON", &json), (b"BIN\0", &content)] {
        bytes.extend((part.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(part);
    }
    bytes
}

/// Each mutation is read or refused, in little time; what is read is built. Returns how many were read.
fn try_mutations(format: MeshFormat, good: &[u8], count: usize, seed: u64) -> usize {
    let path = Path::new("no-such-folder/mesh");
    let mut bits = Bits(seed);
    assert!(
        parse_mesh(format, good, path).is_ok(),
        "{format:?}: {:?}",
        parse_mesh(format, good, path)
    );
    let mut read = 0;
    for k in 0..count {
        let bent = bend(good, &mut bits);
        match parse_mesh(format, &bent, path) {
            Ok(data) => {
                read += 1;
                // A mesh of no area is refused here.
                let built = TriangleMesh::build(&data, Sides::Both, Shading::Smooth);
                assert!(
                    built.is_ok() || built.unwrap_err().to_string().contains("area"),
                    "{k}"
                );
            }
            Err(error) => {
                let words = error.to_string();
                assert!(
                    words.contains("; ") && words.starts_with("no-such-folder"),
                    "{k}: {words}"
                );
            }
        }
    }
    read
}

fn try_all(count: usize) {
    for (format, good) in [
        (MeshFormat::Obj, obj()),
        (MeshFormat::Ply, ply_text()),
        (MeshFormat::Ply, ply_binary()),
        (MeshFormat::Gltf, glb()),
    ] {
        let read = try_mutations(format, &good, count, 5);
        // Both happen: the mutations are neither harmless nor hopeless.
        assert!(
            read > count / 50 && read < count,
            "{format:?}: {read} of {count}"
        );
    }
}

/// Each mutation of a scene file is read and built, or refused with one message; returns how many were read.
fn try_scenes(count: usize) -> usize {
    let room = std::fs::read(Path::new(crate::ROOT).join("tools/scene/scenes/room.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bent.toml");
    let mut bits = Bits(7);
    let mut read = 0;
    for k in 0..count {
        std::fs::write(&file, bend(&room, &mut bits)).unwrap();
        match read_scene(&file).and_then(|scene| scene.build()) {
            Ok(_) => read += 1,
            Err(error) => {
                let words = error.to_string();
                assert!(words.contains("; "), "{k}: {words}");
            }
        }
    }
    read
}

#[test]
fn bent_scenes_are_read_or_refused() {
    let read = try_scenes(1000);
    assert!(read > 20 && read < 1000, "{read}");
}

#[test]
fn bent_files_are_read_or_refused() {
    try_all(2000);
}

/// By hand: `cargo test --release --test it bent_meshes -- --ignored`.
#[test]
#[ignore = "takes long"]
fn many_bent_files_are_read_or_refused() {
    try_all(100_000);
    try_scenes(100_000);
}
