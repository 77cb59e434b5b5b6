//! Sampler files: the same bits after a round trip, and damage is noticed, even where the checksum fits.

use crate::support::loaded;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::material::Material;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::store::{SamplerFile, save};
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, FactoredSettings, Factors, HalfVectorSettings,
    LeafChoice, LobeKind, LobeSettings, Sampler, SamplerSpec,
};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use sha2::{Digest, Sha256};

fn specs() -> [SamplerSpec; 9] {
    [
        SamplerSpec::new(AdaptiveDiscSettings {
            tables: 7,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 5,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 3,
            ..CascadeCdfSettings::uniform()
        }),
        SamplerSpec::new(AdaptiveDiscSettings {
            tables: 4,
            leaves: LeafChoice::Warp,
            ..Default::default()
        }),
        SamplerSpec::new(HalfVectorSettings::default()),
        SamplerSpec::new(HalfVectorSettings::PRESETS[0].1),
        SamplerSpec::new(LobeSettings::fitted(LobeKind::Ggx)),
        SamplerSpec::new(LobeSettings::fitted(LobeKind::AshikhminShirley)),
        factored(),
    ]
}

fn factored() -> SamplerSpec {
    let factors = Factors {
        outer: 3,
        inner: 2,
        theta: 40,
        phi: 12,
        half: true,
        floor: 0.01,
    };
    SamplerSpec::new(FactoredSettings {
        tables: 5,
        factors: Some(factors),
        ..Default::default()
    })
}

fn built(spec: SamplerSpec, folder: &Path) -> (Sampler, Arc<MerlBrdf>, std::path::PathBuf) {
    let material = Material::resolve("red-plastic").unwrap();
    let brdf = material
        .load(LookupRule::Floor)
        .unwrap()
        .table()
        .unwrap()
        .clone();
    let sampler = spec.build(&loaded(&brdf)).unwrap();
    let path = folder.join("s.safetensors");
    save(&sampler, &material, &path, Overwrite::Replace).unwrap();
    (sampler, brdf, path)
}

#[test]
fn a_loaded_sampler_draws_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    for spec in specs() {
        let (fresh, _, path) = built(spec, folder.path());
        let (loaded, _) = SamplerFile::open(&path).unwrap().load(None).unwrap();
        assert_eq!(loaded.spec(), fresh.spec());
        assert_eq!(loaded.bytes(), fresh.bytes());
        for degrees in [0.0, 33.3, 71.0, 89.9] {
            let wo = spherical(f64::to_radians(degrees), 2.0).as_vec3();
            for i in 0..2000 {
                let u = PointSet::Sobol.point(5, i, 0);
                let (a, b) = (fresh.sample(wo, u), loaded.sample(wo, u));
                assert_eq!(a, b);
                let wi = a.map_or(Vec3::Z, |s| s.wi);
                assert_eq!(fresh.pdf(wo, wi).to_bits(), loaded.pdf(wo, wi).to_bits());
            }
        }
    }
}

#[test]
fn saving_twice_gives_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let (_, _, path) = built(specs()[1].clone(), folder.path());
    let first = std::fs::read(&path).unwrap();
    let (_, _, path) = built(specs()[1].clone(), folder.path());
    assert!(first == std::fs::read(&path).unwrap());
}

#[test]
fn every_flipped_byte_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    for spec in specs() {
        let (_, brdf, path) = built(spec, folder.path());
        let good = std::fs::read(&path).unwrap();
        let bad = folder.path().join("bad");
        let load = |bytes: &[u8]| {
            std::fs::write(&bad, bytes).unwrap();
            SamplerFile::open(&bad).and_then(|f| f.into_sampler(&loaded(&brdf)))
        };
        assert!(load(&good).is_ok());
        let header = 8 + u64::from_le_bytes(good[..8].try_into().unwrap()) as usize;
        for at in (header..good.len()).step_by((good.len() - header) / 60 + 1) {
            let mut bytes = good.clone();
            bytes[at] ^= 0x10;
            let message = load(&bytes).unwrap_err().to_string();
            assert!(message.contains("SHA-256"), "{message}");
        }
        for length in [0, 7, 8, 100, header, header + 3, good.len() - 1] {
            assert!(load(&good[..length]).is_err(), "{length} bytes");
        }
        assert!(load(&[&good[..], &[0]].concat()).is_err());
    }
}

