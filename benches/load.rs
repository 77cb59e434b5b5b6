//! A warm MERL file to a table, and an embedded material to a table. `cargo bench --bench load`.

mod harness;

use std::hint::black_box;

use harness::{Group, Harness};
use merlkit::files::Overwrite;
use merlkit::material::merl::{decode_embedded, load, write};

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let mapped = folder.path().join("mapped.binary");
    let read = folder.path().join("read.binary");
    let table = decode_embedded("nickel").unwrap();
    for path in [&mapped, &read] {
        write(&table, path, Overwrite::Refuse).unwrap();
    }
    // A file that is open for writing is read.
    let writer = std::fs::OpenOptions::new().append(true).open(&read);
    for path in [&mapped, &read] {
        assert!(load(path).unwrap().cells().eq(table.cells()));
    }
    let mut harness = Harness::new("load");
    let mut group = Group::new("load", "table");
    group.add("warm file, mapped", 1, || load(black_box(&mapped)).unwrap());
    group.add("warm file, read", 1, || load(black_box(&read)).unwrap());
    group.add("embedded", 1, || {
        decode_embedded(black_box("nickel")).unwrap()
    });
    harness.run(group);
    drop(writer);
}
