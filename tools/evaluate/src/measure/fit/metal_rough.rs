//! A fit in the parameters of metallic-roughness materials, which most formats have.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::{DVec3, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::geometry::unit_upper;
use serde::Serialize;

use super::FittedLobe;
use super::recipe::SHEEN;

/// Reflectance along the normal of a dielectric of index 1.5.
const DIELECTRIC: f64 = 0.04;

/// The sheen of cloth over the rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SheenLayer {
    /// Its colour, linear RGB.
    pub color: [f64; 3],
    /// How far the fibres lean from the normal: the square of glTF's roughness.
    pub alpha: f64,
}

/// A base between dielectric and metal, with a clear coat if the fit has two lobes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MetalRough {
    /// Colour of the diffuse part of a dielectric, and of the highlight of a metal.
    pub base_color: [f64; 3],
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f64,
    /// GGX's α along x and y.
    pub alpha: [f64; 2],
    /// The dielectric's reflectance along the normal over 0.04, at most 1.
    pub specular: f64,
    /// Weight and α of the coat, whose reflectance along the normal is 0.04.
    pub coat: Option<[f64; 2]>,
    /// The sheen between the base and the coat.
    pub sheen: Option<SheenLayer>,
}

impl MetalRough {
    /// Where the search for the parameters starts: those whose reflectances along the normal are those of the fit, on average over the
    /// channels; `None` for a fit of other lobes than one or two of GGX and a sheen.
    ///
    /// With d the diffuse colour, s the highlight's colour along the normal and t = 1 − metallic, t·B = d and 0.04·t + (1 − t)·B = s
    /// give 0.04·t² − (d + s)·t + d = 0.
    pub(super) fn convert(diffuse: [f64; 3], lobes: &[FittedLobe]) -> Option<Self> {
        let (sheen, others) = split_sheen(lobes)?;
        // Of two lobes the smoother one is the coat.
        let (coat, base) = match others.as_slice() {
            [base] => (None, *base),
            [a, b] if a.shape("ax")? <= b.shape("ax")? => (Some(*a), *b),
            [a, b] => (Some(*b), *a),
            _ => return None,
        };
        let highlight = base.along_normal()?;
        let (d, s) = (mean(diffuse), mean(highlight));
        let sum = d + s;
        let root = (sum * sum - 4.0 * DIELECTRIC * d).max(0.0).sqrt();
        let t = ((sum - root) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0);
        let metallic = 1.0 - t;
        let mut base_color = [0.0; 3];
        for (c, color) in base_color.iter_mut().enumerate() {
            let as_dielectric = if t > 0.0 { diffuse[c] / t } else { 0.0 };
            let as_metal = (highlight[c] - DIELECTRIC * t).max(0.0);
            *color = (t * as_dielectric + as_metal).clamp(0.0, 1.0);
        }
        let coat = match coat {
            None => None,
            Some(coat) => {
                let weight = (mean(coat.along_normal()?) / DIELECTRIC).min(1.0);
                Some([weight, coat.shape("ax")?])
            }
        };
        Some(Self {
            base_color,
            metallic,
            alpha: [base.shape("ax")?, base.shape("ay")?],
            specular: if t < 1.0 {
                1.0
            } else {
                (s / DIELECTRIC).min(1.0)
            },
            coat,
            sheen,
        })
    }

    /// Whether x and y have one roughness.
    pub(super) fn is_one_roughness(&self) -> bool {
        self.alpha[0] == self.alpha[1]
    }

    /// The α of equal area, which isotropic formats take.
    pub fn mean_alpha(&self) -> f64 {
        (self.alpha[0] * self.alpha[1]).sqrt()
    }
}

impl FittedLobe {
    /// The reflectance along the normal of a GGX lobe, ((η − 1)/(η + 1))² times its colour; `None` for other lobes.
    pub fn along_normal(&self) -> Option<[f64; 3]> {
        if self.model != "ggx" {
            return None;
        }
        let eta = self.shape("nreal")?;
        let fresnel = ((eta - 1.0) / (eta + 1.0)).powi(2);
        Some(self.colour.map(|c| c * fresnel))
    }

    /// The lobe as a sheen; `None` for other lobes.
    pub fn sheen(&self) -> Option<SheenLayer> {
        (self.model == SHEEN).then_some(SheenLayer {
            color: self.colour,
            alpha: self.shape("alpha")?,
        })
    }
}

/// The sheen of a fit, and its other lobes; `None` for two of them.
fn split_sheen(lobes: &[FittedLobe]) -> Option<(Option<SheenLayer>, Vec<&FittedLobe>)> {
    let (sheens, others): (Vec<_>, Vec<_>) = lobes.iter().partition(|lobe| lobe.model == SHEEN);
    match sheens.as_slice() {
        [] => Some((None, others)),
        [sheen] => Some((sheen.sheen(), others)),
        _ => None,
    }
}

fn mean(colour: [f64; 3]) -> f64 {
    (colour[0] + colour[1] + colour[2]) / 3.0
}

