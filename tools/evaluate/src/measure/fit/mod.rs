//! Analytic models fitted to a material: one or several lobes over a diffuse part.
//!
//! The pairs of directions are fixed (`pairs`), the shapes are searched for (`search`), and the colours that suit given shapes
//! best are solved for at every step (`weights`). Errors are those of the result as its text has it, over pairs that
//! the fit did not see.

mod drawn;
mod metal_rough;
mod metric;
mod pairs;
mod pinning;
mod recipe;
mod refine;
mod search;
mod sphere;
mod weights;

use merlkit::Result;
use merlkit::brdf::Brdf;
use merlkit::image::{encode_png, encode_srgb};
use merlkit::material::analytic::ModelFacts;
use rayon::prelude::*;
use serde::Serialize;

pub use metal_rough::{MetalRough, SheenLayer};
pub use metric::FitMetric;
pub use pairs::LARGEST_ANGLE;
pub use pinning::{ALLOWED_GROWTH, Pinned, PinnedParameter};
pub use recipe::{DEFAULT_FIT_MODELS, FitModel};
pub use sphere::{sphere_difference, sphere_image};

use pairs::FitPairs;
use pinning::pin_parameters;
use recipe::{colour_text, round_digits};
use refine::refine;
use search::{Found, ShapeSearch, Target};

/// Pixels of a side of the spheres whose difference is measured.
pub const SPHERE_SIDE: usize = 64;

/// A model holds a material if its error is at most this fraction of the root mean square of the material's own values.
pub const HELD: f64 = 0.1;

/// What all fits of a run have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FitPlan {
    /// What is compared.
    pub metric: FitMetric,
    /// Pairs that the fit sees.
    pub pairs: usize,
    /// Other pairs, over which errors are measured.
    pub validation_pairs: usize,
    /// Seed of both.
    pub seed: u64,
}

impl Default for FitPlan {
    fn default() -> Self {
        Self {
            metric: FitMetric::default(),
            pairs: 2000,
            validation_pairs: 8000,
            seed: 1,
        }
    }
}

/// A lobe of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedLobe {
    /// Its model.
    pub model: String,
    /// Its shape parameters by their keys, as in the material's text; for Lafortune n and Cz/|Cx|.
    pub shapes: Vec<(String, f64)>,
    /// Its weight, linear RGB.
    pub colour: [f64; 3],
}

impl FittedLobe {
    /// A shape parameter by its key.
    pub fn shape(&self, key: &str) -> Option<f64> {
        let found = self.shapes.iter().find(|shape| shape.0 == key);
        found.map(|shape| shape.1)
    }
}

/// A model fitted to a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelFit {
    /// The model, as "ggx" or "ggx+ggx".
    pub model: String,
    /// The result as a MATERIAL.
    pub material: String,
    /// The root mean square difference over the validation pairs, in the metric.
    pub error: f64,
    /// The same over the pairs of the fit.
    pub fitting_error: f64,
    /// The error over the root mean square of the material's own values.
    pub relative_error: f64,
    /// The difference of two spheres, in 8-bit levels.
    pub sphere_levels: f64,
    /// Whether the relative error is at most [`HELD`].
    pub holds: bool,
    /// Reflectance of the diffuse part, linear RGB.
    pub diffuse: [f64; 3],
    /// The lobes.
    pub lobes: Vec<FittedLobe>,
    /// All parameters and how far they are known.
    pub parameters: Vec<PinnedParameter>,
    /// The same as a metallic-roughness material, and its error in the metric; for one or two lobes of GGX, with or without a sheen.
    pub metal_rough: Option<(MetalRough, f64)>,
}

/// All models fitted to one material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialFit {
    /// The material's name.
    pub material: String,
    /// The fits, in the order of the models.
    pub fits: Vec<ModelFit>,
}

impl MaterialFit {
    /// The fit of the least error, the first of equals.
    pub fn best(&self) -> Option<&ModelFit> {
        let mut best: Option<&ModelFit> = None;
        for fit in &self.fits {
            if best.is_none_or(|best| fit.error < best.error) {
                best = Some(fit);
            }
        }
        best
    }
}

/// Fits each model to a BRDF, in parallel; the results are the same for any number of threads.
///
/// # Errors
/// None that a model of [`FitModel::parse`] can cause.
pub fn fit_models(
    name: &str,
    brdf: &dyn Brdf,
    models: &[FitModel],
    plan: &FitPlan,
) -> Result<MaterialFit> {
    let isotropic = brdf.is_isotropic();
    let pairs = FitPairs::draw(plan.pairs, plan.seed, isotropic);
    let others = FitPairs::draw(plan.validation_pairs, plan.seed ^ 0x5eed, isotropic);
    let target = Target::new(brdf, &pairs, plan.metric);
    let validation = Target::new(brdf, &others, plan.metric);
    let sphere = sphere_image(brdf, SPHERE_SIDE)?;
    let fits: Result<Vec<ModelFit>> = models
        .par_iter()
        .map(|model| fit_model(model, &target, &validation, &sphere))
        .collect();
    Ok(MaterialFit {
        material: name.to_owned(),
        fits: fits?,
    })
}

