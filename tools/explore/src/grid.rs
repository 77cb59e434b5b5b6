//! Values of materials that no MERL table holds: a grid over the four angles of a pair for shaders, and slices.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DQuat, DVec3};
use half::f16;
use merlkit::Brdf;
use merlkit::geometry::spherical;
use merlkit::points::Stream;
use rayon::prelude::*;
use serde_json::json;

use crate::answer::{Answer, ArrayAnswer};
use crate::query::Query;
use crate::refusal::Refusal;
use crate::session::Session;

/// Nodes over θh, φh, θd and φd.
const NODES: [usize; 4] = [64, 64, 20, 24];
/// A pair that is nearer to the horizon takes the values that it would have at this cosine.
const LEAST_COSINE: f64 = 0.02;
/// The binary logarithm that stands for 0 and for all smaller values.
const FLOOR: f32 = -24.0;
/// Pairs that the grid is compared with the material at.
const PAIRS: usize = 4096;
/// The seed that they are drawn with.
const SEED: u64 = 5;
/// Values over θh, and over θd, of a slice.
const SLICE: usize = 90;

/// The angles of a pair, radians: those of [`merlkit::geometry::HalfDiff`], and the azimuth of the half vector.
#[derive(Clone, Copy, Debug)]
struct PairAngles {
    theta_h: f64,
    phi_h: f64,
    theta_d: f64,
    phi_d: f64,
}

impl PairAngles {
    /// `wo` and `wi`.
    fn directions(self) -> [DVec3; 2] {
        let turn = DQuat::from_rotation_z(self.phi_h) * DQuat::from_rotation_y(self.theta_h);
        // Seen from the half vector, the two directions are opposite one another.
        [self.phi_d + TAU / 2.0, self.phi_d].map(|phi| turn * spherical(self.theta_d, phi))
    }

    /// The same azimuths, with polar angles at which both directions are at least [`LEAST_COSINE`] above the horizon.
    fn above_horizon(self) -> Self {
        let theta_h = self.theta_h.min(LEAST_COSINE.acos());
        // The lower of the two cosines is cosθh·cosθd − sinθh·|cosφd|·sinθd = R·cos(θd + α).
        let along = theta_h.sin() * self.phi_d.cos().abs();
        let radius = theta_h.cos().hypot(along);
        let alpha = along.atan2(theta_h.cos());
        let most = (LEAST_COSINE / radius).min(1.0).acos() - alpha;
        Self {
            theta_h,
            theta_d: self.theta_d.min(most.max(0.0)),
            ..self
        }
    }

    /// Red, green and blue of f_r, sr⁻¹.
    fn eval(self, brdf: &dyn Brdf) -> [f32; 3] {
        let [wo, wi] = self.directions();
        brdf.eval(wo.as_vec3(), wi.as_vec3()).to_array()
    }
}

/// The polar angle of the half vector at a fraction of its axis, whose nodes are dense where lobes are narrow.
fn theta_h_at(fraction: f64) -> f64 {
    fraction * fraction * FRAC_PI_2
}

/// Binary logarithms of a material at all nodes, by [φd, θd, θh, φh, channel].
struct AngleGrid {
    logarithms: Vec<f16>,
}

impl AngleGrid {
    fn tabulate(brdf: &dyn Brdf) -> Self {
        let [theta_h, phi_h, theta_d, phi_d] = NODES;
        let rows: Vec<Vec<f16>> = (0..phi_d * theta_d * theta_h)
            .into_par_iter()
            .map(|row| {
                let h = row % theta_h;
                let d = row / theta_h % theta_d;
                let azimuth = row / theta_h / theta_d;
                let mut values = Vec::with_capacity(3 * phi_h);
                for column in 0..phi_h {
                    let angles = PairAngles {
                        theta_h: theta_h_at(h as f64 / (theta_h - 1) as f64),
                        phi_h: column as f64 / phi_h as f64 * TAU,
                        theta_d: d as f64 / (theta_d - 1) as f64 * FRAC_PI_2,
                        phi_d: azimuth as f64 / phi_d as f64 * TAU,
                    };
                    values.extend(angles.above_horizon().eval(brdf).map(encode));
                }
                values
            })
            .collect();
        Self {
            logarithms: rows.concat(),
        }
    }

