//! Store a sampler, and read it back: every value is checked before it is drawn from.
//!
//! `cargo run --release --example read_a_sampler_file`

use std::path::Path;

use merlkit::files::Overwrite;
use merlkit::sampler::store::{SamplerFile, save};
use merlkit::{LookupRule, Material, SamplerSpec};

/// Writes a sampler file into `folder` and reads it; returns the bytes of its tables before and after.
pub fn round_trip(folder: &Path) -> merlkit::Result<[usize; 2]> {
    let material = Material::resolve("chrome")?;
    let spec: SamplerSpec = "half-vector:16KB".parse()?;
    let built = spec.build(&material.load(LookupRule::Floor)?)?;
    let path = folder.join("chrome.merlkit");
    save(&built, &material, &path, Overwrite::Replace)?;

    let file = SamplerFile::open(&path)?;
    println!("{}: {}", path.display(), file.record().spec);
    // `None`: the material that the file names. Its checksum must be the one that the sampler was built from.
    let (read, _material) = file.load(None)?;
    Ok([built.as_dyn().bytes(), read.as_dyn().bytes()])
}

pub fn main() -> merlkit::Result<()> {
    let [before, after] = round_trip(&std::env::temp_dir())?;
    println!("{before} bytes of tables, {after} when read back");
    Ok(())
}
