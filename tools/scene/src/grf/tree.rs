//! What a GRF file says, before names are looked up and files are included.

use glam::DVec3;

/// A part of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum GrfBlock {
    /// Vertices and faces.
    Mesh(MeshBlock),
    /// A luminous parallelogram.
    Light(LightBlock),
    /// Another file, in this place.
    Include {
        /// Its name, relative to the folder of this file.
        file: String,
        /// Where it is named.
        line: usize,
    },
    /// Blocks that are moved.
    Transform {
        /// In the order in which they apply.
        steps: Vec<TransformStep>,
        /// What is moved.
        blocks: Vec<GrfBlock>,
        /// Where it begins.
        line: usize,
    },
    /// Blocks for which names have a meaning.
    Define {
        /// The names and what they mean.
        definitions: Vec<Definition>,
        /// What they hold for.
        blocks: Vec<GrfBlock>,
        /// Where it begins.
        line: usize,
    },
    /// An attribute for the blocks after it.
    Attribute(Attribute),
    /// Where the viewer is whom precomputed irradiance belongs to.
    View(DVec3),
}

/// A step of a transformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TransformStep {
    Scale(DVec3),
    /// Radians about x, then y, then z.
    Rotation(DVec3),
    Translation(DVec3),
}

/// A corner, the two edges that begin there, and radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightBlock {
    pub(super) corner: DVec3,
    pub(super) edges: [DVec3; 2],
    pub(super) rgb: DVec3,
    pub(super) line: usize,
}

/// A name and what it means.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Definition {
    pub(super) name: String,
    pub(super) meaning: Attribute,
}

/// How faces look, or how their reflection is sampled.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Attribute {
    pub(super) value: AttributeValue,
    pub(super) line: usize,
}

/// What an attribute says.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum AttributeValue {
    /// A colour by which the BRDF is multiplied.
    Rgb(DVec3),
    /// A colour that was given a name.
    NamedRgb(String),
    Brdf(BrdfWords),
    /// Radiance of the faces; 0 for none.
    Emission(DVec3),
    /// A sampler and its settings, or a name for them.
    Pdf(ModelWords),
    /// Pictures on surfaces are not drawn.
    Texture,
}

/// A BRDF as it is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum BrdfWords {
    /// A formula; without parameters it may be a name.
    Model(ModelWords),
    /// A file of measured values.
    Measured(String),
    /// BRDFs that have names, with their weights.
    Combine(Vec<(f64, String)>),
}

/// A word and its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModelWords {
    pub(super) name: String,
    pub(super) parameters: Vec<(String, ParameterValue)>,
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ParameterValue {
    Number(f64),
    Flag(bool),
}

/// A mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MeshBlock {
    pub(super) attributes: Vec<Attribute>,
    pub(super) vertices: Vec<DVec3>,
    /// One for each vertex, or none at all.
    pub(super) normals: Vec<DVec3>,
    /// Faces, with the attributes that are written before them.
    pub(super) groups: Vec<FaceGroup>,
    pub(super) line: usize,
}

/// Triangles that look alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FaceGroup {
    /// What changes before them; the rest is as it was.
    pub(super) attributes: Vec<Attribute>,
    pub(super) faces: Vec<[u32; 3]>,
}
