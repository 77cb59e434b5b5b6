//! numpy's `.npz`: a zip archive of arrays, each with its type and shape in front (NEP 1).

use std::io::{Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::contents::{Export, little_endian};
use crate::geometry::merl_axes::{degree_edge, theta_d, theta_h_edge};
use crate::material::merl::{THETA_D_BINS, THETA_H_BINS};

/// Writes all arrays. The archive carries no time: the same bytes for the same material and settings.
pub(super) fn write(export: &Export, out: impl Write + Seek) -> std::io::Result<()> {
    let mut zip = Npz(ZipWriter::new(out));
    tables(export, &mut zip)?;
    settings(export, &mut zip)?;
    axes(export, &mut zip)?;
    let shape = [
        THETA_H_BINS,
        THETA_D_BINS,
        export.dimensions().phi_d_bins,
        3,
    ];
    zip.array("merl.rgb", "<f4", &shape, &little_endian(export.values()))?;
    zip.0.finish()?;
    Ok(())
}

/// The half-vector table, by the names of its file's tensors.
fn tables<W: Write + Seek>(export: &Export, zip: &mut Npz<W>) -> std::io::Result<()> {
    let stored = export.table.to_stored();
    let (tables, rows) = (stored.cosines.len(), stored.edges.len() - 1);
    let slopes: Vec<u8> = stored.slopes.iter().flat_map(|x| x.to_le_bytes()).collect();
    zip.array(
        "knot.cosine",
        "<f4",
        &[tables],
        &little_endian(stored.cosines.iter().copied()),
    )?;
    zip.array("row.edge", "<u2", &[rows + 1], &u16_bytes(&stored.edges))?;
    zip.array("row.cdf", "<u2", &[tables, rows], &u16_bytes(&stored.rows))?;
    zip.array("row.slope", "|i1", &[tables, rows], &slopes)?;
    zip.array(
        "row.density",
        "<u2",
        &[tables, rows, stored.width],
        &u16_bytes(&stored.nodes),
    )
}

/// The angles of the lower edges of the bins of `merl.rgb`, radians.
fn axes<W: Write + Seek>(export: &Export, zip: &mut Npz<W>) -> std::io::Result<()> {
    let theta_h_edges = (0..THETA_H_BINS).map(theta_h_edge).collect();
    let theta_d_edges = (0..THETA_D_BINS).map(|bin| theta_d(bin as f64)).collect();
    let phi_d_edges = (0..export.dimensions().phi_d_bins)
        .map(degree_edge)
        .collect();
    let axes: [(&str, Vec<f64>); 3] = [
        ("theta_h", theta_h_edges),
        ("theta_d", theta_d_edges),
        ("phi_d", phi_d_edges),
    ];
    for (name, edges) in axes {
        let bytes: Vec<u8> = edges.iter().flat_map(|x| x.to_le_bytes()).collect();
        zip.array(name, "<f8", &[edges.len()], &bytes)?;
    }
    Ok(())
}

/// The numbers in little-endian bytes.
fn u16_bytes(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// What was tabulated and how, as scalars and words.
fn settings<W: Write + Seek>(export: &Export, zip: &mut Npz<W>) -> std::io::Result<()> {
    let settings = export.table.settings();
    for (name, count) in [
        ("tables", settings.tables),
        ("rows", settings.rows),
        ("segments", settings.segments),
    ] {
        zip.array(
            &format!("spec.{name}"),
            "<i8",
            &[],
            &(count as u64).to_le_bytes(),
        )?;
    }
    zip.array("spec.fold", "|b1", &[], &[u8::from(settings.fold)])?;
    zip.word("spec.importance", settings.importance.name())?;
    zip.word("lookup", export.brdf.rule().name())?;
    zip.word("material", &export.name)?;
    zip.word("source_sha256", &export.sha256)
}

struct Npz<W: Write + Seek>(ZipWriter<W>);

impl<W: Write + Seek> Npz<W> {
    /// Adds an array whose last index is the fastest; `descr` is numpy's name of its type.
    fn array(
        &mut self,
        name: &str,
        descr: &str,
        shape: &[usize],
        bytes: &[u8],
    ) -> std::io::Result<()> {
        let options = SimpleFileOptions::DEFAULT.compression_method(CompressionMethod::Stored);
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0.write_all(&head(descr, shape))?;
        self.0.write_all(bytes)
    }

    fn word(&mut self, name: &str, word: &str) -> std::io::Result<()> {
        let bytes: Vec<u8> = word
            .chars()
            .flat_map(|c| u32::from(c).to_le_bytes())
            .collect();
        self.array(name, &format!("<U{}", word.chars().count()), &[], &bytes)
    }
}

/// The header in front of an array: a magic word, version 1.0, a length and a dictionary, to a multiple of 64 bytes.
fn head(descr: &str, shape: &[usize]) -> Vec<u8> {
    const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let text = format!(
        "{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}",
        shape.trim_end()
    );
    let whole = (MAGIC.len() + 2 + text.len() + 1).next_multiple_of(64);
    let mut head = MAGIC.to_vec();
    head.extend(((whole - MAGIC.len() - 2) as u16).to_le_bytes());
    head.extend(text.bytes());
    head.resize(whole - 1, b' ');
    head.push(b'\n');
    head
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_as_numpy_writes_them() {
        let head = head("<f4", &[2, 3]);
        assert_eq!(head.len(), 128);
        assert_eq!(head[..10], *b"\x93NUMPY\x01\x00\x76\x00");
        assert!(
            head[10..]
                .starts_with(b"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3,), } ")
        );
        assert_eq!(head[127], b'\n');
        for shape in [&[][..], &[7], &[90, 90, 180, 3]] {
            assert_eq!(super::head("|b1", shape).len() % 64, 0);
        }
    }
}
