//! A material in memory: what every command, sampler and renderer works on.

use std::fmt;
use std::sync::Arc;

use super::facts::{MaterialFacts, no_table};
use super::merl::{CellFormat, LookupRule, MerlBrdf, RoundingError};
use crate::Result;
use crate::brdf::Brdf;
use crate::direction_sampler::DirectionSampler;
use crate::geometry::Symmetry;

/// A loaded material: its BRDF, and what only some kinds of material have.
///
/// The example of [`Material`](crate::material::Material) goes from an argument to a loaded material.
#[derive(Clone)]
pub struct Loaded {
    name: String,
    brdf: Arc<dyn Brdf>,
    table: Option<Arc<MerlBrdf>>,
    own_sampler: Option<Arc<dyn DirectionSampler>>,
    bytes: usize,
    reading: &'static str,
    file_access: Option<String>,
    notes: Vec<String>,
}

impl Loaded {
    /// A MERL table with its lookup rule.
    pub fn from_table(measured: Arc<MerlBrdf>) -> Self {
        Self {
            bytes: measured.table().bytes(),
            notes: [
                gap_note(&measured),
                mixed_note(&measured),
                filled_note(&measured),
                rounding_note(&measured),
            ]
            .into_iter()
            .flatten()
            .collect(),
            table: Some(measured.clone()),
            ..Self::from_brdf(measured)
        }
    }

    /// Any BRDF without tables.
    pub fn from_brdf(brdf: Arc<dyn Brdf>) -> Self {
        Self {
            name: "the material".into(),
            brdf,
            table: None,
            own_sampler: None,
            bytes: 0,
            reading: "values of the BRDF",
            file_access: None,
            notes: Vec::new(),
        }
    }

    /// The same material with the sampler that its source holds.
    pub fn with_own_sampler(self, sampler: Arc<dyn DirectionSampler>) -> Self {
        Self {
            own_sampler: Some(sampler),
            ..self
        }
    }

    /// The same material, whose BRDF has `bytes` of tables.
    pub(crate) fn with_bytes(self, bytes: usize) -> Self {
        Self { bytes, ..self }
    }

    /// The same material, whose values are come by as `reading` says: "values of the file".
    pub fn with_reading(self, reading: &'static str) -> Self {
        Self { reading, ..self }
    }

    /// The same material, whose file was read as `access` says.
    pub(super) fn with_file_access(self, access: String) -> Self {
        Self {
            file_access: Some(access),
            ..self
        }
    }

    /// The same material, of which its users should know `notes`, each a sentence without a full stop.
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// The same material, called `name` in messages and reports.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }

    /// Its name in messages and reports: that of the [`super::Material`] it was loaded from, or "the material".
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its BRDF.
    pub fn brdf(&self) -> &Arc<dyn Brdf> {
        &self.brdf
    }

    /// Which azimuths of `wo` represent all others.
    pub fn symmetry(&self) -> Symmetry {
        self.brdf.symmetry()
    }

    /// Whether it has a part that reflects the mirror direction alone. A BRDF that has such a part has it at the normal, too.
    fn has_mirror(&self) -> bool {
        self.brdf.mirror(glam::Vec3::Z).is_some()
    }

    /// What it is, apart from its values.
    pub fn facts(&self) -> MaterialFacts {
        MaterialFacts {
            symmetry: self.symmetry(),
            has_table: self.table.is_some(),
            has_own_sampler: self.own_sampler.is_some(),
            has_mirror: self.has_mirror(),
        }
    }

    /// The MERL table that it is, with its lookup rule; `None` for other kinds of material.
    pub fn table(&self) -> Option<&Arc<MerlBrdf>> {
        self.table.as_ref()
    }

    /// The MERL table, for `purpose`, which can't do without: "a plot of slices".
    ///
    /// # Errors
    /// As [`MaterialFacts::require_table`].
    pub fn require_table(&self, purpose: &str) -> Result<&Arc<MerlBrdf>> {
        match &self.table {
            Some(table) => Ok(table),
            None => Err(no_table(&self.name, purpose)),
        }
    }

    /// The sampler that its source itself holds, if it does.
    pub fn own_sampler(&self) -> Option<&Arc<dyn DirectionSampler>> {
        self.own_sampler.as_ref()
    }

