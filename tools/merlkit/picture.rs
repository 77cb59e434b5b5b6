//! A scene, what its picture depends on, and the files that it becomes.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use merlkit::Error;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::files::{Overwrite, RegularFile, check_writable};
use merlkit::image::{Image, write_exr, write_png};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::merl::LookupRule;
use merlkit::material::{Loaded, Material};
use merlkit::render::{Effect, EffectPlan, PlanRequest, RenderSettings, Scene, SceneSpec, Surface};

use crate::args;
use crate::progress::Progress;
use crate::provenance::{self, Checksums};
use crate::render_costs::{CostStage, RenderCosts, UsedSampler};
use crate::sampler_choice::SamplerChoice;
use crate::scene_args::Finish;
use crate::sky::print_notes;

/// A scene and everything its picture depends on.
#[derive(Clone)]
pub struct Picture<'a> {
    /// The scene; nothing is loaded.
    pub scene: SceneSpec,
    /// Which effects will be computed.
    pub effects: PlanRequest,
    /// Materials in the order of the scene's.
    pub materials: &'a [Material],
    /// What tables say between their samples.
    pub lookup: LookupRule,
    /// How directions are drawn, where any are; one for each material.
    pub samplers: Vec<SamplerChoice>,
    /// Size, seed and budget of paths.
    pub settings: RenderSettings,
    /// What becomes of the pixels in files.
    pub finish: Finish,
    /// Where the costs are counted, if anybody asks for them.
    pub costs: Option<&'a RenderCosts>,
}

impl Picture<'_> {
    /// Loads what the scene's plan calls for, and says what is to be known of it.
    ///
    /// # Errors
    /// Those of loading and building.
    pub fn load(&self) -> Result<Scene, Error> {
        let mut parts = LoadedParts::default();
        let progress = Progress::new("loading and building", self.materials.len());
        let surface = |i, directions| {
            let surface = parts.surface(self, i, directions);
            progress.advance();
            surface
        };
        let timer = self.begin_loading();
        let scene = Scene::build(&self.scene, self.effects, surface)?;
        timer.end(self.costs);
        print_notes(scene.light_notes());
        Ok(scene)
    }

    /// Remembers when the loading of a scene begins, and what is counted by then.
    fn begin_loading(&self) -> LoadingTimer {
        LoadingTimer {
            start: Instant::now(),
            before: self.costs.map(RenderCosts::preparation),
        }
    }

    /// The samplers as one text: each of them once, in the order of the materials.
    pub fn sampler_key(&self) -> String {
        let mut keys: Vec<String> = self.samplers.iter().map(SamplerChoice::key).collect();
        keys.dedup();
        keys.join("; ")
    }

    /// Refuses, before the work, samplers that can't be built for their materials.
    ///
    /// # Errors
    /// As [`SamplerChoice::check_supports`].
    pub fn check_samplers(&self) -> Result<(), Error> {
        let plan = EffectPlan::for_scene(&self.scene, self.effects);
        if !plan.is_on(Effect::Directions) {
            return Ok(());
        }
        for (material, sampler) in self.materials.iter().zip(&self.samplers) {
            sampler.check_supports(material)?;
        }
        Ok(())
    }

    /// A bar that counts pixels.
    pub fn progress(&self) -> Progress {
        Progress::new("rendering", self.pixels())
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> usize {
        self.settings.width * self.settings.height
    }

    /// All that the pixels follow from, apart from the settings and what is in files.
    pub fn facts(&self) -> Vec<(String, String)> {
        let scene = &self.scene;
        let (mut invalid, mut cells) = (Vec::new(), Vec::new());
        for material in self.materials {
            invalid.push(match material.keeps_channels_apart() {
                true => "channel",
                false => "cell",
            });
            cells.push(material.cell_format().name());
        }
        vec![
            ("sampler".into(), self.sampler_key()),
            ("lookup".into(), self.lookup.name().into()),
            ("invalid".into(), invalid.join(", ")),
            ("table".into(), cells.join(", ")),
            ("effects".into(), format!("{:?}", self.effects)),
            ("spheres".into(), format!("{:?}", scene.spheres)),
            ("objects".into(), format!("{:?}", scene.objects)),
            ("floor".into(), format!("{:?}", scene.floor)),
            ("lights".into(), format!("{:?}", scene.lights)),
            ("camera".into(), format!("{:?}", scene.camera)),
            ("bounces".into(), scene.depth.to_string()),
            ("strategy".into(), format!("{:?}", scene.strategy)),
            ("directions".into(), scene.directions.to_string()),
            ("turn".into(), scene.light_turn.to_string()),
            ("transparent".into(), scene.transparent.to_string()),
            ("clamp".into(), format!("{:?}", scene.clamp)),
        ]
    }

    /// SHA-256 of each file that a light comes from.
    ///
    /// # Errors
    /// [`Error::Io`] if a file can't be read.
    pub fn checksums_of_maps(&self) -> Result<Vec<String>, Error> {
        let maps = self.scene.lights.iter().filter_map(map_file);
        maps.map(|path| RegularFile::open(path)?.sha256()).collect()
    }
}

/// When the loading of a scene began, and what loading and building had taken by then.
struct LoadingTimer {
    start: Instant,
    before: Option<Duration>,
}

impl LoadingTimer {
    fn end(self, costs: Option<&RenderCosts>) {
        if let (Some(costs), Some(before)) = (costs, self.before) {
            costs.add_lights(self.start, before);
        }
    }
}

/// What the last picture was drawn with. The next one takes the same lights and the same material from here.
#[derive(Default)]
pub struct LoadedParts {
    scene: Option<Scene>,
    material: Option<(String, Loaded)>,
    surface: Option<(String, Surface)>,
}

