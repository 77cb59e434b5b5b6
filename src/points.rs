//! Points in the unit square, as pure functions of (seed, index, dimension): the same for any number of threads.

use fearless_simd::{Level, dispatch};
use glam::Vec2;

/// How successive points fill the unit square.
///
/// # Examples
/// ```
/// use merlkit::points::PointSet;
///
/// // A point depends on seed, index and dimension alone, never on the thread.
/// let u = PointSet::Sobol.point(7, 0, 0);
/// assert_eq!(u, PointSet::Sobol.point(7, 0, 0));
/// assert!(u.x >= 0.0 && u.x < 1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PointSet {
    /// Independent uniform numbers.
    Random,
    /// Owen-scrambled Sobol points: every prefix is well spread.
    #[default]
    Sobol,
    /// A lattice for a number of points that is known beforehand, which it spreads better than Sobol points; see
    /// [`Self::point4_of`]. Its pairs of dimensions are shuffled against each other.
    Lattice,
}

/// sobol_burley tabulates 2¹⁶ points a seed; later ones come from another scramble.
const SOBOL_BLOCK: u64 = 1 << 16;

/// Points of a lattice, at most; later ones come from another.
const LATTICE_BLOCK: u64 = 1 << 16;

/// 1 / golden ratio: of all numbers the one whose multiples, modulo 1, stay the most evenly spread. In units of 2⁻³².
const GOLDEN: u32 = 0x9e37_79b9;

impl PointSet {
    /// Point `index` of the pair of dimensions `pair`, in [0, 1)², of a sequence without end.
    pub fn point(self, seed: u64, index: u64, pair: u32) -> Vec2 {
        let p = self.point4(seed, index, pair);
        Vec2::new(p[0], p[1])
    }

    /// Point `index` of the set of four dimensions `set`, in [0, 1)⁴, of a sequence without end; lattices
    /// are of 2¹⁶, and well spread as a whole only.
    pub fn point4(self, seed: u64, index: u64, set: u32) -> [f32; 4] {
        self.point4_of(u64::MAX, seed, index, set)
    }

    /// The first or, if `second`, the last two dimensions of [`Self::point4_of`].
    #[inline]
    pub fn pair_of(self, count: u64, seed: u64, index: u64, set: u32, second: bool) -> Vec2 {
        if self == Self::Lattice {
            let pair = 2 * u64::from(set) + u64::from(second);
            return lattice_pair(count, seed, index, pair);
        }
        let p = self.point4_of(count, seed, index, set);
        if second {
            Vec2::new(p[2], p[3])
        } else {
            Vec2::new(p[0], p[1])
        }
    }

    /// Point `index` of `count` ≥ 1, of the set of four dimensions `set`, in [0, 1)⁴. The number matters to lattices alone:
    /// point i of n is ((i + s)/n, i/ϕ + t mod 1) with the golden ratio ϕ and random shifts s and t, a Kronecker sequence
    /// set up as Hammersley's (Niederreiter 1992, ch. 3 and 5). In every pair but the first of set 0, i is the index under a
    /// permutation of its own. More than 2¹⁶ points are several lattices, all of whose pairs are shuffled; an
    /// index past the end goes on with others.
    #[inline]
    pub fn point4_of(self, count: u64, seed: u64, index: u64, set: u32) -> [f32; 4] {
        match self {
            Self::Lattice => {
                let a = lattice_pair(count, seed, index, 2 * u64::from(set));
                let b = lattice_pair(count, seed, index, 2 * u64::from(set) + 1);
                [a.x, a.y, b.x, b.y]
            }
            Self::Random => {
                let mut stream = Stream::new(mix(seed ^ mix(index ^ mix(u64::from(set)))));
                std::array::from_fn(|_| stream.next_f32())
            }
            Self::Sobol => {
                let scramble = mix(seed ^ mix(index / SOBOL_BLOCK)) as u32;
                let i = (index % SOBOL_BLOCK) as u32;
                // Dimension sets past the table's end start again under another scramble.
                let (set, extra) = (
                    set % sobol_burley::NUM_DIMENSION_SETS_4D,
                    set / sobol_burley::NUM_DIMENSION_SETS_4D,
                );
                sobol_burley::sample_4d(i, set, scramble ^ extra.wrapping_mul(0x9e37_79b9))
            }
        }
    }
}

