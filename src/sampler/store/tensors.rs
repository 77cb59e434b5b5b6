//! Named arrays of numbers, there and back, little-endian.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use safetensors::{Dtype, SafeTensors, serialize, tensor::TensorView};
use sha2::{Digest, Sha256};

use crate::{Error, Result};

/// One-dimensional tensors by name, as bytes.
type Map = BTreeMap<String, (Dtype, Vec<u8>)>;

/// Tensors to be written.
#[derive(Default)]
pub(super) struct TensorsOut(Map);

/// Tensors read from a file, and where they came from.
#[derive(Debug)]
pub(super) struct Tensors {
    path: PathBuf,
    map: Map,
}

/// Numbers that tensors hold.
pub(super) trait Element: Sized {
    const DTYPE: Dtype;
    fn put(&self, out: &mut Vec<u8>);
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

impl TensorsOut {
    pub fn add<T: Element>(&mut self, name: &str, values: impl IntoIterator<Item = T>) {
        let mut bytes = Vec::new();
        values.into_iter().for_each(|v| v.put(&mut bytes));
        self.0.insert(name.into(), (T::DTYPE, bytes));
    }

    pub fn sha256(&self) -> String {
        sha256(&self.0)
    }

    pub fn serialize(&self, metadata: HashMap<String, String>) -> Result<Vec<u8>> {
        let failed = |e: safetensors::SafeTensorError| Error::argument(e.to_string(), "report this");
        let views = self
            .0
            .iter()
            .map(|(name, (dtype, bytes))| {
                let length = bytes.len() * 8 / dtype.bitsize();
                TensorView::new(*dtype, vec![length], bytes).map(|v| (name, v)).map_err(failed)
            })
            .collect::<Result<Vec<_>>>()?;
        serialize(views, Some(metadata)).map_err(failed)
    }
}

impl Tensors {
    /// Reads all tensors and the metadata of a file's bytes. Offsets are checked against the file before anything is copied.
    pub fn read(bytes: &[u8], path: &Path) -> Result<(Self, HashMap<String, String>)> {
        let wrong = |e: safetensors::SafeTensorError| {
            let fix = "name a file written by `merlkit build`, or build it again";
            Error::invalid(path, 0, "a safetensors file", e.to_string(), fix)
        };
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(wrong)?;
        let metadata = header.metadata().clone().unwrap_or_default();
        let map = SafeTensors::deserialize(bytes)
            .map_err(wrong)?
            .iter()
            .map(|(name, view)| (name.to_owned(), (view.dtype(), view.data().to_vec())))
            .collect();
        Ok((Self { path: path.to_owned(), map }, metadata))
    }

    /// The file they were read from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn sha256(&self) -> String {
        sha256(&self.map)
    }

    /// An array of the file.
    pub fn get<T: Element>(&self, name: &str) -> Result<Vec<T>> {
        let (dtype, bytes) =
            self.map.get(name).ok_or_else(|| self.invalid(format!("a tensor \"{name}\""), "none"))?;
        if *dtype != T::DTYPE {
            return Err(self.invalid(format!("tensor \"{name}\" of {:?}", T::DTYPE), format!("{dtype:?}")));
        }
        Ok(bytes.chunks_exact(size_of::<T>()).filter_map(T::get).collect())
    }

    /// The error for content that does not fit.
    pub fn invalid(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        Error::invalid(&self.path, 0, expected, found, "build the sampler file again with `merlkit build`")
    }
}

/// Over names, types and bytes, in the order of names.
fn sha256(map: &Map) -> String {
    let mut hash = Sha256::new();
    for (name, (dtype, bytes)) in map {
        hash.update(format!("{name}:{dtype:?}:{}:", bytes.len()));
        hash.update(bytes);
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}
