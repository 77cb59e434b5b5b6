//! Metallic-roughness parameters fitted in their own formula: what the formats show is nearer to the material than a conversion.

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

use super::metal_rough::{MetalRough, SheenLayer};
use super::search::Target;

/// Steps of the simplex for each coordinate at most.
const STEPS_PER_COORDINATE: u64 = 60;
/// The simplex ends where its errors spread by less.
const LEAST_SPREAD: f64 = 1e-6;
/// Edges of the first simplex.
const EDGE: f64 = 0.3;
/// Domain of α.
const ALPHA: [f64; 2] = [2e-3, 1.0];
/// Fractions p have the coordinate 4·√p, roughnesses ln α.
const ROOT: f64 = 4.0;

/// A search over all parameters that the start has: three of colour, metallic, specular, α, two of a coat, and colour and α of a
/// sheen.
struct MetalRoughSearch<'a> {
    target: &'a Target<'a>,
    start: MetalRough,
}

/// The parameters of the least error that the simplex finds from `start`, never a larger one than there.
pub(super) fn refine(start: MetalRough, target: &Target<'_>) -> MetalRough {
    let search = MetalRoughSearch { target, start };
    let origin = search.coordinates();
    let ends = search.ends();
    let mut simplex = vec![origin.clone()];
    for (i, end) in ends.iter().enumerate() {
        let mut corner = origin.clone();
        // Inwards from the upper ends.
        corner[i] += if origin[i] + EDGE > *end { -EDGE } else { EDGE };
        simplex.push(corner);
    }
    let steps = STEPS_PER_COORDINATE * origin.len() as u64;
    let run = NelderMead::new(simplex)
        .with_sd_tolerance(LEAST_SPREAD)
        .and_then(|solver| {
            Executor::new(&search, solver)
                .configure(|state| state.max_iters(steps))
                .run()
        });
    let best = run.ok().and_then(|result| result.state.best_param);
    let found = best.map_or(start, |x| search.decode(&x));
    if target.error(&found) < target.error(&start) {
        found
    } else {
        start
    }
}

impl MetalRoughSearch<'_> {
    fn coordinates(&self) -> Vec<f64> {
        let start = &self.start;
        let mut x = Vec::new();
        for fraction in start.base_color {
            x.push(ROOT * fraction.sqrt());
        }
        x.push(ROOT * start.metallic.sqrt());
        x.push(ROOT * start.specular.sqrt());
        x.push(start.alpha[0].ln());
        x.push(start.alpha[1].ln());
        if start.is_one_roughness() {
            x.pop();
        }
        if let Some([weight, alpha]) = start.coat {
            x.push(ROOT * weight.sqrt());
            x.push(alpha.ln());
        }
        if let Some(sheen) = start.sheen {
            for fraction in sheen.color {
                x.push(ROOT * fraction.sqrt());
            }
            x.push(sheen.alpha.ln());
        }
        x
    }

    /// The number of roughnesses of the base.
    fn axes(&self) -> usize {
        if self.start.is_one_roughness() { 1 } else { 2 }
    }

    /// The upper ends of the coordinates: 4 for fractions and 0 for roughnesses.
    fn ends(&self) -> Vec<f64> {
        let mut ends = vec![ROOT; 5];
        ends.resize(5 + self.axes(), 0.0);
        if self.start.coat.is_some() {
            ends.extend([ROOT, 0.0]);
        }
        if self.start.sheen.is_some() {
            ends.extend([ROOT, ROOT, ROOT, 0.0]);
        }
        ends
    }

    /// The parameters at coordinates: what lies outside a domain is moved to its end.
    fn decode(&self, x: &[f64]) -> MetalRough {
        let axes = self.axes();
        let (coat, sheen) = match &x[5 + axes..] {
            [weight, alpha, rest @ ..] if self.start.coat.is_some() => {
                (Some([decode_fraction(*weight), decode_alpha(*alpha)]), rest)
            }
            rest => (None, rest),
        };
        let sheen = match sheen {
            [r, g, b, alpha] => Some(SheenLayer {
                color: [*r, *g, *b].map(decode_fraction),
                alpha: decode_alpha(*alpha),
            }),
            _ => None,
        };
        MetalRough {
            base_color: [x[0], x[1], x[2]].map(decode_fraction),
            metallic: decode_fraction(x[3]),
            specular: decode_fraction(x[4]),
            alpha: [x[5], x[4 + axes]].map(decode_alpha),
            coat,
            sheen,
        }
    }
}

fn decode_fraction(x: f64) -> f64 {
    (x.clamp(0.0, ROOT) / ROOT).powi(2)
}

fn decode_alpha(x: f64) -> f64 {
    x.exp().clamp(ALPHA[0], ALPHA[1])
}

impl CostFunction for &MetalRoughSearch<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.target.error(&self.decode(x)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::metric::FitMetric;
    use super::super::pairs::FitPairs;
    use super::*;

    #[test]
    fn a_metallic_roughness_material_finds_itself() {
        let truth = MetalRough {
            base_color: [0.6, 0.3, 0.1],
            metallic: 0.2,
            specular: 1.0,
            alpha: [0.2; 2],
            coat: None,
            sheen: None,
        };
        let pairs = FitPairs::draw(300, 1, true);
        let target = Target::new(&truth, &pairs, FitMetric::CubeRoot);
        let start = MetalRough {
            base_color: [0.5; 3],
            metallic: 0.5,
            specular: 0.5,
            alpha: [0.4; 2],
            coat: None,
            sheen: None,
        };
        let found = refine(start, &target);
        assert!(target.error(&found) < 2e-3, "{found:?}");
        assert!((found.alpha[0] - 0.2).abs() < 5e-3, "{found:?}");
        let coated = MetalRough {
            coat: Some([0.5, 0.05]),
            sheen: Some(SheenLayer {
                color: [0.25, 0.5, 1.0],
                alpha: 0.3,
            }),
            ..start
        };
        let search = MetalRoughSearch {
            target: &target,
            start: coated,
        };
        let back = search.decode(&search.coordinates());
        assert!((back.coat.unwrap()[1] - 0.05).abs() < 1e-9, "{back:?}");
        assert!((back.alpha[1] - 0.4).abs() < 1e-9, "{back:?}");
        let sheen = back.sheen.unwrap();
        assert!((sheen.alpha - 0.3).abs() < 1e-9, "{back:?}");
        assert!((sheen.color[0] - 0.25).abs() < 1e-9, "{back:?}");
        assert_eq!(search.ends().len(), search.coordinates().len());
    }
}