    /// The rule its table is looked up by; `None` without a table.
    pub fn rule(&self) -> Option<LookupRule> {
        self.table.as_ref().map(|table| table.rule())
    }

    /// How its values are come by, for legends: "floor lookup", "floor lookup in f16 cells", "values of the file", "values of a
    /// formula".
    pub fn reading(&self) -> String {
        let Some(measured) = &self.table else {
            return self.reading.into();
        };
        let rule = measured.rule().name();
        match measured.table().cell_format() {
            CellFormat::F32 => format!("{rule} lookup"),
            format => format!("{rule} lookup in {} cells", format.name()),
        }
    }

    /// How its MERL binary was read: "mapped", or "copied" with the reason in brackets; see [`crate::files`]. `None` for other
    /// kinds of material.
    pub fn file_access(&self) -> Option<&str> {
        self.file_access.as_deref()
    }

    /// What its users should know: values that are missing and how they are read, or that reading changed. Sentences without a
    /// full stop.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Bytes of its tables in memory, counted.
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

/// What a table's gaps above the horizon are read as; `None` without gaps.
fn gap_note(measured: &MerlBrdf) -> Option<String> {
    let (table, rule) = (measured.table(), measured.rule());
    let count = table.count_gaps();
    let reading = match rule {
        LookupRule::Floor => "reads them as 0",
        LookupRule::Linear | LookupRule::Centred => {
            "takes the mean of their valid neighbours, and 0 where there is none"
        }
    };
    let percent = 100.0 * count as f64 / table.header().cells() as f64;
    (count > 0).then(|| {
        format!(
            "{count} cells above the horizon ({percent:.2} % of the table) have no value; the {} rule {reading}",
            rule.name()
        )
    })
}

/// What becomes of cells of which some channels are unusable; `None` without such cells.
fn mixed_note(measured: &MerlBrdf) -> Option<String> {
    let (table, rule) = (measured.table(), measured.rule());
    let count = table.mixed_cells();
    let percent = 100.0 * count as f64 / table.header().cells() as f64;
    let reading = match (table.keeps_channels_apart(), rule) {
        (false, _) => {
            "are invalid as a whole, as --invalid cell says; --invalid channel keeps the other channels".into()
        }
        (true, LookupRule::Floor) => {
            "are invalid in these alone, as --invalid channel says; the floor rule reads them as 0".into()
        }
        (true, LookupRule::Linear | LookupRule::Centred) => format!(
            "are invalid in these alone, as --invalid channel says; the {} rule takes the mean of their valid neighbours",
            rule.name()
        ),
    };
    (count > 0).then(|| {
        format!("{count} cells ({percent:.2} % of the table) with unusable values in some channels {reading}")
    })
}

/// How much of a table was filled in; `None` if nothing was.
fn filled_note(measured: &MerlBrdf) -> Option<String> {
    let filled = measured.table().filled();
    let cells = measured.table().header().cells();
    let percent = 100.0 * filled.len() as f64 / cells as f64;
    (!filled.is_empty()).then(|| {
        format!(
            "{} cells ({percent:.2} % of the table) were filled in from others, not measured",
            filled.len()
        )
    })
}

/// How far compact cells are from what was read; `None` for others.
fn rounding_note(measured: &MerlBrdf) -> Option<String> {
    let table = measured.table();
    let worst = RoundingError::worst(table.rounding_errors()?);
    let [median, permille, greatest] =
        [worst.median, worst.permille, worst.greatest].map(|error| 100.0 * error);
    let lost = match worst.zeroed {
        0 => String::new(),
        count => format!("; {count} values above 0 became 0"),
    };
    Some(format!(
        "the table is kept in {} cells, which move the values of its worst channel by {median:.2e} % in the median, by more than \
         {permille:.2e} % one in a thousand, and by at most {greatest:.2e} %{lost}",
        table.cell_format().name()
    ))
}

impl fmt::Debug for Loaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Loaded")
            .field("name", &self.name)
            .field("reading", &self.reading())
            .field("bytes", &self.bytes)
            .finish_non_exhaustive()
    }
}
