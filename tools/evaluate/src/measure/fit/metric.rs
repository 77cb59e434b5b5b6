//! What is compared: a function of f_r·cosθi.

use serde::Serialize;

/// The function of v = f_r·cosθi whose differences are squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitMetric {
    /// v^(1/3) (Fores, Ferwerda and Gu 2012).
    #[default]
    CubeRoot,
    /// ln(1 + v) (Löw et al. 2012).
    Log,
    /// v itself (Ngan, Durand and Matusik 2005).
    Linear,
}

/// Slopes of the cube root are those at this v or above, so that they stay finite at 0.
const LEAST_VALUE: f64 = 1e-6;

impl FitMetric {
    /// All of them by name.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("cube-root", Self::CubeRoot),
        ("log", Self::Log),
        ("linear", Self::Linear),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        let named = Self::ALL.iter().find(|metric| metric.1 == self);
        named.map_or("", |metric| metric.0)
    }

    /// What is compared, as a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Self::CubeRoot => "(f\u{b7}cos\u{3b8}i)^(1/3)",
            Self::Log => "ln(1 + f\u{b7}cos\u{3b8}i)",
            Self::Linear => "f\u{b7}cos\u{3b8}i",
        }
    }

    /// g(v) and dg/dv, for v ≥ 0.
    pub(super) fn value_and_slope(self, v: f64) -> [f64; 2] {
        match self {
            Self::CubeRoot => {
                let root = v.cbrt();
                let steep = root.max(LEAST_VALUE.cbrt());
                [root, 1.0 / (3.0 * steep * steep)]
            }
            Self::Log => [v.ln_1p(), 1.0 / (1.0 + v)],
            Self::Linear => [v, 1.0],
        }
    }
}