/// A sphere of the material and of each fit as PNG, for people.
#[derive(Clone, Debug)]
pub struct FitPictures {
    /// The material.
    pub measured: Vec<u8>,
    /// Each fit, and its absolute difference in 8-bit values, times four.
    pub fitted: Vec<[Vec<u8>; 2]>,
}

/// Draws the spheres of a material and its fits, `side` pixels wide.
///
/// # Errors
/// Those of encoding.
pub fn draw_fits(brdf: &dyn Brdf, fit: &MaterialFit, side: usize) -> Result<FitPictures> {
    let measured = encode_srgb(&sphere_image(brdf, side)?, 0.0);
    let mut fitted = Vec::with_capacity(fit.fits.len());
    for model in &fit.fits {
        let found = ModelFacts::brdf(&model.material)?;
        let bytes = encode_srgb(&sphere_image(&*found, side)?, 0.0);
        let mut difference = Vec::with_capacity(bytes.len());
        for (a, b) in measured.iter().zip(&bytes) {
            difference.push(a.abs_diff(*b).saturating_mul(4));
        }
        fitted.push([
            encode_png(side, side, &bytes)?,
            encode_png(side, side, &difference)?,
        ]);
    }
    Ok(FitPictures {
        measured: encode_png(side, side, &measured)?,
        fitted,
    })
}

/// Fits one model and measures the result as its text has it.
fn fit_model(
    model: &FitModel,
    target: &Target<'_>,
    validation: &Target<'_>,
    sphere: &merlkit::image::Image,
) -> Result<ModelFit> {
    let search = ShapeSearch::new(target, model);
    let found = search.run()?;
    let names = lobe_names(model);
    let labels: Vec<&str> = names.iter().map(String::as_str).collect();
    let parameters = pin_parameters(target, &search, &found, &labels)?;
    let material = material_text(model, &search, &found);
    let fitted = ModelFacts::brdf(&material)?;
    let error = validation.error(&*fitted);
    // A black material has no error to relate to.
    let lobes = fitted_lobes(model, &search, &found);
    let diffuse = part_colour(&found, 0);
    let converted = MetalRough::convert(diffuse, &lobes);
    let metal_rough = converted.map(|start| refine(start, target));
    let relative_error = error / validation.root_mean_square().max(f64::MIN_POSITIVE);
    Ok(ModelFit {
        model: model.name().to_owned(),
        error,
        fitting_error: target.error(&*fitted),
        relative_error,
        sphere_levels: sphere_difference(sphere, &sphere_image(&*fitted, SPHERE_SIDE)?),
        holds: relative_error <= HELD,
        metal_rough: metal_rough.map(|found| (found, validation.error(&found))),
        diffuse,
        lobes,
        parameters,
        material,
    })
}

/// The names of the lobes, numbered where a model occurs twice.
fn lobe_names(model: &FitModel) -> Vec<String> {
    let lobes = model.lobes();
    let mut names = Vec::with_capacity(lobes.len());
    for (i, recipe) in lobes.iter().enumerate() {
        let alone = lobes.len() == 1;
        names.push(if alone {
            recipe.name.to_owned()
        } else {
            format!("{} {}", recipe.name, i + 1)
        });
    }
    names
}

/// The fit as a MATERIAL: a diffuse part and the lobes.
fn material_text(model: &FitModel, search: &ShapeSearch<'_>, found: &Found) -> String {
    let mut text = format!("lambert:reflectance={}", colour_text(part_colour(found, 0)));
    for (i, recipe) in model.lobes().iter().enumerate() {
        let own = search.own_shapes(i, &found.shapes);
        text += "+";
        text += &recipe.text(&search.lobes[i], own, part_colour(found, i + 1));
    }
    text
}

/// The weights of a part in the three channels, in the digits that are printed.
fn part_colour(found: &Found, part: usize) -> [f64; 3] {
    found.weights.map(|weights| round_digits(weights[part], 6))
}

