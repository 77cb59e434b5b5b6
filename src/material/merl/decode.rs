//! From a file's bytes to a table, in one pass.

use byteorder::{ByteOrder, LittleEndian};
use std::path::Path;

use fearless_simd::{Level, dispatch};
use glam::Vec4;

use super::table::{FILLED_MARK, TableBuilder, is_usable};
use super::{Header, MerlTable, SCALE};
use crate::Result;
use crate::files::{Lease, RegularFile, SIGNATURE_BYTES, WhyRead};

/// Cells that are read at a time: three planes of them stay in a processor's cache, and calls are few.
const CHUNK: usize = 16_384;

/// Cells that are mapped at a time: 6 MB in three planes, so that a file takes no more memory than that.
const WINDOW: usize = 1 << 18;

/// Cells that are decoded together: vectors of any processor fit in.
const BLOCK: usize = 16;

/// Reads a MERL binary, checks it and decodes it into a table that no longer needs the file.
///
/// Where nobody can shorten the file meanwhile it is decoded from memory maps, see [`crate::files`]. Otherwise it is read in
/// pieces, into 384 KB of memory: a file that is cut short meanwhile is an error. [`crate::material::Loaded::file_access`] says
/// which.
///
/// See [`MerlTable`](crate::material::merl::MerlTable) for an example of a table.
///
/// # Errors
/// [`crate::Error::Io`] if it can't be opened, [`crate::Error::Unsupported`] if it is no regular file,
/// [`crate::Error::Invalid`] if its header or length is not a MERL file's.
pub fn load(path: &Path) -> Result<MerlTable> {
    load_with_access(path, false).map(|(table, _)| table)
}

/// [`load`], of a table that may keep channels apart ([`MerlTable::keeps_channels_apart`]), and how it was read: "mapped", or
/// "copied" and why.
pub(super) fn load_with_access(path: &Path, apart: bool) -> Result<(MerlTable, String)> {
    let mut file = RegularFile::open(path)?;
    let header = read_header(&mut file)?;
    match decode_mapped(&file, header, apart) {
        Ok(table) => Ok((table, "mapped".into())),
        Err(why) => {
            let table = decode_read(&mut file, header, apart)?;
            Ok((table, format!("copied ({why})")))
        }
    }
}

/// Decodes by `read`.
fn decode_read(file: &mut RegularFile, header: Header, apart: bool) -> Result<MerlTable> {
    let cells = header.cells();
    let mut buffers = [const { Vec::new() }; 3];
    let mut table = TableBuilder::new(header, apart);
    for start in (0..cells).step_by(CHUNK) {
        let count = CHUNK.min(cells - start);
        for (channel, buffer) in buffers.iter_mut().enumerate() {
            buffer.resize(8 * count, 0);
            file.read_at(plane_offset(header, channel, start), buffer)?;
        }
        push_cells(buffers.each_ref().map(|buffer| &buffer[..]), &mut table);
    }
    Ok(table.finish())
}

/// Decodes from memory maps under a lease, or says why the file has to be read.
fn decode_mapped(
    file: &RegularFile,
    header: Header,
    apart: bool,
) -> std::result::Result<MerlTable, WhyRead> {
    let lease = Lease::take(file)?;
    let cells = header.cells();
    let mut table = TableBuilder::new(header, apart);
    for start in (0..cells).step_by(WINDOW) {
        let count = WINDOW.min(cells - start);
        let [red, green, blue] = [0, 1, 2].map(|channel| plane_offset(header, channel, start));
        let bytes = 8 * count;
        let windows = [
            lease.map(red, bytes)?,
            lease.map(green, bytes)?,
            lease.map(blue, bytes)?,
        ];
        push_cells(windows.each_ref().map(|window| window.bytes()), &mut table);
    }
    // The values count only under the lease: the system ends it for a program that has waited too long to write the file.
    if lease.is_held() {
        Ok(table.finish())
    } else {
        Err("another program asked to write to it during reading")
    }
}

/// Where the cells of a colour plane from `cell` on begin.
fn plane_offset(header: Header, channel: usize, cell: usize) -> u64 {
    (Header::BYTES + 8 * (channel * header.cells() + cell)) as u64
}

/// Adds cells from the same stretch of the three colour planes.
fn push_cells(planes: [&[u8]; 3], table: &mut TableBuilder) {
    dispatch!(Level::new(), _ => push_blocks(planes, table));
}

#[inline(always)]
fn push_blocks(planes: [&[u8]; 3], table: &mut TableBuilder) {
    let planes = planes.map(|plane| plane.as_chunks::<8>().0);
    let [red, green, blue] = planes.map(|plane| plane.as_chunks::<BLOCK>().0);
    for (number, ((r, g), b)) in red.iter().zip(green).zip(blue).enumerate() {
        let block = CellBlock::decode([*r, *g, *b]);
        if block.is_ordinary {
            table.extend(&block.cells());
        } else {
            let cells = number * BLOCK..(number + 1) * BLOCK;
            push_one_by_one(planes.map(|plane| &plane[cells.clone()]), table);
        }
    }
    let rest = planes[0].len() / BLOCK * BLOCK;
    push_one_by_one(planes.map(|plane| &plane[rest..]), table);
}

