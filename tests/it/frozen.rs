//! What the code computes, frozen to the bit: values, draws, densities, bytes, pixels and figures.
//!
//! `tests/golden/frozen.csv` holds one row for each thing that is frozen, with a hash of the bits or, for a number of bytes, the
//! number itself. `MERLKIT_FREEZE=1 cargo test --release --test it frozen` writes the file anew, which is right only for a change
//! that is meant to change results.
//!
//! The hashes do not depend on the number of threads. They do depend on the sines, exponentials and logarithms of the platform's
//! C library. Where these differ from those of x86-64 Linux, write the file anew from the last commit that is known to be good
//! before a change is judged by it.
//!
//! All use of the library stands in the module `library`; the rest deals with names, numbers and hashes.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use library::{Figures, Material, Picture};

/// The library's interface, in as few places as possible: when names or paths change, this module alone is adapted.
mod library {
    use std::collections::BTreeMap;
    use std::path::Path;
    use std::sync::{Arc, LazyLock};

    use glam::{DVec3, Vec2, Vec3};
    use merlkit::Wo;
    use merlkit::brdf::Brdf;
    use merlkit::direction_sampler::DirectionSample;
    use merlkit::distribution::Heuristic;
    use merlkit::files::Overwrite;
    use merlkit::geometry::{Symmetry, spherical};
    use merlkit::light::{EnvironmentSource, LightSpec};
    use merlkit::material::Loaded;
    use merlkit::material::merl::{HardCase, MerlTable, decode_embedded};
    use merlkit::material::merl::{LookupRule, MerlBrdf};
    use merlkit::material::rgl::{BsdfFile, RglBrdf};
    use merlkit::points::{PointSet, Stream};
    use merlkit::render::{
        Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Strategy, Surface, render,
    };
    use merlkit::sampler::SamplerSpec;
    use merlkit_evaluate::measure::facts;
    use merlkit_evaluate::measure::profile::{
        AngleFigures, ProfileSettings, SamplerFigures, profile,
    };

    use crate::support::anisotropic::{Brushed, Resolution, bsdf_of};

    pub use crate::support::pairs;

    /// A sampler of any kind.
    pub type Sampler = merlkit::sampler::Sampler;

    /// The lookup rules by name.
    pub const LOOKUPS: [&str; 3] = ["floor", "linear", "centred"];

    fn lookup_rule(name: &str) -> LookupRule {
        match name {
            "floor" => LookupRule::Floor,
            "linear" => LookupRule::Linear,
            "centred" => LookupRule::Centred,
            _ => panic!("no lookup rule {name}"),
        }
    }

    fn sampler_spec(text: &str) -> SamplerSpec {
        text.parse().unwrap()
    }

    /// A material with its lookup rule.
    #[derive(Clone)]
    pub struct Material {
        pub name: &'static str,
        /// `-` for the anisotropic file, which has no rule.
        pub lookup: &'static str,
        brdf: Loaded,
    }

    /// The name of the anisotropic material.
    pub const BRUSHED: &str = "brushed";

    fn brushed_file() -> BsdfFile {
        let metal = Brushed {
            turned: 0.5,
            ..Brushed::STRONG
        };
        bsdf_of(&metal, Symmetry::Half, Resolution::COARSE)
    }

    /// A material of the library's own, or a hard case as `hard:holes`, or [`BRUSHED`]. It is decoded once. It is decoded by
    /// the thread pool, so only threads outside of the pool may ask for one.
    pub fn material(name: &'static str, lookup: &'static str) -> Material {
        static TABLES: LazyLock<BTreeMap<&str, Arc<MerlTable>>> = LazyLock::new(|| {
            let table = |name: &str| match name.strip_prefix("hard:") {
                Some(case) => HardCase::named(case).expect("a hard case").table(),
                None => decode_embedded(name).expect("an embedded material"),
            };
            let names = super::MATERIALS.iter();
            names.map(|&name| (name, Arc::new(table(name)))).collect()
        });
        static FILE: LazyLock<Arc<RglBrdf>> =
            LazyLock::new(|| Arc::new(RglBrdf::new(brushed_file())));
        let brdf = match name {
            BRUSHED => Loaded::from_brdf(FILE.clone()).with_own_sampler(FILE.clone()),
            _ => {
                let measured = MerlBrdf::new(TABLES[name].clone(), lookup_rule(lookup));
                Loaded::from_table(Arc::new(measured))
            }
        };
        Material {
            name,
            lookup: if name == BRUSHED { "-" } else { lookup },
            brdf,
        }
    }

