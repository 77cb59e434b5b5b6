//! Points in the unit square, as pure functions of (seed, index, dimension): the same for any number of threads.

use glam::Vec2;

/// How successive points fill the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PointSet {
    /// Independent uniform numbers.
    Random,
    /// Owen-scrambled Sobol points.
    #[default]
    Sobol,
}

/// sobol_burley tabulates 2¹⁶ points a seed; later ones come from another scramble.
const SOBOL_BLOCK: u64 = 1 << 16;

impl PointSet {
    /// Point `index` of the pair of dimensions `pair`, in [0, 1)².
    pub fn point(self, seed: u64, index: u64, pair: u32) -> Vec2 {
        let p = self.point4(seed, index, pair);
        Vec2::new(p[0], p[1])
    }

    /// Point `index` of the set of four dimensions `set`, in [0, 1)⁴.
    pub fn point4(self, seed: u64, index: u64, set: u32) -> [f32; 4] {
        match self {
            Self::Random => {
                let mut stream = Stream::new(mix(seed ^ mix(index ^ mix(u64::from(set)))));
                std::array::from_fn(|_| stream.next_f32())
            }
            Self::Sobol => {
                let scramble = mix(seed ^ mix(index / SOBOL_BLOCK)) as u32;
                let i = (index % SOBOL_BLOCK) as u32;
                // Dimension sets past the table's end start again under another scramble.
                let (set, extra) =
                    (set % sobol_burley::NUM_DIMENSION_SETS_4D, set / sobol_burley::NUM_DIMENSION_SETS_4D);
                sobol_burley::sample_4d(i, set, scramble ^ extra.wrapping_mul(0x9e37_79b9))
            }
        }
    }
}

/// A short stream of random numbers started from any 64 bits (SplitMix64, Steele et al. 2014).
#[derive(Clone, Debug)]
pub struct Stream(u64);

impl Stream {
    /// Stream of the given seed; neighbouring seeds give unrelated streams.
    #[inline]
    pub fn new(seed: u64) -> Self {
        Self(mix(seed))
    }

    /// Stream that a point of the unit square determines, for methods that need more numbers than it holds.
    #[inline]
    pub fn from_point(u: Vec2) -> Self {
        Self::new(u64::from(u.x.to_bits()) << 32 | u64::from(u.y.to_bits()))
    }

    /// The next 64 bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    #[inline]
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// SplitMix64's finaliser: a bijection of 64 bits that looks random.
#[inline]
pub fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_unit_square_and_fill_it() {
        for set in [PointSet::Random, PointSet::Sobol] {
            let mut quarters = [0u32; 4];
            for i in 0..4096 {
                let p = set.point(7, i, 0);
                assert!((0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y));
                quarters[usize::from(p.x >= 0.5) + 2 * usize::from(p.y >= 0.5)] += 1;
            }
            for q in quarters {
                assert!((900..1150).contains(&q), "{set:?}: {quarters:?}");
            }
        }
    }

    #[test]
    fn sobol_goes_past_its_table() {
        let far = PointSet::Sobol.point(1, (1 << 32) + 5, 900);
        assert!((0.0..1.0).contains(&far.x));
        assert_ne!(PointSet::Sobol.point(1, 0, 0), PointSet::Sobol.point(1, SOBOL_BLOCK, 0));
    }
}
