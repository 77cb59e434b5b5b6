//! How each model is fitted: its shape parameters, their domains and starts, and its text.

use std::fmt::Write;

use merlkit::{Error, Result};

/// How a shape parameter's value p is turned into the coordinate x that the search moves along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ShapeScale {
    /// x = ln p.
    Log,
    /// x = 4·√F, F = ((p − 1)/(p + 1))² being the reflectance along the normal of the index p.
    Index,
    /// x = 4·√p.
    Root,
}

impl ShapeScale {
    pub(super) fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Log => value.ln(),
            Self::Index => 4.0 * (value - 1.0) / (value + 1.0),
            Self::Root => 4.0 * value.sqrt(),
        }
    }

    pub(super) fn value(self, x: f64) -> f64 {
        match self {
            Self::Log => x.exp(),
            Self::Index => (4.0 + x) / (4.0 - x),
            Self::Root => (0.25 * x).powi(2),
        }
    }
}

/// A shape parameter of a lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapeParameter {
    /// Its keys in the model's text: two where x and y have one each.
    pub(super) keys: &'static [&'static str],
    /// The domain of the fit, within that of the model.
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) scale: ShapeScale,
    /// Values that the search starts from.
    starts: &'static [f64],
}

/// A model whose parameters can be fitted.
pub(super) struct Recipe {
    pub(super) name: &'static str,
    shapes: &'static [ShapeParameter],
    /// Parameters that keep their values.
    fixed: &'static str,
}

const fn log_shape(
    keys: &'static [&'static str],
    [low, high]: [f64; 2],
    starts: &'static [f64],
) -> ShapeParameter {
    ShapeParameter {
        keys,
        low,
        high,
        scale: ShapeScale::Log,
        starts,
    }
}

/// The index of a dielectric or, above 2.5, of what reflects as a metal does.
const INDEX: ShapeParameter = ShapeParameter {
    keys: &["nreal"],
    low: 1.02,
    high: 100.0,
    scale: ShapeScale::Index,
    starts: &[1.5, 10.0],
};
const ROUGHNESS_STARTS: &[f64] = &[0.015, 0.04, 0.1, 0.2, 0.4, 0.8];
const EXPONENT_STARTS: &[f64] = &[3.0, 12.0, 50.0, 200.0, 1000.0, 8000.0];
const EXPONENTS: [f64; 2] = [1.0, 1e5];

/// All models that are fitted.
const RECIPES: [Recipe; 9] = [
    Recipe {
        name: "ward",
        shapes: &[log_shape(&["sx", "sy"], [3e-3, 2.0], ROUGHNESS_STARTS)],
        fixed: "ks=1,kd=0",
    },
    Recipe {
        name: "blinn",
        shapes: &[log_shape(&["n"], EXPONENTS, EXPONENT_STARTS)],
        fixed: "ks=1,kd=0",
    },
    Recipe {
        name: "phong",
        shapes: &[log_shape(&["n"], EXPONENTS, EXPONENT_STARTS)],
        fixed: "ks=1,kd=0",
    },
    Recipe {
        name: "lafortune",
        shapes: &[
            log_shape(&["n"], EXPONENTS, EXPONENT_STARTS),
            log_shape(&[RATIO], [0.3, 2.0], &[0.9, 1.0, 1.1]),
        ],
        fixed: "kp=0",
    },
    Recipe {
        name: "torrance",
        shapes: &[log_shape(&["rough"], [3e-3, 2.0], ROUGHNESS_STARTS), INDEX],
        fixed: "nimag=0,ks=1,kd=0",
    },
    Recipe {
        name: "he",
        shapes: &[
            log_shape(&["sigma"], [0.01, 0.5], &[0.05, 0.15, 0.4]),
            log_shape(&["tau"], [0.1, 100.0], &[0.5, 1.5, 5.0, 15.0, 50.0]),
            INDEX,
        ],
        fixed: "lambda=577,nimag=0,ks=1,kd=0",
    },
    Recipe {
        name: "ashikhmin",
        shapes: &[
            log_shape(&["ex", "ey"], EXPONENTS, EXPONENT_STARTS),
            ShapeParameter {
                keys: &["Rs"],
                low: 1e-4,
                high: 1.0,
                scale: ShapeScale::Root,
                starts: &[0.04, 0.7],
            },
        ],
        fixed: "Rd=0",
    },
    Recipe {
        name: "ggx",
        shapes: &[
            log_shape(&["ax", "ay"], [2e-3, 1.0], ROUGHNESS_STARTS),
            INDEX,
        ],
        fixed: "nimag=0",
    },
    Recipe {
        name: SHEEN,
        shapes: &[log_shape(&["alpha"], [0.02, 1.0], &[0.1, 0.3, 0.8])],
        fixed: "ks=1",
    },
];

/// The sheen of cloth, which goes with a highlight and is neither smoother nor rougher.
pub(super) const SHEEN: &str = "sheen";

/// What every fit has, and may be named as a part of a sum.
const DIFFUSE: &str = "diffuse";

