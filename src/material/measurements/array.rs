//! Tables as arrays of numpy: `.npy`, and `.npz` archives of them (NEP 1).

use std::path::Path;

use crate::files::RegularFile;
use crate::material::merl::{Header, MerlTable, THETA_D_BINS, THETA_H_BINS};
use crate::{Error, Result};

/// Arrays beyond this many bytes are refused; a table of 360 bins of φd in f64 has 70 MB.
const LONGEST: u64 = 1 << 28;
const FIX: &str =
    "store f_r in sr⁻¹ as an array [90, 90, 180, 3] or [3, 90, 90, 180] of <f4 or <f8, in C order";

/// Reads a table of f_r in sr⁻¹, by bins θh, θd, φd of MERL's axes, from an array of shape [90, 90, 180, 3] or
/// [3, 90, 90, 180] (or 360 bins of φd). Of an archive it is the array `merl.rgb`, as exports have it, or the only one.
/// Negative and NaN values are gaps: of their channel if `channels_apart`, else of their whole cell.
///
/// The example of [`Measurements`](crate::material::measurements::Measurements) makes a table from a list.
///
/// # Errors
/// [`Error::Io`], [`Error::Unsupported`] for what is too long, [`Error::Invalid`] for an array that is no such table.
pub fn read_array(path: &Path, channels_apart: bool) -> Result<MerlTable> {
    let bytes = RegularFile::open(path)?.read_all(LONGEST)?;
    if bytes.starts_with(b"PK") {
        return from_npy(&unpack(bytes, path)?, channels_apart, path);
    }
    from_npy(&bytes, channels_apart, path)
}

/// The array of an archive.
#[cfg(feature = "npz")]
fn unpack(bytes: Vec<u8>, path: &Path) -> Result<Vec<u8>> {
    use std::io::{Cursor, Read};

    let expected = "an .npz archive of numpy";
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes))
        .map_err(|e| refuse(path, 0, expected, &e.to_string()))?;
    let mut names: Vec<String> = Vec::new();
    for name in archive.file_names().flatten() {
        names.push(name.into_owned());
    }
    let name = match names.as_slice() {
        [only] => only.clone(),
        _ if names.iter().any(|name| name == "merl.rgb.npy") => "merl.rgb.npy".into(),
        _ => {
            let found = format!("arrays {}", names.join(", "));
            return Err(refuse(path, 0, expected, &found));
        }
    };
    let mut entry = archive.by_name(&name).map_err(|e| {
        let fix = "write the archive with np.savez, which does not compress";
        Error::invalid(
            path,
            0,
            "an array that is stored uncompressed",
            e.to_string(),
            fix,
        )
    })?;
    let mut out = Vec::new();
    let read = Read::take(&mut entry, LONGEST).read_to_end(&mut out);
    read.map_err(|e| Error::io(path, "read", e))?;
    Ok(out)
}

/// Stands in for the reader where archives are left out.
#[cfg(not(feature = "npz"))]
fn unpack(_: Vec<u8>, path: &Path) -> Result<Vec<u8>> {
    Err(Error::Unsupported {
        path: path.to_owned(),
        what: "an .npz archive, in this build of the library,".into(),
        fix: "build it with the feature `npz`, or save the array as .npy".into(),
    })
}

fn refuse(path: &Path, offset: usize, expected: &str, found: &str) -> Error {
    Error::invalid(path, offset as u64, expected, found, FIX)
}

/// A table from the bytes of an `.npy` file.
fn from_npy(bytes: &[u8], channels_apart: bool, path: &Path) -> Result<MerlTable> {
    let head = read_head(bytes, path)?;
    let header = Header {
        phi_d_bins: head.phi_d_bins,
    };
    let (width, cells) = (head.width, header.cells());
    let values = &bytes[head.end..];
    if values.len() != 3 * width * cells {
        let expected = format!("{} bytes of numbers", 3 * width * cells);
        let found = values.len().to_string();
        return Err(refuse(path, head.end, &expected, &found));
    }
    let mut cell = 0;
    Ok(MerlTable::collect(header, channels_apart, |_, _, _| {
        let rgb = [0, 1, 2].map(|channel| {
            let k = if head.channels_last {
                3 * cell + channel
            } else {
                channel * cells + cell
            };
            number(&values[width * k..][..width])
        });
        cell += 1;
        rgb
    }))
}

/// A number of four or eight bytes, little-endian.
fn number(bytes: &[u8]) -> f64 {
    if let Some(eight) = bytes.first_chunk::<8>() {
        return f64::from_le_bytes(*eight);
    }
    match bytes.first_chunk::<4>() {
        Some(four) => f64::from(f32::from_le_bytes(*four)),
        None => f64::NAN,
    }
}

/// What the header of an `.npy` file states.
struct ArrayHead {
    /// Where the numbers begin, in bytes.
    end: usize,
    /// Bytes of a number: 4 or 8.
    width: usize,
    phi_d_bins: usize,
    /// Whether the channel is the last index, and the fastest; else it is the first.
    channels_last: bool,
}

/// The numbers between the parentheses of `'shape':(90,90,180,3)`, in a head without blanks; none if there are none.
fn read_shape(head: &str) -> Vec<usize> {
    let mut shape = Vec::new();
    let Some((_, rest)) = head.split_once("'shape':(") else {
        return shape;
    };
    let numbers = rest.split(')').next().unwrap_or_default();
    for number in numbers.split(',') {
        if let Ok(number) = number.parse() {
            shape.push(number);
        }
    }
    shape
}

fn read_head(bytes: &[u8], path: &Path) -> Result<ArrayHead> {
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err(refuse(path, 0, "an array of numpy", "other bytes"));
    }
    // Version 1 has a length of two bytes, later ones of four.
    let (start, length): (usize, usize) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => {
            (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
        }
        _ => return Err(refuse(path, bytes.len(), "a head", "the end of the file")),
    };
    let Some(head) = bytes.get(start..start.saturating_add(length)) else {
        return Err(refuse(path, start, "a head", "the end of the file"));
    };
    let head = String::from_utf8_lossy(head).replace(' ', "");
    let width = if head.contains("'descr':'<f4'") {
        4
    } else if head.contains("'descr':'<f8'") {
        8
    } else {
        return Err(refuse(path, start, "numbers of type <f4 or <f8", &head));
    };
    if head.contains("'fortran_order':True") {
        return Err(refuse(path, start, "an array in C order", &head));
    }
    let shape = read_shape(&head);
    let (phi_d_bins, channels_last) = match shape.as_slice() {
        [THETA_H_BINS, THETA_D_BINS, n @ (180 | 360), 3] => (*n, true),
        [3, THETA_H_BINS, THETA_D_BINS, n @ (180 | 360)] => (*n, false),
        _ => {
            let found = format!("{shape:?}");
            return Err(refuse(path, start, "the shape of a table", &found));
        }
    };
    Ok(ArrayHead {
        end: start + length,
        width,
        phi_d_bins,
        channels_last,
    })
}