#[test]
fn another_material_or_lookup_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (_, brdf, path) = built(specs()[1].clone(), folder.path());
    let other = Material::resolve("nickel").unwrap();
    let message = SamplerFile::open(&path)
        .unwrap()
        .load(Some(other))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("nickel") && message.contains("SHA-256"),
        "{message}"
    );
    let linear = Arc::new(MerlBrdf::new(brdf.table().clone(), LookupRule::Linear));
    let message = SamplerFile::open(&path)
        .unwrap()
        .into_sampler(&loaded(&linear))
        .unwrap_err()
        .to_string();
    assert!(message.contains("--lookup floor"), "{message}");
}

/// A sampler file taken apart, to be changed and written again with a checksum that fits.
struct Forged {
    tensors: BTreeMap<String, (Dtype, Vec<u8>)>,
    record: serde_json::Value,
}

impl Forged {
    fn read(bytes: &[u8]) -> Self {
        let (_, header) = SafeTensors::read_metadata(bytes).unwrap();
        let file = SafeTensors::deserialize(bytes).unwrap();
        Self {
            tensors: file
                .iter()
                .map(|(n, v)| (n.to_owned(), (v.dtype(), v.data().to_vec())))
                .collect(),
            record: serde_json::from_str(&header.metadata().as_ref().unwrap()["merlkit"]).unwrap(),
        }
    }

    fn write(&mut self) -> Vec<u8> {
        let mut hash = Sha256::new();
        for (name, (dtype, bytes)) in &self.tensors {
            hash.update(format!("{name}:{dtype:?}:{}:", bytes.len()));
            hash.update(bytes);
        }
        let hex: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        self.record["payload_sha256"] = hex.into();
        let metadata = HashMap::from([("merlkit".to_owned(), self.record.to_string())]);
        let views = self.tensors.iter().map(|(name, (dtype, bytes))| {
            (
                name,
                TensorView::new(*dtype, vec![bytes.len() * 8 / dtype.bitsize()], bytes).unwrap(),
            )
        });
        safetensors::serialize(views, Some(metadata)).unwrap()
    }

    fn bytes(&mut self, name: &str) -> &mut Vec<u8> {
        &mut self.tensors.get_mut(name).unwrap().1
    }

    fn set_f32(&mut self, name: &str, at: usize, value: f32) {
        self.bytes(name)[4 * at..4 * at + 4].copy_from_slice(&value.to_le_bytes());
    }

    fn u32(&mut self, name: &str, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes(name)[4 * at..4 * at + 4].try_into().unwrap())
    }

    fn set_u32(&mut self, name: &str, at: usize, value: u32) {
        self.bytes(name)[4 * at..4 * at + 4].copy_from_slice(&value.to_le_bytes());
    }

    fn set_u16(&mut self, name: &str, at: usize, value: u16) {
        self.bytes(name)[2 * at..2 * at + 2].copy_from_slice(&value.to_le_bytes());
    }

    fn cut(&mut self, name: &str, bytes: usize) {
        let length = self.bytes(name).len();
        self.bytes(name).truncate(length - bytes);
    }

    fn settings(&mut self, key: &str, value: serde_json::Value) {
        self.record["settings"][key] = value;
    }
}

/// What is done to a file, and a word of the answer.
type Forgery = (&'static str, fn(&mut Forged), &'static str);

