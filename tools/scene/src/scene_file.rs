//! Scene files: TOML that becomes a [`SceneDescription`].

use std::path::Path;

use glam::DVec3;
use merlkit::color::Rgb;
use merlkit::files::RegularFile;
use merlkit::light::{Area, Directional, LightSpec, Point};
use merlkit::{Error, Result};
use serde::Deserialize;
use toml::Spanned;

use crate::background::Background;
use crate::description::{CameraEntry, LightEntry, ObjectEntry, SceneDescription};
use crate::grf::read_grf;
use crate::object_table::ObjectTable;
use crate::scene_fault::{SceneFault, check_given, count_lines, suggest};
use crate::strength::Strength;

/// Bytes of a scene file, at most.
const MOST_BYTES: u64 = 1 << 24;

/// The file, as serde reads it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneTable {
    size: Option<[usize; 2]>,
    spp: Option<u64>,
    bounces: Option<u32>,
    background: Option<Spanned<String>>,
    #[serde(default)]
    camera: CameraTable,
    #[serde(default)]
    material: Vec<Spanned<MaterialTable>>,
    #[serde(default)]
    object: Vec<Spanned<ObjectTable>>,
    #[serde(default)]
    light: Vec<Spanned<LightTable>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraTable {
    eye: Option<[f64; 3]>,
    look_at: Option<[f64; 3]>,
    fov: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialTable {
    name: String,
    brdf: String,
}

/// A light: which of the keys belong to which kind is checked after reading.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightTable {
    kind: String,
    corner: Option<[f64; 3]>,
    edge_u: Option<[f64; 3]>,
    edge_v: Option<[f64; 3]>,
    position: Option<[f64; 3]>,
    towards: Option<[f64; 3]>,
    radiance: Option<Strength>,
    intensity: Option<Strength>,
    irradiance: Option<Strength>,
    map: Option<String>,
}