    /// One function of the BRDF: for one pair, and for many.
    pub struct Evaluations {
        pub single: Vec<Vec3>,
        pub pairs: Vec<Vec3>,
    }

    impl Material {
        fn as_dyn(&self) -> &dyn Brdf {
            &**self.brdf.brdf()
        }

        pub fn eval(&self, wo: &[Vec3], wi: &[Vec3]) -> Evaluations {
            let mut pairs = vec![Vec3::ZERO; wo.len()];
            self.as_dyn().eval_batch(Wo::Each(wo), wi, &mut pairs);
            let single = wo
                .iter()
                .zip(wi)
                .map(|(&wo, &wi)| self.as_dyn().eval(wo, wi))
                .collect();
            Evaluations { single, pairs }
        }

        pub fn eval_cos(&self, wo: &[Vec3], wi: &[Vec3]) -> Evaluations {
            let mut pairs = vec![Vec3::ZERO; wo.len()];
            self.as_dyn().eval_cos_batch(Wo::Each(wo), wi, &mut pairs);
            let brdf = self.as_dyn();
            let single = wo
                .iter()
                .zip(wi)
                .map(|(&wo, &wi)| brdf.eval_cos(wo, wi))
                .collect();
            Evaluations { single, pairs }
        }

        /// For one `wo`.
        pub fn eval_many(&self, wo: Vec3, wi: &[Vec3]) -> Evaluations {
            let mut pairs = vec![Vec3::ZERO; wi.len()];
            self.as_dyn().eval_batch(Wo::One(wo), wi, &mut pairs);
            let single = wi.iter().map(|&wi| self.as_dyn().eval(wo, wi)).collect();
            Evaluations { single, pairs }
        }

        /// Builds the sampler that `text` names.
        pub fn sampler(&self, text: &str) -> Sampler {
            sampler_spec(text).build(&self.brdf).unwrap()
        }
    }

    /// A direction and its density, or a failed draw.
    pub type Draw = Option<(Vec3, f32)>;

    fn draw(sample: Option<DirectionSample>) -> Draw {
        sample.map(|s| (s.wi, s.pdf))
    }

    pub fn sample(sampler: &Sampler, wo: Vec3, u: Vec2) -> Draw {
        draw(sampler.sample(wo, u))
    }

    pub fn sample_batch(sampler: &Sampler, wo: Vec3, points: &[Vec2]) -> Vec<Draw> {
        let mut out = vec![None; points.len()];
        sampler.sample_batch(Wo::One(wo), points, &mut out);
        out.into_iter().map(draw).collect()
    }

    pub fn sample_pairs(sampler: &Sampler, wo: &[Vec3], points: &[Vec2]) -> Vec<Draw> {
        let mut out = vec![None; wo.len()];
        sampler.sample_batch(Wo::Each(wo), points, &mut out);
        out.into_iter().map(draw).collect()
    }

    pub fn sample_many(sampler: &Sampler, wo: Vec3, count: usize, seed: u64) -> Vec<Draw> {
        sampler
            .draw_stratified(wo, count, seed)
            .into_iter()
            .map(draw)
            .collect()
    }

    pub fn pdf(sampler: &Sampler, wo: Vec3, wi: Vec3) -> f32 {
        sampler.pdf(wo, wi)
    }

    pub fn pdf_pairs(sampler: &Sampler, wo: &[Vec3], wi: &[Vec3]) -> Vec<f32> {
        let mut out = vec![0.0; wo.len()];
        sampler.pdf_batch(Wo::Each(wo), wi, &mut out);
        out
    }

    pub fn bytes(sampler: &Sampler) -> usize {
        sampler.bytes()
    }

    /// A direction by its polar angle and azimuth in radians.
    pub fn direction(theta: f64, phi: f64) -> Vec3 {
        spherical(theta, phi).as_vec3()
    }

    /// Independent points of the unit square.
    pub fn random_points(count: usize, seed: u64) -> Vec<Vec2> {
        let mut random = Stream::new(seed);
        (0..count)
            .map(|_| Vec2::new(random.next_f32(), random.next_f32()))
            .collect()
    }

    fn point_set(name: &str) -> PointSet {
        match name {
            "random" => PointSet::Random,
            "sobol" => PointSet::Sobol,
            "lattice" => PointSet::Lattice,
            _ => panic!("no point set {name}"),
        }
    }