fn assert_each_is_refused(spec: SamplerSpec, forgeries: &[Forgery]) {
    let folder = tempfile::tempdir().unwrap();
    let (fresh, brdf, path) = built(spec, folder.path());
    let good = std::fs::read(&path).unwrap();
    let forged = folder.path().join("forged.safetensors");
    let load = |bytes: Vec<u8>| {
        std::fs::write(&forged, bytes).unwrap();
        SamplerFile::open(&forged).and_then(|f| f.into_sampler(&loaded(&brdf)))
    };
    let untouched = load(Forged::read(&good).write()).unwrap();
    assert_eq!(
        untouched.bytes(),
        fresh.bytes(),
        "taking apart and writing is no damage"
    );
    for (what, change, word) in forgeries {
        let mut file = Forged::read(&good);
        change(&mut file);
        match load(file.write()) {
            Ok(_) => panic!("{what}: accepted"),
            Err(error) => {
                let message = error.to_string();
                assert!(
                    !message.contains("SHA-256"),
                    "{what}: only the checksum was noticed: {message}"
                );
                assert!(
                    message.contains(word) && !message.contains('\n'),
                    "{what}: {message}"
                );
            }
        }
    }
}

/// Faults that a file of any sampler can have.
const COMMON: [Forgery; 5] = [
    (
        "another version",
        |f| f.record["version"] = 1.into(),
        "layout version 3, found version 1",
    ),
    (
        "no version",
        |f| drop(f.record.as_object_mut().unwrap().remove("version")),
        "metadata of a merlkit sampler",
    ),
    (
        "an unknown sampler",
        |f| f.record["spec"] = "magic".into(),
        "metadata of a merlkit sampler",
    ),
    (
        "a sampler without tables",
        |f| {
            f.record["spec"] = "cosine".into();
            f.record["settings"] = serde_json::json!({});
        },
        "cosine",
    ),
    (
        "a floor above 1",
        |f| f.settings("floor", 1.5.into()),
        "floor=1.5",
    ),
];

#[test]
fn forged_trees_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "NaN for a bound",
            |f| f.set_f32("leaf.bound", 2, f32::NAN),
            "leaf 2 of tree 0",
        ),
        (
            "infinity for a bound",
            |f| f.set_f32("leaf.bound", 0, f32::INFINITY),
            "leaf 0 of tree 0",
        ),
        (
            "a bound of 0",
            |f| f.set_f32("leaf.bound", 1, 0.0),
            "leaf 1 of tree 0",
        ),
        (
            "a bound below 0",
            |f| f.set_f32("leaf.bound", 1, -1.0),
            "leaf 1 of tree 0",
        ),
        (
            "a leaf too deep",
            |f| f.set_u32("leaf.code", 3, 15 << 28),
            "leaf 3 of tree 0",
        ),
        (
            "a leaf beside the disc's square",
            |f| f.set_u32("leaf.code", 3, 1 << 28 | 2),
            "leaf 3 of tree 0",
        ),
        (
            "probabilities that fall",
            |f| f.set_u32("leaf.upper", 5, 0),
            "probabilities of tree 0",
        ),
        (
            "probabilities below 1",
            |f| {
                let last = f.u32("tree.start", 1) as usize - 1;
                f.set_u32("leaf.upper", last, u32::MAX - 1);
            },
            "sum to 1",
        ),
        (
            "starts past the end",
            |f| f.set_u32("tree.start", 6, u32::MAX),
            "starts that partition",
        ),
        (
            "starts that fall",
            |f| f.set_u32("tree.start", 3, 1),
            "starts that partition",
        ),
        (
            "a first start other than 0",
            |f| f.set_u32("tree.start", 0, 1),
            "starts that partition",
        ),
        (
            "a tree without leaves",
            |f| f.set_u32("tree.start", 1, 0),
            "0 leaves",
        ),
        (
            "NaN for an integral",
            |f| f.set_f32("tree.integral", 4, f32::NAN),
            "tree 4",
        ),
        (
            "an integral below 0",
            |f| f.set_f32("tree.integral", 4, -0.5),
            "tree 4",
        ),
        (
            "a dark tree with leaves",
            |f| f.set_f32("tree.integral", 4, 0.0),
            "tree 4",
        ),
        ("a short tensor", |f| f.cut("leaf.bound", 4), "equal length"),
        (
            "a missing tree",
            |f| {
                f.cut("tree.start", 4);
                f.cut("tree.integral", 4);
            },
            "7 trees",
        ),
        (
            "another number of trees",
            |f| f.settings("tables", 8.into()),
            "8 trees",
        ),
        (
            "no trees at all",
            |f| f.settings("tables", 0.into()),
            "tables=0",
        ),
        (
            "more trees than can be counted",
            |f| f.settings("tables", u64::MAX.into()),
            "tables=18446744073709551615",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("leaf.code");
            },
            "a tensor \"leaf.code\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("leaf.code").unwrap().0 = Dtype::I32,
            "U32, found I32",
        ),
        (
            "a depth past its domain",
            |f| f.settings("depth", 99.into()),
            "depth=99",
        ),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[0].clone(), &forgeries);
}

