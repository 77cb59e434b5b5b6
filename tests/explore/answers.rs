//! Answers are the library's numbers, to the bit.

use merlkit::files::Overwrite;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::glam::{DVec3, Vec3};
use merlkit::light::{Environment, EnvironmentSource, SkySampling};
use merlkit::material::merl::{CellFormat, Header, MerlTable};
use merlkit::material::rgl::{BsdfFile, BsdfSize, RglBrdf, tabulate};
use merlkit::sampler::{AdaptiveDisc, HalfVectorSettings};
use merlkit::{Brdf, Loaded, LookupRule, Material, SamplerSpec, export::Export};
use serde_json::{Value, json};

use crate::read::{ask, ask_json, session};

fn load(argument: &str) -> Loaded {
    let material = Material::resolve(argument).unwrap();
    material.load(LookupRule::Floor).unwrap()
}

fn direction(theta: f64, phi: f64) -> Vec3 {
    spherical(theta.to_radians(), phi.to_radians()).as_vec3()
}

#[test]
fn draws_and_their_densities_are_those_of_the_library() {
    let session = session(&["nickel"]);
    let loaded = load("nickel");
    let wo = direction(45.0, 30.0);
    for text in ["cosine", "half-vector:tables=6,rows=20", "lobe:ggx"] {
        let encoded = text
            .replace(':', "%3A")
            .replace(',', "%2C")
            .replace('=', "%3D");
        let key =
            format!("api/v1/draws?material=0&sampler={encoded}&theta=45&phi=30&count=300&seed=7");
        let answer = ask(&session, &key);
        let sampler = text.parse::<SamplerSpec>().unwrap().build(&loaded).unwrap();
        let drawn = sampler.draw_stratified(wo, 300, 7);
        let (wi, pdf) = (answer.bits("wi"), answer.bits("pdf"));
        let weight = answer.bits("weight");
        for (k, draw) in drawn.iter().enumerate() {
            let (expected_wi, expected_pdf) = draw.map_or((Vec3::ZERO, 0.0), |d| (d.wi, d.pdf));
            assert_eq!(
                wi[3 * k..3 * k + 3],
                expected_wi.to_array().map(f32::to_bits)
            );
            assert_eq!(pdf[k], expected_pdf.to_bits(), "{text}: draw {k}");
            let Some(draw) = draw else { continue };
            assert_eq!(pdf[k], sampler.pdf(wo, draw.wi).to_bits());
            let value = loaded.brdf().eval_cos(wo, draw.wi) / draw.pdf;
            assert_eq!(weight[3 * k..3 * k + 3], value.to_array().map(f32::to_bits));
        }
        let failed = drawn.iter().filter(|draw| draw.is_none()).count();
        assert_eq!(answer.members["failed"], failed);
    }
}

#[test]
fn lobes_are_values_of_the_brdf() {
    let arguments = ["nickel", "ward:sx=0.1,sy=0.4"];
    let session = session(&arguments);
    for (id, argument) in arguments.iter().enumerate() {
        let key = format!("api/v1/lobe?material={id}&theta=60&phi=20&rows=9&columns=12");
        let answer = ask(&session, &key);
        let found = answer.bits("f");
        let loaded = load(argument);
        for row in 0..9 {
            for column in 0..12 {
                let theta_i = (row as f64 + 0.5) / 9.0 * 90.0;
                let wi = direction(theta_i, column as f64 / 12.0 * 360.0);
                let value = loaded.brdf().eval(direction(60.0, 20.0), wi);
                let start = 3 * (12 * row + column);
                let bits = value.to_array().map(f32::to_bits);
                assert_eq!(found[start..start + 3], bits, "{argument} {row} {column}");
            }
        }
    }
}

#[test]
fn tables_hold_the_words_of_compact_cells() {
    let session = session(&["nickel", "lambert:reflectance=0.5", "ward:sx=0.1,sy=0.4"]);
    let answer = ask(&session, "api/v1/table?material=0");
    assert_eq!(answer.members["arrays"][0]["shape"], json!([90, 90, 180]));
    assert_eq!(answer.members["resampled"], false);
    let measured = load("nickel").table().unwrap().table().as_ref().clone();
    let compact = measured.with_cell_format(CellFormat::Rgb9e5).unwrap();
    let unit = answer.members["unit"].as_f64().unwrap() as f32;
    // The words are decoded here as a page decodes them.
    for (k, &word) in answer.bits("table").iter().enumerate() {
        let cell = compact.cell(k);
        assert_eq!(word == 0xf800_0000, cell.w == 0.0, "cell {k}");
        if cell.w == 0.0 {
            continue;
        }
        let scale = (word >> 27) as f32;
        for (channel, shift) in [0, 9, 18].into_iter().enumerate() {
            let value = (word >> shift & 511) as f32 * scale.exp2() * unit;
            assert_eq!(value, cell[channel], "cell {k}");
        }
    }
    let error = compact.rounding_errors().unwrap();
    let greatest = error.iter().fold(0f32, |most, e| most.max(e.greatest));
    assert_eq!(answer.members["error"].as_f64().unwrap() as f32, greatest);

    let resampled = ask(&session, "api/v1/table?material=1");
    assert_eq!(resampled.members["resampled"], true);
    let refusal = session.answer("api/v1/table?material=2").unwrap_err();
    assert_eq!(refusal.status, 400);
    assert!(refusal.message.contains("anisotropic"), "{refusal}");
}