    /// Four coordinates of point `index` of `count`.
    pub fn point4(set: &str, count: u64, seed: u64, index: u64, dimensions: u32) -> [f32; 4] {
        point_set(set).point4_of(count, seed, index, dimensions)
    }

    /// Two coordinates of point `index` of a sequence without end.
    pub fn point2(set: &str, seed: u64, index: u64, pair: u32) -> [f32; 2] {
        point_set(set).point(seed, index, pair).to_array()
    }

    /// What a small picture shows, in words.
    #[derive(Clone, Copy)]
    pub struct Picture {
        /// `point`, `directional`, `area`, `environment` or `uniform`.
        pub light: &'static str,
        /// `mis`, `mis:balance`, `light`, `brdf` or `ris`.
        pub strategy: &'static str,
        /// With a floor there are two spheres, so that light is reflected between surfaces.
        pub floor: bool,
        /// `sobol`, `lattice` or `random`.
        pub points: &'static str,
        pub samples: u64,
        /// `even`, `adaptive`, `error` (to a target error) or `everything` (even, with all effects forced on).
        pub mode: &'static str,
    }

    impl Picture {
        fn scene(&self) -> SceneSpec {
            let name = "sphere".to_owned();
            let spheres = if self.floor {
                vec![name.clone(), name]
            } else {
                vec![name]
            };
            let row = SceneSpec::row(&spheres, 1.5);
            let environment = LightSpec::Environment;
            let light = match self.light {
                name @ ("point" | "directional" | "area") => row.light(name).unwrap(),
                "environment" => environment(EnvironmentSource::Studio),
                "uniform" => environment(EnvironmentSource::Uniform(Vec3::new(0.5, 0.7, 0.9))),
                _ => panic!("no light {}", self.light),
            };
            let strategy = match self.strategy {
                "mis" => Strategy::Mis(Heuristic::Power),
                "mis:balance" => Strategy::Mis(Heuristic::Balance),
                "light" => Strategy::Light,
                "brdf" => Strategy::Brdf,
                "ris" => Strategy::Ris {
                    candidates: Strategy::CANDIDATES,
                },
                _ => panic!("no strategy {}", self.strategy),
            };
            let floor = self.floor.then_some(0.6);
            SceneSpec {
                lights: vec![light],
                floor,
                strategy,
                ..row
            }
        }

        /// Renders it; means and standard errors of the pixels, and other numbers that the way of rendering gives.
        pub fn render(&self, material: &Material, sampler: &Sampler) -> Pixels {
            let spec = self.scene();
            let request = match self.mode {
                "everything" => PlanRequest::Everything,
                _ => PlanRequest::AsNeeded,
            };
            let brdf = material.brdf.brdf().clone();
            let surface = |_, _| {
                Ok(Surface {
                    brdf: brdf.clone(),
                    sampler: Some(sampler.shared()),
                })
            };
            let scene = Scene::build(&spec, request, surface).unwrap();
            let budget = match self.mode {
                "adaptive" => Budget::Adaptive(self.samples),
                "error" => Budget::ToError {
                    error: 0.1,
                    most: self.samples,
                },
                _ => Budget::Even(self.samples),
            };
            let settings = RenderSettings {
                width: 48,
                height: 32,
                seed: 7,
                points: point_set(self.points),
                budget,
            };
            let rendered = render(&scene, &settings, &|_| {}).unwrap();
            let mut others = Vec::new();
            if let Some(refined) = &rendered.refinement {
                others.extend([refined.paths as f64, refined.traced as f64]);
                others.push(refined.error());
                others.extend(refined.tiles.iter().map(|t| t.error));
            }
            Pixels::of(&rendered.film, others)
        }
    }

    /// What a film holds, row by row.
    pub struct Pixels {
        pub means: Vec<DVec3>,
        pub errors: Vec<DVec3>,
        pub others: Vec<f64>,
    }

    impl Pixels {
        fn of(film: &Film, others: Vec<f64>) -> Self {
            let (w, h) = (film.width(), film.height());
            let each = |value: &dyn Fn(usize, usize) -> DVec3| {
                (0..w * h).map(|i| value(i % w, i / w)).collect()
            };
            Self {
                means: each(&|x, y| film.mean(x, y)),
                errors: each(&|x, y| film.standard_error(x, y)),
                others,
            }
        }
    }