fn fitted_lobes(model: &FitModel, search: &ShapeSearch<'_>, found: &Found) -> Vec<FittedLobe> {
    let mut lobes = Vec::new();
    for (i, recipe) in model.lobes().iter().enumerate() {
        let own = search.own_shapes(i, &found.shapes);
        let mut shapes = Vec::new();
        for (parameter, value) in search.lobes[i].iter().zip(own) {
            for key in parameter.keys {
                shapes.push(((*key).to_owned(), round_digits(*value, 7)));
            }
        }
        lobes.push(FittedLobe {
            model: recipe.name.to_owned(),
            shapes,
            colour: part_colour(found, i + 1),
        });
    }
    lobes
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::material::{LookupRule, Material};

    fn fit(material: &str, models: &[&str], metric: FitMetric) -> MaterialFit {
        let loaded = Material::resolve(material).unwrap();
        let loaded = loaded.load(LookupRule::Linear).unwrap();
        let models: Vec<FitModel> = models.iter().map(|m| FitModel::parse(m).unwrap()).collect();
        let plan = FitPlan {
            metric,
            pairs: 800,
            validation_pairs: 1000,
            seed: 1,
        };
        fit_models(material, &**loaded.brdf(), &models, &plan).unwrap()
    }

    #[test]
    fn known_parameters_are_found_again() {
        let text = "lambert:reflectance=0.3/0.1/0.02+ggx:ax=0.15,ay=0.15,nreal=1.8,nimag=0,rgb=0.9/0.8/0.4";
        for (_, metric) in FitMetric::ALL {
            let fits = fit(text, &["ggx"], *metric).fits;
            let lobe = &fits[0].lobes[0];
            assert!(fits[0].error < 1e-4, "{metric:?}: {}", fits[0].material);
            assert!((lobe.shape("ax").unwrap() - 0.15).abs() < 1e-3);
            assert!((lobe.shape("nreal").unwrap() - 1.8).abs() < 0.02);
            for (found, true_value) in lobe.colour.iter().zip([0.9, 0.8, 0.4]) {
                assert!((found - true_value).abs() < 0.02, "{:?}", lobe.colour);
            }
            for (found, true_value) in fits[0].diffuse.iter().zip([0.3, 0.1, 0.02]) {
                assert!((found - true_value).abs() < 1e-3, "{:?}", fits[0].diffuse);
            }
        }
    }

    #[test]
    fn each_model_finds_itself() {
        for text in [
            "lambert:reflectance=0.2+ward:sx=0.1,sy=0.1,ks=0.3,kd=0",
            "lambert:reflectance=0.2+blinn:n=80,ks=0.3,kd=0",
            "lambert:reflectance=0.2+lafortune:n=30,kp=0,Cx=-0.9,Cy=-0.9,Cz=0.95",
            "lambert:reflectance=0.2+torrance:rough=0.2,nreal=1.5,nimag=0,ks=1,kd=0",
            "lambert:reflectance=0.2+ashikhmin:ex=60,ey=60,Rs=0.05,Rd=0",
            "lambert:reflectance=0.2+sheen:alpha=0.3,ks=0.4",
        ] {
            let model = text.split(['+', ':']).nth(2).unwrap();
            let found = fit(text, &[model], FitMetric::CubeRoot);
            assert!(
                found.fits[0].relative_error < 2e-3,
                "{text}: {:?}",
                found.fits[0]
            );
        }
    }

    #[test]
    fn an_anisotropic_lobe_has_two_roughnesses() {
        let text = "lambert:reflectance=0.1+ggx:ax=0.1,ay=0.3,nreal=1.5,nimag=0";
        let found = fit(text, &["ggx"], FitMetric::CubeRoot);
        let lobe = &found.fits[0].lobes[0];
        let [x, y] = ["ax", "ay"].map(|key| lobe.shape(key).unwrap());
        assert!((x - 0.1).abs() < 2e-3 && (y - 0.3).abs() < 5e-3, "{x} {y}");
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let one = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap();
        let three = rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .build()
            .unwrap();
        let text = "lambert:reflectance=0.1+torrance:rough=0.2,nreal=1.5,ks=1,kd=0";
        let [a, b] = [one, three]
            .map(|pool| pool.install(|| fit(text, &["ggx", "ward", "blinn"], FitMetric::CubeRoot)));
        assert_eq!(a, b);
    }

    #[test]
    fn what_the_data_do_not_show_is_not_pinned_down() {
        let found = fit("lambert:reflectance=0.4", &["ggx"], FitMetric::CubeRoot);
        let parameters = &found.fits[0].parameters;
        let loose = parameters.iter().filter(|p| p.pinned != Pinned::Down);
        assert!(loose.count() >= 3, "{parameters:?}");
        let diffuse = parameters.iter().find(|p| p.name == "diffuse red").unwrap();
        assert!((diffuse.value - 0.4).abs() < 0.01);
    }

    #[test]
    fn black_materials_have_a_fit() {
        let found = fit("lambert:reflectance=0", &["ggx"], FitMetric::CubeRoot);
        assert!(found.fits[0].error < 1e-3, "{:?}", found.fits[0]);
        assert!(found.fits[0].material.contains("reflectance=0"));
    }
}
