//! Option files of the thesis's renderer (OP, its section 7.5): `KEY value…` a line.

use std::path::{Path, PathBuf};

use glam::DVec3;
use merlkit::color::Rgb;
use merlkit::files::RegularFile;
use merlkit::render::SceneSpec;
use merlkit::{Error, Result};

use super::option_lines::{LineFault, MOST_COUNT, OptionLine, OptionLines};
use super::tokens::fault_in_line;
use super::tree::{ModelWords, ParameterValue};
use super::words::sampler_text;
use crate::background::Background;
use crate::description::{LightEntry, SceneDescription};
use crate::scene_file::resolve_path;

/// Bytes of an option file, at most.
const MOST_BYTES: u64 = 1 << 20;
/// The most paths per pixel.
const MOST_SPP: u64 = 1 << 32;

/// What an option file asks for, as far as it means something here.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OptionFile {
    /// The scene, in the folder of the option file.
    pub scene: Option<PathBuf>,
    /// Width and height of the picture, each ≥ 1.
    pub size: Option<[usize; 2]>,
    /// The picture's name, without extension and folder.
    pub output: Option<String>,
    /// The eye.
    pub eye: Option<DVec3>,
    /// The point in the middle of the picture.
    pub look_at: Option<DVec3>,
    /// Whether the points of pixels are random.
    pub random: bool,
    /// What is seen past the objects.
    pub background: Option<Background>,
    /// A map that lights the scene, as the option `--light` takes it.
    pub environment: Option<String>,
    /// Paths per pixel, ≥ 1.
    pub spp: Option<u64>,
    /// Directions at each vertex, ≥ 1.
    pub directions: Option<u32>,
    /// The sampler of materials that the scene names none for, as the option `--sampler` takes it.
    pub sampler: Option<String>,
    /// Whether seconds or bytes are asked for.
    pub measures: bool,
}

impl OptionFile {
    /// Reads an option file. The last line of a key counts alone: a second one is refused.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that can't be read or has more than a megabyte; [`Error::Argument`] with the line of an unknown key, and
    /// of a value outside its domain.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = RegularFile::open(path)?.read_all(MOST_BYTES)?;
        let name = path.display().to_string();
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let what = format!("{name}: text that is no UTF-8 from byte {valid} on");
            Error::argument(what, "save it as UTF-8")
        })?;
        Self::parse(&name, &text, path.parent().unwrap_or(Path::new("")))
    }

    fn parse(name: &str, text: &str, folder: &Path) -> Result<Self> {
        let lines = OptionLines::parse(name, text)?;
        lines
            .options(folder)
            .map_err(|(line, (what, fix))| fault_in_line(name, line, &what, &fix))
    }

    /// Puts what is asked for into a scene. The scene's own samplers remain, and its lights but for the studio of a scene that has none.
    pub fn apply(&self, scene: &mut SceneDescription) {
        scene.size = self.size.or(scene.size);
        scene.spp = self.spp.or(scene.spp);
        scene.camera.eye = self.eye.or(scene.camera.eye);
        scene.camera.look_at = self.look_at.or(scene.camera.look_at);
        scene.background = self.background.or(scene.background);
        if let Some(map) = &self.environment {
            let studio = LightEntry::Named("studio".into());
            scene.lights.retain(|light| *light != studio);
            scene.lights.push(LightEntry::Named(map.clone()));
        }
        if self.sampler.is_some() {
            scene.samplers.resize(scene.materials.len(), None);
            for sampler in scene.samplers.iter_mut().filter(|s| s.is_none()) {
                sampler.clone_from(&self.sampler);
            }
        }
    }
}

