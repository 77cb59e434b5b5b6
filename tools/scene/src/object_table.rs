//! An `[[object]]` of a scene file.

use std::path::Path;

use glam::{DAffine3, DVec2, DVec3};
use merlkit::color::Rgb;
use serde::Deserialize;

use crate::description::{ShapeEntry, SurfaceEntry};
use crate::mesh::{Shading, Sides};
use crate::placing::place;
use crate::revolution::{jar_profile, smooth_profile};
use crate::scene_fault::{SceneFault, check_given, suggest};
use crate::strength::Strength;

/// An object, as serde reads it: which of the keys belong to which shape is checked after reading.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectTable {
    pub(crate) name: Option<String>,
    pub(crate) material: Option<String>,
    shape: String,
    // Spheres.
    centre: Option<[f64; 3]>,
    radius: Option<f64>,
    // Quads.
    corner: Option<[f64; 3]>,
    edge_u: Option<[f64; 3]>,
    edge_v: Option<[f64; 3]>,
    // Surfaces of revolution.
    profile: Option<Profile>,
    rows: Option<usize>,
    segments: Option<usize>,
    // Displaced spheres.
    amplitude: Option<f64>,
    steps: Option<u32>,
    seed: Option<u64>,
    // Mesh files.
    file: Option<String>,
    // Any mesh.
    sides: Option<SidesWord>,
    smooth: Option<bool>,
    // All but spheres.
    emission: Option<Strength>,
    // Instances.
    original: Option<String>,
    // Any object.
    translate: Option<[f64; 3]>,
    rotate: Option<[f64; 3]>,
    scale: Option<ScaleFactors>,
}

/// Points of radius and height, or a word.
#[derive(Deserialize)]
#[serde(untagged)]
enum Profile {
    Named(String),
    Points(Vec<[f64; 2]>),
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SidesWord {
    Both,
    Outer,
}

/// One factor, or one for each axis.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ScaleFactors {
    Equal(f64),
    Each([f64; 3]),
}

/// Keys of every object.
const COMMON: [&str; 3] = ["translate", "rotate", "scale"];

/// Rows of a profile that is a word, and segments where nothing is said.
const ROWS: usize = 49;
const SEGMENTS: usize = 48;

/// The shapes, with the keys that they take and those of these that they need.
const SHAPES: [(&str, &[&str], &[&str]); 6] = [
    ("sphere", &["centre", "radius"], &["radius"]),
    (
        "quad",
        &["corner", "edge_u", "edge_v", "emission"],
        &["corner", "edge_u", "edge_v"],
    ),
    (
        "revolution",
        &["profile", "rows", "segments", "sides", "smooth", "emission"],
        &["profile"],
    ),
    (
        "displaced-sphere",
        &[
            "radius",
            "amplitude",
            "steps",
            "seed",
            "sides",
            "smooth",
            "emission",
        ],
        &["radius", "amplitude", "steps"],
    ),
    ("mesh", &["file", "sides", "smooth", "emission"], &["file"]),
    ("instance", &["original", "emission"], &["original"]),
];

impl ObjectTable {
    /// Refuses keys that the shape has no meaning for, and the lack of those that it needs.
    pub(crate) fn check_keys(&self) -> Result<(), SceneFault> {
        let given = [
            ("centre", self.centre.is_some()),
            ("radius", self.radius.is_some()),
            ("corner", self.corner.is_some()),
            ("edge_u", self.edge_u.is_some()),
            ("edge_v", self.edge_v.is_some()),
            ("profile", self.profile.is_some()),
            ("rows", self.rows.is_some()),
            ("segments", self.segments.is_some()),
            ("amplitude", self.amplitude.is_some()),
            ("steps", self.steps.is_some()),
            ("seed", self.seed.is_some()),
            ("file", self.file.is_some()),
            ("sides", self.sides.is_some()),
            ("smooth", self.smooth.is_some()),
            ("emission", self.emission.is_some()),
            ("original", self.original.is_some()),
        ];
        let shape = SHAPES.iter().find(|(name, ..)| *name == self.shape);
        let Some((name, allowed, needed)) = shape else {
            let words: Vec<String> = SHAPES.iter().map(|(name, ..)| (*name).to_owned()).collect();
            let what = format!("no shape is called \"{}\"", self.shape);
            return Err(SceneFault::new(what, suggest(&self.shape, &words, "")));
        };
        let subject = format!("the shape {name}");
        check_given(&subject, &given, &[*allowed, &COMMON].concat(), needed)
    }

