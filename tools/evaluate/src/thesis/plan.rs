//! How much of each experiment is run.

use std::path::Path;

use merlkit::Result;
use merlkit::files::RegularFile;
use merlkit_scene::read_mesh;
use serde::{Deserialize, Serialize};

/// Version of what pieces hold: those of another are measured again.
const FORMAT: u32 = 1;

/// How much is run. Pieces of different plans don't go together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThesisPlan {
    /// Version of the pieces' shape.
    pub format: u32,
    /// Version of merlkit.
    pub version: String,
    /// Whether it is the small run.
    pub quick: bool,
    /// Seed of all draws.
    pub seed: u64,
    /// Pixels a side of a picture of one sphere; others are in proportion.
    pub side: usize,
    /// Samples per pixel, ascending.
    pub samples: Vec<u64>,
    /// Samples per pixel of references.
    pub reference_samples: u64,
    /// Quadtrees of a disc that is built as published.
    pub trees: usize,
    /// Pixels a side of the image that such trees are built from.
    pub image: usize,
    /// Tables of a cascade CDF over the polar angle of `wo`.
    pub tables: usize,
    /// Cells of its tables before compression, over θh and φh.
    pub cells: [usize; 2],
    /// Draws of an experiment that counts them.
    pub draws: usize,
    /// Calls of each batch that is timed.
    pub timed_calls: usize,
    /// The processor that times are measured on.
    pub processor: String,
    /// The mesh of scene 3; `None` for the displaced sphere.
    #[serde(default)]
    pub mesh: Option<PlanMesh>,
}

/// A mesh file that takes the place of a scene's own mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanMesh {
    /// Its path, as it was given.
    pub file: String,
    /// SHA-256 of its bytes in hexadecimal; of glTF without the buffers beside it.
    pub sha256: String,
    /// Its vertices.
    pub vertices: usize,
    /// Its triangles.
    pub faces: usize,
}

impl PlanMesh {
    /// Reads the mesh once, so that a file that is none is refused before any work.
    ///
    /// # Errors
    /// As [`read_mesh`].
    pub fn read(path: &Path) -> Result<Self> {
        let data = read_mesh(path)?;
        Ok(Self {
            file: path.display().to_string(),
            sha256: RegularFile::open(path)?.sha256()?,
            vertices: data.vertices.len(),
            faces: data.faces.len(),
        })
    }
}

impl ThesisPlan {
    /// The thesis's resolutions, and its numbers of samples up to 400.
    pub fn full(seed: u64, processor: &str) -> Self {
        Self {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").into(),
            quick: false,
            seed,
            side: 128,
            samples: vec![1, 25, 100, 400],
            reference_samples: 16_384,
            trees: 60,
            image: 800,
            tables: 32,
            cells: [1024, 512],
            draws: 100_000,
            timed_calls: 20_000,
            processor: processor.into(),
            mesh: None,
        }
    }

    /// Everything in a few minutes: fewer trees, cells, pixels and samples.
    pub fn quick(seed: u64, processor: &str) -> Self {
        Self {
            quick: true,
            side: 40,
            samples: vec![1, 25],
            reference_samples: 1024,
            trees: 4,
            image: 400,
            tables: 6,
            cells: [512, 128],
            draws: 20_000,
            timed_calls: 1000,
            ..Self::full(seed, processor)
        }
    }

    /// The most samples of a picture.
    pub(super) fn most_samples(&self) -> u64 {
        self.samples.last().copied().unwrap_or(1)
    }
}