#[test]
fn forged_warps_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a child before its parent",
            |f| f.set_u32("node.first", 3, 3),
            "node 3 of tree 0",
        ),
        (
            "a child in another tree",
            |f| f.set_u32("node.first", 0, u32::MAX),
            "node 0 of tree 0",
        ),
        (
            "five children",
            |f| f.set_u16("node.inner", 1, 31),
            "node 1 of tree 0",
        ),
        (
            "starts that fall",
            |f| f.set_u32("tree.start", 2, 0),
            "starts that partition",
        ),
        (
            "starts past the end",
            |f| f.set_u32("tree.start", 4, u32::MAX),
            "starts that partition",
        ),
        ("a missing tree", |f| f.cut("tree.start", 4), "4 trees"),
        (
            "more trees than can be counted",
            |f| f.settings("tables", u64::MAX.into()),
            "tables=18446744073709551615",
        ),
        (
            "a missing split",
            |f| f.cut("node.split", 2),
            "three splits",
        ),
        (
            "another kind of tree",
            |f| f.settings("leaves", "envelope".into()),
            "a tensor \"leaf.upper\"",
        ),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[3].clone(), &forgeries);
}

#[test]
fn forged_curves_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a CDF that falls",
            |f| f.set_u16("marginal.cdf", 2, 0),
            "marginal curves",
        ),
        (
            "a conditional that falls",
            |f| {
                let mut knots =
                    |c| f.u32("conditional.start", c + 1) - f.u32("conditional.start", c);
                let curve = (0..).find(|&c| knots(c) > 3).unwrap();
                let start = f.u32("conditional.start", curve) as usize;
                f.set_u16("conditional.cdf", start + 1, u16::MAX);
            },
            "conditional curves",
        ),
        (
            "a CDF that starts above 0",
            |f| f.set_u16("marginal.cdf", 0, 1),
            "curve 0",
        ),
        (
            "a CDF that ends below 1",
            |f| {
                let last = f.u32("marginal.start", 1) as usize - 1;
                f.set_u16("marginal.cdf", last, u16::MAX - 1);
            },
            "curve 0",
        ),
        (
            "starts past the end",
            |f| f.set_u32("marginal.start", 1, u32::MAX),
            "starts",
        ),
        (
            "starts that fall",
            |f| {
                let third = f.u32("conditional.start", 3);
                f.set_u32("conditional.start", 2, third + 1);
            },
            "starts",
        ),
        (
            "a first start other than 0",
            |f| f.set_u32("marginal.start", 0, 1),
            "starts",
        ),
        (
            "an empty curve",
            |f| f.set_u32("marginal.start", 1, 0),
            "curve 0",
        ),
        (
            "a knot past the grid",
            |f| {
                let last = f.u32("marginal.start", 1) as usize - 1;
                f.set_u16("marginal.position", last, 9000);
            },
            "curve 0",
        ),
        (
            "knots that fall",
            |f| f.set_u16("marginal.position", 1, 0),
            "curve 0",
        ),
        (
            "fewer knots than values",
            |f| f.cut("conditional.position", 2),
            "positions",
        ),
        (
            "a missing conditional",
            |f| {
                let knots = f.bytes("conditional.start").len() / 4;
                let last =
                    f.u32("conditional.start", knots - 1) - f.u32("conditional.start", knots - 2);
                f.cut("conditional.start", 4);
                f.cut("conditional.position", 2 * last as usize);
                f.cut("conditional.cdf", 2 * last as usize);
            },
            "a conditional for each",
        ),
        (
            "a conditional without mass",
            |f| {
                // The second piece of the first marginal has mass; its conditional is made void.
                for knot in f.u32("conditional.start", 1)..f.u32("conditional.start", 2) {
                    f.set_u16("conditional.cdf", knot as usize, 0);
                }
            },
            "piece 1 of marginal 0",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 4.into()),
            "4 marginals",
        ),
        (
            "another grid",
            |f| f.settings("theta_h", 512.into()),
            "marginal curves over 512 cells",
        ),
        (
            "another grid of φh",
            |f| f.settings("phi_h", 256.into()),
            "conditional curves over 256 cells",
        ),
        (
            "a grid past its domain",
            |f| f.settings("phi_h", 100_000.into()),
            "x100000",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("conditional.cdf");
            },
            "a tensor \"conditional.cdf\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("marginal.position").unwrap().0 = Dtype::I16,
            "U16, found I16",
        ),
        ("no tensors", |f| f.tensors.clear(), "found none"),
    ];
    forgeries.extend(COMMON);
    assert_each_is_refused(specs()[1].clone(), &forgeries);
}

