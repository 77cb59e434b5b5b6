//! The tensor file: named arrays with types and shapes, little-endian.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::files::{Overwrite, RegularFile, write_new};
use crate::{Error, Result};

const MAGIC: &[u8; 12] = b"tensor_file\0";
const VERSION: [u8; 2] = [1, 0];
/// Where the list of fields begins: behind magic, version and their number.
const FIELDS: usize = 18;
/// Bytes at the beginning of a file in which [`FieldList::read`] looks for the list of fields; files have a dozen of them.
const LIST_BYTES: u64 = 1 << 16;
/// Bytes of the longest file that is read.
const LONGEST: u64 = 1 << 32;
/// Data of every field begin at a multiple of this.
const ALIGNMENT: usize = 8;
/// Bytes of an element by the number of its type: none, then u8, i8, u16, i16, u32, i32, u64, i64, f16, f32, f64.
const WIDTHS: [usize; 12] = [0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8];
const U8: u8 = 1;
pub(in crate::material) const U16: u8 = 3;
pub(in crate::material) const F32: u8 = 10;

/// An array of numbers, the last axis the fastest; the shape's product is the number of values.
///
/// The example of [`BsdfFile`](crate::material::rgl::BsdfFile) tabulates a material and evaluates the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Length of each axis.
    pub shape: Vec<usize>,
    /// All values.
    pub values: Vec<f32>,
}

impl Tensor {
    /// An array of `shape` that holds `value` everywhere.
    pub fn filled(shape: &[usize], value: f32) -> Self {
        Self {
            shape: shape.to_vec(),
            values: vec![value; shape.iter().product()],
        }
    }
}

/// A field to be written.
pub(super) enum Data<'a> {
    Bytes(&'a [u8]),
    Floats(&'a [usize], &'a [f32]),
}

/// What a file holds and where, once its container is known to be sound: every array lies in the file, none overlaps another.
#[derive(Debug)]
pub(in crate::material) struct FieldList {
    path: PathBuf,
    fields: BTreeMap<String, TensorField>,
}

/// A file that has been read as a whole.
#[derive(Debug)]
pub(super) struct TensorFile {
    list: FieldList,
    bytes: Vec<u8>,
}

/// An array in a file.
#[derive(Debug)]
pub(in crate::material) struct TensorField {
    /// Where the list of fields names it.
    entry: usize,
    /// Number of the type of its elements.
    pub dtype: u8,
    /// Length of each axis.
    pub shape: Vec<usize>,
    /// Where its data begin.
    pub start: usize,
    /// Where they end.
    pub end: usize,
}

/// Whether `path` begins as a tensor file does.
///
/// See [`BsdfFile`](crate::material::rgl::BsdfFile) for an example of what is in one.
pub fn looks_like_bsdf(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    RegularFile::open(path)
        .and_then(|mut f| f.read_at(0, &mut start))
        .is_ok()
        && start == *MAGIC
}

impl FieldList {
    /// Reads the list at the beginning of a file, and none of the data.
    pub fn read(file: &mut RegularFile) -> Result<Self> {
        let mut start = vec![0; file.len().min(LIST_BYTES) as usize];
        file.read_at(0, &mut start)?;
        Self::parse(
            &start,
            usize::try_from(file.len()).unwrap_or(usize::MAX),
            file.path(),
        )
    }

    /// Finds all fields of a file of `length` bytes that begins with `bytes`. `path` is for messages.
    fn parse(bytes: &[u8], length: usize, path: &Path) -> Result<Self> {
        let mut cursor = Cursor {
            bytes,
            length,
            at: 0,
            path,
        };
        let count = cursor.head()?;
        let mut fields = BTreeMap::new();
        for _ in 0..count {
            let entry = cursor.at;
            let (name, field) = cursor.field()?;
            if fields.contains_key(&name) {
                return Err(cursor.wrong(
                    entry,
                    "fields of different names",
                    format!("another {name:?}"),
                ));
            }
            fields.insert(name, field);
        }
        check_places(&fields, &cursor)?;
        Ok(Self {
            path: path.to_owned(),
            fields,
        })
    }

    pub fn has(&self, name: &str) -> bool {
        self.fields.contains_key(name)
    }

    /// Whether these are the fields of a `.pbsdf` file (Baek et al. 2020).
    pub fn is_polarised(&self) -> bool {
        self.has("M") && self.has("wvls")
    }

    /// The field of a name.
    pub fn require(&self, name: &str) -> Result<&TensorField> {
        match self.fields.get(name) {
            Some(field) => Ok(field),
            None => {
                let expected = format!("a field \"{name}\"");
                Err(self.wrong(FIELDS, expected, "none".into()))
            }
        }
    }

