//! From a file's bytes to a table, in one pass.

use byteorder::{ByteOrder, LittleEndian};
use std::path::Path;

use super::table::{FILLED_MARK, TableBuilder};
use super::{Header, MerlTable, SCALE};
use crate::Result;
use crate::files::{Mapped, RegularFile, SIGNATURE_BYTES};

/// Cells that are read at a time: three planes of them stay in a processor's cache, and calls are few.
const CHUNK: usize = 16_384;

/// Reads a MERL binary, checks it and decodes it into a table that no longer needs the file.
///
/// It is read in pieces, into 384 KB of memory, by `read`: a file that is cut short meanwhile is an error.
///
/// # Errors
/// [`crate::Error::Io`] if it can't be opened, [`crate::Error::Unsupported`] if it is no regular file,
/// [`crate::Error::Invalid`] if its header or length is not a MERL file's.
pub fn load(path: &Path) -> Result<MerlTable> {
    load_channels(path, false)
}

/// [`load`], of a table that may keep channels apart ([`MerlTable::keeps_channels_apart`]).
pub(super) fn load_channels(path: &Path, apart: bool) -> Result<MerlTable> {
    let mut file = RegularFile::open(path)?;
    let header = read_header(&mut file)?;
    let (cells, mut buffers) = (header.cells(), [const { Vec::new() }; 3]);
    let mut table = TableBuilder::new(header, apart);
    for start in (0..cells).step_by(CHUNK) {
        let count = CHUNK.min(cells - start);
        for (channel, buffer) in buffers.iter_mut().enumerate() {
            buffer.resize(8 * count, 0);
            file.read_at(
                (Header::BYTES + 8 * (channel * cells + start)) as u64,
                buffer,
            )?;
        }
        let [red, green, blue] = &buffers;
        note_filled([red, green, blue], &mut table);
        decode_cells([red, green, blue], |rgb| table.push(rgb));
    }
    Ok(table.finish())
}

/// [`load`] through a memory map, for a file that nobody shortens meanwhile: if somebody does, the system ends the process
/// with SIGBUS.
///
/// # Errors
/// As [`load`].
pub fn load_mapped(path: &Path) -> Result<MerlTable> {
    let mapped = Mapped::open(path)?;
    let header = Header::parse(mapped.bytes(), mapped.bytes().len() as u64, path)?;
    let (red, rest) = mapped.bytes()[Header::BYTES..].split_at(8 * header.cells());
    let (green, blue) = rest.split_at(8 * header.cells());
    let mut table = TableBuilder::new(header, false);
    note_filled([red, green, blue], &mut table);
    decode_cells([red, green, blue], |rgb| table.push(rgb));
    Ok(table.finish())
}

/// Notes which of the next cells carry the mark of values that were filled in.
fn note_filled([red, green, blue]: [&[u8]; 3], table: &mut TableBuilder) {
    let mark = (FILLED_MARK as u16).to_le_bytes();
    let is_marked = |plane: &[u8], cell: usize| plane[8 * cell..].starts_with(&mark);
    for (cell, bytes) in red.as_chunks::<8>().0.iter().enumerate() {
        if bytes.starts_with(&mark) && is_marked(green, cell) && is_marked(blue, cell) {
            table.mark_filled(cell);
        }
    }
}

/// Checks the header and the length of a file, without its values.
pub(super) fn check_file(path: &Path) -> Result<()> {
    read_header(&mut RegularFile::open(path)?).map(drop)
}

fn read_header(file: &mut RegularFile) -> Result<Header> {
    // More than the header: a file of another kind is told by what it begins with.
    let mut head = [0; SIGNATURE_BYTES];
    let there = &mut head[..file.len().min(SIGNATURE_BYTES as u64) as usize];
    file.read_at(0, there)?;
    Header::parse(there, file.len(), file.path())
}

/// Decodes cells from the same stretch of the three colour planes, red, green and blue: little-endian doubles, scaled to
/// f_r in sr⁻¹. Any bit pattern is a value; a cell that is not complete in all planes is left out.
///
/// Planes start at byte 12 of a file and are unaligned there, so they are read byte-wise rather than cast.
pub fn decode_cells([red, green, blue]: [&[u8]; 3], mut push: impl FnMut([f64; 3])) {
    for ((r, g), b) in red
        .as_chunks::<8>()
        .0
        .iter()
        .zip(green.as_chunks::<8>().0)
        .zip(blue.as_chunks::<8>().0)
    {
        push([
            LittleEndian::read_f64(r) * SCALE[0],
            LittleEndian::read_f64(g) * SCALE[1],
            LittleEndian::read_f64(b) * SCALE[2],
        ]);
    }
}
