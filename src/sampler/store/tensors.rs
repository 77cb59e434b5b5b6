//! Named arrays of numbers, there and back, little-endian.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::{Path, PathBuf};

use safetensors::tensor::{Metadata, TensorView};
use safetensors::{Dtype, serialize};
use sha2::{Digest, Sha256};

use crate::{Error, Result};

/// One-dimensional tensors to be written, by name, as bytes.
///
/// The example of [`SamplerFile`](crate::sampler::store::SamplerFile) stores a sampler and reads it back.
#[derive(Debug, Default)]
pub struct TensorWriter(BTreeMap<String, (Dtype, Vec<u8>)>);

/// Tensors in a file's bytes, and where these came from.
///
/// The example of [`SamplerFile`](crate::sampler::store::SamplerFile) stores a sampler and reads it back.
#[derive(Debug)]
pub struct Tensors {
    path: PathBuf,
    bytes: Vec<u8>,
    /// Where the ranges below count from.
    data_start: usize,
    map: BTreeMap<String, (Dtype, Range<usize>)>,
}

/// Numbers that tensors hold: `f32`, `u32`, `u16` and `i8`.
///
/// The example of [`SamplerFile`](crate::sampler::store::SamplerFile) stores a sampler and reads it back.
pub trait Element: Sized {
    /// The type's name in a file.
    const DTYPE: Dtype;

    /// Appends the number's bytes.
    fn put(&self, out: &mut Vec<u8>);

    /// The number of so many bytes; `None` if their count is not its own.
    fn get(bytes: &[u8]) -> Option<Self>;
}