/// A point among those that a seed gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointId {
    pub(crate) seed: u64,
    pub(crate) index: u64,
    /// How many points the seed gives; only lattices need it.
    pub(crate) count: u64,
}

impl PointSet {
    /// [`Self::pair_of`] of many points, to the bit. Neighbours of one seed share its work.
    pub(crate) fn fill_pairs(self, ids: &[PointId], set: u32, second: bool, out: &mut Vec<Vec2>) {
        out.clear();
        out.resize(ids.len(), Vec2::ZERO);
        if self == Self::Lattice {
            let pair = 2 * u64::from(set) + u64::from(second);
            dispatch!(Level::new(), _ => fill_lattice_pairs(ids, pair, out));
            return;
        }
        for (out, id) in out.iter_mut().zip(ids) {
            *out = self.pair_of(id.count, id.seed, id.index, set, second);
        }
    }
}

/// [`lattice_pair`] of many points.
#[inline(always)]
fn fill_lattice_pairs(ids: &[PointId], pair: u64, out: &mut [Vec2]) {
    let mut start = 0;
    while start < ids.len() {
        // A run of points of one lattice, with indices one after the other.
        let first = ids[start];
        let lattice = LatticeBlock::new(first.count, first.seed, first.index, pair);
        let mut end = start + 1;
        while end < ids.len()
            && ids[end].seed == first.seed
            && ids[end].count == first.count
            && ids[end].index == first.index + (end - start) as u64
            && lattice.holds(ids[end].index)
        {
            end += 1;
        }
        lattice.fill(first.index, &mut out[start..end]);
        start = end;
    }
}

/// One of the lattices that hold the points of a seed.
struct LatticeBlock {
    /// Index of its first point, and the number of its points.
    start: u64,
    size: u32,
    key: u64,
    is_shuffled: bool,
}

impl LatticeBlock {
    /// The lattice that holds point `index`.
    #[inline(always)]
    fn new(count: u64, seed: u64, index: u64, pair: u64) -> Self {
        let block = count.clamp(1, LATTICE_BLOCK);
        let turn = index / block;
        let start = turn * block;
        // The last block of many holds what is left.
        let size = if index < count {
            block.min(count - start)
        } else {
            block
        };
        Self {
            start,
            size: size as u32,
            key: mix(seed ^ mix(pair ^ mix(turn))),
            // All others being shuffled against each other, the first may stay as it is, where all of it is taken.
            is_shuffled: !(pair == 0 && count <= LATTICE_BLOCK),
        }
    }

    #[inline(always)]
    fn holds(&self, index: u64) -> bool {
        index - self.start < u64::from(self.size)
    }

    /// The points from `index` on.
    #[inline(always)]
    fn fill(&self, index: u64, out: &mut [Vec2]) {
        let first = (index - self.start) as u32;
        if !self.is_shuffled {
            for (k, out) in out.iter_mut().enumerate() {
                *out = lattice(self.size, first + k as u32, self.key);
            }
            return;
        }
        let turn = place_turn(self.size, self.key);
        let key = mix(!self.key);
        if self.size.is_power_of_two() {
            // The bijection of just as many bits needs no second try.
            for (k, out) in out.iter_mut().enumerate() {
                let place = scramble(self.size, first + k as u32, key) + turn;
                let place = if place < self.size {
                    place
                } else {
                    place - self.size
                };
                *out = lattice(self.size, place, self.key);
            }
            return;
        }
        for (k, out) in out.iter_mut().enumerate() {
            let place = shuffled(self.size, first + k as u32, key) + turn;
            let place = if place < self.size {
                place
            } else {
                place - self.size
            };
            *out = lattice(self.size, place, self.key);
        }
    }
}

