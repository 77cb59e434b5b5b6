//! Cells of a table of which some channels alone are invalid: as a whole, or these channels alone.

use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};
use merlkit::brdf::Importance;
use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::material::measurements::fill_gaps;
use merlkit::material::merl::{Header, MerlTable, write};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::store::{SamplerFile, save};
use merlkit::{SamplerSpec, Wo};

const HEADER: Header = Header { phi_d_bins: 180 };
/// f_r of the table everywhere but in the cells below.
const GOOD: [f64; 3] = [0.1, 0.2, 0.3];

/// A file whose blue is NaN in every 7th cell, and whose green is negative in every 11th.
fn torn_file(folder: &Path) -> PathBuf {
    let path = folder.join("torn.binary");
    let table = MerlTable::from_fn(HEADER, |_, _, _| GOOD);
    write(&table, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let mut put = |channel: usize, cell: usize, value: f64| {
        let start = 12 + 8 * (channel * HEADER.cells() + cell);
        bytes[start..start + 8].copy_from_slice(&value.to_le_bytes());
    };
    for cell in 0..HEADER.cells() {
        if cell % 7 == 0 {
            put(2, cell, f64::NAN);
        }
        if cell % 11 == 0 {
            put(1, cell, -3.0);
        }
    }
    let mut file = std::fs::File::create(&path).unwrap();
    file.seek(SeekFrom::Start(0)).unwrap();
    file.write_all(&bytes).unwrap();
    path
}

fn material(path: &Path, apart: bool) -> Material {
    let material = Material::resolve(path.to_str().unwrap()).unwrap();
    material.with_channels_apart(apart)
}

fn loaded(path: &Path, apart: bool, rule: LookupRule) -> Loaded {
    material(path, apart).load(rule).unwrap()
}

fn table(loaded: &Loaded) -> &MerlTable {
    loaded.table().unwrap().table()
}

/// Cells with an invalid channel.
fn torn_cells() -> u64 {
    (0..HEADER.cells())
        .filter(|cell| cell % 7 == 0 || cell % 11 == 0)
        .count() as u64
}

#[test]
fn a_cell_is_invalid_as_a_whole_unless_channels_are_kept_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = torn_file(folder.path());
    let good = Vec3::from(GOOD.map(|v| v as f32));
    for apart in [false, true] {
        let material = loaded(&path, apart, LookupRule::Floor);
        let table = table(&material);
        assert_eq!(table.keeps_channels_apart(), apart);
        assert_eq!(table.mixed_cells(), torn_cells());
        let invalid = if apart { 0 } else { torn_cells() };
        assert_eq!(table.census().invalid(), invalid);
        for (cell, found) in table.cells().enumerate() {
            let bad = [false, cell % 11 == 0, cell % 7 == 0];
            let valid = match apart {
                true => bad.map(|bad| !bad),
                false => [!bad.contains(&true); 3],
            };
            assert_eq!(table.valid_channels(cell), valid, "{cell}");
            let expected = Vec3::select(valid.into(), good, Vec3::ZERO);
            assert!((found.truncate() - expected).abs().max_element() < 1e-6);
        }
        let notes = material.notes().join("; ");
        let rule = if apart { "channel" } else { "cell" };
        assert!(
            notes.contains(&format!("{} cells (22.08 % of the table)", torn_cells()))
                && notes.contains(&format!("as --invalid {rule} says")),
            "{notes}"
        );
    }
}

#[test]
fn linear_rules_renormalise_each_channel_and_batches_agree() {
    let folder = tempfile::tempdir().unwrap();
    let path = torn_file(folder.path());
    let wi: Vec<Vec3> = (0..500)
        .map(|k| spherical(f64::from(k) * 0.003, f64::from(k) * 0.7).as_vec3())
        .collect();
    let wo = spherical(0.4, 0.3).as_vec3();
    for rule in LookupRule::ALL {
        let [whole, apart] = [false, true].map(|apart| loaded(&path, apart, rule));
        let mut batch = vec![Rgb::ZERO; wi.len()];
        apart.brdf().eval_batch(Wo::One(wo), &wi, &mut batch);
        let mut zeros = [0, 0];
        for (&wi, batch) in wi.iter().zip(batch) {
            let value = apart.brdf().eval(wo, wi);
            assert_eq!(
                value.to_array().map(f32::to_bits),
                batch.to_array().map(f32::to_bits)
            );
            for (zeros, value) in zeros.iter_mut().zip([whole.brdf().eval(wo, wi), value]) {
                *zeros += value.to_array().into_iter().filter(|v| *v == 0.0).count();
            }
            if rule != LookupRule::Floor {
                let good = Vec3::from(GOOD.map(|v| v as f32));
                assert!((value - good).abs().max_element() < 1e-6, "{value}");
            }
        }
        match rule {
            // By cell three channels are lost in 22 % of the cells; by channel one in most of these.
            LookupRule::Floor => assert!(zeros[0] > 2 * zeros[1] && zeros[1] > 50, "{zeros:?}"),
            _ => assert_eq!(zeros, [0, 0]),
        }
    }
}