/// Lafortune's Cz over |Cx|, whose text has the factors themselves.
const RATIO: &str = "Cz/|Cx|";

/// Ward, Blinn-Phong, Lafortune, Cook-Torrance, He and Ashikhmin-Shirley, which Ngan et al. (2005) compared, and GGX.
pub const DEFAULT_FIT_MODELS: [&str; 7] = [
    "ward",
    "blinn",
    "lafortune",
    "torrance",
    "he",
    "ashikhmin",
    "ggx",
];

/// Full names of models.
const ALIASES: [(&str, &str); 3] = [
    ("blinn-phong", "blinn"),
    ("cook-torrance", "torrance"),
    ("ashikhmin-shirley", "ashikhmin"),
];

/// The most lobes of a fit.
const MOST_LOBES: usize = 3;

/// Lobes over a diffuse part: "ggx", "ggx+ggx" for two, or "ggx+sheen".
#[derive(Clone)]
pub struct FitModel {
    name: String,
    lobes: Vec<&'static Recipe>,
}

impl FitModel {
    /// Reads a model's name, or several with `+` between them. The diffuse part may be named with them.
    ///
    /// # Errors
    /// [`Error::Argument`] for a name that can't be fitted, with the names that can, for the diffuse part alone and for more lobes
    /// than three.
    pub fn parse(text: &str) -> Result<Self> {
        let mut lobes = Vec::new();
        for name in text.split('+') {
            if name == DIFFUSE {
                continue;
            }
            let alias = ALIASES.iter().find(|alias| alias.0 == name);
            let name = alias.map_or(name, |alias| alias.1);
            match RECIPES.iter().find(|recipe| recipe.name == name) {
                Some(recipe) => lobes.push(recipe),
                None => return Err(unknown_model(name)),
            }
        }
        if lobes.is_empty() {
            return Err(Error::argument(
                format!("{text} has no lobe"),
                "name a lobe as well; every fit has a diffuse part",
            ));
        }
        if lobes.len() > MOST_LOBES {
            return Err(Error::argument(
                format!("{text} has {} lobes", lobes.len()),
                format!("fit at most {MOST_LOBES}"),
            ));
        }
        let names: Vec<&str> = lobes.iter().map(|recipe| recipe.name).collect();
        Ok(Self {
            name: names.join("+"),
            lobes,
        })
    }

    /// Its text, as "ggx+ggx".
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn lobes(&self) -> &[&'static Recipe] {
        &self.lobes
    }
}

