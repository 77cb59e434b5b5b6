//! A fit as a sampler: the lobe samplers draw from the same distributions of half vectors.

use merlkit::Result;
use merlkit::sampler::{LEAST_DIFFUSE, SamplerSpec};

use super::ModelFit;

/// Models with the lobe sampler and the shape parameters that they have in common.
const SAMPLERS: [(&str, &str, [&str; 2]); 4] = [
    ("ggx", "ggx", ["ax", "ay"]),
    ("ward", "ward", ["sx", "sy"]),
    ("blinn", "blinn", ["n", "n"]),
    ("ashikhmin", "ashikhmin-shirley", ["ex", "ey"]),
];

impl ModelFit {
    /// The lobe sampler with the fit's shape, whose diffuse fraction is that of the reflectances along the normal; `None` for a fit
    /// of several lobes, of an anisotropic one, or of a model without such a sampler.
    ///
    /// # Errors
    /// None for shapes in their domains.
    pub fn sampler(&self) -> Result<Option<SamplerSpec>> {
        let [lobe] = self.lobes.as_slice() else {
            return Ok(None);
        };
        let Some((_, sampler, keys)) = SAMPLERS.iter().find(|s| s.0 == lobe.model) else {
            return Ok(None);
        };
        let [along, across] = keys.map(|key| lobe.shape(key).unwrap_or_default());
        if along != across {
            return Ok(None);
        }
        let fresnel = lobe.shape("Rs").unwrap_or(1.0);
        let highlight = lobe
            .along_normal()
            .unwrap_or(lobe.colour.map(|c| c * fresnel));
        let [diffuse, highlight] = [self.diffuse, highlight].map(|c| c.iter().sum::<f64>());
        let fraction = diffuse / (diffuse + highlight).max(f64::MIN_POSITIVE);
        let fraction = fraction.clamp(f64::from(LEAST_DIFFUSE), 1.0) as f32;
        let along = along as f32;
        let text = format!("lobe:{sampler},parameters={along}/{along}/{fraction}");
        Ok(Some(text.parse()?))
    }
}
