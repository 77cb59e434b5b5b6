//! From a table to a MERL binary.

use byteorder::{ByteOrder, LittleEndian};
use std::io::Write;
use std::path::Path;

use super::{Header, MerlTable};
use crate::files::{Overwrite, write_new};
use crate::{Error, Result};

/// Writes `table` as a MERL binary that the original reader accepts. Invalid cells become −1 in all channels.
///
/// Loading the file gives the same table to the bit.
///
/// See [`MerlTable`](crate::material::merl::MerlTable) for an example of a table.
///
/// # Errors
/// As [`write_new`].
pub fn write(table: &MerlTable, path: &Path, overwrite: Overwrite) -> Result<()> {
    write_raw(table.header(), path, overwrite, |cell, channel| {
        table.raw(cell, channel)
    })
}

/// Writes `raw(cell, channel)`, in file order and in a file's units, as a MERL binary.
pub(super) fn write_raw(
    header: Header,
    path: &Path,
    overwrite: Overwrite,
    raw: impl Fn(usize, usize) -> f64,
) -> Result<()> {
    write_new(path, overwrite, |out| {
        fill(header, out, &raw).map_err(|e| Error::io(path, "write", e))
    })
}

fn fill<W: Write + ?Sized>(
    header: Header,
    out: &mut W,
    raw: &impl Fn(usize, usize) -> f64,
) -> std::io::Result<()> {
    out.write_all(&header.to_bytes())?;
    let mut row = vec![0u8; 8 * header.phi_d_bins];
    for channel in 0..3 {
        for start in (0..header.cells()).step_by(header.phi_d_bins) {
            for (k, bytes) in row.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                LittleEndian::write_f64(bytes, raw(start + k, channel));
            }
            out.write_all(&row)?;
        }
    }
    Ok(())
}