    /// Named lists of numbers.
    pub type Figures = Vec<(&'static str, Vec<f64>)>;

    /// The figures of `report --json` that are the same in every run, for each sampler. `folder` is for temporary files. The
    /// bytes of sampler files are left out, because files hold the names of settings.
    pub fn report(name: &str, lookup: &str, samplers: &[&str], folder: &Path) -> Vec<Figures> {
        let path = folder.join("brushed.bsdf");
        let argument = if name == BRUSHED {
            brushed_file().write(&path, Overwrite::Refuse).unwrap();
            path.to_str().expect("a path in UTF-8")
        } else {
            name
        };
        let material = merlkit::material::Material::resolve(argument).unwrap();
        let specs: Vec<SamplerSpec> = samplers.iter().map(|s| sampler_spec(s)).collect();
        let settings = ProfileSettings {
            draws: 2000,
            timed_calls: 700,
            ..ProfileSettings::default()
        };
        let rule = if name == BRUSHED {
            LookupRule::Floor
        } else {
            lookup_rule(lookup)
        };
        let figures = profile(&material, rule, &specs, &settings, &|| {}).unwrap();
        let of_sampler = |s: &SamplerFigures| {
            let angles =
                |value: fn(&AngleFigures) -> f64| s.angles.iter().map(value).collect::<Vec<f64>>();
            vec![
                ("material bytes", vec![figures.material_bytes as f64]),
                ("table bytes", vec![s.table_bytes as f64]),
                ("failed draws", vec![s.calls.failed]),
                (
                    "angles",
                    [angles(|a| a.theta_o_deg), angles(|a| a.phi_o_deg)].concat(),
                ),
                ("relstd", angles(|a| a.spread.relstd)),
                ("albedo", angles(|a| a.spread.mean)),
                ("peak", angles(|a| a.spread.peak)),
                ("holes", angles(|a| a.spread.holes)),
                ("pdf integral", angles(|a| a.spread.pdf_integral)),
                ("bias", angles(|a| a.bias.relative)),
                ("bias error", angles(|a| a.bias.standard_error)),
                (
                    "summary",
                    vec![s.relstd(), s.worst_relstd(), s.worst_holes()],
                ),
            ]
        };
        figures.samplers.iter().map(of_sampler).collect()
    }

    /// The figures of `info --json`.
    pub fn info(material: &Material) -> Figures {
        let f = facts(&material.brdf);
        let (asymmetry, table) = (f.asymmetry.expect("isotropic"), f.table.expect("a table"));
        let wide = |channels: [f32; 3]| channels.map(f64::from);
        let albedo = f
            .albedo
            .iter()
            .flat_map(|a| [&wide(a.rgb)[..], &[a.error.into()]].concat());
        let above = &f.albedo_above_one;
        let ranges = above.ranges_degrees.iter().flatten().map(|&d| d as f64);
        let greatest = [f64::from(above.greatest), above.greatest_at_degrees as f64];
        let at = asymmetry.greatest_at.map(|i| i as f64);
        vec![
            ("albedo", albedo.collect()),
            (
                "albedo above one",
                greatest.into_iter().chain(ranges).collect(),
            ),
            (
                "asymmetry",
                [&[asymmetry.mean, asymmetry.greatest], &at[..]].concat(),
            ),
            ("range", [wide(table.min), wide(table.max)].concat()),
            (
                "invalid above horizon",
                vec![table.invalid_above_horizon as f64],
            ),
        ]
    }
}

/// Six embedded materials and a table with holes.
const MATERIALS: [&str; 7] = [
    "nickel",
    "chrome",
    "teflon",
    "red-plastic",
    "blue-metallic-paint",
    "red-fabric2",
    "hard:holes",
];

/// Samplers of isotropic materials.
const SAMPLERS: [&str; 19] = [
    "cosine",
    "half-vector:2KB",
    "half-vector:64KB",
    "half-vector:1MB",
    "half-vector:64KB,folded",
    "adaptive-disc",
    "adaptive-disc:rejection-free",
    "adaptive-disc:rejection",
    "adaptive-disc:published",
    "cascade-cdf",
    "cascade-cdf:uniform",
    "cascade-cdf:published",
    "lobe:cosine",
    "lobe:cosine-sphere",
    "lobe:blinn",
    "lobe:ward",
    "lobe:ashikhmin-shirley",
    "lobe:ggx",
    "factored",
];

/// Samplers of the anisotropic material.
const ANISOTROPIC: [&str; 4] = ["cosine", "half-vector:2KB", "half-vector:64KB", "file"];

/// FNV-1a of 64 bits.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.0 = (self.0 ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    fn f32s(&mut self, values: &[f32]) {
        values
            .iter()
            .for_each(|x| self.bytes(&x.to_bits().to_le_bytes()));
    }

    fn f64s(&mut self, values: &[f64]) {
        values
            .iter()
            .for_each(|x| self.bytes(&x.to_bits().to_le_bytes()));
    }

    fn text(&self) -> String {
        format!("{:016x}", self.0)
    }
}

