//! From a file's bytes to a table, in one pass.

use byteorder::{ByteOrder, LittleEndian};
use std::path::Path;

use super::table::{FILLED_MARK, TableBuilder};
use super::{Header, MerlTable, SCALE};
use crate::Result;
use crate::files::{Lease, RegularFile, SIGNATURE_BYTES, WhyRead};

/// Cells that are read at a time: three planes of them stay in a processor's cache, and calls are few.
const CHUNK: usize = 16_384;

/// Cells that are mapped at a time: 6 MB in three planes, so that a file takes no more memory than that.
const WINDOW: usize = 1 << 18;

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
        let [red, green, blue] = &buffers;
        note_filled([red, green, blue], &mut table);
        decode_cells([red, green, blue], |rgb| table.push(rgb));
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
        let planes = windows.each_ref().map(|window| window.bytes());
        note_filled(planes, &mut table);
        decode_cells(planes, |rgb| table.push(rgb));
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

/// Notes which of the next cells carry the mark of values that were filled in.
fn note_filled([red, green, blue]: [&[u8]; 3], table: &mut TableBuilder) {
    let mark = (FILLED_MARK as u16).to_le_bytes();
    for (cell, bytes) in red.as_chunks::<8>().0.iter().enumerate() {
        let is_filled = bytes.starts_with(&mark)
            && green[8 * cell..].starts_with(&mark)
            && blue[8 * cell..].starts_with(&mark);
        if is_filled {
            table.mark_filled(cell);
        }
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
        push([
            LittleEndian::read_f64(r) * SCALE[0],
            LittleEndian::read_f64(g) * SCALE[1],
            LittleEndian::read_f64(b) * SCALE[2],
        ]);
    }
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