impl OptionLines<'_> {
    /// All that the lines ask for.
    fn options(&self, folder: &Path) -> core::result::Result<OptionFile, LineFault> {
        self.check_unused()?;
        let mut options = OptionFile {
            eye: self.numbers("BPT_VIEWER")?.map(DVec3::from_array),
            look_at: self.numbers("BPT_VLOOK")?.map(DVec3::from_array),
            random: self.flag("BPT_PIXEL_RANDOM")?,
            sampler: self.sampler()?,
            ..OptionFile::default()
        };
        if let Some(line) = self.find("BPT_SCENE") {
            options.scene = Some(folder.join(line.words()?));
        }
        if let Some(line) = self.find("BPT_IMAGE_RESOLUTION") {
            options.size = Some(line.counts(MOST_COUNT)?.map(|side| side as usize));
        }
        if let Some(line) = self.find("BPT_OUTPUT_IMAGE") {
            options.output = Some(picture_name(line)?);
        }
        if let Some(line) = self.find("BPT_BACKGROUND") {
            options.background = Some(Background::Colour(parse_colour(line)?));
        }
        if let Some(line) = self.find("BPT_EM_BACKGROUND") {
            options.environment = Some(resolve_path(folder, line.words()?));
        }
        if let Some(line) = self.find("BPT_PIXEL_SAMPLERES") {
            // a × b points of the pixel.
            let [across, down] = line.counts(MOST_SPP)?;
            let spp = across.checked_mul(down).filter(|spp| *spp <= MOST_SPP);
            options.spp = Some(spp.ok_or_else(|| line.fault("give fewer points"))?);
        }
        if let Some(line) = self.find("BPT_RE_NSECRAYSROOT") {
            // The square root of the number of directions.
            let most = u64::from(SceneSpec::MOST_DIRECTIONS);
            let [root] = line.counts(most)?;
            let directions = (root * root <= most).then_some((root * root) as u32);
            options.directions = Some(directions.ok_or_else(|| line.fault("give at most 256"))?);
        }
        for key in [
            "BPT_PDF_MEMSTAT",
            "BPT_CHRONO_SAMPLING",
            "BPT_CHRONO_RENDERING",
            "BPT_CHRONO_PREBUILD",
        ] {
            options.measures |= self.flag(key)?;
        }
        Ok(options)
    }

    /// Checks the values of keys that mean nothing here, and refuses what is not drawn.
    fn check_unused(&self) -> core::result::Result<(), LineFault> {
        for key in ["BPT_PIXEL_RADIAL", "BPT_QT_RELEASE", "BPT_DISPLAYWINDOW"] {
            self.flag(key)?;
        }
        if let Some(line) = self.find("BPT_RAYCASTING")
            && line.flag()?
        {
            return Err(line.fault("give false: pictures of normals are not drawn"));
        }
        if let Some(line) = self.find("BPT_PDF_FACTORS_FILE") {
            return Err(line.fault("remove it: factors are computed, not read"));
        }
        Ok(())
    }

    /// The sampler of the PDF that is named.
    fn sampler(&self) -> core::result::Result<Option<String>, LineFault> {
        // Values are checked whether the PDF takes them or not.
        let [exponent] = self.numbers("BPT_PDF_LOBEEXPONENT")?.unwrap_or([30.0]);
        let [nu] = self.numbers("BPT_PDF_ANISONU")?.unwrap_or([25.0]);
        let [nv] = self.numbers("BPT_PDF_ANISONV")?.unwrap_or([25.0]);
        let disc = self.disc()?;
        let cdf = self.counts_or("BPT_PDF_CDF_RES", [256, 32])?;
        let is_compressed = self.flag("BPT_PDF_CDF_COMPRESS")?;
        let factors = self.factors()?;
        let Some(line) = self.find("BPT_PDF_NAME") else {
            return Ok(None);
        };
        let word = line.words()?.to_ascii_lowercase();
        let text = match word.as_str() {
            "disk" => Ok(disc),
            "diffuse" | "specular" => sampler_text(&model(&word, &[])),
            "sphere" | "hemisphere" => sampler_text(&model(&word, &[("exp", exponent)])),
            "anisotropic" => sampler_text(&model(&word, &[("nu", nu), ("nv", nv)])),
            "cascadecdf" => {
                let cells = [("nTh", cdf[0] as f64), ("nPh", cdf[1] as f64)];
                let mut words = model(&word, &cells);
                words.parameters.push(flag("compress", is_compressed));
                sampler_text(&words)
            }
            "factored" => sampler_text(&factors),
            _ => {
                let fix = "name DIFFUSE, SPECULAR, HEMISPHERE, SPHERE, ANISOTROPIC, DISK, FACTORED or CASCADECDF";
                return Err(line.fault(fix));
            }
        };
        // A setting outside the domain of the sampler is found there.
        let checked = text.and_then(|text| match text.parse::<merlkit::SamplerSpec>() {
            Ok(_) => Ok(text),
            Err(Error::Argument { what, fix }) => Err((what, fix)),
            Err(other) => Err((other.to_string(), "correct the values".into())),
        });
        checked.map(Some).map_err(|fault| (line.number, fault))
    }

    /// The adaptive disc: trees, image, trials and levels.
    fn disc(&self) -> core::result::Result<String, LineFault> {
        let [tables] = self.counts_or("BPT_QT_PRECOMPUTED", [20])?;
        let [azimuths] = self.counts_or("BPT_QT_ANISOTROPIC", [1])?;
        let [grid] = self.counts_or("BPT_QT_IMGRES", [800])?;
        let mut text = format!("adaptive-disc:published,tables={tables},grid={grid}");
        if azimuths > 1 {
            text += &format!(",azimuths={azimuths}");
        }
        if let Some([trials]) = self.numbers("BPT_QT_AVGNMAX")? {
            text += &format!(",n-max={trials}");
        }
        if let Some(line) = self.find("BPT_DEPTH") {
            // Levels with the root, of which each but the first is a subdivision.
            let [levels] = line.counts(MOST_COUNT)?;
            text += &format!(",depth={}", levels - 1);
        }
        Ok(text)
    }

    /// The factored BRDF, with the resolutions of the thesis's first examples where nothing is said.
    fn factors(&self) -> core::result::Result<ModelWords, LineFault> {
        let [u_theta, u_phi] = self.counts_or("BPT_PDF_FACTORS_RESU", [16, 16])?;
        let [p_theta, p_phi] = self.counts_or("BPT_PDF_FACTORS_RESP", [32, 16])?;
        let [outer, inner] = self.counts_or("BPT_PDF_FACTORS_JK", [2, 1])?;
        let numbers = [
            ("uTh", u_theta),
            ("uPh", u_phi),
            ("pTh", p_theta),
            ("pPh", p_phi),
            ("J", outer),
            ("K", inner),
        ];
        let mut words = model("factored", &numbers.map(|(key, n)| (key, n as f64)));
        let half = self.flag("BPT_PDF_FACTORS_HALF")?;
        words.parameters.push(flag("half", half));
        Ok(words)
    }
}

