//! From a mapped file to a table, in one pass.

use byteorder::{ByteOrder, LittleEndian};
use std::path::Path;

use super::table::TableBuilder;
use super::{Header, MerlTable, SCALE};
use crate::Result;
use crate::files::Mapped;

/// Maps a MERL binary, checks it and decodes it into a table that no longer needs the file.
///
/// # Errors
/// [`crate::Error::Io`] if it can't be opened, [`crate::Error::Unsupported`] if it is no regular file,
/// [`crate::Error::Invalid`] if its header or length is not a MERL file's.
pub fn load(path: &Path) -> Result<MerlTable> {
    let mapped = Mapped::open(path)?;
    let header = Header::parse(mapped.bytes(), path)?;
    Ok(decode(header, &mapped.bytes()[Header::BYTES..]))
}

/// Decodes three colour planes of little-endian doubles. They start at byte 12 of a file and are unaligned, so they are
/// read byte-wise rather than cast.
fn decode(header: Header, payload: &[u8]) -> MerlTable {
    let plane = payload.len() / 3;
    let (red, rest) = payload.split_at(plane);
    let (green, blue) = rest.split_at(plane);
    let mut table = TableBuilder::new(header);
    for ((r, g), b) in
        red.as_chunks::<8>().0.iter().zip(green.as_chunks::<8>().0).zip(blue.as_chunks::<8>().0)
    {
        table.push([
            LittleEndian::read_f64(r) * SCALE[0],
            LittleEndian::read_f64(g) * SCALE[1],
            LittleEndian::read_f64(b) * SCALE[2],
        ]);
    }
    table.finish()
}
