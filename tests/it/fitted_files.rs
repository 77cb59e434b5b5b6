//! Fits in files are read by MaterialX, Mitsuba 3 and the validator of glTF.
//!
//! Python packages are found or fetched as for [`crate::mitsuba`]; the validator is found by a `node` whose `NODE_PATH` has
//! `gltf-validator`. What is missing is skipped, saying so.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;

use glam::{DVec3, Vec3};
use merlkit::geometry::{cosine_hemisphere, reflect_about, spherical};
use merlkit::material::analytic::ModelFacts;
use merlkit::material::{LookupRule, Material};
use merlkit::points::PointSet;
use merlkit_evaluate::measure::fit::{FitModel, FitPlan, ModelFit, fit_models};
use merlkit_evaluate::report::{FitFormat, fitted_text};

use crate::mitsuba::PYTHON;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mitsuba/fitted.py");

/// Not by a macro, whose output the test harness would keep to itself.
fn skip(what: &str) -> bool {
    let note = format!("skipped: {what}\n");
    std::io::stderr().write_all(note.as_bytes()).unwrap();
    false
}

fn has_mitsuba() -> bool {
    PYTHON.is_some() || skip("no python3 with mitsuba (MERLKIT_MITSUBA=1 fetches it)")
}

/// Whether that Python has MaterialX as well.
static HAS_MATERIALX: LazyLock<bool> = LazyLock::new(|| {
    let Some(python) = PYTHON.as_ref() else {
        return false;
    };
    let runs = |arguments: &[&str]| {
        let output = Command::new(python).args(arguments).output();
        output.is_ok_and(|o| o.status.success())
    };
    let may_fetch = std::env::var_os("MERLKIT_MITSUBA").is_some_and(|v| v == "1");
    runs(&["-c", "import MaterialX"])
        || may_fetch
            && runs(&["-m", "pip", "install", "--quiet", "MaterialX"])
            && runs(&["-c", "import MaterialX"])
});

/// A fit to a plastic-like or metal-like formula.
fn fit(material: &str, model: &str) -> ModelFit {
    let brdf = ModelFacts::brdf(material).unwrap();
    let plan = FitPlan {
        pairs: 500,
        validation_pairs: 500,
        ..FitPlan::default()
    };
    let models = [FitModel::parse(model).unwrap()];
    let found = fit_models("sample", &*brdf, &models, &plan).unwrap();
    found.fits[0].clone()
}

const PLASTIC: &str =
    "lambert:reflectance=0.4/0.1/0.05+torrance:rough=0.25,nreal=1.6,nimag=0,ks=1,kd=0";
const CLOTH: &str =
    "lambert:reflectance=0.3/0.1/0.1+ggx:ax=0.6,ay=0.6,nreal=1.4,nimag=0+sheen:alpha=0.3,ks=0.3";
const METAL: &str = "he:sigma=0.3,tau=3,rgb=0.9/0.7/0.5";

fn succeeds(output: Output) -> String {
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaints}");
    String::from_utf8(output.stdout).unwrap()
}

/// Pairs of directions over the hemisphere and in the highlight.
fn pairs(count: u64) -> Vec<[Vec3; 2]> {
    let mut pairs = Vec::new();
    for i in 0..count {
        let [a, b] = [0, 1].map(|set| PointSet::Random.point(3, i, set).as_dvec2());
        let wo = cosine_hemisphere(a);
        let half = spherical(0.4 * b.x * b.x, std::f64::consts::TAU * b.y);
        let mirrored = reflect_about(wo, half);
        let near = i % 2 == 1 && mirrored.z > 0.01;
        let wi = if near { mirrored } else { cosine_hemisphere(b) };
        pairs.push([wo.as_vec3(), wi.as_vec3()]);
    }
    pairs
}

/// f·cosθi of a BSDF of a file, as Mitsuba reads it.
fn ask_mitsuba(folder: &Path, file: &str, id: &str, pairs: &[[Vec3; 2]]) -> Vec<DVec3> {
    let mut bytes = Vec::new();
    for number in pairs.iter().flatten().flat_map(|w| w.to_array()) {
        bytes.extend(number.to_le_bytes());
    }
    std::fs::write(folder.join("in"), bytes).unwrap();
    let mut command = Command::new(PYTHON.as_ref().unwrap());
    command.args(["-B", SCRIPT, "mitsuba", file, id, "in", "out"]);
    succeeds(command.current_dir(folder).output().unwrap());
    let answer = std::fs::read(folder.join("out")).unwrap();
    let numbers: Vec<f32> = answer
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect();
    let rows = numbers.chunks(3);
    rows.map(|row| Vec3::from_slice(row).as_dvec3()).collect()
}

/// Smith's Λ of GGX.
fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Mitsuba masks and shadows independently, 1/((1 + Λo)(1 + Λi)), where this library correlates heights, 1/(1 + Λo + Λi).
#[test]
fn mitsubas_ggx_is_the_fitted_one_pair_by_pair() {
    if !has_mitsuba() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let pairs = pairs(2000);
    for material in [PLASTIC, METAL] {
        let fit = fit(material, "ggx");
        let text = fitted_text(FitFormat::Mitsuba, "sample", &fit).unwrap();
        std::fs::write(folder.path().join("fit.xml"), text).unwrap();
        let theirs = ask_mitsuba(folder.path(), "fit.xml", "sample", &pairs);
        let (diffuse, lobe) = fit.material.split_once('+').unwrap();
        let parts = [diffuse, lobe].map(|part| ModelFacts::brdf(part).unwrap());
        let alpha = fit.lobes[0].shape("ax").unwrap();
        let (mut worst, mut darkest) = (0.0f64, 1.0f64);
        for ([wo, wi], theirs) in pairs.iter().zip(&theirs) {
            let [o, i] = [wo, wi].map(|w| lambda(w.as_dvec3(), alpha));
            let masking = (1.0 + o + i) / ((1.0 + o) * (1.0 + i));
            let [diffuse, lobe] = [0, 1].map(|k| parts[k].eval_cos(*wo, *wi).as_dvec3());
            let ours = diffuse + lobe * masking;
            let off = (ours - *theirs).abs().max_element() / ours.max_element().max(1e-4);
            worst = worst.max(off);
            darkest = darkest.min((theirs / (diffuse + lobe)).min_element());
        }
        assert!(worst < 2e-3, "{material}: {worst}");
        // With their masking the two differ, by a known amount and in one sense.
        assert!((0.5..1.0).contains(&darkest), "{material}: {darkest}");
    }
}