fn flag(key: &str, value: bool) -> (String, ParameterValue) {
    (key.to_owned(), ParameterValue::Flag(value))
}

fn model(name: &str, numbers: &[(&str, f64)]) -> ModelWords {
    let mut parameters = Vec::new();
    for (key, number) in numbers {
        parameters.push(((*key).to_owned(), ParameterValue::Number(*number)));
    }
    ModelWords {
        name: name.to_owned(),
        parameters,
    }
}

/// The name of a picture without its extension: in the folder where the command runs, and in no other.
fn picture_name(line: &OptionLine<'_>) -> core::result::Result<String, LineFault> {
    let word = line.words()?;
    let path = Path::new(word);
    let is_plain = path.file_name().is_some_and(|name| name == word);
    let stem = path
        .file_stem()
        .filter(|_| is_plain && !word.contains('\\'));
    match stem {
        Some(stem) => Ok(stem.to_string_lossy().into_owned()),
        None => Err(line.fault("give a name without a folder")),
    }
}

/// Linear channels from 0 to 1.
fn parse_colour(line: &OptionLine<'_>) -> core::result::Result<Rgb, LineFault> {
    let channels = line.numbers::<3>()?;
    if channels.iter().any(|x| !(0.0..=1.0).contains(x)) {
        return Err(line.fault("give channels from 0 to 1"));
    }
    Ok(Rgb::from_array(channels.map(|x| x as f32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 7.2 of the thesis.
    const EXAMPLE: &str = include_str!("../../../../data/thesis/grf/example.op");

    fn parse(text: &str) -> Result<OptionFile> {
        OptionFile::parse("a.op", text, Path::new("folder"))
    }

    #[test]
    fn the_example_of_the_thesis_is_understood() {
        let options = parse(EXAMPLE).unwrap();
        let expected = OptionFile {
            scene: Some("folder/escena.grf".into()),
            size: Some([500, 400]),
            output: Some("buzon".into()),
            eye: Some(DVec3::new(0.5, 0.5, 1.0)),
            look_at: Some(DVec3::new(0.5, 0.1, 0.0)),
            random: true,
            background: Some(Background::Colour(Rgb::ONE)),
            environment: None,
            spp: Some(2),
            directions: Some(10_000),
            sampler: Some("adaptive-disc:published,tables=90,grid=800,n-max=1.7,depth=4".into()),
            measures: true,
        };
        assert_eq!(options, expected);
    }

    #[test]
    fn every_pdf_is_a_sampler() {
        for (lines, expected) in [
            ("BPT_PDF_NAME DIFFUSE", "cosine"),
            (
                "bpt_pdf_name Sphere\nBPT_PDF_LobeExponent 81",
                "lobe:cosine,parameters=81/81/0.1",
            ),
            (
                "BPT_PDF_NAME HEMISPHERE",
                "lobe:cosine-hemisphere,parameters=30/30/0.1",
            ),
            (
                "BPT_PDF_NAME ANISOTROPIC\nBPT_PDF_ANISONU 9",
                "lobe:ashikhmin-shirley,parameters=9/25/0.1,axes=surface",
            ),
            (
                "BPT_PDF_NAME CASCADECDF",
                "cascade-cdf:cells=256x32,tolerance=none",
            ),
            (
                "BPT_PDF_NAME CascadeCDF\nBPT_PDF_CDF_RES 64 16\nBPT_PDF_CDF_COMPRESS true",
                "cascade-cdf:cells=64x16",
            ),
            (
                "BPT_PDF_NAME FACTORED\nBPT_PDF_FACTORS_RESU 16 1\nBPT_PDF_FACTORS_JK 2 3\nBPT_PDF_FACTORS_HALF true",
                "factored:tables=16,factors=2x3/32x16/half-vector/0.1",
            ),
        ] {
            let options = parse(lines).unwrap();
            assert_eq!(options.sampler.as_deref(), Some(expected), "{lines}");
        }
    }

    #[test]
    fn faults_name_the_line_and_what_to_do() {
        for (text, expected) in [
            (
                "\nBPT_IMAGE_RESOLUTON 4 4",
                "a.op, line 2: there is no key BPT_IMAGE_RESOLUTON; did you mean \"BPT_IMAGE_RESOLUTION\"",
            ),
            (
                "BPT_DEPTH 5\nBPT_DEPTH 5",
                "line 2: BPT_DEPTH is given twice",
            ),
            (
                "BPT_IMAGE_RESOLUTION 4",
                "line 1: BPT_IMAGE_RESOLUTION 4; give two whole numbers",
            ),
            ("BPT_IMAGE_RESOLUTION 4 0", "from 1 to"),
            ("BPT_IMAGE_RESOLUTION 4 4 4", "give two whole numbers"),
            ("BPT_VIEWER 1 2 nan", "give three numbers"),
            ("BPT_BACKGROUND 1 2 0", "channels from 0 to 1"),
            ("BPT_OUTPUT_IMAGE ../../x.exr", "a name without a folder"),
            ("BPT_OUTPUT_IMAGE ..", "a name without a folder"),
            ("BPT_OUTPUT_IMAGE", "give a file"),
            ("BPT_RE_NSECRAYSROOT 257", "at most 256"),
            ("BPT_PIXEL_SAMPLERES 4000000000 4000000000", "fewer points"),
            ("BPT_PDF_NAME Disc", "DISK"),
            ("\n\nBPT_PDF_NAME Disk\nBPT_QT_AVGNMAX 0.5", "line 3"),
            ("BPT_PDF_MEMSTAT yes", "give true or false"),
            ("BPT_RAYCASTING true", "normals are not drawn"),
            (
                "BPT_PDF_FACTORS_FILE factored_plastic",
                "computed, not read",
            ),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
        let empty = parse("// nothing\n\n").unwrap();
        assert_eq!(empty, OptionFile::default());
    }

    /// What the scene says of its samplers remains, and a studio that nobody asked for does not.
    #[test]
    fn options_are_put_into_a_scene() {
        let mut scene = SceneDescription {
            materials: vec!["nickel".into(), "teflon".into()],
            samplers: vec![Some("cosine".into()), None],
            lights: vec![LightEntry::Named("studio".into())],
            spp: Some(7),
            ..SceneDescription::default()
        };
        let lines = "BPT_PDF_NAME Sphere\nBPT_EM_BACKGROUND uniform:1\nBPT_BACKGROUND 0 0.5 1\nBPT_IMAGE_RESOLUTION 3 4";
        parse(lines).unwrap().apply(&mut scene);
        let lobe = "lobe:cosine,parameters=30/30/0.1".to_owned();
        assert_eq!(scene.samplers, [Some("cosine".to_owned()), Some(lobe)]);
        assert_eq!(scene.lights, [LightEntry::Named("uniform:1".into())]);
        let colour = Background::Colour(Rgb::new(0.0, 0.5, 1.0));
        assert_eq!(scene.background, Some(colour));
        assert_eq!((scene.size, scene.spp), (Some([3, 4]), Some(7)));
    }
}
