//! Meshes that take the place of the sphere.

use std::path::Path;

use merlkit::glam::DVec3;
use merlkit_explore::Session;
use merlkit_scene::{MeshFormat, parse_mesh, read_scene};
use serde_json::Value;

use crate::read::{ask, ask_json, session};

/// A pyramid far from the origin, one of whose triangles has no area.
const PYRAMID: &str = "v 10 0 0\nv 14 0 0\nv 14 0 4\nv 10 0 4\nv 12 3 2\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 1 2\n";

fn vectors(numbers: &[f32]) -> Vec<DVec3> {
    let threes = numbers.chunks_exact(3);
    threes
        .map(|p| DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])))
        .collect()
}

fn send(session: &Session, name: &str, bytes: &[u8]) -> Value {
    let answer = session
        .answer_mesh_upload(&format!("name={name}"), bytes)
        .unwrap();
    serde_json::from_slice(&answer.bytes).unwrap()
}

#[test]
fn a_mesh_has_the_vertices_of_its_file_and_the_camera_of_a_scene() {
    let session = session(&["lambert"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pyramid.obj");
    std::fs::write(&path, PYRAMID).unwrap();
    session.add_mesh(&path).unwrap();
    let listed = &ask_json(&session, "api/v1/materials")["meshes"][0];
    assert_eq!(listed["name"], "pyramid");
    assert_eq!(listed["text"], path.display().to_string());
    assert_eq!(
        (listed["faces"].as_u64(), listed["dropped"].as_u64()),
        (Some(6), Some(1))
    );

    let answer = ask(&session, "api/v1/mesh?mesh=0");
    let number = |name: &str| answer.members[name].as_f64().unwrap();
    let vector = |name: &str| {
        let values = answer.members[name].as_array().unwrap();
        DVec3::from_array([0, 1, 2].map(|axis| values[axis].as_f64().unwrap()))
    };
    let data = parse_mesh(
        MeshFormat::Obj,
        PYRAMID.as_bytes(),
        Path::new("pyramid.obj"),
    )
    .unwrap();
    let (centre, radius) = (vector("centre"), number("radius"));
    let positions = vectors(&answer.floats("positions"));
    assert_eq!(positions.len(), data.vertices.len());
    for (found, expected) in positions.iter().zip(&data.vertices) {
        assert!((centre + radius * *found - *expected).length() < 1e-5);
        assert!(found.length() < 1.0 + 1e-6);
    }
    for (found, expected) in vectors(&answer.floats("normals"))
        .iter()
        .zip(data.vertex_normals())
    {
        assert!((*found - expected).length() < 1e-6);
    }
    let faces = answer.bits("faces");
    assert_eq!(faces.len(), 18);
    for (found, expected) in faces.chunks_exact(3).zip(&data.faces) {
        assert_eq!(found, expected);
    }

    // The camera of a scene file that says nothing of one.
    let scene = folder.path().join("scene.toml");
    let text = "[[material]]\nname = \"m\"\nbrdf = \"lambert\"\n[[object]]\nshape = \"mesh\"\nfile = \"pyramid.obj\"\nmaterial = \"m\"\n";
    std::fs::write(&scene, text).unwrap();
    let camera = read_scene(&scene).unwrap().build().unwrap().spec.camera;
    assert!((centre - camera.target).length() < 1e-12);
    assert!((centre + radius * vector("eye") - camera.eye).length() < 1e-9);
    assert_eq!(number("vertical_angle"), camera.vertical_angle);
}

#[test]
fn meshes_are_told_by_their_endings_and_have_names_of_their_own() {
    let session = session(&["lambert"]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(
        send(&session, "..%2Fa.OBJ", PYRAMID.as_bytes())["name"],
        "a"
    );
    assert_eq!(send(&session, "a.ply", ply.as_bytes())["name"], "a-2");
    let sphere = send(&session, "sphere.obj", PYRAMID.as_bytes());
    assert_eq!(
        (sphere["name"].as_str(), sphere["text"].as_str()),
        (Some("sphere-2"), None)
    );
    assert_eq!(ask(&session, "api/v1/mesh?mesh=1").bits("faces"), [0, 1, 2]);
    assert_eq!(
        session.answer("api/v1/mesh?mesh=3").unwrap_err().status,
        404
    );
}

#[test]
fn meshes_that_are_none_or_too_large_are_refused() {
    let session = session(&["lambert"]);
    let many_corners = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{}\n", " 1 2 3".repeat(400_000));
    let many_objects = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{}{{}}]}}",
        "{},".repeat(600_000)
    );
    let many_vertices = "ply\nformat binary_little_endian 1.0\nelement vertex 1600000\nproperty uchar x\nproperty uchar y\n\
                         property uchar z\nend_header\n".to_owned() + &"\0".repeat(4_800_000);
    let many_faces = "ply\nformat binary_little_endian 1.0\nelement face 1000001\nproperty list uchar uchar vertex_indices\n\
                      end_header\n".to_owned() + &"\0".repeat(1_000_001);
    let secret = std::env::current_dir().unwrap().join("Cargo.toml");
    assert!(secret.exists());
    let external = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[]}],\
                    \"buffers\":[{\"byteLength\":4,\"uri\":\"Cargo.toml\"}]}";
    for (name, bytes, word) in [
        ("a.obj", "", "without a triangle"),
        ("a.obj", "v 0 0 0\nf 1 1 1\n", "area"),
        ("a.obj", &many_corners, "more than 1000000 triangles"),
        ("a.ply", &many_vertices, "1500000 vertices"),
        ("a.ply", &many_faces, "more than 1000000 triangles"),
        ("a.gltf", &many_objects, "JSON objects"),
        ("a.gltf", external, "buffer"),
        ("a.stl", PYRAMID, "extension"),
        ("a", PYRAMID, "extension"),
    ] {
        let refusal = session
            .answer_mesh_upload(&format!("name={name}"), bytes.as_bytes())
            .unwrap_err();
        assert_eq!(refusal.status, 400, "{name}: {refusal}");
        assert!(refusal.message.contains(word), "{name}: {refusal}");
        let folder = std::env::temp_dir().display().to_string();
        assert!(
            word == "buffer" || !refusal.message.contains(&folder),
            "{refusal}"
        );
    }
    for _ in 0..16 {
        send(&session, "a.obj", PYRAMID.as_bytes());
    }
    let refusal = session
        .answer_mesh_upload("name=a.obj", PYRAMID.as_bytes())
        .unwrap_err();
    assert_eq!(refusal.status, 503);
}
