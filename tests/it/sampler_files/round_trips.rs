//! What is saved comes back, and nothing else does.

use super::*;

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

#[test]
fn an_infinite_tolerance_survives_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let spec: SamplerSpec = "cascade-cdf:cells=64x16,tolerance=inf".parse().unwrap();
    let (fresh, _, path) = built(spec, folder.path());
    let (read, _) = SamplerFile::open(&path).unwrap().load(None).unwrap();
    assert_eq!(read.fitted(), fresh.fitted());
}