#[test]
fn run_time_files_are_those_of_the_export() {
    let session = session(&["nickel"]);
    let answer = session.answer("api/v1/runtime?material=0").unwrap();
    let material = Material::resolve("nickel").unwrap();
    let settings = HalfVectorSettings::default();
    let export = Export::new(&material, &load("nickel"), settings).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nickel.merlkit");
    export.write_runtime(&path, Overwrite::Refuse).unwrap();
    assert!(std::fs::read(path).unwrap() == answer.bytes.as_ref());
}

#[test]
fn discs_are_the_leaves_of_the_nearest_tree() {
    let session = session(&["nickel"]);
    let answer = ask(&session, "api/v1/disc?material=0&theta=40&n_max=4");
    let spec: SamplerSpec = "adaptive-disc:n-max=4".parse().unwrap();
    let sampler = spec.build(&load("nickel")).unwrap();
    let disc: &AdaptiveDisc = sampler.downcast().unwrap();
    let tree = disc.subdivision(40f64.to_radians());
    let rectangles = answer.floats("rectangles");
    assert_eq!(rectangles.len(), 4 * tree.cells.len());
    let (mut area, mut probability) = (0.0, 0.0);
    for (k, cell) in tree.cells.iter().enumerate() {
        assert_eq!(answer.floats("bounds")[k], cell.bound);
        assert_eq!(answer.floats("probabilities")[k], cell.share as f32);
        assert_eq!(cell.bound > 0.0, cell.share > 0.0);
        let [x0, y0, x1, y1] = *rectangles[4 * k..].first_chunk().unwrap();
        area += f64::from((x1 - x0) * (y1 - y0));
        probability += cell.share;
    }
    assert!((area - 4.0).abs() < 1e-9, "{area}");
    assert!((probability - 1.0).abs() < 1e-6, "{probability}");
    let trials = answer.members["trials"].as_f64().unwrap();
    assert!((1.0..4.5).contains(&trials), "{trials}");
}

#[test]
fn albedos_of_turned_surfaces_are_those_of_the_direction() {
    let session = session(&["lambert:reflectance=0.2/0.4/0.8", "ward:sx=0.1,sy=0.4"]);
    let answer = ask_json(&session, "api/v1/albedo?material=0&theta=30&phi=10");
    for (channel, expected) in [0.2, 0.4, 0.8].into_iter().enumerate() {
        let found = answer["rgb"][channel].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-4, "{answer}");
    }
    // A brushed surface has other albedos along and across its grooves: those of wo itself.
    let brushed = load("ward:sx=0.1,sy=0.4");
    let mut found = Vec::new();
    for phi in [0, 90] {
        let key = format!("api/v1/albedo?material=1&theta=70&phi={phi}");
        let answer = ask_json(&session, &key);
        let wo = direction(70.0, f64::from(phi));
        let direct = Quadrature::new(wo, POINTS_PER_BIN)
            .integrate(|wi| f64::from(brushed.brdf().eval_cos(wo, wi).x));
        let rgb = answer["rgb"][0].as_f64().unwrap();
        assert!((rgb - direct).abs() < 2e-4, "{phi}: {rgb} {direct}");
        assert!(answer["error"].as_f64().unwrap() < 1e-2, "{answer}");
        found.push(rgb);
    }
    assert!((found[0] - found[1]).abs() > 2e-3, "{found:?}");
}