/// Adds cells of which some may be invalid or filled.
#[inline(never)]
fn push_one_by_one([red, green, blue]: [&[[u8; 8]]; 3], table: &mut TableBuilder) {
    let mark = (FILLED_MARK as u16).to_le_bytes();
    for ((r, g), b) in red.iter().zip(green).zip(blue) {
        if r.starts_with(&mark) && g.starts_with(&mark) && b.starts_with(&mark) {
            table.mark_filled();
        }
        table.push(decode_cell([r, g, b]));
    }
}

/// The numbers of a few cells by channel, in columns that vector code works on.
struct CellBlock {
    channels: [[f32; BLOCK]; 3],
    /// Whether all cells have three usable channels and no mark of a filled one.
    is_ordinary: bool,
}

impl CellBlock {
    #[inline(always)]
    fn decode(bytes: [[[u8; 8]; BLOCK]; 3]) -> Self {
        let mut channels = [[0.0; BLOCK]; 3];
        let (mut unusable, mut marks) = (0u64, [0u64; BLOCK]);
        for channel in 0..3 {
            for cell in 0..BLOCK {
                let bits = u64::from_le_bytes(bytes[channel][cell]);
                let value = f64::from_bits(bits) * SCALE[channel];
                let rounded = value as f32;
                channels[channel][cell] = rounded;
                unusable |= u64::from(!is_usable(rounded, value));
                // 0 in the low bits of all three if the cell was filled.
                marks[cell] |= (bits ^ FILLED_MARK) & 0xffff;
            }
        }
        for mark in marks {
            unusable |= u64::from(mark == 0);
        }
        Self {
            channels,
            is_ordinary: unusable == 0,
        }
    }

    /// The cells as a table holds valid ones.
    #[inline(always)]
    fn cells(&self) -> [Vec4; BLOCK] {
        let mut cells = [Vec4::ONE; BLOCK];
        let [red, green, blue] = &self.channels;
        for (cell, rgba) in cells.iter_mut().enumerate() {
            *rgba = Vec4::new(red[cell], green[cell], blue[cell], 1.0);
        }
        cells
    }
}

/// Checks the header and the length of a file, without its values.
pub(super) fn check_file(path: &Path) -> Result<()> {
    read_header(&mut RegularFile::open(path)?).map(drop)
}

fn read_header(file: &mut RegularFile) -> Result<Header> {
    // More than the header: a file of another kind is recognised by its first bytes.
    let mut head = [0; SIGNATURE_BYTES];
    let there = &mut head[..file.len().min(SIGNATURE_BYTES as u64) as usize];
    file.read_at(0, there)?;
    Header::parse(there, file.len(), file.path())
}

/// Decodes cells from the same stretch of the three colour planes, red, green and blue: little-endian doubles, scaled to
/// f_r in sr⁻¹. Any bit pattern is a value; a cell that is not complete in all planes is left out.
///
/// Planes start at byte 12 of a file and are unaligned there, so they are read byte-wise rather than cast.
///
/// See [`MerlTable`](crate::material::merl::MerlTable) for an example of a table.
pub fn decode_cells([red, green, blue]: [&[u8]; 3], mut push: impl FnMut([f64; 3])) {
    let [red, green, blue] = [red, green, blue].map(|plane| plane.as_chunks::<8>().0);
    for ((r, g), b) in red.iter().zip(green).zip(blue) {
        push(decode_cell([r, g, b]));
    }
}

/// f_r of one cell from its numbers in a file.
#[inline]
fn decode_cell([red, green, blue]: [&[u8; 8]; 3]) -> [f64; 3] {
    [
        LittleEndian::read_f64(red) * SCALE[0],
        LittleEndian::read_f64(green) * SCALE[1],
        LittleEndian::read_f64(blue) * SCALE[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::super::{decode_embedded, write};
    use super::*;
    use crate::files::Overwrite;

    #[test]
    fn mapped_and_read_tables_are_equal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nickel.binary");
        let nickel = decode_embedded("nickel").unwrap();
        write(&nickel, &path, Overwrite::Refuse).unwrap();
        let mut file = RegularFile::open(&path).unwrap();
        let header = read_header(&mut file).unwrap();
        let read = decode_read(&mut file, header, false).unwrap();
        assert!(read.cells().eq(nickel.cells()));
        let access = load_with_access(&path, false).unwrap().1;
        match decode_mapped(&file, header, false) {
            Ok(mapped) => {
                assert!(mapped.cells().eq(read.cells()) && mapped.census() == read.census());
                assert_eq!(access, "mapped");
            }
            Err(why) => assert_eq!(access, format!("copied ({why})")),
        }
        let writer = std::fs::OpenOptions::new()
            .append(true)
            .open(&path)
            .unwrap();
        let (copied, access) = load_with_access(&path, false).unwrap();
        assert!(copied.cells().eq(nickel.cells()));
        assert!(access.starts_with("copied ("), "{access}");
        drop(writer);
    }
}
