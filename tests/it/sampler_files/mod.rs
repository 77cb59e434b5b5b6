//! Sampler files: the same bits after a round trip, and damage is noticed, even where the checksum fits.

mod forged_cascades;
mod forged_discs;
mod forged_mixtures;
mod forged_tables;
mod headers;
mod round_trips;

use crate::support::loaded;
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
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

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