/// Point `index` of the lattices that hold the `count` points a seed gives a pair of dimensions, and of others past these.
#[inline]
fn lattice_pair(count: u64, seed: u64, index: u64, pair: u64) -> Vec2 {
    let mut out = [Vec2::ZERO];
    LatticeBlock::new(count, seed, index, pair).fill(index, &mut out);
    out[0]
}

/// Point `i` of a lattice of `count`, shifted by `key`.
#[inline(always)]
fn lattice(count: u32, i: u32, key: u64) -> Vec2 {
    let shift = (key & 0xff_ffff) as f32 * (1.0 / (1u32 << 24) as f32);
    let x = (f64::from(i) + f64::from(shift)) / f64::from(count);
    // In units of 2⁻³², where what is past 1 is lost by itself.
    let y = f64::from(i.wrapping_mul(GOLDEN).wrapping_add((key >> 32) as u32))
        * (1.0 / (1u64 << 32) as f64);
    // Rounding to f32 must not reach 1.
    const LAST: f32 = 1f32.next_down();
    Vec2::new((x as f32).min(LAST), (y as f32).min(LAST))
}

/// By how many places a lattice of `count` is turned: as many as the bits of `key` say that shift nothing. By the shuffling alone
/// some places of small lattices would be taken more often than others.
#[inline(always)]
fn place_turn(count: u32, key: u64) -> u32 {
    ((((key >> 24) & 0xff) * u64::from(count)) >> 8) as u32
}

/// Place of `index` < `count` ≤ 2¹⁶ under the permutation that `key` chooses: bijections of as many bits as it takes, again
/// and again until the result is a place ("cycle walking", Black and Rogaway 2002).
#[inline(always)]
fn shuffled(count: u32, index: u32, key: u64) -> u32 {
    let mut i = index;
    loop {
        i = scramble(count, i, key);
        if i < count {
            return i;
        }
    }
}

/// A bijection of as many bits as numbers below `count` ≤ 2¹⁶ take, in four rounds.
#[inline(always)]
fn scramble(count: u32, index: u32, key: u64) -> u32 {
    let bits = u32::BITS - (count - 1).leading_zeros();
    let mask = ((1u64 << bits) - 1) as u32;
    let half = bits.div_ceil(2);
    let mut i = index;
    for round in 0..4 {
        // Only the low bits count.
        let key = key >> (13 * round);
        i = i
            .wrapping_mul(key as u32 | 1)
            .wrapping_add((key >> 7) as u32)
            & mask;
        i ^= i >> half;
    }
    i
}