#[test]
fn forged_curves_with_every_knot_are_refused() {
    let forgeries: [Forgery; 3] = [
        (
            "a curve of another length",
            |f| {
                let start = f.u32("conditional.start", 1);
                f.set_u32("conditional.start", 1, start - 1);
            },
            "curve 0",
        ),
        (
            "another grid",
            |f| f.settings("theta_h", 255.into()),
            "marginal curves over 255 cells",
        ),
        (
            "a tolerance that is negative",
            |f| f.settings("tolerance", (-1.0).into()),
            "tolerance",
        ),
    ];
    assert_each_is_refused(specs()[2].clone(), &forgeries);
}

#[test]
fn forged_half_vector_tables_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "a knot that is no normal",
            |f| f.set_f32("knot.cosine", 0, 0.99),
            "fall from 1",
        ),
        (
            "knots that rise",
            |f| f.set_f32("knot.cosine", 2, 0.9999),
            "fall from 1",
        ),
        (
            "NaN for a knot",
            |f| f.set_f32("knot.cosine", 1, f32::NAN),
            "fall from 1",
        ),
        (
            "a knot on the horizon",
            |f| f.set_f32("knot.cosine", 6, 0.0),
            "stay above 0",
        ),
        (
            "rows that do not begin at 0",
            |f| f.set_u16("row.edge", 0, 1),
            "from 0 to 79",
        ),
        (
            "rows past the end",
            |f| f.set_u16("row.edge", 22, 80),
            "from 0 to 79",
        ),
        (
            "edges that fall",
            |f| f.set_u16("row.edge", 2, 1),
            "from 0 to 79",
        ),
        (
            "an empty first row",
            |f| f.set_u16("row.cdf", 0, 0),
            "tensor \"row.cdf\"",
        ),
        (
            "a probability below 1",
            |f| f.set_u16("row.cdf", 21, 65534),
            "tensor \"row.cdf\"",
        ),
        (
            "probabilities that fall",
            |f| f.set_u16("row.cdf", 30, 1),
            "tensor \"row.cdf\"",
        ),
        (
            "a slope that is too steep",
            |f| f.bytes("row.slope")[5] = 123,
            "row.slope",
        ),
        (
            "the steepest slope downwards",
            |f| f.bytes("row.slope")[5] = 128,
            "row.slope",
        ),
        (
            "a density of 0",
            |f| f.set_u16("row.density", 7, 0),
            "row.density",
        ),
        (
            "a density that is too large",
            |f| f.set_u16("row.density", 7, 65535),
            "row.density",
        ),
        (
            "a short tensor",
            |f| f.cut("row.slope", 1),
            "154 values in tensor \"row.slope\"",
        ),
        (
            "a shorter one",
            |f| f.cut("row.density", 2),
            "values in tensor \"row.density\"",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 8.into()),
            "8 values in tensor \"knot.cosine\"",
        ),
        (
            "another number of rows",
            |f| f.settings("rows", 23.into()),
            "24 values in tensor \"row.edge\"",
        ),
        (
            "no segments",
            |f| f.settings("segments", 0.into()),
            "segments=0",
        ),
        (
            "more segments than can be",
            |f| f.settings("segments", u64::MAX.into()),
            "segments",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("row.cdf");
            },
            "a tensor \"row.cdf\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("row.slope").unwrap().0 = Dtype::U8,
            "I8, found U8",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(
        SamplerSpec::new(HalfVectorSettings::PRESETS[0].1),
        &forgeries,
    );
}