#[test]
fn directions_of_environments_have_the_densities_of_their_maps() {
    let session = session(&["lambert"]);
    let source = EnvironmentSource::from_name("studio").unwrap();
    let map = source.load_map(SkySampling::Importance).unwrap();
    let rest = "name=studio&material=0&theta=30&phi=0&keep=200&seed=3";
    let key = format!("api/v1/environment-draws?{rest}&candidates=1&strategy=light");
    let answer = ask(&session, &key);
    let (wi, pdf) = (answer.floats("wi"), answer.floats("pdf"));
    for k in 0..200 {
        let local = Vec3::from_slice(&wi[3 * k..]).as_dvec3();
        let world = DVec3::new(local.x, local.z, -local.y);
        let expected = map.pdf(world.normalize()) as f32;
        assert!(
            (pdf[k] / expected - 1.0).abs() < 1e-2,
            "{} {expected}",
            pdf[k]
        );
        let point = Environment::map_point(world).as_vec2();
        let found = &answer.floats("uv")[2 * k..2 * k + 2];
        assert!((found[0] - point.x).abs() < 1e-5 && (found[1] - point.y).abs() < 1e-5);
    }
    // Of one candidate, resampling keeps that of the BRDF, with its density.
    let key =
        |strategy| format!("api/v1/environment-draws?{rest}&candidates=1&strategy={strategy}");
    let [brdf, ris] = ["brdf", "ris"].map(|strategy| ask(&session, &key(strategy)));
    assert_eq!(brdf.bits("wi"), ris.bits("wi"));
    assert_eq!(brdf.bits("pdf"), ris.bits("pdf"));
}

#[test]
fn files_that_are_sent_become_materials() {
    let session = session(&["lambert"]);
    let ward = load("ward:sx=0.3,sy=0.3");
    let file = tabulate(
        |wo, wi| ward.brdf().eval(wo, wi),
        BsdfSize::ALL[0],
        String::new(),
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("felt.bsdf");
    file.write(&path, Overwrite::Refuse).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let answer = session
        .answer_upload("name=..%2Fbrdfs%2Ffelt.bsdf", &bytes)
        .unwrap();
    let entry: Value = serde_json::from_slice(&answer.bytes).unwrap();
    assert_eq!((&entry["id"], &entry["name"]), (&json!(1), &json!("felt")));
    assert_eq!(
        (&entry["kind"], &entry["text"]),
        (&json!("rgl"), &Value::Null)
    );
    let found = ask(
        &session,
        "api/v1/lobe?material=1&theta=30&phi=0&rows=5&columns=4",
    );
    let brdf = RglBrdf::new(BsdfFile::open(&path).unwrap());
    for k in 0..20 {
        let wi = direction((f64::from(k / 4) + 0.5) * 18.0, f64::from(k % 4) * 90.0);
        let value = brdf.eval(direction(30.0, 0.0), wi);
        let start = 3 * k as usize;
        let bits = value.to_array().map(f32::to_bits);
        assert_eq!(found.bits("f")[start..start + 3], bits, "{k}");
    }
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| [0.25; 3]);
    let path = folder.path().join("grey.binary");
    merlkit::material::merl::write(&table, &path, Overwrite::Refuse).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let answer = session.answer_upload("name=grey.binary", &bytes).unwrap();
    let entry: Value = serde_json::from_slice(&answer.bytes).unwrap();
    assert_eq!((&entry["id"], &entry["kind"]), (&json!(2), &json!("merl")));
    assert!(session.answer("api/v1/runtime?material=2").is_ok());
}

#[test]
fn formulas_are_registered_once_and_paths_are_none() {
    let session = session(&["nickel"]);
    let key = "api/v1/formula?text=ward%3Asx%3D0.2%2Csy%3D0.3";
    let entry = ask_json(&session, key);
    assert_eq!(
        (&entry["id"], &entry["isotropic"]),
        (&json!(1), &json!(false))
    );
    assert_eq!(entry["model"], "ward");
    let parameter = &entry["parameters"][0];
    assert_eq!(parameter["name"], "sx");
    assert_eq!(
        (&parameter["min"], &parameter["value"]),
        (&json!(0.001), &json!(0.2))
    );
    assert_eq!(ask_json(&session, key)["id"], 1);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ward");
    std::fs::write(&file, b"no BRDF").unwrap();
    let file = file.display().to_string();
    for text in [
        "..%2F..%2Fetc%2Fpasswd",
        "nickel",
        "%2Fdev%2Fzero",
        "",
        "lambert%2B%2Fetc%2Fpasswd",
        &file,
    ] {
        let key = format!("api/v1/formula?text={text}");
        let refusal = session.answer(&key).unwrap_err();
        assert_eq!(refusal.status, 400, "{text}");
        assert!(refusal.message.contains("no model is called"), "{refusal}");
    }
    for name in ["..%2Fsky.exr", "sky.hdr", "%2Fdev%2Fzero"] {
        let key = format!("api/v1/environment?name={name}");
        assert_eq!(session.answer(&key).unwrap_err().status, 404, "{name}");
    }
    assert_eq!(
        ask_json(&session, "api/v1/materials")["materials"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
}