macro_rules! element {
    ($t:ty, $dtype:expr) => {
        impl Element for $t {
            const DTYPE: Dtype = $dtype;
            fn put(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
            fn get(bytes: &[u8]) -> Option<Self> {
                bytes.try_into().ok().map(Self::from_le_bytes)
            }
        }
    };
}
element!(f32, Dtype::F32);
element!(u32, Dtype::U32);
element!(u16, Dtype::U16);
element!(i8, Dtype::I8);

impl TensorWriter {
    /// Adds a tensor, or replaces that of the same name.
    pub fn add<T: Element>(&mut self, name: &str, values: impl IntoIterator<Item = T>) {
        let mut bytes = Vec::new();
        values.into_iter().for_each(|v| v.put(&mut bytes));
        self.0.insert(name.into(), (T::DTYPE, bytes));
    }

    /// SHA-256 over names, types and bytes, in hexadecimal.
    pub(super) fn sha256(&self) -> String {
        sha256(
            self.0
                .iter()
                .map(|(name, (dtype, bytes))| (name.as_str(), *dtype, bytes.as_slice())),
        )
    }

    /// The bytes of a file.
    pub(super) fn serialize(&self, metadata: HashMap<String, String>) -> Result<Vec<u8>> {
        let failed =
            |e: safetensors::SafeTensorError| Error::argument(e.to_string(), "report this");
        let views = self
            .0
            .iter()
            .map(|(name, (dtype, bytes))| {
                let length = bytes.len() * 8 / dtype.bitsize();
                TensorView::new(*dtype, vec![length], bytes)
                    .map(|v| (name, v))
                    .map_err(failed)
            })
            .collect::<Result<Vec<_>>>()?;
        serialize(views, Some(metadata)).map_err(failed)
    }
}

impl Tensors {
    /// Finds all tensors, and the metadata, in a file's bytes. Nothing is copied.
    ///
    /// The header is checked here rather than by `SafeTensors::deserialize`, which adds to an offset that a file may choose,
    /// and so overflows.
    pub(super) fn read(bytes: Vec<u8>, path: &Path) -> Result<(Self, HashMap<String, String>)> {
        let (data_start, header) = read_header(&bytes, path)?;
        let metadata = header.metadata().clone().unwrap_or_default();
        let mut map = BTreeMap::new();
        for (name, info) in header.tensors() {
            let (start, end) = info.data_offsets;
            map.insert(name, (info.dtype, start..end));
        }
        Ok((
            Self {
                path: path.to_owned(),
                bytes,
                data_start,
                map,
            },
            metadata,
        ))
    }

    /// The file they were read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// SHA-256 over names, types and bytes, in hexadecimal.
    pub(super) fn sha256(&self) -> String {
        sha256(
            self.map
                .iter()
                .map(|(name, (dtype, range))| (name.as_str(), *dtype, self.data(range))),
        )
    }

    /// An array of the file.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is none of that name and type.
    pub fn get<T: Element>(&self, name: &str) -> Result<Vec<T>> {
        Ok(self
            .raw::<T>(name)?
            .chunks_exact(size_of::<T>())
            .filter_map(T::get)
            .collect())
    }

    /// The bytes of an array of the file.
    fn raw<T: Element>(&self, name: &str) -> Result<&[u8]> {
        let (dtype, range) = self
            .map
            .get(name)
            .ok_or_else(|| self.invalid(format!("a tensor \"{name}\""), "none"))?;
        if *dtype != T::DTYPE {
            let expected = format!("tensor \"{name}\" of {:?}", T::DTYPE);
            return Err(self.error(
                self.data_start + range.start,
                expected,
                format!("{dtype:?}"),
            ));
        }
        Ok(self.data(range))
    }

    /// Part `k` of the `count` of `length` values each that an array of the file must have.
    ///
    /// # Errors
    /// As [`Self::get`], and [`Error::Invalid`] for an array of another length.
    pub fn get_nth<T: Element>(
        &self,
        name: &str,
        length: usize,
        k: usize,
        count: usize,
    ) -> Result<Vec<T>> {
        let (raw, size) = (self.raw::<T>(name)?, size_of::<T>());
        if raw.len() != length * count * size {
            let found = (raw.len() / size).to_string();
            return Err(self.invalid_in(name, 0, &format!("{} values", length * count), found));
        }
        let part = raw
            .get(k * length * size..(k + 1) * length * size)
            .unwrap_or_default();
        Ok(part.chunks_exact(size).filter_map(T::get).collect())
    }

    fn data(&self, range: &Range<usize>) -> &[u8] {
        self.bytes[self.data_start..]
            .get(range.clone())
            .unwrap_or_default()
    }

    /// The error for a header or metadata that does not fit.
    pub fn invalid(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        self.error(LENGTH, expected.into(), found.into())
    }

    /// The error for tensor `name` whose value `index` does not fit, or that as a whole does not (0).
    pub fn invalid_in(
        &self,
        name: &str,
        index: usize,
        expected: &str,
        found: impl Into<String>,
    ) -> Error {
        let offset = self.map.get(name).map_or(LENGTH, |(dtype, range)| {
            self.data_start + (range.start + index * dtype.bitsize() / 8).min(range.end)
        });
        self.error(
            offset,
            format!("{expected} in tensor \"{name}\""),
            found.into(),
        )
    }

    fn error(&self, offset: usize, expected: String, found: String) -> Error {
        Error::invalid(
            &self.path,
            offset as u64,
            expected,
            found,
            "build it again with `merlkit build`",
        )
    }
}

/// Where a header's JSON begins, behind its length.
const LENGTH: usize = 8;

/// Checks the header against the file: tensors follow each other without gaps and end where the file ends.
fn read_header(bytes: &[u8], path: &Path) -> Result<(usize, Metadata)> {
    let wrong = |offset: usize, found: String| {
        let fix = "name a file written by `merlkit build`, or build it again";
        Error::invalid(path, offset as u64, "a safetensors file", found, fix)
    };
    let Some((length, rest)) = bytes.split_first_chunk::<LENGTH>() else {
        return Err(wrong(
            bytes.len(),
            format!("the end of a file of {} bytes", bytes.len()),
        ));
    };
    let length = u64::from_le_bytes(*length);
    let Some(json) = usize::try_from(length).ok().and_then(|n| rest.get(..n)) else {
        return Err(wrong(
            0,
            format!("a header of {length} bytes in a file of {}", bytes.len()),
        ));
    };
    // A header is one line, so that the column is the place.
    let metadata: Metadata = serde_json::from_slice(json).map_err(|e| {
        wrong(
            LENGTH + e.column().saturating_sub(1).min(json.len()),
            e.to_string(),
        )
    })?;
    let data = rest.len() - json.len();
    if metadata.data_len() != data {
        let found = format!(
            "{data} bytes of tensors where the header counts {}",
            metadata.data_len()
        );
        return Err(wrong(LENGTH + json.len(), found));
    }
    Ok((LENGTH + json.len(), metadata))
}

/// Over names, types and bytes, in the order of names.
fn sha256<'a>(tensors: impl Iterator<Item = (&'a str, Dtype, &'a [u8])>) -> String {
    let mut hash = Sha256::new();
    for (name, dtype, bytes) in tensors {
        hash.update(format!("{name}:{dtype:?}:{}:", bytes.len()));
        hash.update(bytes);
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