    /// The field of a name, of elements of type `dtype` on so many axes.
    pub fn field(&self, name: &str, dtype: u8, axes: usize) -> Result<&TensorField> {
        let field = self.require(name)?;
        if field.dtype != dtype || field.shape.len() != axes {
            let expected = format!("elements of type {dtype} on {axes} axes");
            let found = format!("type {} on {}", field.dtype, field.shape.len());
            return Err(self.wrong_entry(name, expected, found));
        }
        Ok(field)
    }

    /// The error for a field that does not fit as a whole; its place is in the list of fields.
    pub fn wrong_entry(
        &self,
        name: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Error {
        let at = self.fields.get(name).map_or(FIELDS, |f| f.entry);
        self.wrong(
            at,
            format!("{} in field \"{name}\"", expected.into()),
            found.into(),
        )
    }

    /// The error for value `index` of a field of floats.
    pub fn wrong_value(&self, name: &str, index: usize, expected: &str, found: f32) -> Error {
        let at = self
            .fields
            .get(name)
            .map_or(FIELDS, |f| (f.start + 4 * index).min(f.end));
        self.wrong(
            at,
            format!("{expected} in field \"{name}\""),
            format!("{found} as value {index}"),
        )
    }

    /// The error for byte `at` of the file, with advice that fits what its fields are.
    fn wrong(&self, at: usize, expected: String, found: String) -> Error {
        match self.is_polarised() {
            true => Error::invalid(&self.path, at as u64, expected, found, POLARISED_FIX),
            false => wrong(&self.path, at, expected, found),
        }
    }
}

impl TensorFile {
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_bytes(RegularFile::open(path)?.read_all(LONGEST)?, path)
    }

    /// Finds all fields in a file's bytes; nothing is copied. `path` is for messages.
    pub fn from_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self> {
        Ok(Self {
            list: FieldList::parse(&bytes, bytes.len(), path)?,
            bytes,
        })
    }

    pub fn has(&self, name: &str) -> bool {
        self.list.has(name)
    }

    /// A field of bytes.
    pub fn bytes(&self, name: &str) -> Result<&[u8]> {
        let field = self.list.field(name, U8, 1)?;
        Ok(self.bytes.get(field.start..field.end).unwrap_or_default())
    }

    /// A field of finite numbers with so many axes, none of them empty.
    pub fn floats(&self, name: &str, axes: usize) -> Result<Tensor> {
        let field = self.list.field(name, F32, axes)?;
        let bytes = self.bytes.get(field.start..field.end).unwrap_or_default();
        let values: Vec<f32> = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|b| f32::from_le_bytes(*b))
            .collect();
        if values.is_empty() {
            return Err(self.wrong_entry(
                name,
                "values",
                format!("none, of shape {:?}", field.shape),
            ));
        }
        match values.iter().position(|v| !v.is_finite()) {
            Some(k) => Err(self.wrong_value(name, k, "finite numbers", values[k])),
            None => Ok(Tensor {
                shape: field.shape.clone(),
                values,
            }),
        }
    }

    /// As [`FieldList::wrong_entry`].
    pub fn wrong_entry(
        &self,
        name: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Error {
        self.list.wrong_entry(name, expected, found)
    }

    /// As [`FieldList::wrong_value`].
    pub fn wrong_value(&self, name: &str, index: usize, expected: &str, found: f32) -> Error {
        self.list.wrong_value(name, index, expected, found)
    }
}

/// What to do about a file that does not fit.
const FIX: &str = "name a .bsdf file of a measured material, or fetch or export it again";
const POLARISED_FIX: &str =
    "name a .pbsdf file of the KAIST database of polarimetric measurements, or fetch it again";

/// The error for byte `at` of a file whose fields are not known; its name decides which kind of file it was meant to be.
fn wrong(path: &Path, at: usize, expected: String, found: String) -> Error {
    let is_polarised = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("pbsdf"));
    let fix = if is_polarised { POLARISED_FIX } else { FIX };
    Error::invalid(path, at as u64, expected, found, fix)
}

/// Reads the list of fields; every read is checked against the end of the file.
struct Cursor<'a> {
    /// The beginning of the file, or all of it.
    bytes: &'a [u8],
    /// Bytes of the whole file.
    length: usize,
    at: usize,
    path: &'a Path,
}