fn hash_of_f32s(values: &[f32]) -> String {
    let mut hash = Hash::new();
    hash.f32s(values);
    hash.text()
}

fn hash_of_f64s(values: &[f64]) -> String {
    let mut hash = Hash::new();
    hash.f64s(values);
    hash.text()
}

fn hash_of_vectors(values: &[Vec3]) -> String {
    let mut hash = Hash::new();
    values.iter().for_each(|v| hash.f32s(&v.to_array()));
    hash.text()
}

fn hash_of_draws(draws: &[library::Draw]) -> String {
    let mut hash = Hash::new();
    for draw in draws {
        hash.bytes(&[u8::from(draw.is_some())]);
        if let Some((wi, pdf)) = draw {
            hash.f32s(&[wi.x, wi.y, wi.z, *pdf]);
        }
    }
    hash.text()
}

/// A key and what is frozen under it.
type Row = (String, String);

/// Heading of the file; the last column is what is frozen, all others are the key.
const HEADING: &str = "group,material,lookup,subject,figure,value";

/// The groups, in the order in which they stand in the file.
const GROUPS: [&str; 4] = ["eval", "sample", "render", "report"];

/// A row of the file, its fields quoted where they hold a comma.
fn row(fields: [&str; 5], value: impl Into<String>) -> Row {
    let quoted = fields.map(|f| {
        if f.contains(',') {
            format!("\"{f}\"")
        } else {
            f.to_owned()
        }
    });
    (quoted.join(","), value.into())
}

fn golden_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/frozen.csv")
}

/// All rows of the file; none if there is no file.
fn golden_rows() -> Vec<Row> {
    let text = std::fs::read_to_string(golden_path()).unwrap_or_default();
    let rows = text
        .lines()
        .skip(1)
        .map(|l| l.rsplit_once(',').expect("a value after a comma"));
    rows.map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect()
}

fn is_of(group: &str, row: &Row) -> bool {
    row.0.split(',').next() == Some(group)
}

/// Compares the rows of a group with those in the file, or replaces them there.
fn settle(group: &str, found: Vec<Row>) {
    // Several groups may end at the same time.
    static FILE: Mutex<()> = Mutex::new(());
    assert!(GROUPS.contains(&group) && found.iter().all(|r| is_of(group, r)));
    let keys: std::collections::BTreeSet<&String> = found.iter().map(|r| &r.0).collect();
    assert_eq!(
        keys.len(),
        found.len(),
        "two rows of {group} have the same key"
    );
    if std::env::var_os("MERLKIT_FREEZE").is_some_and(|v| v == "1") {
        let _guard = FILE
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        return write(group, found);
    }
    let differences = differences(group, &found, &golden_rows());
    let count = differences.lines().count();
    assert!(
        count == 0,
        "{count} of {} rows of {group} differ:\n{differences}",
        found.len()
    );
}

fn write(group: &str, found: Vec<Row>) {
    let mut rows: Vec<Row> = golden_rows()
        .into_iter()
        .filter(|r| !is_of(group, r))
        .collect();
    rows.extend(found);
    let place = |row: &Row| GROUPS.iter().position(|g| is_of(g, row));
    rows.sort_by_key(place);
    let lines = rows.iter().map(|(key, value)| format!("{key},{value}\n"));
    std::fs::write(
        golden_path(),
        format!("{HEADING}\n{}", lines.collect::<String>()),
    )
    .unwrap();
}

/// One line for each row that differs, is missing or is not in the file.
fn differences(group: &str, found: &[Row], golden: &[Row]) -> String {
    let golden: Vec<&Row> = golden.iter().filter(|r| is_of(group, r)).collect();
    let mut lines = String::new();
    for (key, value) in found {
        match golden.iter().find(|g| g.0 == *key) {
            Some(g) if g.1 == *value => {}
            Some(g) => writeln!(lines, "  {key}: {value}, frozen as {}", g.1).unwrap(),
            None => writeln!(lines, "  {key}: {value}, not frozen").unwrap(),
        }
    }
    for (key, value) in golden {
        if !found.iter().any(|f| f.0 == *key) {
            writeln!(lines, "  {key}: not computed, frozen as {value}").unwrap();
        }
    }
    lines
}