#[test]
fn forged_lobes_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "another parameter",
            |f| f.set_f32("lobe.parameter", 0, 0.123),
            "parameters of the record",
        ),
        (
            "NaN for a parameter",
            |f| f.set_f32("lobe.parameter", 2, f32::NAN),
            "parameters of the record",
        ),
        ("a short tensor", |f| f.cut("lobe.parameter", 4), "3 values"),
        (
            "no parameters",
            |f| f.settings("parameters", serde_json::Value::Null),
            "parameters of the record",
        ),
        (
            "another lobe",
            |f| f.settings("kind", "magic".into()),
            "settings of a merlkit sampler",
        ),
        (
            "parameters past their domain in both places",
            |f| {
                for i in 0..3 {
                    f.set_f32("lobe.parameter", i, 0.0);
                }
                let zero = serde_json::json!({"along": 0.0, "across": 0.0, "diffuse": 0.0});
                f.settings("parameters", zero);
            },
            "ggx with parameters 0, 0 and 0",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("lobe.parameter");
            },
            "a tensor \"lobe.parameter\", found none",
        ),
        (
            "another type",
            |f| f.tensors.get_mut("lobe.parameter").unwrap().0 = Dtype::U32,
            "F32, found U32",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(specs()[6].clone(), &forgeries);
}

#[test]
fn forged_factors_are_refused() {
    let mut forgeries: Vec<Forgery> = vec![
        (
            "NaN for a share",
            |f| f.set_f32("term.weight", 8, f32::NAN),
            "shares of table 1",
        ),
        (
            "a share below 0",
            |f| f.set_f32("term.weight", 8, -0.1),
            "shares of table 1",
        ),
        (
            "a share above 1",
            |f| f.set_f32("term.weight", 8, 1.5),
            "shares of table 1",
        ),
        (
            "shares above 1 together",
            |f| (6..12).for_each(|i| f.set_f32("term.weight", i, 0.3)),
            "shares of table 1",
        ),
        (
            "a term that can't be drawn",
            |f| {
                let row = f.u32("theta.start", 1) as usize;
                (0..row).for_each(|i| f.set_u16("theta.cdf", i, 0));
            },
            "terms that can be drawn",
        ),
        (
            "a CDF that falls",
            |f| f.set_u16("phi.cdf", 3, 0),
            "phi curves",
        ),
        (
            "starts past the end",
            |f| f.set_u32("theta.start", 1, u32::MAX),
            "starts",
        ),
        (
            "a short tensor",
            |f| f.cut("term.weight", 4),
            "30 of 6 terms",
        ),
        (
            "another number of tables",
            |f| f.settings("tables", 6.into()),
            "36 of 6 terms",
        ),
        ("no tables", |f| f.settings("tables", 0.into()), "tables=0"),
        (
            "more tables than can be",
            |f| f.settings("tables", u64::MAX.into()),
            "tables",
        ),
        (
            "no factors",
            |f| f.settings("factors", serde_json::Value::Null),
            "factors of a factored sampler",
        ),
        (
            "other cells",
            |f| f.record["settings"]["factors"]["theta"] = 41.into(),
            "theta curves over 41",
        ),
        (
            "another J",
            |f| f.record["settings"]["factors"]["outer"] = 4.into(),
            "of 8 terms",
        ),
        (
            "no J",
            |f| f.record["settings"]["factors"]["outer"] = 0.into(),
            "factors=0x2/",
        ),
        (
            "a floor past 1",
            |f| f.record["settings"]["factors"]["floor"] = 1.5.into(),
            "/1.5",
        ),
        (
            "a missing tensor",
            |f| {
                f.tensors.remove("phi.cdf");
            },
            "a tensor \"phi.cdf\", found none",
        ),
    ];
    forgeries.extend(COMMON.into_iter().filter(|f| f.0 != "a floor above 1"));
    assert_each_is_refused(factored(), &forgeries);
}

