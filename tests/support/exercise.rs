//! What is done with one hostile input: read it, and if it is accepted, use what it gives. For the seeded driver of the tests
//! and for the targets of `fuzz/`.

use std::path::Path;
use std::sync::Arc;

use glam::Vec2;
use merlkit::geometry::{DirectionPairs, spherical};
use merlkit::image::decode_image;
use merlkit::material::Loaded;
use merlkit::material::merl::{Header, MerlTable, decode_cells};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::sampler::store::SamplerFile;

/// A material for samplers of any file: smooth, with a lobe.
pub fn material() -> Loaded {
    let lobe = |h: usize, d: usize, p: usize| {
        [1.0 / (1 + h * h) as f64, 0.1, 0.01 * (1 + d + p % 7) as f64]
    };
    let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 180 }, lobe));
    Loaded::from_table(Arc::new(MerlBrdf::new(table, LookupRule::Floor)))
}

/// A length that a file claims (eight bytes), the beginning of the file, and numbers of the three planes.
pub fn merl(input: &[u8]) -> bool {
    let Some((length, file)) = input.split_first_chunk::<8>() else {
        return false;
    };
    let plane = file.len() / 3;
    let planes = [&file[..plane], &file[plane..2 * plane], &file[2 * plane..]];
    let mut cells = 0;
    decode_cells(planes, |_| cells += 1);
    assert_eq!(cells, plane / 8);
    match Header::parse(file, u64::from_le_bytes(*length), Path::new("fuzz")) {
        Ok(header) => {
            assert_eq!(header.file_bytes(), u64::from_le_bytes(*length));
            assert!(header.phi_d_bins == 180 || header.phi_d_bins == 360);
            true
        }
        Err(error) => one_line(&error),
    }
}

/// A sampler file; one that is accepted draws directions with finite densities.
pub fn sampler(input: &[u8], material: &Loaded) -> bool {
    match SamplerFile::from_bytes(input.to_vec(), Path::new("fuzz"))
        .and_then(|f| f.into_sampler(material))
    {
        Ok(sampler) => {
            for (i, theta) in [0.0, 0.6, 1.5].into_iter().enumerate() {
                let wo = spherical(theta, 0.3).as_vec3();
                let edge = 1.0f32.next_down();
                for u in [
                    Vec2::new(0.3, 0.8),
                    Vec2::new(0.0, edge),
                    Vec2::new(edge, i as f32 * 0.5),
                ] {
                    let drawn = sampler.sample(wo, u);
                    assert!(
                        drawn.is_none_or(|s| s.wi.is_finite() && s.pdf.is_finite() && s.pdf > 0.0)
                    );
                    let wi = drawn.map_or(spherical(0.4, 2.0).as_vec3(), |s| s.wi);
                    let pdf = sampler.pdf(wo, wi);
                    assert!(pdf.is_finite() && pdf >= 0.0, "{pdf} {wi}");
                }
            }
            true
        }
        Err(error) => one_line(&error),
    }
}

/// A picture of any format.
pub fn picture(input: &[u8]) -> bool {
    match decode_image(input, Path::new("fuzz")) {
        Ok(image) => {
            assert_eq!(image.pixels().len(), image.width() * image.height());
            true
        }
        Err(error) => one_line(&error),
    }
}

/// Lines of directions; those that are accepted are unit vectors. Whether any line was accepted and none refused.
pub fn pairs(input: &[u8]) -> bool {
    let mut accepted = false;
    for pair in DirectionPairs::new(input, Path::new("fuzz")) {
        match pair {
            Ok((wo, wi)) => {
                assert!(
                    [wo, wi].iter().all(|w| (w.length() - 1.0).abs() < 1e-6),
                    "{wo} {wi}"
                );
                accepted = true;
            }
            Err(error) => return one_line(&error),
        }
    }
    accepted
}

/// A message is one line for a reader, however wild the file; always false.
fn one_line(error: &merlkit::Error) -> bool {
    let text = error.to_string();
    assert!(text.starts_with("fuzz") || !text.is_empty());
    assert!(text.len() < 4096, "a message of {} bytes", text.len());
    false
}