/// Pairs of directions above the horizon, and some that are no unit vectors, not above the horizon or no directions at all.
fn pairs(count: usize, seed: u64) -> (Vec<Vec3>, Vec<Vec3>) {
    let (a, b) = (library::direction(0.7, 0.3), library::direction(1.1, 2.9));
    let normal = Vec3::Z;
    let odd = [
        (normal, normal),
        (normal, a),
        (a, normal),
        (a, a),
        (a * 3.0, b * 0.25),
        (a * 1e-3, b * 1e3),
        (a, -b),
        (-a, b),
        (Vec3::X, b),
        (a, Vec3::NEG_Y),
        (a, Vec3::ZERO),
        (Vec3::ZERO, b),
        (Vec3::NAN, b),
        (a, Vec3::new(0.1, f32::NAN, 0.9)),
        (Vec3::INFINITY, b),
        (a, Vec3::new(0.0, 0.0, f32::INFINITY)),
        (a, Vec3::new(1.0, 0.0, 1e-7)),
        (Vec3::new(-1.0, 0.0, 1e-7), a),
    ];
    library::pairs(count, seed).chain(odd).unzip()
}

fn assert_same_bits(single: &[f32], many: &[f32], what: &str) {
    assert_eq!(single.len(), many.len(), "{what}");
    for (k, (a, b)) in single.iter().zip(many).enumerate() {
        assert_eq!(
            a.to_bits(),
            b.to_bits(),
            "{what}, number {k}: {a} alone, {b} among many"
        );
    }
}

fn flat(vectors: &[Vec3]) -> Vec<f32> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

#[test]
fn eval() {
    let materials: Vec<Material> = MATERIALS
        .iter()
        .flat_map(|name| library::LOOKUPS.map(|lookup| library::material(name, lookup)))
        .chain([library::material(library::BRUSHED, "-")])
        .collect();
    settle(
        "eval",
        materials.par_iter().flat_map_iter(eval_rows).collect(),
    );
}

fn eval_rows(material: &Material) -> Vec<Row> {
    let (wo, wi) = pairs(2000, 11);
    let what = format!("{} {}", material.name, material.lookup);
    let rows = [
        ("eval", material.eval(&wo, &wi)),
        ("eval cos", material.eval_cos(&wo, &wi)),
    ];
    for (figure, values) in &rows {
        let (single, pairs) = (flat(&values.single), flat(&values.pairs));
        assert_same_bits(&single, &pairs, &format!("{what} {figure}"));
    }
    for &wo in wo.iter().step_by(97) {
        let many = material.eval_many(wo, &wi[..99]);
        assert_same_bits(
            &flat(&many.single),
            &flat(&many.pairs),
            &format!("{what} eval many"),
        );
    }
    let row = |(figure, values): (&str, library::Evaluations)| {
        row(
            ["eval", material.name, material.lookup, "-", figure],
            hash_of_vectors(&values.single),
        )
    };
    rows.into_iter().map(row).collect()
}

#[test]
fn draws() {
    let floor = |name| library::material(name, "floor");
    let mut jobs: Vec<(Material, &str)> = Vec::new();
    for name in MATERIALS {
        // What takes seconds to build is drawn from for a few materials.
        let few = |s: &&&str| match **s {
            "adaptive-disc:published" => ["nickel", "teflon"].contains(&name),
            "adaptive-disc:rejection" | "factored" => {
                ["nickel", "chrome", "red-plastic", "hard:holes"].contains(&name)
            }
            _ => true,
        };
        jobs.extend(SAMPLERS.iter().filter(few).map(|&s| (floor(name), s)));
    }
    jobs.extend(ANISOTROPIC.map(|s| (library::material(library::BRUSHED, "-"), s)));
    jobs.extend(
        ["linear", "centred"].map(|l| (library::material("nickel", l), "half-vector:64KB")),
    );
    jobs.push((floor("blue-metallic-paint"), "half-vector:64KB,luminance"));
    let mut rows = point_rows();
    rows.par_extend(
        jobs.par_iter()
            .flat_map_iter(|(material, text)| draw_rows(material, text)),
    );
    settle("sample", rows);
}