/// D·G/(4·cosθo·cosθi) of GGX with Smith's masking of correlated heights, as in glTF's specification.
fn ggx_lobe(wo: DVec3, wi: DVec3, [ax, ay]: [f64; 2]) -> f64 {
    let h = (wo + wi).normalize();
    let scaled = (h / DVec3::new(ax, ay, 1.0)).length_squared();
    let density = 1.0 / (PI * ax * ay * scaled * scaled);
    let [o, i] = [wo, wi].map(|w| (w * DVec3::new(ax, ay, 1.0)).length());
    0.5 * density / (wi.z * o + wo.z * i)
}

/// (2 + 1/α)·sin^(1/α) θh/(2π) over 4(cosθo + cosθi − cosθo·cosθi), the simpler of both forms in the notes of KHR_materials_sheen.
fn sheen_lobe(wo: DVec3, wi: DVec3, alpha: f64) -> f64 {
    let h = (wo + wi).normalize();
    let density = (2.0 + 1.0 / alpha) * h.x.hypot(h.y).powf(1.0 / alpha) / TAU;
    density / (4.0 * (wo.z + wi.z - wo.z * wi.z))
}

/// Schlick's F = F₀ + (1 − F₀)(1 − c)⁵.
fn schlick(along_normal: f64, cosine: f64) -> f64 {
    along_normal + (1.0 - along_normal) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

impl Brdf for MetalRough {
    /// m·F(B)·L + (1 − m)·((1 − F)·B/π + F·L), L being GGX's lobe, and the sheen; under the coat c: c·F·L′ + (1 − c·F)·that.
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return Rgb::ZERO;
        };
        let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
        let cos_d = (0.5 * (wo + wi).length()).min(1.0);
        let lobe = ggx_lobe(wo, wi, self.alpha);
        let fresnel = schlick(DIELECTRIC * self.specular, cos_d);
        let base = self.base_color.map(|b| {
            let dielectric = (1.0 - fresnel) * b * FRAC_1_PI + fresnel * lobe;
            self.metallic * schlick(b, cos_d) * lobe + (1.0 - self.metallic) * dielectric
        });
        let mut base = DVec3::from_array(base);
        if let Some(sheen) = self.sheen {
            base += DVec3::from_array(sheen.color) * sheen_lobe(wo, wi, sheen.alpha);
        }
        let value = match self.coat {
            None => base,
            Some([weight, alpha]) => {
                let coat = weight * schlick(DIELECTRIC, cos_d);
                base * (1.0 - coat) + DVec3::splat(coat * ggx_lobe(wo, wi, [alpha; 2]))
            }
        };
        value.as_vec3()
    }

    fn is_isotropic(&self) -> bool {
        self.is_one_roughness()
    }

    fn symmetry(&self) -> merlkit::geometry::Symmetry {
        if self.is_isotropic() {
            merlkit::geometry::Symmetry::Isotropic
        } else {
            merlkit::geometry::Symmetry::Quarter
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::material::analytic::ModelFacts;

    fn ggx(colour: [f64; 3], eta: f64) -> FittedLobe {
        FittedLobe {
            model: "ggx".into(),
            shapes: vec![
                ("ax".into(), 0.2),
                ("ay".into(), 0.2),
                ("nreal".into(), eta),
            ],
            colour,
        }
    }

    #[test]
    fn metals_and_plastics_are_told_apart() {
        let metal = MetalRough::convert([0.0; 3], &[ggx([0.9, 0.8, 0.7], 20.0)]).unwrap();
        assert_eq!(metal.metallic, 1.0);
        let plastic = MetalRough::convert([0.5, 0.1, 0.1], &[ggx([1.0; 3], 1.5)]).unwrap();
        assert!(plastic.metallic < 1e-6, "{plastic:?}");
        assert!((plastic.base_color[0] - 0.5).abs() < 1e-6);
        let dull = MetalRough::convert([0.5; 3], &[ggx([0.5; 3], 1.5)]).unwrap();
        assert!((dull.specular - 0.5).abs() < 1e-6 && dull.metallic == 0.0);
        let lacquer = [ggx([0.5; 3], 1.5), ggx([1.0; 3], 20.0)];
        let [weight, _] = MetalRough::convert([0.0; 3], &lacquer)
            .unwrap()
            .coat
            .unwrap();
        assert!((weight - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_sheen_is_the_catalogues() {
        let sheen = FittedLobe {
            model: SHEEN.into(),
            shapes: vec![("alpha".into(), 0.3)],
            colour: [0.6, 0.3, 0.1],
        };
        let lobes = [ggx([0.0; 3], 1.5), sheen.clone()];
        let cloth = MetalRough::convert([0.0; 3], &lobes).unwrap();
        let text = "sheen:alpha=0.3,ks=1,rgb=0.6/0.3/0.1";
        let formula = ModelFacts::brdf(text).unwrap();
        let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.28, 0.0, 0.96));
        let bare = MetalRough {
            sheen: None,
            ..cloth
        };
        let difference = cloth.eval(wo, wi) - bare.eval(wo, wi);
        assert!((difference - formula.eval(wo, wi)).abs().max_element() < 1e-6);
        assert!(MetalRough::convert([0.0; 3], &[sheen.clone(), sheen]).is_none());
    }
}