/// Reads a scene file: TOML, or GRF if it ends in `.grf`. Paths in it are relative to its folder.
///
/// # Errors
/// [`Error::Io`] for a file that can't be read; [`Error::Argument`] for text that is no scene, which says the line and, for a key
/// that is not known, the nearest that is.
pub fn read_scene(path: &Path) -> Result<SceneDescription> {
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("grf"))
    {
        return read_grf(path);
    }
    let bytes = RegularFile::open(path)?.read_all(MOST_BYTES)?;
    let text = String::from_utf8(bytes).map_err(|error| Error::Unsupported {
        path: path.to_owned(),
        what: format!(
            "text that is no UTF-8 from byte {} on",
            error.utf8_error().valid_up_to()
        ),
        fix: "save it as UTF-8".into(),
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_scene(&text, folder).map_err(|fault| {
        let what = match fault.line {
            Some(line) => format!("{}, line {line}: {}", path.display(), fault.what),
            None => format!("{}: {}", path.display(), fault.what),
        };
        Error::argument(what, fault.fix)
    })
}

/// The background of a scene, if it says one.
fn parse_background(
    text: &str,
    word: Option<&Spanned<String>>,
) -> core::result::Result<Option<Background>, SceneFault> {
    let Some(word) = word else { return Ok(None) };
    let read: core::result::Result<Background, String> = word.as_ref().parse();
    match read {
        Ok(background) => Ok(Some(background)),
        Err(fix) => {
            let fault = SceneFault::new(format!("the background \"{}\"", word.as_ref()), fix);
            Err(fault.with_line(text, word.span().start))
        }
    }
}

/// The scene that a text describes.
pub(crate) fn parse_scene(
    text: &str,
    folder: &Path,
) -> core::result::Result<SceneDescription, SceneFault> {
    let table: SceneTable = toml::from_str(text).map_err(|error| explain(text, &error))?;
    let mut names: Vec<String> = Vec::new();
    let mut scene = SceneDescription {
        camera: CameraEntry {
            eye: table.camera.eye.map(DVec3::from_array),
            look_at: table.camera.look_at.map(DVec3::from_array),
            fov: table.camera.fov,
        },
        size: table.size,
        spp: table.spp,
        bounces: table.bounces,
        background: parse_background(text, table.background.as_ref())?,
        ..SceneDescription::default()
    };
    for material in &table.material {
        let MaterialTable { name, brdf } = material.as_ref();
        if names.contains(name) {
            let fault = SceneFault::new(
                format!("a second material \"{name}\""),
                "give each a name of its own",
            );
            return Err(fault.with_line(text, material.span().start));
        }
        names.push(name.clone());
        scene.materials.push(resolve_path(folder, brdf));
    }
    let mut tables = Vec::new();
    for object in &table.object {
        let line = count_lines(text, object.span().start);
        let built = add_object(&mut scene, object.as_ref(), &tables, &names, folder, line);
        built.map_err(|fault| fault.with_line(text, object.span().start))?;
        tables.push(object.as_ref());
    }
    for light in &table.light {
        let entry = read_light(light.as_ref(), folder);
        let entry = entry.map_err(|fault| fault.with_line(text, light.span().start))?;
        scene.lights.push(entry);
    }
    Ok(scene)
}

fn add_object(
    scene: &mut SceneDescription,
    table: &ObjectTable,
    before: &[&ObjectTable],
    materials: &[String],
    folder: &Path,
    line: usize,
) -> core::result::Result<(), SceneFault> {
    table.check_keys()?;
    let original = match table.find_original(before)? {
        Some(position) => Some(scene.objects[position].clone()),
        None => None,
    };
    let material = match (&table.material, &original) {
        (Some(name), _) => materials
            .iter()
            .position(|known| known == name)
            .ok_or_else(|| {
                let what = format!("no material is called \"{name}\"");
                SceneFault::new(what, suggest(name, materials, "add a [[material]]"))
            })?,
        (None, Some(original)) => original.material,
        (None, None) => {
            let what = "an object without a material";
            return Err(SceneFault::new(what, "add material = \"NAME\""));
        }
    };
    // An instance emits what it says, or what its original emits.
    let inherited = original.as_ref().and_then(|original| original.emission);
    let emission = table.emission().or(inherited);
    let shape = match original {
        Some(original) => original.shape,
        None => table.shape_entry(folder)?,
    };
    let name = match &table.name {
        Some(name) => format!("object \"{name}\" in line {line}"),
        None => format!("the object in line {line}"),
    };
    scene.objects.push(ObjectEntry {
        name,
        shape,
        to_world: table.placement()?,
        material,
        emission,
    });
    Ok(())
}

/// Refuses an unknown kind, keys that it has no meaning for, and the lack of those that it needs.
fn check_light_keys(table: &LightTable) -> core::result::Result<(), SceneFault> {
    let given = [
        ("corner", table.corner.is_some()),
        ("edge_u", table.edge_u.is_some()),
        ("edge_v", table.edge_v.is_some()),
        ("position", table.position.is_some()),
        ("towards", table.towards.is_some()),
        ("radiance", table.radiance.is_some()),
        ("intensity", table.intensity.is_some()),
        ("irradiance", table.irradiance.is_some()),
        ("map", table.map.is_some()),
    ];
    let keys: &[&str] = match table.kind.as_str() {
        "area" => &["corner", "edge_u", "edge_v", "radiance"],
        "point" => &["position", "intensity"],
        "directional" => &["towards", "irradiance"],
        "environment" => &["map"],
        other => {
            let kinds = ["area", "point", "directional", "environment"].map(str::to_owned);
            let what = format!("no light is of the kind \"{other}\"");
            return Err(SceneFault::new(what, suggest(other, &kinds, "")));
        }
    };
    check_given(
        &format!("a light of the kind {}", table.kind),
        &given,
        keys,
        keys,
    )
}

fn read_light(table: &LightTable, folder: &Path) -> core::result::Result<LightEntry, SceneFault> {
    check_light_keys(table)?;
    let light = match table.kind.as_str() {
        "area" => LightSpec::Area(Area {
            corner: vector(table.corner),
            edge_u: vector(table.edge_u),
            edge_v: vector(table.edge_v),
            radiance: strength(table.radiance),
        }),
        "point" => LightSpec::Point(Point {
            position: vector(table.position),
            intensity: strength(table.intensity),
        }),
        "directional" => {
            let towards = vector(table.towards).try_normalize().ok_or_else(|| {
                let what = "a directional light without a direction";
                SceneFault::new(what, "give a vector that points to the light")
            })?;
            LightSpec::Directional(Directional {
                towards,
                irradiance: strength(table.irradiance),
            })
        }
        _ => {
            let word = table.map.as_deref().unwrap_or_default();
            return Ok(LightEntry::Named(resolve_path(folder, word)));
        }
    };
    Ok(LightEntry::Placed(light))
}

fn vector(value: Option<[f64; 3]>) -> DVec3 {
    value.map_or(DVec3::ZERO, DVec3::from_array)
}

fn strength(value: Option<Strength>) -> Rgb {
    value.map_or(Rgb::ZERO, Strength::rgb)
}

/// A word that may be a path: where there is such a file in the folder, its path.
pub(crate) fn resolve_path(folder: &Path, word: &str) -> String {
    // What follows a colon are settings, as in sky.exr:clamp.
    let file = word.split(':').next().unwrap_or(word);
    let inside = folder.join(file);
    if file.is_empty() || !inside.is_file() {
        return word.to_owned();
    }
    format!("{}{}", inside.display(), &word[file.len()..])
}

/// An error of the TOML reader, with the line and the key that was meant.
fn explain(text: &str, error: &toml::de::Error) -> SceneFault {
    let message = error.message().lines().next().unwrap_or_default();
    // "unknown field `spq`, expected one of `size`, `spp`": every other piece is a name.
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let fault = match names.split_first() {
        Some((unknown, known)) if message.starts_with("unknown field") => {
            let known: Vec<String> = known.iter().map(|name| (*name).to_owned()).collect();
            let what = format!("there is no key \"{unknown}\" here");
            SceneFault::new(what, suggest(unknown, &known, ""))
        }
        _ => SceneFault::new(message, "docs/scenes.md lists the keys"),
    };
    match error.span() {
        Some(span) => fault.with_line(text, span.start),
        None => fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::ShapeEntry;

    const GOOD: &str = r#"
spp = 16
[camera]
eye = [0, 1, 5]
look_at = [0, 1, 0]
[[material]]
name = "grey"
brdf = "lambert:reflectance=0.5"
[[object]]
name = "jar"
shape = "revolution"
profile = "jar"
material = "grey"
[[object]]
shape = "instance"
original = "jar"
translate = [2, 0, 0]
rotate = [0, 90, 0]
scale = 0.5
[[light]]
kind = "area"
corner = [0, 4, 0]
edge_u = [1, 0, 0]
edge_v = [0, 0, 1]
radiance = [17, 12, 4]
"#;

    fn fault(text: &str) -> String {
        let fault = parse_scene(text, Path::new("")).unwrap_err();
        format!("{:?} {}; {}", fault.line, fault.what, fault.fix)
    }

    #[test]
    fn a_scene_is_read_and_built() {
        let scene = parse_scene(GOOD, Path::new("")).unwrap();
        assert_eq!((scene.spp, scene.objects.len()), (Some(16), 2));
        assert!(matches!(
            scene.objects[1].shape,
            ShapeEntry::Revolution { .. }
        ));
        let built = scene.build().unwrap();
        // Both jars are one mesh.
        assert_eq!(built.triangles, 2 * 48 * 48 - 48);
        assert_eq!(built.spec.objects.len(), 2);
        // x goes to −z by a quarter of a turn about y, and is half as long.
        let turned = scene.objects[1].to_world.transform_point3(DVec3::X);
        assert!(
            turned.abs_diff_eq(DVec3::new(2.0, 0.0, -0.5), 1e-12),
            "{turned}"
        );
    }

    #[test]
    fn faults_have_a_line_and_the_key_that_was_meant() {
        let unknown = fault(&GOOD.replace("look_at", "look_to"));
        assert!(
            unknown.starts_with("Some(5)") && unknown.contains("\"look_at\""),
            "{unknown}"
        );
        let spp = fault(&GOOD.replace("spp = 16", "ssp = 16"));
        assert!(
            spp.starts_with("Some(2)") && spp.contains("\"spp\""),
            "{spp}"
        );
        let shape = fault(&GOOD.replace("\"revolution\"", "\"revolutions\""));
        assert!(
            shape.starts_with("Some(9)") && shape.contains("\"revolution\""),
            "{shape}"
        );
        let material = fault(&GOOD.replace("material = \"grey\"", "material = \"gray\""));
        assert!(material.contains("\"grey\""), "{material}");
        let original = fault(&GOOD.replace("original = \"jar\"", "original = \"jor\""));
        assert!(
            original.starts_with("Some(14)") && original.contains("\"jar\""),
            "{original}"
        );
        let meaning = fault(&GOOD.replace("profile =", "radius = 2\nprofile ="));
        assert!(meaning.contains("radius has no meaning"), "{meaning}");
        let lacking = fault(&GOOD.replace("edge_u = [1, 0, 0]\n", ""));
        assert!(
            lacking.starts_with("Some(20)") && lacking.contains("edge_u"),
            "{lacking}"
        );
        let typed = fault(&GOOD.replace("spp = 16", "spp = \"many\""));
        assert!(typed.starts_with("Some(2)"), "{typed}");
        let background = fault(&GOOD.replace("spp = 16", "background = \"red\""));
        assert!(
            background.starts_with("Some(2)") && background.contains("#ffcc00"),
            "{background}"
        );
        let scale = fault(&GOOD.replace("scale = 0.5", "scale = [1, 0, 1]"));
        assert!(scale.contains("scaled to nothing"), "{scale}");
    }
}
