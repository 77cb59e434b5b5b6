//! Several ways of estimating one integral: weights for two techniques, and one candidate kept out of many.

/// How two techniques that can find the same direction are weighted (Veach and Guibas 1995).
///
/// See [`Reservoir`](crate::distribution::Reservoir) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Heuristic {
    /// In proportion to the squares of their densities: little is left of a technique where the other is much denser.
    #[default]
    Power,
    /// In proportion to their densities: no other weighting has a variance much lower.
    Balance,
}

impl Heuristic {
    /// Both, in the order of their names on the command line.
    pub const ALL: [Self; 2] = [Self::Power, Self::Balance];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Balance => "balance",
        }
    }

    /// Weight, in [0, 1], of a technique that chose a direction with density `own` > 0, where another chooses it with
    /// density `other` ≥ 0; both times their numbers of samples, if these differ. The two techniques' weights sum to 1.
    #[inline]
    pub fn weight(self, own: f64, other: f64) -> f64 {
        debug_assert!(own > 0.0 && other >= 0.0);
        // own²/(own² + other²), or own/(own + other).
        // By the ratio, so that no square overflows.
        let ratio = other / own;
        match self {
            Self::Power => 1.0 / (1.0 + ratio * ratio),
            Self::Balance => 1.0 / (1.0 + ratio),
        }
    }
}

/// One of a sequence of candidates, each kept with a probability in proportion to its weight: the choice of resampled
/// importance sampling (Talbot et al. 2005), in one pass and from one number.
///
/// # Examples
/// ```
/// use merlkit::distribution::{Heuristic, Reservoir};
///
/// let mut reservoir = Reservoir::new(0.9);
/// reservoir.offer(Some(("dim", 1.0)));
/// reservoir.offer(Some(("bright", 3.0)));
/// let kept = reservoir.kept().expect("a weight is positive");
/// assert_eq!(kept.mean_weight, 2.0);
///
/// // The weights with which multiple importance sampling combines two techniques sum to 1.
/// let [light, brdf] = [Heuristic::Power.weight(2.0, 1.0), Heuristic::Power.weight(1.0, 2.0)];
/// assert!((light + brdf - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Reservoir<T> {
    kept: Option<(T, f64)>,
    sum: f64,
    count: u32,
    /// In [0, 1); uniform, given what is kept.
    u: f64,
}

/// What a [`Reservoir`] kept.
///
/// See [`Reservoir`](crate::distribution::Reservoir) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept<T> {
    /// The candidate.
    pub candidate: T,
    /// Its weight, > 0.
    pub weight: f64,
    /// Mean weight of all candidates.
    pub mean_weight: f64,
}

impl<T> Reservoir<T> {
    /// An empty one that will choose by `u`, uniform in [0, 1).
    pub fn new(u: f64) -> Self {
        Self {
            kept: None,
            sum: 0.0,
            count: 0,
            u,
        }
    }

    /// The next candidate; `None` is one of weight 0. A weight must be finite and ≥ 0, and so must the sum of all.
    pub fn offer(&mut self, candidate: Option<(T, f64)>) {
        self.count += 1;
        let Some((candidate, weight)) = candidate.filter(|c| c.1 > 0.0) else {
            return;
        };
        self.sum += weight;
        debug_assert!(self.sum.is_finite());
        // With the chance wᵢ/(w₁ + … + wᵢ) for each newcomer, candidate i is kept in the end with probability wᵢ/Σw.
        let chance = weight / self.sum;
        // What is left of `u` after the choice is as uniform as it was: it serves the next one.
        if self.u < chance {
            self.kept = Some((candidate, weight));
            self.u /= chance;
        } else {
            self.u = (self.u - chance) / (1.0 - chance);
        }
        self.u = self.u.min(1.0f64.next_down());
    }

    /// The candidate kept; `None` if all weights were 0.
    pub fn kept(self) -> Option<Kept<T>> {
        // Candidates of weight 0 count too: the mean is over all that were offered.
        let mean_weight = self.sum / f64::from(self.count);
        self.kept.map(|(candidate, weight)| Kept {
            candidate,
            weight,
            mean_weight,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_two_techniques_sum_to_one() {
        for heuristic in Heuristic::ALL {
            for (a, b) in [(1.0, 1.0), (3.0, 0.5), (1e200, 1e-200)] {
                let sum = heuristic.weight(a, b) + heuristic.weight(b, a);
                assert!((sum - 1.0).abs() < 1e-15, "{heuristic:?} {a} {b}");
            }
            assert_eq!(heuristic.weight(2.0, 0.0), 1.0);
            assert_eq!(heuristic.weight(1e-200, 1e200), 0.0);
        }
        assert!((Heuristic::Balance.weight(3.0, 1.0) - 0.75).abs() < 1e-15);
        assert!((Heuristic::Power.weight(3.0, 1.0) - 0.9).abs() < 1e-15);
    }

    fn choose(u: f64, weights: &[f64]) -> Option<Kept<usize>> {
        let mut reservoir = Reservoir::new(u);
        for (i, &weight) in weights.iter().enumerate() {
            reservoir.offer(Some((i, weight)));
        }
        reservoir.offer(None);
        reservoir.kept()
    }

    #[test]
    fn candidates_are_kept_in_proportion_to_their_weights() {
        let weights = [1.0, 0.0, 4.0, 2.0, 1.0];
        let mut counts = [0.0; 5];
        let n = 8000;
        for i in 0..n {
            let kept = choose((f64::from(i) + 0.5) / f64::from(n), &weights).unwrap();
            assert_eq!(
                (kept.weight, kept.mean_weight),
                (weights[kept.candidate], 8.0 / 6.0)
            );
            counts[kept.candidate] += 8.0 / f64::from(n);
        }
        for (count, weight) in counts.iter().zip(weights) {
            assert!((count - weight).abs() < 0.01, "{counts:?}");
        }
    }

    #[test]
    fn nothing_is_kept_of_nothing() {
        assert_eq!(choose(0.3, &[]), None);
        assert_eq!(choose(0.3, &[0.0, 0.0]), None);
        for u in [0.0, 1.0f64.next_down()] {
            assert!(choose(u, &[0.0, 1e-300, 1e300]).is_some());
        }
    }
}