impl LoadedParts {
    /// Loads what the plan of a picture's scene calls for and is not loaded already, and says what is to be known of it.
    ///
    /// # Errors
    /// Those of loading and building.
    pub fn load(&mut self, picture: &Picture<'_>) -> Result<&Scene, Error> {
        let previous = self.scene.take();
        let surface = |i, directions| self.surface(picture, i, directions);
        let timer = picture.begin_loading();
        let scene = match &previous {
            Some(previous) => previous.build_next(&picture.scene, picture.effects, surface)?,
            None => Scene::build(&picture.scene, picture.effects, surface)?,
        };
        timer.end(picture.costs);
        if previous.is_none() {
            print_notes(scene.light_notes());
        }
        Ok(self.scene.insert(scene))
    }

    fn surface(
        &mut self,
        picture: &Picture<'_>,
        number: usize,
        directions: bool,
    ) -> Result<Surface, Error> {
        let material = &picture.materials[number];
        let key = format!("{:?} {}", material.origin(), picture.lookup.name());
        let choice = &picture.samplers[number];
        let surface_key = format!("{key} {directions} {}", choice.key());
        if let Some((known, surface)) = &self.surface
            && *known == surface_key
        {
            return Ok(surface.clone());
        }
        self.surface = None;
        if self
            .material
            .as_ref()
            .is_none_or(|(known, _)| *known != key)
        {
            self.material = None;
        }
        let loaded = match self.material.take() {
            Some((_, loaded)) => loaded,
            None => load_material(material, picture)?,
        };
        let sampler = match directions {
            true => Some(build_sampler(choice, &loaded, picture.costs)?),
            false => None,
        };
        let surface = Surface {
            brdf: loaded.brdf().clone(),
            sampler,
        };
        self.material = Some((key, loaded));
        self.surface = Some((surface_key, surface.clone()));
        Ok(surface)
    }
}

/// The samplers of all pictures as one text.
pub fn describe_samplers(pictures: &[Picture<'_>]) -> String {
    let mut keys: Vec<String> = pictures.iter().map(Picture::sampler_key).collect();
    keys.dedup();
    format!("samplers {}", keys.join("; "))
}

/// Loads a material, and counts the time if anybody asks for costs.
fn load_material(material: &Material, picture: &Picture<'_>) -> Result<Loaded, Error> {
    let start = Instant::now();
    let loaded = args::load(material, picture.lookup)?;
    if let Some(costs) = picture.costs {
        costs.add(CostStage::Loading, start);
    }
    Ok(loaded)
}

/// The sampler of a material, whose building and calls are measured if anybody asks for costs.
fn build_sampler(
    choice: &SamplerChoice,
    loaded: &Loaded,
    costs: Option<&RenderCosts>,
) -> Result<Arc<dyn DirectionSampler>, Error> {
    let start = Instant::now();
    let sampler = choice.build(loaded)?.shared();
    let Some(costs) = costs else {
        return Ok(sampler);
    };
    let cost = UsedSampler {
        material: loaded.name().to_owned(),
        sampler: choice.label(),
        bytes: sampler.bytes(),
        building: 0.0,
    };
    costs.add_sampler(start, cost);
    Ok(costs.meter(sampler))
}

/// The file of a light that comes from one.
pub fn map_file(light: &LightSpec) -> Option<&Path> {
    match light {
        LightSpec::Environment(EnvironmentSource::File { path, .. }) => Some(path),
        _ => None,
    }
}

/// The files of a picture.
pub struct Files {
    /// Linear RGB.
    pub exr: PathBuf,
    /// Tone-mapped sRGB.
    pub png: PathBuf,
    /// What an unfinished picture needs to go on.
    pub partial: PathBuf,
    /// What the headers say of where the picture comes from.
    pub provenance: Option<String>,
}

impl Files {
    /// NAME.exr and NAME.png, and NAME.partial; an extension of either kind in `name` is left out first.
    pub fn named(name: &Path) -> Self {
        let is_picture = name.extension().is_some_and(|e| e == "exr" || e == "png");
        let stem = if is_picture {
            name.with_extension("")
        } else {
            name.to_owned()
        };
        let [exr, png, partial] = [".exr", ".png", ".partial"].map(|extension| {
            let mut path = stem.clone().into_os_string();
            path.push(extension);
            PathBuf::from(path)
        });
        Self {
            exr,
            png,
            partial,
            provenance: None,
        }
    }

    /// Writes both; `state` is a sentence about a picture that is not finished.
    ///
    /// # Errors
    /// As [`write_exr`] and [`write_png`].
    pub fn write(
        &self,
        image: Image,
        finish: &Finish,
        state: Option<String>,
        overwrite: Overwrite,
    ) -> Result<(), Error> {
        let words = self.provenance.iter().cloned().chain(state).collect();
        let image = finish.apply(image, words);
        write_exr(&self.exr, &image, overwrite)?;
        write_png(&self.png, &image, finish.exposure, overwrite)
    }

    /// The same files, whose headers name the program, its command line and the materials.
    ///
    /// # Errors
    /// Those of reading a material's file.
    pub fn with_provenance(
        self,
        materials: &[Material],
        sums: &mut Checksums,
    ) -> Result<Self, Error> {
        Ok(Self {
            provenance: Some(provenance::describe(materials, sums)?),
            ..self
        })
    }

    /// Tells of files that can't be written before the work, not after it.
    ///
    /// # Errors
    /// As [`check_writable`].
    pub fn check(&self, overwrite: Overwrite) -> Result<(), Error> {
        check_writable(&self.exr, overwrite)?;
        check_writable(&self.png, overwrite)
    }
}