/// No model of that name can be fitted: names it may have been meant as, and all that can be.
fn unknown_model(name: &str) -> Error {
    let mut ranked = Vec::new();
    for recipe in &RECIPES {
        ranked.push((strsim::jaro_winkler(name, recipe.name), recipe.name));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let names: Vec<&str> = ranked.iter().map(|r| r.1).collect();
    Error::argument(
        format!("\"{name}\" is no model that can be fitted"),
        format!(
            "did you mean {}? The models are {}",
            names[0],
            names.join(", ")
        ),
    )
}

impl Recipe {
    /// The shape parameters; in an anisotropic fit x and y have one each.
    pub(super) fn shapes(&self, isotropic: bool) -> Vec<ShapeParameter> {
        let mut shapes = Vec::new();
        for shape in self.shapes {
            match shape.keys {
                [_, _] if !isotropic => {
                    for i in 0..2 {
                        shapes.push(ShapeParameter {
                            keys: &shape.keys[i..=i],
                            ..*shape
                        });
                    }
                }
                _ => shapes.push(*shape),
            }
        }
        shapes
    }

    /// The largest weight of a channel.
    pub(super) fn largest_weight(&self, shapes: &[f64]) -> f64 {
        match self.name {
            // Lafortune's factors may be 2, so the lobe is at most 2ⁿ times the one whose largest factor is 1.
            "lafortune" => shapes[0].exp2().min(1e30),
            _ => 1.0,
        }
    }

    /// The text of the lobe with these shapes and the colour `weights`, each at most [`Self::largest_weight`].
    pub(super) fn text(
        &self,
        parameters: &[ShapeParameter],
        shapes: &[f64],
        weights: [f64; 3],
    ) -> String {
        if self.name == "lafortune" {
            return lafortune_text(shapes, weights);
        }
        let mut text = format!("{}:", self.name);
        for (parameter, value) in parameters.iter().zip(shapes) {
            for key in parameter.keys {
                let _ = write!(text, "{key}={},", round_digits(*value, 7));
            }
        }
        text + self.fixed + ",rgb=" + &colour_text(weights)
    }
}

/// Lafortune's lobe: the largest weight A becomes the factor A^(1/n) of Cx, Cy and Cz.
fn lafortune_text(shapes: &[f64], weights: [f64; 3]) -> String {
    let [n, ratio] = [shapes[0], shapes[1]];
    let n = round_digits(n, 7);
    let largest = weights[0].max(weights[1]).max(weights[2]);
    let scale = if largest > 0.0 {
        largest.powf(1.0 / n)
    } else {
        1.0
    };
    let unit = scale / ratio.max(1.0);
    let [x, z] = [unit, unit * ratio].map(|c| round_digits(c.min(2.0), 10));
    let colour = weights.map(|w| if largest > 0.0 { w / largest } else { 0.0 });
    format!(
        "lafortune:n={n},kp=0,Cx={},Cy={},Cz={z},rgb={}",
        -x,
        -x,
        colour_text(colour)
    )
}

/// A colour in the domain 0 to 1.
pub(super) fn colour_text(weights: [f64; 3]) -> String {
    let [r, g, b] = weights.map(|w| round_digits(w.clamp(0.0, 1.0), 6));
    format!("{r}/{g}/{b}")
}

/// The number with so many significant digits.
pub(super) fn round_digits(value: f64, digits: usize) -> f64 {
    let text = format!("{value:.*e}", digits - 1);
    text.parse().unwrap_or(value)
}

/// Values of all shape parameters that the search may start from. Of several lobes each is rougher than the one in front of
/// it, apart from a sheen, and only the first start of their other parameters is taken.
pub(super) fn start_values(model: &FitModel, isotropic: bool) -> Vec<Vec<f64>> {
    let several = model.lobes().len() > 1;
    // The rank of the last lobe that is no sheen, and the values so far.
    let mut all: Vec<(Option<usize>, Vec<f64>)> = vec![(None, Vec::new())];
    for recipe in model.lobes() {
        let mut longer = Vec::new();
        for (rank, values) in &all {
            for (next, lobe) in lobe_starts(&recipe.shapes(isotropic), several) {
                let values = [values.as_slice(), &lobe].concat();
                if recipe.name == SHEEN {
                    longer.push((*rank, values));
                } else if rank.is_none_or(|rank| next > rank) {
                    longer.push((Some(next), values));
                }
            }
        }
        all = longer;
    }
    all.into_iter().map(|(_, values)| values).collect()
}

/// Starts of one lobe, each with its rank by roughness.
fn lobe_starts(parameters: &[ShapeParameter], several: bool) -> Vec<(usize, Vec<f64>)> {
    let mut all: Vec<(usize, Vec<f64>)> = vec![(0, Vec::new())];
    for (k, parameter) in parameters.iter().enumerate() {
        let count = if several && k > 0 {
            1
        } else {
            parameter.starts.len()
        };
        let mut longer = Vec::new();
        for (rank, values) in &all {
            for (i, start) in parameter.starts[..count].iter().enumerate() {
                let rank = if k == 0 {
                    rank_roughness(parameter, i)
                } else {
                    *rank
                };
                longer.push((rank, [values.as_slice(), &[*start]].concat()));
            }
        }
        all = longer;
    }
    all
}

/// The rank of a start by roughness; large exponents are smooth.
fn rank_roughness(parameter: &ShapeParameter, i: usize) -> usize {
    if parameter.high > 1e3 {
        parameter.starts.len() - i
    } else {
        i
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_start_is_in_its_domain_and_every_text_is_a_model() {
        for recipe in &RECIPES {
            for isotropic in [true, false] {
                let model = FitModel::parse(recipe.name).unwrap();
                let parameters = recipe.shapes(isotropic);
                for start in start_values(&model, isotropic) {
                    assert_eq!(start.len(), parameters.len());
                    for (value, parameter) in start.iter().zip(&parameters) {
                        assert!((parameter.low..=parameter.high).contains(value));
                        let x = parameter.scale.coordinate(*value);
                        assert!((parameter.scale.value(x) / value - 1.0).abs() < 1e-9);
                    }
                    let text = recipe.text(&parameters, &start, [0.5, 0.25, 1.0]);
                    merlkit::material::analytic::ModelFacts::parse(&text).unwrap();
                }
            }
        }
    }

    #[test]
    fn several_lobes_start_from_smooth_to_rough() {
        let model = FitModel::parse("ggx+ggx").unwrap();
        let starts = start_values(&model, true);
        assert_eq!(starts.len(), 15);
        assert!(starts.iter().all(|s| s.len() == 4 && s[0] < s[2]));
        // A sheen goes with every roughness.
        for text in ["ggx+sheen", "sheen+ggx+diffuse"] {
            let model = FitModel::parse(text).unwrap();
            assert_eq!(start_values(&model, true).len(), 18);
        }
    }

    #[test]
    fn models_that_are_unknown_are_answered_with_names() {
        for (text, near) in [
            ("gxg", "ggx"),
            ("wrad", "ward"),
            ("torrence", "torrance"),
            ("", "ggx"),
            ("shine", "sheen"),
            ("diffuse", "name a lobe"),
        ] {
            let message = FitModel::parse(text).err().unwrap().to_string();
            assert!(message.contains(near), "{message}");
        }
        assert!(FitModel::parse("ggx+ggx+ggx+ggx").is_err());
        assert!(FitModel::parse("cook-torrance").is_ok());
    }
}