/// The points that draws are made from.
fn point_rows() -> Vec<Row> {
    let sets = ["random", "sobol", "lattice"];
    let points = |set: &&str| {
        let mut numbers = Vec::new();
        for k in 0..500 {
            let (seed, set4) = (k % 7, (k % 11) as u32);
            numbers.extend(library::point4(set, 100 + k, seed, k * 13 % 300, set4));
            numbers.extend(library::point2(set, seed, k * k * k, set4));
        }
        row(["sample", "-", "-", *set, "points"], hash_of_f32s(&numbers))
    };
    sets.iter().map(points).collect()
}

/// Directions that draws are made at: from the normal to the horizon, one of another length, and two that have no draws.
fn outgoing() -> Vec<Vec3> {
    let mut wos: Vec<Vec3> = [0.0, 1e-4, 0.2, 0.6, 1.0, 1.3, 1.5, 1.5705]
        .iter()
        .enumerate()
        .map(|(k, &theta)| library::direction(theta, 0.4 + 1.9 * k as f64))
        .collect();
    wos.extend([library::direction(0.9, -2.0) * 2.5, Vec3::NEG_Z, Vec3::NAN]);
    wos
}

/// Points of the unit square, its edges among them.
fn points(count: usize, seed: u64) -> Vec<Vec2> {
    let edge = 1f32.next_down();
    let mut points = library::random_points(count - 4, seed);
    points.extend([
        Vec2::ZERO,
        Vec2::new(0.0, edge),
        Vec2::new(edge, 0.0),
        Vec2::splat(edge),
    ]);
    points
}

fn draw_rows(material: &Material, text: &str) -> Vec<Row> {
    let sampler = material.sampler(text);
    let what = format!("{} {} {text}", material.name, material.lookup);
    // Draws one by one, by `wo`, and all at once.
    let (mut wos, mut us, mut draws, mut many) = (vec![], vec![], vec![], vec![]);
    for (k, wo) in outgoing().into_iter().enumerate() {
        let points = points(200, 100 + k as u64);
        let single: Vec<_> = points
            .iter()
            .map(|&u| library::sample(&sampler, wo, u))
            .collect();
        let batch = library::sample_batch(&sampler, wo, &points);
        assert_eq!(
            hash_of_draws(&single),
            hash_of_draws(&batch),
            "{what}: a batch at {wo}"
        );
        draws.extend(single);
        wos.extend(vec![wo; points.len()]);
        us.extend(points);
        many.extend(library::sample_many(&sampler, wo, 64, k as u64));
    }
    // In another order, so that neighbours differ in `wo`.
    let order: Vec<usize> = (0..wos.len()).map(|k| k * 631 % wos.len()).collect();
    let (wos, us): (Vec<Vec3>, Vec<Vec2>) = order.iter().map(|&k| (wos[k], us[k])).unzip();
    let shuffled: Vec<_> = order.iter().map(|&k| draws[k]).collect();
    let paired = library::sample_pairs(&sampler, &wos, &us);
    assert_eq!(
        hash_of_draws(&shuffled),
        hash_of_draws(&paired),
        "{what}: pairs"
    );

    let (wo, wi) = pairs(2000, 23);
    let densities: Vec<f32> = wo
        .iter()
        .zip(&wi)
        .map(|(&wo, &wi)| library::pdf(&sampler, wo, wi))
        .collect();
    assert_same_bits(
        &densities,
        &library::pdf_pairs(&sampler, &wo, &wi),
        &format!("{what}: pdf"),
    );

    let row = |figure: &str, value: String| {
        row(
            ["sample", material.name, material.lookup, text, figure],
            value,
        )
    };
    vec![
        row("draws", hash_of_draws(&draws)),
        row("many draws", hash_of_draws(&many)),
        row("densities", hash_of_f32s(&densities)),
        row("bytes", library::bytes(&sampler).to_string()),
    ]
}

const LIGHTS: [&str; 5] = ["point", "directional", "area", "environment", "uniform"];
const STRATEGIES: [&str; 5] = ["mis", "mis:balance", "light", "brdf", "ris"];

/// A picture in the studio, from which others differ in a few things.
const STUDIO: Picture = Picture {
    light: "environment",
    strategy: "mis",
    floor: false,
    points: "lattice",
    samples: 6,
    mode: "even",
};