impl Cursor<'_> {
    fn head(&mut self) -> Result<u32> {
        if self.bytes.get(..MAGIC.len()) != Some(MAGIC) {
            return Err(self.wrong(
                0,
                "a tensor file, which begins with \"tensor_file\"",
                "something else",
            ));
        }
        self.at = MAGIC.len();
        let version = self.take()?;
        if version != VERSION {
            let found = format!("version {}.{}", version[0], version[1]);
            return Err(self.wrong(MAGIC.len(), "a tensor file of version 1.0", found));
        }
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn field(&mut self) -> Result<(String, TensorField)> {
        let entry = self.at;
        let length = usize::from(u16::from_le_bytes(self.take()?));
        let name = self.slice(length)?;
        let Ok(name) = String::from_utf8(name.to_vec()) else {
            return Err(self.wrong(entry + 2, "a name in UTF-8", "other bytes"));
        };
        let axes = u16::from_le_bytes(self.take()?);
        let [dtype] = self.take()?;
        let width = match WIDTHS.get(usize::from(dtype)) {
            Some(&width) if width > 0 => width,
            _ => {
                let found = format!("type {dtype} for {name:?}");
                return Err(self.wrong(self.at - 1, "a type of 1 to 11", found));
            }
        };
        let offset = u64::from_le_bytes(self.take()?);
        let mut shape = Vec::new();
        for _ in 0..axes {
            let length = u64::from_le_bytes(self.take()?);
            shape.push(usize::try_from(length).unwrap_or(usize::MAX));
        }
        let count = shape.iter().try_fold(width, |n, &axis| n.checked_mul(axis));
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = count
            .and_then(|n| start.checked_add(n))
            .filter(|&end| end <= self.length);
        let Some(end) = end else {
            let found = format!("{name:?} of shape {shape:?} from byte {offset} on");
            return Err(self.wrong(entry, format!("data within {} bytes", self.length), found));
        };
        Ok((
            name,
            TensorField {
                entry,
                dtype,
                shape,
                start,
                end,
            },
        ))
    }

    fn slice(&mut self, length: usize) -> Result<&[u8]> {
        let start = self.at;
        let Some(slice) = self.bytes.get(start..start + length) else {
            let found = match self.bytes.len() == self.length {
                true => format!("the end of a file of {} bytes", self.length),
                false => format!("more than {} bytes of it", self.bytes.len()),
            };
            return Err(self.wrong(self.bytes.len(), "the list of fields to go on", found));
        };
        self.at += length;
        Ok(slice)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut out = [0; N];
        out.copy_from_slice(self.slice(N)?);
        Ok(out)
    }

    fn wrong(&self, at: usize, expected: impl Into<String>, found: impl Into<String>) -> Error {
        wrong(self.path, at, expected.into(), found.into())
    }
}

/// Data lie behind the list of fields, aligned, and none in another's.
fn check_places(fields: &BTreeMap<String, TensorField>, list: &Cursor<'_>) -> Result<()> {
    let mut by_start: Vec<(&String, &TensorField)> =
        fields.iter().filter(|(_, f)| f.end > f.start).collect();
    by_start.sort_by_key(|(_, f)| f.start);
    let mut free = list.at;
    for (name, field) in by_start {
        if field.start < free {
            let found = format!("data of {name:?} at byte {}", field.start);
            return Err(list.wrong(field.entry, format!("data from byte {free} on"), found));
        }
        if field.start % WIDTHS[usize::from(field.dtype)] != 0 {
            let found = format!("data of {name:?} at byte {}", field.start);
            return Err(list.wrong(field.entry, "data aligned to their elements", found));
        }
        free = field.end;
    }
    Ok(())
}

/// Writes a tensor file; returns its length in bytes.
pub(super) fn write(path: &Path, overwrite: Overwrite, fields: &[(&str, Data<'_>)]) -> Result<u64> {
    let bytes = encode(fields);
    write_new(path, overwrite, |out| {
        out.write_all(&bytes)
            .map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(bytes.len() as u64)
}

/// The bytes of a tensor file, fields in the order given.
fn encode(fields: &[(&str, Data<'_>)]) -> Vec<u8> {
    let list: usize = fields
        .iter()
        .map(|(name, data)| 13 + name.len() + 8 * data.shape().len())
        .sum();
    let mut at = FIELDS + list;
    let mut out = [&MAGIC[..], &VERSION, &(fields.len() as u32).to_le_bytes()].concat();
    for (name, data) in fields {
        at = at.next_multiple_of(ALIGNMENT);
        out.extend_from_slice(&(name.len() as u16).to_le_bytes());
        out.extend_from_slice(name.as_bytes());
        out.extend_from_slice(&(data.shape().len() as u16).to_le_bytes());
        out.push(data.dtype());
        out.extend_from_slice(&(at as u64).to_le_bytes());
        data.shape()
            .iter()
            .for_each(|&axis| out.extend_from_slice(&(axis as u64).to_le_bytes()));
        at += data.bytes();
    }
    for (_, data) in fields {
        out.resize(out.len().next_multiple_of(ALIGNMENT), 0);
        match data {
            Data::Bytes(bytes) => out.extend_from_slice(bytes),
            Data::Floats(_, values) => values
                .iter()
                .for_each(|v| out.extend_from_slice(&v.to_le_bytes())),
        }
    }
    out
}

impl Data<'_> {
    fn dtype(&self) -> u8 {
        match self {
            Self::Bytes(_) => U8,
            Self::Floats(..) => F32,
        }
    }

    fn shape(&self) -> Vec<usize> {
        match self {
            Self::Bytes(bytes) => vec![bytes.len()],
            Self::Floats(shape, _) => shape.to_vec(),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Floats(_, values) => size_of_val(*values),
        }
    }
}