    /// What a shader reads: the logarithms of the nodes about a pair, mixed linearly in each of the four angles.
    fn look_up(&self, angles: PairAngles) -> [f32; 3] {
        let [theta_h, phi_h, theta_d, phi_d] = NODES;
        let h = (angles.theta_h / FRAC_PI_2).sqrt() * (theta_h - 1) as f64;
        let d = angles.theta_d / FRAC_PI_2 * (theta_d - 1) as f64;
        let h = neighbours(h, theta_h, false);
        let d = neighbours(d, theta_d, false);
        let column = neighbours(angles.phi_h / TAU * phi_h as f64, phi_h, true);
        let azimuth = neighbours(angles.phi_d / TAU * phi_d as f64, phi_d, true);
        let mut sum = [0f64; 3];
        for (azimuth, wa) in azimuth {
            for (d, wd) in d {
                for (h, wh) in h {
                    for (column, wc) in column {
                        let node = ((azimuth * theta_d + d) * theta_h + h) * phi_h + column;
                        for (channel, sum) in sum.iter_mut().enumerate() {
                            let logarithm = self.logarithms[3 * node + channel];
                            *sum += wa * wd * wh * wc * logarithm.to_f64();
                        }
                    }
                }
            }
        }
        sum.map(|logarithm| logarithm.exp2() as f32)
    }

    /// Relative differences from the material, of the mean of the channels, in ascending order: at random pairs above the horizon,
    /// spread evenly over the axes of the grid.
    fn errors(&self, brdf: &dyn Brdf) -> Vec<f64> {
        let mut random = Stream::new(SEED);
        let mut errors = Vec::with_capacity(PAIRS);
        while errors.len() < PAIRS {
            let drawn = PairAngles {
                theta_h: theta_h_at(random.next_f64()),
                phi_h: random.next_f64() * TAU,
                theta_d: random.next_f64() * FRAC_PI_2,
                phi_d: random.next_f64() * TAU,
            };
            let [wo, wi] = drawn.directions();
            if wo.z.min(wi.z) < LEAST_COSINE {
                continue;
            }
            let expected: f32 = drawn.eval(brdf).iter().sum();
            let found: f32 = self.look_up(drawn).iter().sum();
            let difference = f64::from((found - expected).abs());
            // Next to nothing instead of nothing is no error that is seen.
            errors.push(difference / f64::from(expected).max(f64::from(FLOOR).exp2()));
        }
        errors.sort_by(f64::total_cmp);
        errors
    }
}

/// The two nodes about a position on an axis of `count`, and their weights.
fn neighbours(position: f64, count: usize, is_circle: bool) -> [(usize, f64); 2] {
    let position = match is_circle {
        true => position.rem_euclid(count as f64),
        false => position.clamp(0.0, (count - 1) as f64),
    };
    let low = (position as usize).min(count - 1);
    let high = match is_circle {
        true => (low + 1) % count,
        false => (low + 1).min(count - 1),
    };
    let weight = position - low as f64;
    [(low, 1.0 - weight), (high, weight)]
}

/// A value as the logarithm of a cell.
fn encode(value: f32) -> f16 {
    f16::from_f32(value.log2().max(FLOOR))
}

/// A material resampled over four angles, and how far it is from the material.
pub(crate) fn grid(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let (_, loaded) = session.load(query.material()?)?;
    let brdf = &**loaded.brdf();
    let grid = AngleGrid::tabulate(brdf);
    let errors = grid.errors(brdf);
    let mut answer = ArrayAnswer::new(json!({
        "median": errors[PAIRS / 2],
        "percentile99": errors[PAIRS * 99 / 100],
        "floor": FLOOR.exp2(),
        "horizon": LEAST_COSINE,
    }));
    let words: Vec<u16> = grid.logarithms.iter().map(|x| x.to_bits()).collect();
    let [theta_h, phi_h, theta_d, phi_d] = NODES;
    answer.push_u16("log2", &[phi_d, theta_d, theta_h, phi_h, 3], &words);
    Ok(answer.finish())
}