#[test]
fn cells_that_are_whole_keep_their_bits_where_channels_are_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.binary");
    let mut state = 1u64;
    let noise = MerlTable::from_fn(HEADER, |_, _, _| {
        [0; 3].map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 40) as f64 * 1e-6
        })
    });
    write(&noise, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    // One channel of one cell at grazing angles, far from the pairs below.
    let last = 12 + 8 * (HEADER.cells() - 90);
    bytes[last..last + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    for rule in LookupRule::ALL {
        let [whole, apart] = [false, true].map(|apart| loaded(&path, apart, rule));
        assert_eq!(table(&apart).mixed_cells(), 1);
        for k in 0..2000 {
            let k = f64::from(k);
            let wo = spherical((k * 0.618).fract(), k).as_vec3();
            let wi = spherical((k * 0.414).fract(), k * 0.37).as_vec3();
            let [a, b] = [&whole, &apart].map(|l| l.brdf().eval(wo, wi).to_array());
            assert_eq!(a.map(f32::to_bits), b.map(f32::to_bits), "{rule:?} {k}");
        }
    }
}

#[test]
fn files_of_tables_that_keep_channels_apart_come_back_and_fill_channel_by_channel() {
    let folder = tempfile::tempdir().unwrap();
    let path = torn_file(folder.path());
    let apart = loaded(&path, true, LookupRule::Floor);
    let copy = folder.path().join("copy.binary");
    write(table(&apart), &copy, Overwrite::Refuse).unwrap();
    let read = loaded(&copy, true, LookupRule::Floor);
    assert!(table(&read).cells().eq(table(&apart).cells()));
    assert_eq!(table(&read).mixed_cells(), torn_cells());
    let filled = fill_gaps(table(&apart));
    assert_eq!(filled.count_gaps(), 0);
    for (cell, (found, had)) in filled.cells().zip(table(&apart).cells()).enumerate() {
        let valid = table(&apart).valid_channels(cell);
        for channel in 0..3 {
            if valid[channel] {
                assert_eq!(found[channel], had[channel], "{cell}");
            } else if found.w == 1.0 {
                assert!(
                    (f64::from(found[channel]) - GOOD[channel]).abs() < 1e-5,
                    "{cell}"
                );
            }
        }
    }
    assert!(filled.mixed_cells() < torn_cells() / 2);
}

#[test]
fn samplers_hold_on_tables_that_keep_channels_apart_and_their_files_remember() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("uneven.binary");
    // Bright channels that are invalid by turns, so that a cell's own mean is no bound of what lies between.
    let uneven = MerlTable::from_fn(HEADER, |_, _, _| [1.0; 3]);
    write(&uneven, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    for cell in 0..HEADER.cells() {
        let start = 12 + 8 * ((cell % 3) * HEADER.cells() + cell);
        bytes[start..start + 8].copy_from_slice(&(-1f64).to_le_bytes());
    }
    std::fs::write(&path, bytes).unwrap();
    let material = material(&path, true);
    let brdf = material.load(LookupRule::Linear).unwrap();
    let spec: SamplerSpec = "adaptive-disc".parse().unwrap();
    let sampler = spec.build(&brdf).unwrap();
    let wo = spherical(0.5, 0.0).as_vec3();
    let (mut sum, count) = (0.0, 4000);
    for k in 0..count {
        let k = f64::from(k) + 0.5;
        let u = Vec2::new(
            (k * 0.754_877_67).fract() as f32,
            (k * 0.569_840_29).fract() as f32,
        );
        if let Some(draw) = sampler.sample(wo, u) {
            let value = Importance::Mean.reduce(brdf.brdf().eval_cos(wo, draw.wi));
            sum += f64::from(value / draw.pdf);
        }
    }
    // f is 1 in every channel, whose albedo is π.
    let albedo = sum / f64::from(count);
    assert!((albedo - std::f64::consts::PI).abs() < 0.05, "{albedo}");
    let stored = folder.path().join("disc.table");
    save(&sampler, &material, &stored, Overwrite::Refuse).unwrap();
    let (_, read) = SamplerFile::open(&stored).unwrap().load(None).unwrap();
    assert!(table(&read).keeps_channels_apart());
    let other = material
        .with_channels_apart(false)
        .load(LookupRule::Linear)
        .unwrap();
    let refused = SamplerFile::open(&stored).unwrap().into_sampler(&other);
    assert!(refused.unwrap_err().to_string().contains("invalid"));
}
