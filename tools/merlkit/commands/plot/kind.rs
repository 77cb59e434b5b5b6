//! What can be drawn, and which options each kind takes.

/// What to draw. The help says what each is below its options: texts of values would make it three lines for each option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    // f_r·cosθ in the plane of incidence against the angle of wi; with --sampler, the ideal density and the sampler's
    Lobe,
    // The same as lobe, in polar coordinates
    LobePolar,
    // f_r·cosθ over the whole hemisphere, as a shaded solid
    #[value(name = "lobe-3d", alias = "lobe3d")]
    Lobe3d,
    // The table at one φd over θh and θd, in false colours
    Slice,
    // The same as slice in the material's own colours: gamma 2.2, one pixel per bin
    SliceRgb,
    // The leaves of the adaptive disc, and directions drawn by --sampler, on the unit disc
    Disc,
    // The CDF over θh of cascade-cdf before and after compression, with its knots
    Cdf,
    // The CDF over φh of cascade-cdf at the median θh, before and after compression
    CdfAzimuth,
    // Directional albedo against θ; for one table alone, with each of the three lookup rules
    Albedo,
    // An environment with the directions that a strategy draws, and its luminance
    Environment,
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Lobe => "lobe",
            Self::LobePolar => "lobe-polar",
            Self::Lobe3d => "lobe-3d",
            Self::Slice => "slice",
            Self::SliceRgb => "slice-rgb",
            Self::Disc => "disc",
            Self::Cdf => "cdf",
            Self::CdfAzimuth => "cdf-azimuth",
            Self::Albedo => "albedo",
            Self::Environment => "environment",
        }
    }

    /// Whether curves of samplers are drawn into the same picture.
    pub fn is_lobe(self) -> bool {
        matches!(self, Self::Lobe | Self::LobePolar)
    }

    pub fn is_slice(self) -> bool {
        matches!(self, Self::Slice | Self::SliceRgb)
    }

    /// Whether several materials share a picture.
    pub fn takes_several(self) -> bool {
        self.is_lobe() || matches!(self, Self::Albedo | Self::Lobe3d)
    }

    /// Whether an option named so has an effect, on so many materials, with samplers or without.
    pub fn takes(self, option: &str, materials: usize, samplers: bool) -> bool {
        let solid = self == Self::Lobe3d;
        match option {
            "--theta" => !self.is_slice() && self != Self::Albedo,
            "--sampler" => !self.is_slice() && self != Self::Albedo && !solid,
            // The albedo of a single table is drawn for all three rules.
            "--lookup" => !self.is_slice() && (self != Self::Albedo || materials > 1),
            "--value" => (self.is_lobe() || solid) && !samplers,
            "--channel" => self.takes_several() && !samplers,
            "--scale" => self.takes_several() || self == Self::Slice,
            "--phi-d" => self.is_slice(),
            "--exposure" => matches!(self, Self::SliceRgb | Self::Environment),
            "--elevation" | "--azimuth" => solid,
            "--together" => solid && materials > 1,
            _ => matches!(self, Self::Disc | Self::Environment),
        }
    }
}
