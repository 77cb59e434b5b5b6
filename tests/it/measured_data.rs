//! Measurements that are no part of the project, for tests that skip without them.

use std::path::PathBuf;

/// A folder of the one that the environment variable MERLKIT_DATA names: `rgl` with `.bsdf` files of the RGL database, `other`
/// with measurements of other laboratories. `None`, and a line that says so, where there is none.
pub fn data_folder(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("MERLKIT_DATA").map(|data| PathBuf::from(data).join(name));
    let found = folder.filter(|folder| folder.is_dir());
    if found.is_none() {
        println!("skipped: MERLKIT_DATA names no folder with {name}/");
    }
    found
}

/// The `.bsdf` files of the folder `rgl`, by name; none without it.
pub fn measured_files() -> Vec<PathBuf> {
    let Some(folder) = data_folder("rgl") else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "bsdf"));
    paths.sort();
    paths
}
