//! Meshes and scenes of every format that is read.

use merlkit_scene::{MeshFormat, OptionFile, Shading, Sides, TriangleMesh, parse_mesh, read_scene};

use super::*;

/// A triangle in a file has a place in a hierarchy, corners in f64, and all of it several times while it is made.
const MESH_FACTOR: usize = 1024;

/// A scene of quads and small meshes: each entry is a tree of values while it is read.
const SCENE_FACTOR: usize = 1024;

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

/// A file that is scrambled, or one of whose numbers is another.
fn bend(good: &[u8], random: &mut Stream) -> Vec<u8> {
    let mut bytes = good.to_vec();
    if below(random, 2) == 0 {
        scramble(&mut bytes, random);
        return bytes;
    }
    let place = below(random, bytes.len());
    let digits = bytes[place..].iter().take_while(|b| b.is_ascii_digit());
    let end = place + digits.count();
    let word = WORDS[below(random, WORDS.len())].bytes();
    bytes.splice(place..end, word);
    bytes
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

/// A mesh of any format; one that is accepted is made ready to be intersected, unless it has no area.
fn read_mesh(format: MeshFormat, input: &[u8]) -> bool {
    match parse_mesh(format, input, Path::new("fuzz/mesh")) {
        Ok(data) => match TriangleMesh::build(&data, Sides::Both, Shading::Smooth) {
            Ok(_) => true,
            Err(error) => {
                assert!(error.to_string().contains("area"), "{error}");
                false
            }
        },
        Err(error) => {
            let words = error.to_string();
            assert!(words.starts_with("fuzz") && words.contains("; "), "{words}");
            false
        }
    }
}

/// A hundredth of the inputs are meshes of each kind.
#[test]
fn meshes() {
    for (name, format, good) in [
        ("obj", MeshFormat::Obj, obj()),
        ("ply-text", MeshFormat::Ply, ply_text()),
        ("ply-binary", MeshFormat::Ply, ply_binary()),
        ("glb", MeshFormat::Gltf, glb()),
    ] {
        assert!(read_mesh(format, &good), "{name}");
        let make = |random: &mut Stream| bend(&good, random);
        drive(name, MESH_FACTOR, 100, make, |input| {
            read_mesh(format, input)
        });
    }
}

/// A scene in a file of the thread's own; one that is accepted is built.
fn read_scene_file(folder: &Path, ending: &str, input: &[u8]) -> bool {
    let thread = rayon::current_thread_index().unwrap_or(usize::MAX);
    let file = folder.join(format!("{thread}.{ending}"));
    std::fs::write(&file, input).unwrap();
    match read_scene(&file).and_then(|scene| scene.build()) {
        Ok(_) => true,
        Err(error) => {
            let words = error.to_string();
            assert!(words.contains("; "), "{words}");
            false
        }
    }
}

/// A hundredth of the inputs are scenes in TOML, and as many are scenes in GRF.
#[test]
fn scenes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().unwrap();
    for (name, file) in [
        ("toml", "tools/scene/scenes/room.toml"),
        ("grf", "tools/scene/scenes/grammar.grf"),
    ] {
        let good = std::fs::read(root.join(file)).unwrap();
        assert!(read_scene_file(folder.path(), name, &good), "{name}");
        let make = |random: &mut Stream| bend(&good, random);
        let read = |input: &[u8]| read_scene_file(folder.path(), name, input);
        drive(name, SCENE_FACTOR, 100, make, read);
    }
}

/// An option file of the thread's own; one that is accepted has settings in their domains.
fn read_option_file(folder: &Path, input: &[u8]) -> bool {
    let thread = rayon::current_thread_index().unwrap_or(usize::MAX);
    let file = folder.join(format!("{thread}.op"));
    std::fs::write(&file, input).unwrap();
    match OptionFile::read(&file) {
        Ok(options) => {
            if let Some(sampler) = &options.sampler {
                sampler.parse::<merlkit::SamplerSpec>().unwrap();
            }
            if let Some(name) = &options.output {
                assert_eq!(Path::new(name).file_name().unwrap(), name.as_str());
            }
            let counts = [options.spp, options.directions.map(u64::from)];
            assert!(counts.into_iter().flatten().all(|count| count > 0));
            true
        }
        Err(error) => {
            let words = error.to_string();
            assert!(words.contains("; ") && words.len() < 4000, "{words}");
            false
        }
    }
}

#[test]
fn option_files() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let good = std::fs::read(root.join("data/thesis/grf/example.op")).unwrap();
    assert!(read_option_file(folder.path(), &good));
    let make = |random: &mut Stream| bend(&good, random);
    let read = |input: &[u8]| read_option_file(folder.path(), input);
    drive("op", SCENE_FACTOR, 100, make, read);
}
