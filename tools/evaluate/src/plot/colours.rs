//! Colours that stand for values.

/// Every eighth of matplotlib's viridis (van der Walt and Smith 2015): even steps of lightness, told apart by colour-blind
/// readers and in print.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// 8-bit sRGB of a value in [0, 1], dark to light; values outside take the nearer end, NaN the dark one.
pub fn viridis(value: f64) -> [u8; 3] {
    let last = VIRIDIS.len() - 1;
    let at = if value > 0.0 {
        value.min(1.0) * last as f64
    } else {
        0.0
    };
    let i = (at as usize).min(last - 1);
    let t = at - i as f64;
    [0, 1, 2].map(|c| {
        let mixed = f64::from(VIRIDIS[i][c]) * (1.0 - t) + f64::from(VIRIDIS[i + 1][c]) * t;
        mixed.round() as u8
    })
}
