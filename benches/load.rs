//! A warm MERL file to a table, and an embedded material to a table.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use merlkit::files::Overwrite;
use merlkit::material::merl::{decode_embedded, load, write};

fn benches(c: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nickel.binary");
    let table = decode_embedded("nickel").unwrap();
    write(&table, &path, Overwrite::Refuse).unwrap();
    assert!(load(&path).unwrap().cells() == table.cells());
    let mut group = c.benchmark_group("load");
    group.sample_size(40);
    group.bench_function("warm file, mapped", |b| {
        b.iter(|| load(black_box(&path)).unwrap())
    });
    // A file that is open for writing is read.
    let writer = std::fs::OpenOptions::new().append(true).open(&path);
    group.bench_function("warm file, read", |b| {
        b.iter(|| load(black_box(&path)).unwrap())
    });
    drop(writer);
    group.bench_function("embedded", |b| {
        b.iter(|| decode_embedded(black_box("nickel")).unwrap())
    });
    group.finish();
}

criterion_group!(load_benches, benches);
criterion_main!(load_benches);