/// A short stream of random numbers started from any 64 bits (SplitMix64, Steele et al. 2014).
///
/// # Examples
/// ```
/// use merlkit::points::Stream;
///
/// let mut numbers = Stream::new(7);
/// let first = numbers.next_f32();
/// assert!((0.0..1.0).contains(&first));
/// assert_eq!(Stream::new(7).next_f32(), first);
/// ```
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
///
/// [`Stream`] is made of it, and has an example.
#[inline]
pub fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn permute_index(count: u32, index: u32, key: u64) -> u32 {
        (shuffled(count, index, mix(!key)) + place_turn(count, key)) % count
    }

    #[test]
    fn many_points_are_those_of_single_calls() {
        for count in [1, 5, 16, 64, 100, 70_000] {
            let mut ids = Vec::new();
            for pixel in 0..5 {
                for index in 0..20 {
                    let index = index + pixel * 65_530;
                    let seed = mix(pixel);
                    ids.push(PointId { seed, index, count });
                }
            }
            for points in [PointSet::Random, PointSet::Sobol, PointSet::Lattice] {
                for (set, second) in [(0, false), (0, true), (3, true)] {
                    let mut out = Vec::new();
                    points.fill_pairs(&ids, set, second, &mut out);
                    for (out, id) in out.iter().zip(&ids) {
                        let single = points.pair_of(id.count, id.seed, id.index, set, second);
                        assert_eq!(*out, single, "{points:?} {count} {id:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn points_are_in_the_unit_square_and_fill_it() {
        for set in [PointSet::Random, PointSet::Sobol, PointSet::Lattice] {
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
    fn shuffling_is_a_permutation_and_takes_all_places_alike() {
        for count in [1u32, 2, 3, 7, 8, 40, 64, 100] {
            let mut landed = vec![0u32; (count * count) as usize];
            const KEYS: u64 = 4000;
            for key in 0..KEYS {
                let places: Vec<u32> = (0..count)
                    .map(|i| permute_index(count, i, mix(key)))
                    .collect();
                let mut sorted = places.clone();
                sorted.sort_unstable();
                assert_eq!(sorted, (0..count).collect::<Vec<_>>());
                places
                    .iter()
                    .enumerate()
                    .for_each(|(i, &p)| landed[i * count as usize + p as usize] += 1);
            }
            let expected = KEYS as f64 / f64::from(count);
            let chi2: f64 = landed
                .iter()
                .map(|&l| (f64::from(l) - expected).powi(2) / expected)
                .sum();
            let freedom = f64::from(count.saturating_sub(1)).powi(2);
            assert!(
                chi2 <= freedom + 4.0 * (2.0 * freedom).sqrt(),
                "{count}: {chi2} of {freedom}"
            );
        }
    }

    #[test]
    fn lattices_are_in_the_square_without_bias_and_spread_better_than_sobol() {
        for count in [1, 16, 40, 64, 100] {
            // The share below a slanted edge, which is ½ for points that are uniform.
            let errors = |set: PointSet| {
                let share = |seed: u64| {
                    let below = |i: &u64| {
                        let p = set.point4_of(count, seed, *i, 3);
                        assert!(p.iter().all(|v| (0.0..1.0).contains(v)));
                        p[2] * 0.6 + p[3] * 0.4 < 0.5
                    };
                    (0..count).filter(below).count() as f64 / count as f64 - 0.5
                };
                let all: Vec<f64> = (0..4000).map(share).collect();
                let n = all.len() as f64;
                (
                    all.iter().sum::<f64>() / n,
                    all.iter().map(|e| e * e).sum::<f64>() / n,
                )
            };
            let ((mean, lattice), (_, sobol)) =
                (errors(PointSet::Lattice), errors(PointSet::Sobol));
            assert!(
                mean.abs() < 4.0 * (lattice / 4000.0).sqrt(),
                "{count}: {mean}"
            );
            assert!(
                count == 1 || lattice < 0.5 * sobol,
                "{count}: {lattice} {sobol}"
            );
        }
    }

    #[test]
    fn many_points_are_several_lattices_of_which_the_last_is_whole() {
        const COUNT: u64 = 100_000;
        for second in [false, true] {
            let points =
                (0..COUNT).map(|i| PointSet::Lattice.pair_of(COUNT, 3, i, 0, second).as_dvec2());
            let mean = points.sum::<glam::DVec2>() / COUNT as f64;
            assert!(mean.abs_diff_eq(glam::DVec2::splat(0.5), 1e-4), "{mean}");
        }
        let past = PointSet::Lattice.pair_of(16, 3, 16, 0, false);
        assert_ne!(past, PointSet::Lattice.pair_of(16, 3, 0, 0, false));
    }

    #[test]
    fn sobol_goes_past_its_table() {
        let far = PointSet::Sobol.point(1, (1 << 32) + 5, 900);
        assert!((0.0..1.0).contains(&far.x));
        assert_ne!(
            PointSet::Sobol.point(1, 0, 0),
            PointSet::Sobol.point(1, SOBOL_BLOCK, 0)
        );
    }
}