#[test]
fn mitsubas_principled_bsdf_looks_like_the_fit() {
    if !has_mitsuba() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let pairs = pairs(2000);
    for (material, model) in [(PLASTIC, "ggx"), (METAL, "ggx"), (PLASTIC, "ggx+ggx")] {
        let fit = fit(material, model);
        let text = fitted_text(FitFormat::Mitsuba, "sample", &fit).unwrap();
        std::fs::write(folder.path().join("fit.xml"), text).unwrap();
        let theirs = ask_mitsuba(folder.path(), "fit.xml", "sample_principled", &pairs);
        let ours = ModelFacts::brdf(&fit.material).unwrap();
        let mut sums = [DVec3::ZERO; 2];
        for ([wo, wi], theirs) in pairs.iter().zip(&theirs) {
            sums[0] += ours.eval_cos(*wo, *wi).as_dvec3().map(f64::cbrt);
            sums[1] += theirs.map(f64::cbrt);
        }
        let off = (sums[1] / sums[0] - 1.0).abs().max_element();
        assert!(off < 0.15, "{material}, {model}: {off}");
    }
}

#[test]
fn materialx_validates_the_file_and_makes_shaders_of_it() {
    if !has_mitsuba() || !*HAS_MATERIALX && !skip("no python3 with MaterialX") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (material, model) in [(PLASTIC, "ggx"), (METAL, "ggx+ggx"), (CLOTH, "ggx+sheen")] {
        let text = fitted_text(FitFormat::MaterialX, "a sample", &fit(material, model)).unwrap();
        std::fs::write(folder.path().join("fit.mtlx"), text).unwrap();
        let mut command = Command::new(PYTHON.as_ref().unwrap());
        command.args(["-B", SCRIPT, "materialx", "fit.mtlx"]);
        let names = succeeds(command.current_dir(folder.path()).output().unwrap());
        let names: Vec<&str> = names.lines().collect();
        assert_eq!(names, ["a_sample_openpbr", "a_sample_standard"]);
    }
}

/// Nickel in MaterialX's own renderer; Xvfb is display enough.
#[test]
fn materialx_renders_nickel() {
    if !has_mitsuba() || !*HAS_MATERIALX && !skip("no python3 with MaterialX") {
        return;
    }
    if std::env::var_os("DISPLAY").is_none() {
        skip("no display with OpenGL for MaterialX's renderer");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let nickel = Material::resolve("nickel").unwrap();
    let nickel = nickel.load(LookupRule::Linear).unwrap();
    let models = [FitModel::parse("ggx").unwrap()];
    let found = fit_models("nickel", &**nickel.brdf(), &models, &FitPlan::default()).unwrap();
    let text = fitted_text(FitFormat::MaterialX, "nickel", &found.fits[0]).unwrap();
    std::fs::write(folder.path().join("nickel.mtlx"), text).unwrap();
    for name in ["nickel_openpbr", "nickel_standard"] {
        let mut command = Command::new(PYTHON.as_ref().unwrap());
        let picture = folder.path().join(name).with_extension("png");
        let picture = picture.to_str().unwrap();
        command.args(["-B", SCRIPT, "render", "nickel.mtlx", name, picture]);
        let values = succeeds(command.current_dir(folder.path()).output().unwrap());
        let (largest, mean) = values.trim().split_once(' ').unwrap();
        // A highlight on a dark metal.
        assert!(largest.parse::<f64>().unwrap() > 240.0, "{name}: {values}");
        assert!(
            (20.0..90.0).contains(&mean.parse::<f64>().unwrap()),
            "{name}: {values}"
        );
    }
}

const VALIDATE: &str = "const fs = require('fs'), v = require('gltf-validator');
v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))
 .then(r => { console.log(JSON.stringify(r.issues)); process.exit(r.issues.numErrors + r.issues.numWarnings ? 1 : 0) });";

#[test]
fn the_validator_of_gltf_has_nothing_to_say() {
    let found = Command::new("node")
        .args(["-e", "require('gltf-validator')"])
        .output()
        .is_ok_and(|o| o.status.success());
    if !found {
        skip("no node with gltf-validator on NODE_PATH");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let brushed = "lambert:reflectance=0.1+ggx:ax=0.1,ay=0.3,nreal=5,nimag=0";
    for (material, model) in [
        (PLASTIC, "ggx"),
        (METAL, "ggx+ggx"),
        (brushed, "ggx"),
        (CLOTH, "ggx+sheen"),
    ] {
        let text = fitted_text(FitFormat::Gltf, "sample", &fit(material, model)).unwrap();
        std::fs::write(folder.path().join("fit.gltf"), text).unwrap();
        let mut command = Command::new("node");
        command.args(["-e", VALIDATE, "fit.gltf"]);
        let output = command.current_dir(folder.path()).output().unwrap();
        let issues = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{issues}");
    }
}
