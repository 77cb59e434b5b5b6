//! Whether a number of samples that was found on some seeds holds on others.

use serde::Serialize;

use super::Curve;
use super::point::{ErrorPoint, PointPlan, Reference, errors_at};
use super::target::next_count;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::Environment;
use merlkit::material::Loaded;

/// A sampler measured again, on seeds that its choice has not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Proof {
    /// Samples of one estimate that were found to be enough; the error is that of this very number.
    pub samples: usize,
    /// The first of the fresh seeds.
    pub first_seed: u64,
    /// How many.
    pub seeds: u64,
    /// The error with its interval, whose upper end is at most what was asked for.
    pub error: ErrorPoint,
}

/// Estimates of more samples are not tried.
const MOST_PROVED: usize = 1 << 20;
/// Seeds of a proof for each seed of the plan.
const SEEDS: u64 = 4;
/// From more samples than these on, a proof has as many seeds as the plan, or it would take minutes.
const MANY_SAMPLES: usize = 1 << 15;

/// What proofs are about.
pub(super) struct Prover<'a> {
    pub material: &'a Loaded,
    pub sky: &'a Environment,
    pub references: &'a [Reference],
    pub plan: &'a PointPlan,
    /// The relative error that is to be kept.
    pub error: f64,
}

impl Prover<'_> {
    /// The first number of samples from `start` on, by [`next_count`], at which the upper end of the error's interval is at
    /// most the error asked for. Each number has seeds of its own. `None` if that takes more samples than are tried.
    ///
    /// The upper end decides, not the mean: a mean at the limit is above it for half of all seeds, and whoever draws again
    /// until a mean lies below has chosen the seeds.
    pub fn prove(
        &self,
        curve: &Curve,
        sampler: &dyn DirectionSampler,
        start: usize,
    ) -> Option<Proof> {
        let mut samples = start.max(1);
        let mut round = 0;
        while samples <= MOST_PROVED {
            let seeds = if samples > MANY_SAMPLES {
                self.plan.seeds
            } else {
                SEEDS * self.plan.seeds
            };
            let fresh = PointPlan {
                samples: vec![samples],
                first_seed: self.fresh_seed(&curve.label, round),
                seeds,
                ..self.plan.clone()
            };
            let brdf = &**self.material.brdf();
            let error = *errors_at(sampler, brdf, self.sky, self.references, &fresh).first()?;
            if error.high <= self.error {
                return Some(Proof {
                    samples,
                    first_seed: fresh.first_seed,
                    seeds,
                    error,
                });
            }
            samples = next_count(samples);
            round += 1;
        }
        None
    }

    /// The first of the seeds of a round: a hash of the material, as its reflected light, of the sampler, of the round and
    /// of the seed of the run, so that no two proofs share seeds, nor does a proof share any with the choice. Below 2⁵³,
    /// which every reader of JSON takes as it is.
    fn fresh_seed(&self, sampler: &str, round: u64) -> u64 {
        let mut bytes = Vec::new();
        for reference in self.references {
            bytes.extend(reference.radiance.to_bits().to_le_bytes());
        }
        bytes.extend(sampler.as_bytes());
        bytes.extend(round.to_le_bytes());
        bytes.extend(self.plan.first_seed.to_le_bytes());
        hash(&bytes) >> 11
    }
}

/// FNV-1a of 64 bits, and behind it the finaliser of MurmurHash3 (`fmix64`), which spreads every bit over all others.
fn hash(bytes: &[u8]) -> u64 {
    let mut h = 0xcbf2_9ce4_8422_2325_u64;
    for byte in bytes {
        h = (h ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    }
    h = (h ^ (h >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    h = (h ^ (h >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    h ^ (h >> 33)
}

#[cfg(test)]
mod tests {
    use super::hash;

    /// `fmix64` of FNV-1a of nothing and of "a" (af63dc4c8601ec8c), by an independent implementation.
    #[test]
    fn hashes_are_those_of_the_published_functions() {
        assert_eq!(hash(b""), 0xefd0_1f60_ba99_2926);
        assert_eq!(hash(b"a"), 0x82a2_a958_a9be_ce5b);
    }
}
