//! Squares of the disc's quadtree.

use glam::DVec2;

/// A square of [−1, 1]², by its lower corner and side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct QuadCell {
    pub corner: DVec2,
    pub side: f64,
}

/// Subdivisions that a square's code has room for.
pub(in crate::sampler) const DEEPEST: u32 = 14;

/// An axis-aligned rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub low: DVec2,
    pub high: DVec2,
}

impl QuadCell {
    pub const ROOT: Self = Self {
        corner: DVec2::NEG_ONE,
        side: 2.0,
    };

    /// Child 0..4: bit 0 is the upper half in x, bit 1 in y.
    #[inline]
    pub fn child(self, i: usize) -> Self {
        debug_assert!(i < 4);
        let side = self.side * 0.5;
        Self {
            corner: self.corner + side * DVec2::new((i & 1) as f64, (i >> 1) as f64),
            side,
        }
    }

    /// Depth in the upper four bits, then the square's column and row among all of its depth, fourteen bits each.
    pub fn code(self) -> u32 {
        let depth = (2.0 / self.side).log2().round() as u32;
        debug_assert!(depth <= DEEPEST);
        let place = |x: f64| ((x + 1.0) / self.side).round() as u32;
        depth << 28 | place(self.corner.x) << 14 | place(self.corner.y)
    }

    /// The part of a walk in Z-order that a square of this code takes: its first place, and how many places there are in it,
    /// each a square of the greatest depth.
    #[inline]
    pub fn z_range(code: u32) -> (u32, u32) {
        let up = DEEPEST - (code >> 28);
        let (column, row) = (code >> 14 & 0x3fff, code & 0x3fff);
        (
            (spread(column) | spread(row) << 1) << (2 * up),
            1 << (2 * up),
        )
    }

    /// The square of a code.
    #[inline]
    pub fn of_code(code: u32) -> Self {
        // 2^(1 − depth), by its exponent.
        let side = f64::from_bits((1024 - u64::from(code >> 28)) << 52);
        let place = DVec2::new(f64::from(code >> 14 & 0x3fff), f64::from(code & 0x3fff));
        Self {
            corner: place * side - 1.0,
            side,
        }
    }

    /// Bounding rectangle of the part inside the unit disc; `None` if there is none.
    ///
    /// The thesis (6.3.4) has eight cases, by which corners lie inside. One rule covers all of them: the square reaches as
    /// far along x as the circle does at its y nearest to 0, and the same the other way round.
    #[inline]
    pub fn inside_disc(self) -> Option<Rect> {
        let (low, high) = (self.corner, self.corner + self.side);
        let far = low.abs().max(high.abs());
        if far.length_squared() <= 1.0 {
            return Some(Rect { low, high });
        }
        // Distance from the square to either axis, and the circle's reach there.
        let near = low.max(-high).max(DVec2::ZERO);
        let reach2 = DVec2::ONE - near.yx() * near.yx();
        if reach2.min_element() <= 0.0 {
            return None;
        }
        let reach = DVec2::new(reach2.x.sqrt(), reach2.y.sqrt());
        let rect = Rect {
            low: low.max(-reach),
            high: high.min(reach),
        };
        (rect.low.x < rect.high.x && rect.low.y < rect.high.y).then_some(rect)
    }
}

/// Place in a walk in Z-order of the smallest square that holds the point `p` of the unit square.
#[inline]
pub(super) fn z_place(p: DVec2) -> u32 {
    let cells = f64::from(1u32 << DEEPEST);
    let cell = (p * cells).clamp(DVec2::ZERO, DVec2::splat(cells - 1.0));
    spread(cell.x as u32) | spread(cell.y as u32) << 1
}

/// The 14 bits of a number, each with a 0 before it.
#[inline]
fn spread(bits: u32) -> u32 {
    let mut x = bits;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

impl Rect {
    /// Area.
    pub fn area(self) -> f64 {
        let size = self.high - self.low;
        size.x * size.y
    }

    /// Point at relative position `t` in [0, 1)².
    #[inline]
    pub fn point(self, t: DVec2) -> DVec2 {
        self.low + t * (self.high - self.low)
    }

    /// Smallest and largest squared distance from `p`.
    pub fn distances_squared(self, p: DVec2) -> (f64, f64) {
        // Along each axis the nearest distance is 0 where the rectangle spans p, and the farthest is that of an end.
        let (low, high) = (self.low - p, self.high - p);
        let near = low.max(-high).max(DVec2::ZERO);
        let far = low.abs().max(high.abs());
        (near.length_squared(), far.length_squared())
    }
}

use glam::Vec2Swizzles as _;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_give_back_their_squares() {
        let mut square = QuadCell::ROOT;
        assert_eq!(QuadCell::of_code(square.code()), square);
        for depth in 1..=DEEPEST {
            square = square.child(depth as usize % 4);
            assert_eq!(QuadCell::of_code(square.code()), square);
            assert_eq!(square.code() >> 28, depth);
        }
    }

    #[test]
    fn squares_take_the_places_of_their_points() {
        let mut square = QuadCell::ROOT;
        for depth in 0..=DEEPEST {
            let (first, count) = QuadCell::z_range(square.code());
            for t in [DVec2::ZERO, DVec2::splat(0.37), DVec2::new(0.999, 0.01)] {
                let p = square.corner + square.side * t;
                let place = z_place((p + 1.0) * 0.5);
                assert!((first..first + count).contains(&place), "{square:?} {p}");
            }
            // Children follow one another.
            if depth < DEEPEST {
                let firsts = [0, 1, 2, 3].map(|i| QuadCell::z_range(square.child(i).code()).0);
                let expected = [0, 1, 2, 3].map(|i| first + i * (count / 4));
                assert_eq!(firsts, expected);
                square = square.child(depth as usize * 7 % 4);
            }
        }
    }

    #[test]
    fn rectangles_hold_the_part_inside_and_touch_the_circle() {
        let mut leaves = vec![QuadCell::ROOT];
        for _ in 0..4 {
            leaves = leaves
                .iter()
                .flat_map(|s| (0..4).map(|i| s.child(i)))
                .collect();
        }
        let n = 40;
        for square in leaves {
            let mut inside = 0;
            for k in 0..n * n {
                let t = DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n);
                let p = square.corner + square.side * t;
                if p.length_squared() < 1.0 {
                    inside += 1;
                    let r = square.inside_disc().unwrap();
                    assert!(
                        p.cmpge(r.low).all() && p.cmple(r.high).all(),
                        "{square:?} {r:?} {p}"
                    );
                }
            }
            if let Some(r) = square.inside_disc() {
                let share =
                    f64::from(inside) / f64::from(n * n) * square.side * square.side / r.area();
                assert!(
                    share > 0.45,
                    "{square:?}: the rectangle is mostly outside, {share}"
                );
            }
        }
    }
}