    /// The position of the object that an instance repeats; `None` for other shapes.
    pub(crate) fn find_original(&self, before: &[&Self]) -> Result<Option<usize>, SceneFault> {
        let Some(original) = &self.original else {
            return Ok(None);
        };
        let names: Vec<Option<&String>> = before.iter().map(|table| table.name.as_ref()).collect();
        let position = names.iter().position(|name| *name == Some(original));
        position.map(Some).ok_or_else(|| {
            let known: Vec<String> = names.into_iter().flatten().cloned().collect();
            let what = format!("no object before this one has the name \"{original}\"");
            let fix = suggest(original, &known, "give the object that is repeated a name");
            SceneFault::new(what, fix)
        })
    }

    /// The shape; [`Self::check_keys`] found the keys that it needs.
    pub(crate) fn shape_entry(&self, folder: &Path) -> Result<ShapeEntry, SceneFault> {
        Ok(match self.shape.as_str() {
            "sphere" => ShapeEntry::Sphere {
                centre: vector(self.centre),
                radius: self.radius.unwrap_or_default(),
            },
            "quad" => ShapeEntry::Quad {
                corner: vector(self.corner),
                edges: [vector(self.edge_u), vector(self.edge_v)],
            },
            "revolution" => ShapeEntry::Revolution {
                profile: self.points()?,
                segments: self.segments.unwrap_or(SEGMENTS),
                surface: self.surface(),
            },
            "displaced-sphere" => ShapeEntry::DisplacedSphere {
                radius: self.radius.unwrap_or_default(),
                amplitude: self.amplitude.unwrap_or_default(),
                steps: self.steps.unwrap_or_default(),
                seed: self.seed.unwrap_or_default(),
                surface: self.surface(),
            },
            _ => ShapeEntry::File {
                path: folder.join(self.file.as_deref().unwrap_or_default()),
                surface: self.surface(),
            },
        })
    }

    /// The radiance of its surface, where it says one.
    pub(crate) fn emission(&self) -> Option<Rgb> {
        self.emission.map(Strength::rgb)
    }

    fn surface(&self) -> SurfaceEntry {
        SurfaceEntry {
            sides: match self.sides {
                Some(SidesWord::Outer) => Sides::Outer,
                Some(SidesWord::Both) | None => Sides::Both,
            },
            shading: match self.smooth {
                Some(true) => Shading::Smooth,
                Some(false) | None => Shading::Flat,
            },
        }
    }

    /// The points of the profile, smoothed where `rows` asks for more of them.
    fn points(&self) -> Result<Vec<DVec2>, SceneFault> {
        let (points, rows) = match &self.profile {
            Some(Profile::Named(word)) if word == "jar" => (jar_profile().to_vec(), ROWS),
            Some(Profile::Named(word)) => {
                let what = format!("no profile is called \"{word}\"");
                return Err(SceneFault::new(
                    what,
                    "give \"jar\" or points [radius, height]",
                ));
            }
            Some(Profile::Points(points)) => {
                let points: Vec<DVec2> = points.iter().copied().map(DVec2::from_array).collect();
                let rows = points.len();
                (points, rows)
            }
            None => (Vec::new(), 0),
        };
        // What is out of bounds is refused where the surface is built, before memory is taken for it.
        let rows = self.rows.unwrap_or(rows).min(1 << 16);
        Ok(smooth_profile(&points, rows))
    }

    /// Where the object is put.
    pub(crate) fn placement(&self) -> Result<DAffine3, SceneFault> {
        let scale = match self.scale {
            Some(ScaleFactors::Equal(factor)) => DVec3::splat(factor),
            Some(ScaleFactors::Each(factors)) => DVec3::from_array(factors),
            None => DVec3::ONE,
        };
        let (translate, rotate) = (vector(self.translate), vector(self.rotate));
        let is_usable = scale.is_finite()
            && translate.is_finite()
            && rotate.is_finite()
            && scale.abs().min_element() > 0.0;
        match is_usable {
            true => Ok(place(translate, rotate, scale)),
            false => Err(SceneFault::new(
                "an object that is scaled to nothing or put nowhere",
                "give finite numbers, and scales other than 0",
            )),
        }
    }
}

fn vector(value: Option<[f64; 3]>) -> DVec3 {
    value.map_or(DVec3::ZERO, DVec3::from_array)
}