/// A file of the given header, JSON, and bytes of tensors.
fn with_header(json: &str, data: &[u8]) -> Vec<u8> {
    [
        &(json.len() as u64).to_le_bytes()[..],
        json.as_bytes(),
        data,
    ]
    .concat()
}

fn refusal(bytes: Vec<u8>) -> (u64, String) {
    match SamplerFile::from_bytes(bytes, Path::new("forged")) {
        Err(merlkit::Error::Invalid { offset, found, .. }) => (offset, found),
        other => panic!("{other:?}"),
    }
}

#[test]
fn headers_that_lie_are_refused_with_their_place() {
    assert_eq!(refusal(vec![1, 2, 3]).0, 3);
    assert_eq!(refusal(u64::MAX.to_le_bytes().to_vec()).0, 0);
    assert_eq!(refusal(with_header("{", b"")).0, 8);
    assert_eq!(refusal(with_header("{\"a\":7}", b"")).0, 8 + 6);
    assert_eq!(refusal(with_header("{}", b"trailing")).0, 10);
    // The sum of what the tensors claim and of what stands before them passes 2⁶⁴.
    let part = (1u64 << 61) - 1;
    let mut tensors: Vec<String> = (0..8)
        .map(|k| tensor(&format!("t{k}"), part, k * part))
        .collect();
    tensors.push(tensor("u", 7, 8 * part));
    let (_, found) = refusal(with_header(&format!("{{{}}}", tensors.join(",")), b"few"));
    assert!(found.contains("3 bytes of tensors"), "{found}");
}

fn tensor(name: &str, length: u64, start: u64) -> String {
    format!(
        "\"{name}\":{{\"dtype\":\"U8\",\"shape\":[{length}],\"data_offsets\":[{start},{}]}}",
        start + length
    )
}

#[test]
fn a_bad_value_is_told_with_tensor_and_byte() {
    let folder = tempfile::tempdir().unwrap();
    let (_, brdf, path) = built(specs()[0].clone(), folder.path());
    let mut file = Forged::read(&std::fs::read(&path).unwrap());
    let marker = f32::from_bits(0xffc1_2345);
    file.set_f32("leaf.bound", 2, marker);
    let bytes = file.write();
    let at = bytes
        .windows(4)
        .position(|w| w == marker.to_le_bytes())
        .unwrap() as u64;
    match SamplerFile::from_bytes(bytes, &path).and_then(|f| f.into_sampler(&loaded(&brdf))) {
        Err(merlkit::Error::Invalid {
            offset, expected, ..
        }) => {
            assert_eq!(offset, at);
            assert!(expected.contains("in tensor \"leaf.bound\""), "{expected}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_file_whose_text_and_settings_contradict_each_other_is_refused() {
    assert_each_is_refused(
        SamplerSpec::new(HalfVectorSettings::default()),
        &[(
            "another size in the text",
            |f| f.record["spec"] = "half-vector:2KB".into(),
            "the settings of half-vector:2KB",
        )],
    );
    assert_each_is_refused(
        SamplerSpec::new(LobeSettings::fitted(LobeKind::Ggx)),
        &[(
            "another lobe in the text",
            |f| f.record["spec"] = "lobe:ward".into(),
            "the settings of lobe:ward",
        )],
    );
}

#[test]
fn an_infinite_tolerance_survives_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let spec: SamplerSpec = "cascade-cdf:cells=64x16,tolerance=inf".parse().unwrap();
    let (fresh, _, path) = built(spec, folder.path());
    let (read, _) = SamplerFile::open(&path).unwrap().load(None).unwrap();
    assert_eq!(read.fitted(), fresh.fitted());
}