/// f_r at the centres of MERL's bins over θh and θd, for one φh and one φd; −1 where a direction is below the horizon.
pub(crate) fn slice(session: &Session, query: &Query) -> Result<Answer, Refusal> {
    let phi_h = query.number("phi_h", -360.0..=360.0)?.to_radians();
    let phi_d = query.number("phi_d", -360.0..=360.0)?.to_radians();
    let (_, loaded) = session.load(query.material()?)?;
    let brdf = &**loaded.brdf();
    let mut values = Vec::with_capacity(3 * SLICE * SLICE);
    for h in 0..SLICE {
        for d in 0..SLICE {
            let angles = PairAngles {
                theta_h: theta_h_at((h as f64 + 0.5) / SLICE as f64),
                phi_h,
                theta_d: (d as f64 + 0.5) / SLICE as f64 * FRAC_PI_2,
                phi_d,
            };
            let is_above = angles.directions().iter().all(|w| w.z > 0.0);
            values.extend(match is_above {
                true => angles.eval(brdf),
                false => [-1.0; 3],
            });
        }
    }
    let mut answer = ArrayAnswer::new(json!({}));
    answer.push_f32("f", &[SLICE, SLICE, 3], &values);
    Ok(answer.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::geometry::HalfDiff;
    use merlkit::{LookupRule, Material};

    fn random_angles(random: &mut Stream) -> PairAngles {
        PairAngles {
            theta_h: random.next_f64() * FRAC_PI_2,
            phi_h: random.next_f64() * TAU,
            theta_d: random.next_f64() * FRAC_PI_2,
            phi_d: random.next_f64() * TAU,
        }
    }

    #[test]
    fn pairs_have_the_angles_that_they_are_made_of() {
        let mut random = Stream::new(1);
        for _ in 0..1000 {
            let angles = random_angles(&mut random);
            let [wo, wi] = angles.directions();
            let found = HalfDiff::from_directions(wo, wi).unwrap();
            assert!((found.theta_h - angles.theta_h).abs() < 1e-9, "{angles:?}");
            assert!((found.theta_d - angles.theta_d).abs() < 1e-9, "{angles:?}");
            let apart = (found.phi_d - angles.phi_d).rem_euclid(TAU);
            assert!(apart.min(TAU - apart) < 1e-6, "{angles:?}");
            let sum = wo + wi;
            let apart = (sum.y.atan2(sum.x) - angles.phi_h).rem_euclid(TAU);
            assert!(apart.min(TAU - apart) < 1e-6, "{angles:?}");
        }
    }

    #[test]
    fn what_is_below_the_horizon_is_brought_above_it_and_nothing_else_is_moved() {
        let mut random = Stream::new(2);
        let mut moved = 0;
        for _ in 0..1000 {
            let angles = random_angles(&mut random);
            let lowest = |angles: PairAngles| {
                let [wo, wi] = angles.directions();
                wo.z.min(wi.z)
            };
            let above = angles.above_horizon();
            assert!(lowest(above) > LEAST_COSINE - 1e-9, "{angles:?}");
            if lowest(angles) > LEAST_COSINE {
                assert!((above.theta_d - angles.theta_d).abs() < 1e-12);
            } else {
                // The polar angle ends where the lower of the directions reaches the least cosine.
                assert!(above.theta_d == 0.0 || lowest(above) < LEAST_COSINE + 1e-9);
                moved += 1;
            }
        }
        assert!((200..800).contains(&moved), "{moved}");
    }

    #[test]
    fn a_brushed_metal_is_resampled_within_a_few_per_cent() {
        for (text, median, most) in [
            ("ward:sx=0.1,sy=0.3", 0.002, 0.08),
            ("ward:sx=0.3,sy=0.3", 0.002, 0.08),
        ] {
            let material = Material::resolve(text).unwrap();
            let loaded = material.load(LookupRule::Floor).unwrap();
            let errors = AngleGrid::tabulate(&**loaded.brdf()).errors(&**loaded.brdf());
            let found = [errors[PAIRS / 2], errors[PAIRS * 99 / 100]];
            assert!(found[0] < median && found[1] < most, "{text}: {found:?}");
            assert!(found[0] > 0.0, "{text}: {found:?}");
        }
    }
}
