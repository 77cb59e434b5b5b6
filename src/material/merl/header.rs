//! The twelve bytes in front, and what they promise about the rest.

use byteorder::{ByteOrder, LittleEndian};
use std::path::Path;

use crate::files::{FileClass, looks_like_utia, recognise_kind};
use crate::geometry::merl_axes::{THETA_D_BINS, THETA_H_BINS};
use crate::{Error, Result};

/// Factors from a file's raw values to f_r in sr⁻¹, for red, green and blue.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
pub const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Dimensions that a file declares; only the two known kinds exist as values of this type.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// 180 (isotropic and reciprocal, φd in [0, π)) or 360 (no φd symmetry, φd in [0, 2π)).
    pub phi_d_bins: usize,
}

impl Header {
    /// Bytes of the header: three little-endian `i32`.
    pub const BYTES: usize = 12;

    /// Reads the header from the first bytes of a file of `file_bytes`, and checks that length against it, before anything
    /// is allocated. `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the offset where the file stops being a MERL file; [`Error::Unsupported`] for what is recognised
    /// as a file of another kind.
    pub fn parse(bytes: &[u8], file_bytes: u64, path: &Path) -> Result<Self> {
        let Some(head) = bytes.get(..Self::BYTES) else {
            return Err(Error::invalid(
                path,
                bytes.len() as u64,
                "a 12-byte header (three 32-bit dimensions)",
                format!("the end of a file of {file_bytes} bytes"),
                "fetch the file again: it is empty or cut off",
            ));
        };
        let mut dims = [0i32; 3];
        LittleEndian::read_i32_into(head, &mut dims);
        let header = match dims {
            [90, 90, 180] => Self { phi_d_bins: 180 },
            [90, 90, 360] => Self { phi_d_bins: 360 },
            _ => return Err(wrong_dimensions(bytes, dims, file_bytes, path)),
        };
        header.check_length(file_bytes, path)?;
        Ok(header)
    }

    /// Refuses a file that is not as long as the dimensions demand.
    fn check_length(self, file_bytes: u64, path: &Path) -> Result<()> {
        let expected = self.file_bytes();
        if file_bytes == expected {
            return Ok(());
        }
        if file_bytes == expected / 2 + Self::BYTES as u64 / 2 {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: "a MERL table in single precision".into(),
                fix: "write its values as 64-bit floating-point numbers, as the MERL database has them".into(),
            });
        }
        let (end, fix) = if file_bytes < expected {
            (file_bytes, "fetch the file again: it is cut off")
        } else {
            (
                expected,
                "remove what follows the table, or fetch the file again",
            )
        };
        Err(Error::invalid(
            path,
            end,
            format!("{expected} bytes for 90 × 90 × {}", self.phi_d_bins),
            format!("{file_bytes} bytes"),
            fix,
        ))
    }

    /// Cells of one colour plane.
    pub fn cells(self) -> usize {
        THETA_H_BINS * THETA_D_BINS * self.phi_d_bins
    }

    /// Length of a whole file: 34,992,012 bytes for 180 bins of φd.
    pub fn file_bytes(self) -> u64 {
        (Self::BYTES + 3 * 8 * self.cells()) as u64
    }

    /// The header's twelve bytes.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut out = [0; Self::BYTES];
        let dims = [
            THETA_H_BINS as i32,
            THETA_D_BINS as i32,
            self.phi_d_bins as i32,
        ];
        LittleEndian::write_i32_into(&dims, &mut out);
        out
    }
}

/// The error for dimensions that no MERL file has. It names the kind of file where one is recognised.
fn wrong_dimensions(bytes: &[u8], dims: [i32; 3], file_bytes: u64, path: &Path) -> Error {
    // It has no mark of its own, and a byte of a number may look like that of another kind.
    if looks_like_utia(bytes, file_bytes) {
        return Error::Unsupported {
            path: path.to_owned(),
            what: "what looks like a file of the UTIA database, by its size,".into(),
            fix: "`merlkit import` makes a MERL binary of it, without its anisotropy".into(),
        };
    }
    if let Some((what, fix)) = recognise_other(bytes, dims) {
        return Error::Unsupported {
            path: path.to_owned(),
            what: what.into(),
            fix,
        };
    }
    let [a, b, c] = dims;
    Error::invalid(
        path,
        0,
        "dimensions 90 × 90 × 180 or 90 × 90 × 360",
        format!("{a} × {b} × {c}"),
        "name a MERL BRDF binary (little-endian, isotropic)",
    )
}

/// What a file is whose dimensions are not MERL's, and what to do with it; `None` if it is of no known kind.
fn recognise_other(start: &[u8], dims: [i32; 3]) -> Option<(&'static str, String)> {
    if let [90, 90, 180 | 360] = dims.map(i32::swap_bytes) {
        let fix = "reverse the bytes of its three 32-bit dimensions and of each 64-bit value";
        return Some(("a MERL table in big-endian byte order", fix.into()));
    }
    let (what, class) = recognise_kind(start)?;
    let fix = match class {
        FileClass::Environment => {
            "name a material here; pictures are environments, for --light".into()
        }
        FileClass::DisplayPicture | FileClass::RadiancePicture | FileClass::Useless => {
            "name a material".into()
        }
        FileClass::Archive("unzip") => {
            "unzip it, and name what it holds; `merlkit import` makes a MERL binary of an .npz file"
                .into()
        }
        FileClass::Archive(command) => format!("unpack it with {command}, and name what it holds"),
        FileClass::Placeholder => {
            "fetch the file itself: this came in its place (git lfs pull, where it is a pointer)"
                .into()
        }
        FileClass::Array => "`merlkit import` makes a MERL binary of it".into(),
        FileClass::Container => {
            "write its values as a MERL binary: docs/import.md has the layout".into()
        }
        FileClass::FourierBsdf => {
            "use the material's measurements: Fourier coefficients are not read".into()
        }
        FileClass::SamplerFile => {
            "name the material; `merlkit info FILE` says which, and `sample` draws from the file"
                .into()
        }
        FileClass::Text => {
            "name a MERL binary or a .bsdf file; `merlkit import` makes a MERL binary of a list of measurements"
                .into()
        }
    };
    Some((what, fix))
}
