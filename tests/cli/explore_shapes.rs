//! The page of `merlkit explore` with anisotropic materials and meshes, and what people do with it: dropping files, dragging, zooming.
//!
//! The test skips, saying so, where the others of the page do.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::glam::DQuat;
use merlkit::material::rgl::{BsdfSize, tabulate};
use merlkit::{LookupRule, Material};
use serde_json::Value;

use crate::browsers::{choose_picture_folder, find_driven_chromium};
use crate::explore_page::{Difference, Server, colours, run_script};

const SHAPES: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../tests/browser/explore_shapes.js"
);

/// Runs what the page calls the command of a picture, in a shell as a reader would, for a picture of this size.
fn run_in_shell(folder: &Path, command: &str, size: u64) {
    let program = cargo_bin!("merlkit").display().to_string();
    let command = command
        .replace(
            "merlkit render",
            &format!("'{program}' render --spp 16 --force"),
        )
        .replace("512x512", &format!("{size}x{size}"));
    let output = Command::new("sh")
        .args(["-c", &command])
        .current_dir(folder)
        .output()
        .unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command}: {complaints}");
}

/// Compares pictures of a mesh where there is no edge: a pixel may be any of its neighbours', since edges are smoothed by other points.
fn compare_inside(seen: &Path, rendered: &Path, size: usize) {
    let (seen, rendered) = (colours(seen), colours(rendered));
    assert_eq!((seen.len(), rendered.len()), (size * size, size * size));
    let (mut off, mut lit) = (0, 0);
    for y in 1..size - 1 {
        for x in 1..size - 1 {
            let (mut low, mut high) = ([255; 3], [0; 3]);
            for neighbour in 0..9 {
                let place = (y + neighbour / 3 - 1) * size + x + neighbour % 3 - 1;
                for channel in 0..3 {
                    low[channel] = rendered[place][channel].min(low[channel]);
                    high[channel] = rendered[place][channel].max(high[channel]);
                }
            }
            let colour = seen[y * size + x];
            let is_within = (0..3).all(|c| {
                colour[c].saturating_add(2) >= low[c] && colour[c] <= high[c].saturating_add(2)
            });
            off += usize::from(!is_within);
            lit += usize::from(high != [0; 3]);
        }
    }
    assert!(lit > 5000, "{lit} pixels are lit");
    assert!(off * 500 <= lit, "{off} of {lit} pixels differ");
}

/// A polyhedron around a sphere that is not at the origin: convex, so that it casts no shadow on itself.
fn write_ball(path: &Path) {
    let mut text = String::new();
    for [x, y, z] in [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ] {
        text += &format!("v {} {} {}\n", 5 + 2 * x, 1 + 2 * y, 2 * z);
    }
    for face in [
        "3 5 1", "3 1 6", "3 6 2", "3 2 5", "4 1 5", "4 6 1", "4 2 6", "4 5 2",
    ] {
        text += &format!("f {face}\n");
    }
    std::fs::write(path, text).unwrap();
}

/// sRGB of a colour channel as the page shows it: the tone curve, then the transfer function.
fn encode(x: f32) -> f32 {
    let toned = if x > 0.5 {
        1.0 - 0.5 * (1.0 - 2.0 * x).exp()
    } else {
        x
    };
    let encoded = if toned <= 0.003_130_8 {
        12.92 * toned
    } else {
        1.055 * toned.powf(1.0 / 2.4) - 0.055
    };
    255.0 * encoded
}

/// The slice's pixels against values of the library at the pairs that its axes name.
fn compare_slice(slice: &Value) {
    let material = Material::resolve("ward:sx=0.1,sy=0.3").unwrap();
    let loaded = material.load(LookupRule::Floor).unwrap();
    let (phi_h, phi_d) = (30f64.to_radians(), 70f64.to_radians());
    let mut grey = 0;
    for bin in slice["bins"].as_array().unwrap() {
        let theta_h = ((bin["h"].as_f64().unwrap() + 0.5) / 90.0).powi(2) * FRAC_PI_2;
        let theta_d = (bin["d"].as_f64().unwrap() + 0.5).to_radians();
        let turn = DQuat::from_rotation_z(phi_h) * DQuat::from_rotation_y(theta_h);
        let wi = turn * spherical(theta_d, phi_d);
        let wo = turn * spherical(theta_d, phi_d + PI);
        let value = loaded.brdf().eval(wo.as_vec3(), wi.as_vec3());
        for channel in 0..3 {
            let shown = bin["rgb"][channel].as_f64().unwrap() as f32;
            let expected = match wo.z.min(wi.z) > 0.0 {
                true => encode(value[channel]),
                false => f32::from(0x8au8),
            };
            assert!((shown - expected).abs() <= 1.0, "{bin}: {expected}");
        }
        grey += usize::from(wo.z.min(wi.z) <= 0.0);
    }
    assert!((1..4).contains(&grey), "{slice}");
    let caption = slice["caption"].as_str().unwrap();
    assert!(caption.contains("anisotropic"), "{caption}");
}

/// A member of the state in the address as a number; what is left out is 0.
fn number(state: &Value, name: &str) -> f64 {
    state[name]
        .as_str()
        .map_or(0.0, |text| text.parse().unwrap())
}

