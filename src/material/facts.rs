//! What is known of a material before it is loaded, so that impossible requests are refused before any work.

use crate::geometry::Symmetry;
use crate::{Error, Result};

/// What a material is, apart from its values.
///
/// The example of [`Material`](crate::material::Material) goes from an argument to a loaded material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialFacts {
    /// Which azimuths of `wo` represent all others.
    pub symmetry: Symmetry,
    /// Whether it is a MERL table.
    pub has_table: bool,
    /// Whether its source holds a sampler of its own.
    pub has_own_sampler: bool,
    /// Whether it has a part that reflects the mirror direction alone, as [`crate::Brdf::mirror`].
    pub has_mirror: bool,
}

impl MaterialFacts {
    /// Whether turning both directions about the normal leaves f_r as it is.
    pub fn is_isotropic(&self) -> bool {
        self.symmetry == Symmetry::Isotropic
    }

    /// Refuses the material called `name` unless it is a MERL table, which `purpose` can't do without: "a plot of slices".
    ///
    /// # Errors
    /// [`Error::Argument`] for a material that is not a MERL table.
    pub fn require_table(&self, name: &str, purpose: &str) -> Result<()> {
        if self.has_table {
            return Ok(());
        }
        Err(no_table(name, purpose))
    }

    /// Refuses the material called `name` if it is anisotropic, for `purpose`, which knows no azimuth of `wo`.
    ///
    /// # Errors
    /// [`Error::Argument`] for an anisotropic material.
    pub fn require_isotropic(&self, name: &str, purpose: &str) -> Result<()> {
        if self.is_isotropic() {
            return Ok(());
        }
        Err(Error::argument(
            format!("{purpose} is for isotropic materials only, and {name} is anisotropic"),
            "name an isotropic material",
        ))
    }
}

/// The one refusal of a material that is not a MERL table.
pub(super) fn no_table(name: &str, purpose: &str) -> Error {
    Error::argument(
        format!("{purpose} needs a MERL table, and {name} is not one"),
        "name a MERL binary or a built-in material, or make a table of an isotropic material with `merlkit import`",
    )
}
