//! Which of several contenders is the best where their figures are right to some per cent only.

use serde::{Deserialize, Serialize};

/// Contenders whose counted time is within this factor of the least are equal in time: the counted model is right to some
/// 25 %.
pub const TIE: f64 = 1.25;
/// Of those, contenders that need no more than this factor of the fewest samples are equal in samples: the errors that the
/// numbers of samples come from are right to some 10 %.
const SAME_SAMPLES: f64 = 1.1;

/// What contenders are judged by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contender {
    /// Counted seconds.
    pub seconds: f64,
    /// Samples of one estimate.
    pub samples: f64,
    /// Bytes of tables.
    pub bytes: usize,
}

/// The best of several, and those that only the tie rule puts behind it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Winner {
    /// Its position.
    pub index: usize,
    /// Positions of the others within [`TIE`] of the least time.
    pub ties: Vec<usize>,
}

/// The best of `contenders`: of those within [`TIE`] of the least time the one with the fewest samples, of equals in samples
/// the one with the fewest bytes, then the one that is first. `None` takes no part, nor does a time that is no number.
///
/// Times, samples and bytes that are the same in every run give the same winner in every run.
pub fn best(contenders: &[Option<Contender>]) -> Option<Winner> {
    let timed = |c: &Contender| c.seconds.is_finite();
    let mut rest: Vec<(usize, Contender)> = Vec::new();
    for (i, contender) in contenders.iter().enumerate() {
        rest.extend(contender.filter(timed).map(|c| (i, c)));
    }
    let least = |of: fn(&Contender) -> f64, among: &[(usize, Contender)]| {
        among
            .iter()
            .map(|(_, c)| of(c))
            .fold(f64::INFINITY, f64::min)
    };
    // Equal in time.
    let most_seconds = TIE * least(|c| c.seconds, &rest);
    rest.retain(|(_, c)| c.seconds <= most_seconds);
    let equal_in_time: Vec<usize> = rest.iter().map(|(i, _)| *i).collect();
    // Equal in samples as well.
    let most_samples = SAME_SAMPLES * least(|c| c.samples, &rest);
    rest.retain(|(_, c)| c.samples <= most_samples);
    // The fewest bytes; the first of equals.
    let (index, _) = *rest.iter().min_by_key(|(i, c)| (c.bytes, *i))?;
    let ties = equal_in_time.into_iter().filter(|i| *i != index).collect();
    Some(Winner { index, ties })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contender(seconds: f64, samples: f64, bytes: usize) -> Option<Contender> {
        Some(Contender {
            seconds,
            samples,
            bytes,
        })
    }

    #[test]
    fn ties_go_to_fewer_samples_and_then_to_fewer_bytes() {
        let all = [
            contender(1.0, 100.0, 64_000),
            // A tie in time, but more samples.
            contender(1.1, 200.0, 10),
            // Equal in time and in samples, and smaller.
            contender(1.2, 105.0, 2000),
            // Slower.
            contender(1.3, 10.0, 0),
            None,
            contender(f64::NAN, 1.0, 0),
        ];
        let winner = best(&all).unwrap();
        assert_eq!((winner.index, winner.ties), (2, vec![0, 1]));
        assert_eq!(best(&[None, contender(f64::INFINITY, 1.0, 1)]), None);
        assert_eq!(best(&[]), None);
    }

    #[test]
    fn a_clear_lead_is_no_tie() {
        let all = [contender(3.0, 10.0, 0), contender(1.0, 100.0, 64_000)];
        let winner = best(&all).unwrap();
        assert!(winner.index == 1 && winner.ties.is_empty());
    }
}