fn check_drops(drops: &Value) {
    let felt = &drops["felt.bsdf"];
    assert_eq!(felt["said"], "Loaded felt.");
    assert!(
        felt["materials"]
            .as_array()
            .unwrap()
            .contains(&"felt".into()),
        "{felt}"
    );
    let mesh = &drops["dropped.obj"];
    assert_eq!(
        (&mesh["said"], &mesh["shape"]),
        (&"Loaded dropped.".into(), &"dropped".into())
    );
    let broken = &drops["broken.obj"];
    assert!(
        broken["said"].as_str().unwrap().starts_with("broken.obj: "),
        "{broken}"
    );
    assert_eq!(broken["shape"], "dropped");
}

/// The first finger moves wo by half a degree a pixel and the light as well, and the page stays where it is.
fn check_touches(touches: &Value) {
    let [before, lobe, sphere] = [0, 1, 2].map(|k| &touches["states"][k]);
    let theta = number(lobe, "theta") - 30.0;
    assert!(theta.abs() > 10.0, "{touches}");
    assert!(number(lobe, "phi") != 0.0, "{touches}");
    assert_eq!(lobe["lightTheta"], before["lightTheta"]);
    assert!(number(sphere, "lightTheta") > 55.0, "{touches}");
    assert!(number(sphere, "lightPhi") > -25.0, "{touches}");
    assert_eq!(sphere["theta"], lobe["theta"]);
    assert_eq!(touches["scrolls"], serde_json::json!([0, 0]));
}

fn check_zooms(zooms: &Value) {
    // Fingers that were 0.1 of the canvas apart are 0.4 apart in the end, and their middle has not moved.
    let pinched = &zooms["pinched"];
    assert!(
        (number(pinched, "polarZoom") - 4.0).abs() < 0.4,
        "{pinched}"
    );
    assert!(
        (number(pinched, "polarX") - 0.375).abs() < 0.03,
        "{pinched}"
    );
    assert!(
        (number(pinched, "polarY") - 0.375).abs() < 0.03,
        "{pinched}"
    );
    assert!(
        zooms["caption"].as_str().unwrap().contains("Zoomed"),
        "{zooms}"
    );
    assert_eq!(number(&zooms["reset"], "polarZoom"), 0.0, "{zooms}");
    assert!(
        (number(&zooms["wheeled"], "plotZoom") - 2.0).abs() < 0.01,
        "{zooms}"
    );
    assert!(
        (number(&zooms["pressed"], "plotZoom") - 2.5).abs() < 0.01,
        "{zooms}"
    );
    let moved = number(&zooms["moved"], "plotX") - number(&zooms["pressed"], "plotX");
    assert!((moved - 0.04).abs() < 1e-3, "{zooms}");
    assert_eq!(number(&zooms["shrunk"], "plotZoom"), 0.0, "{zooms}");
    assert!(zooms["scrolled"].as_f64().unwrap() > 0.0, "{zooms}");
}

#[test]
fn anisotropic_materials_meshes_files_and_fingers() {
    let Some(chromium) = find_driven_chromium() else {
        return;
    };
    let scratch = tempfile::tempdir().unwrap();
    let folder = &choose_picture_folder(scratch.path());
    let ball = folder.join("ball.obj");
    write_ball(&ball);
    std::fs::copy(&ball, folder.join("dropped.obj")).unwrap();
    let lambert = Material::resolve("lambert").unwrap();
    let lambert = lambert.load(LookupRule::Floor).unwrap();
    let felt = tabulate(
        |wo, wi| lambert.brdf().eval(wo, wi),
        BsdfSize::ALL[0],
        String::new(),
    );
    felt.write(&folder.join("felt.bsdf"), Overwrite::Replace)
        .unwrap();
    let mesh = ball.display().to_string();
    let server = Server::start(&["nickel", "ward:sx=0.1,sy=0.3", "--mesh", &mesh]);
    let found = run_script(SHAPES, &chromium, &server.address, folder);

    for (name, rendered) in [
        ("brushed", "sphere.png"),
        ("mesh", "mesh.png"),
        ("smooth", "mesh.png"),
    ] {
        let part = &found[name];
        let seen = folder.join(format!("seen-{name}.png"));
        let size = part["size"].as_u64().unwrap();
        run_in_shell(folder, part["command"].as_str().unwrap(), size);
        let caption = part["caption"].as_str().unwrap();
        assert!(
            caption.contains("anisotropic") && caption.contains("99 of 100"),
            "{caption}"
        );
        if name == "brushed" {
            // The grid is off by up to 6 % at one pair in a hundred. 0.8 % of the pixels and 0.1 % of the brightness were measured; with sx = 0.11
            // 2.4 % of the pixels differ.
            Difference::measure(&seen, &folder.join(rendered)).assert_within(0.02, 0.005);
        } else {
            compare_inside(&seen, &folder.join(rendered), size as usize);
        }
    }
    let caption = found["mesh"]["caption"].as_str().unwrap();
    assert!(
        caption.contains("8 triangles; it casts no shadow on itself"),
        "{caption}"
    );
    assert!(
        found["skyCaption"]
            .as_str()
            .unwrap()
            .contains("under studio"),
        "{found}"
    );
    assert_eq!(found["hidden"], serde_json::json!([true, false]));
    compare_slice(&found["slice"]);
    check_drops(&found["drops"]);
    check_touches(&found["touches"]);
    check_zooms(&found["zooms"]);
}