#[test]
fn pictures() {
    let floor = |name| library::material(name, "floor");
    let (nickel, table) = (floor("nickel"), "half-vector:64KB");
    let mut jobs: Vec<(Material, &str, Vec<Picture>)> = Vec::new();
    jobs.push((nickel.clone(), table, nickel_pictures()));
    for (name, points) in [("red-plastic", "sobol"), ("blue-metallic-paint", "random")] {
        let of = |light| {
            [false, true].map(|floor| Picture {
                light,
                floor,
                points,
                samples: 4,
                ..STUDIO
            })
        };
        jobs.push((
            floor(name),
            table,
            LIGHTS.iter().flat_map(|&l| of(l)).collect(),
        ));
    }
    // Each of the other samplers, alone and with a floor.
    let both = vec![
        Picture {
            strategy: "brdf",
            ..STUDIO
        },
        Picture {
            floor: true,
            ..STUDIO
        },
    ];
    let others = SAMPLERS
        .iter()
        .filter(|s| **s != table && **s != "adaptive-disc:published");
    jobs.extend(others.map(|&s| (nickel.clone(), s, both.clone())));
    let brushed = library::material(library::BRUSHED, "-");
    jobs.extend(ANISOTROPIC.map(|s| (brushed.clone(), s, both.clone())));
    jobs.push((floor("hard:holes"), table, both.clone()));
    jobs.push((library::material("nickel", "centred"), table, both));
    let rows = jobs.par_iter().flat_map_iter(|(material, text, pictures)| {
        let sampler = material.sampler(text);
        pictures
            .iter()
            .flat_map(move |p| picture_rows(material, text, &sampler, p))
    });
    settle("render", rows.collect());
}

/// All lights by all strategies, and all ways of rendering with all sets of points.
fn nickel_pictures() -> Vec<Picture> {
    let mut pictures = Vec::new();
    for light in LIGHTS {
        for strategy in STRATEGIES {
            pictures.extend([false, true].map(|floor| Picture {
                light,
                strategy,
                floor,
                ..STUDIO
            }));
        }
    }
    for points in ["sobol", "lattice", "random"] {
        for strategy in ["mis", "ris"] {
            let modes = [
                ("even", 5),
                ("adaptive", 16),
                ("adaptive", 23),
                ("error", 64),
            ];
            pictures.extend(modes.map(|(mode, samples)| Picture {
                strategy,
                floor: true,
                points,
                samples,
                mode,
                ..STUDIO
            }));
        }
    }
    let everything = |floor| Picture {
        floor,
        mode: "everything",
        ..STUDIO
    };
    pictures.extend([false, true].map(everything));
    pictures
}

fn picture_rows(
    material: &Material,
    text: &str,
    sampler: &library::Sampler,
    picture: &Picture,
) -> Vec<Row> {
    let Picture {
        light,
        strategy,
        points,
        samples,
        mode,
        ..
    } = picture;
    let floor = if picture.floor { " floor" } else { "" };
    let shown = format!("{light} {strategy}{floor} {samples} {points} {mode}");
    let pixels = picture.render(material, sampler);
    let flat = |v: &[glam::DVec3]| v.iter().flat_map(|p| p.to_array()).collect::<Vec<f64>>();
    let errors = [flat(&pixels.errors), pixels.others].concat();
    let row = |figure: &str, values: &[f64]| {
        let figure = format!("{shown}: {figure}");
        row(
            ["render", material.name, material.lookup, text, &figure],
            hash_of_f64s(values),
        )
    };
    vec![row("pixels", &flat(&pixels.means)), row("errors", &errors)]
}

#[test]
fn report() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = Vec::new();
    let mut add = |material: &str, lookup: &str, subject: &str, figures: Figures| {
        for (figure, values) in figures {
            // Numbers of bytes are frozen as they are, and so can be read.
            let value = match (figure.ends_with("bytes"), &values[..]) {
                (true, [bytes]) => bytes.to_string(),
                _ => hash_of_f64s(&values),
            };
            rows.push(row(["report", material, lookup, subject, figure], value));
        }
    };
    let three = ["cosine", "half-vector:64KB", "lobe:ggx"];
    for (name, lookup, samplers) in [
        ("nickel", "floor", &three[..]),
        ("teflon", "linear", &three),
        (library::BRUSHED, "-", &["half-vector:2KB"]),
    ] {
        let figures = library::report(name, lookup, samplers, folder.path());
        assert_eq!(figures.len(), samplers.len());
        for (subject, figures) in samplers.iter().zip(figures) {
            add(name, lookup, subject, figures);
        }
    }
    for name in ["nickel", "hard:holes"] {
        add(
            name,
            "floor",
            "-",
            library::info(&library::material(name, "floor")),
        );
    }
    settle("report", rows);
}
