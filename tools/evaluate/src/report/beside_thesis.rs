//! The 2008 thesis's tables beside ours, as ratios.

use serde::Serialize;

use super::Sheet;
use super::thesis::{THESIS_KB, cost_rows, thesis_uniform_memory};
use crate::measure::compare::{Comparison, Curve, MaterialComparison, Setting};
use crate::measure::convergence::Technique;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, HalfVectorSettings, LeafChoice, SamplerSpec,
};

/// One table of the thesis, with our counterparts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ThesisTable {
    /// Its number and what it shows.
    pub title: String,
    /// What is held against what, and how they differ.
    pub note: String,
    /// The figures; ratios are the thesis's over ours.
    pub sheet: Sheet,
}

impl ThesisTable {
    pub(super) fn new(title: &str, note: &str, sheet: Sheet) -> Option<Self> {
        (!sheet.rows.is_empty()).then(|| Self {
            title: title.into(),
            note: note.into(),
            sheet,
        })
    }
}

/// The tables for which something was measured: 5.9, 5.10, 6.23 and the rankings of 6.14 and 6.22. Materials
/// and numbers of samples that the thesis doesn't have are left out.
pub fn beside_thesis(comparison: &Comparison) -> Vec<ThesisTable> {
    let costs = [
        uniform_memory(comparison),
        compressed(comparison),
        precomputation(comparison),
    ];
    costs
        .into_iter()
        .chain(super::thesis_ranking::rankings(comparison))
        .flatten()
        .collect()
}

/// Ours of a sampler that the thesis has too.
struct Ours {
    label: String,
    table_bytes: usize,
    /// Tables or trees for as many directions; `None` for what is one table for all.
    tables: Option<usize>,
    build_seconds: f64,
}

impl From<&Curve> for Ours {
    fn from(c: &Curve) -> Self {
        let Curve {
            label,
            table_bytes,
            build_seconds,
            ..
        } = c;
        let (table_bytes, build_seconds) = (*table_bytes, *build_seconds);
        Self {
            label: label.clone(),
            table_bytes,
            tables: count_tables(&c.competitor.spec),
            build_seconds,
        }
    }
}

impl From<&Setting> for Ours {
    fn from(s: &Setting) -> Self {
        let label = s.knob.spec.to_string();
        Self {
            label,
            table_bytes: s.table_bytes,
            tables: count_tables(&s.knob.spec),
            build_seconds: s.build_seconds,
        }
    }
}

impl Ours {
    fn kb(&self) -> f64 {
        self.table_bytes as f64 / THESIS_KB
    }
}

/// Directions that an isotropic material's sampler has a table of its own for.
fn count_tables(spec: &SamplerSpec) -> Option<usize> {
    let cascade = spec.settings::<CascadeCdfSettings>().map(|s| s.tables);
    cascade.or_else(|| spec.settings::<AdaptiveDiscSettings>().map(|s| s.tables))
}

/// Cascade CDFs without compression, by size.
fn whole_cdfs<'a>(comparison: &'a Comparison, material: Option<&str>) -> Vec<&'a Setting> {
    let of = comparison
        .settings
        .iter()
        .find(|s| material.is_none_or(|m| s.material == m));
    let mut all: Vec<&Setting> = of.iter().flat_map(|s| &s.settings).collect();
    all.retain(|s| is_cascade(&s.knob.spec, |c| c.tolerance.is_none()));
    all.sort_by_key(|s| s.table_bytes);
    all
}

/// What of ours does what the thesis's method does.
fn counterpart(
    comparison: &Comparison,
    material: &MaterialComparison,
    method: &str,
) -> Option<Ours> {
    let curve = |of: &dyn Fn(&SamplerSpec) -> bool| {
        let brdf = material
            .curves
            .iter()
            .filter(|c| c.competitor.technique == Technique::Brdf);
        brdf.into_iter()
            .find(|c| of(&c.competitor.spec))
            .map(Ours::from)
    };
    match method {
        "uniform CDF" => whole_cdfs(comparison, Some(&material.material))
            .last()
            .map(|s| Ours::from(*s)),
        "compressed CDF" => curve(&|s| is_cascade(s, |c| c.tolerance.is_some())),
        "adaptive disc" => curve(&is_plain_disc),
        _ => curve(&|s| s.settings() == Some(&HalfVectorSettings::default())),
    }
}

/// Whether it is the thesis's own kind of adaptive disc.
pub(super) fn is_plain_disc(spec: &SamplerSpec) -> bool {
    spec.settings::<AdaptiveDiscSettings>()
        .is_some_and(|s| s.depth > 0 && s.leaves != LeafChoice::Warp)
}

/// Whether it is a cascade CDF of such settings.
fn is_cascade(spec: &SamplerSpec, matches: impl Fn(&CascadeCdfSettings) -> bool) -> bool {
    spec.settings().is_some_and(matches)
}

fn uniform_memory(comparison: &Comparison) -> Option<ThesisTable> {
    let whole = whole_cdfs(comparison, None);
    let mut sheet = Sheet::new(&[
        "thesis cells, θ × φ",
        "thesis KB",
        "thesis KB a table",
        "ours",
        "ours KB a table",
        "ratio",
    ]);
    for (theta, phi, kb) in thesis_uniform_memory() {
        let fine_enough = whole.iter().find(|s| {
            is_cascade(&s.knob.spec, |c| {
                c.theta_h >= theta as usize && c.phi_h >= phi as usize
            })
        });
        let Some(ours) = fine_enough.map(|s| Ours::from(*s)) else {
            continue;
        };
        let Some(tables) = ours.tables else {
            continue;
        };
        // Its tables are as many as a table has cells: nθ·nφ tables of nθ·(nφ + 1) doubles.
        let (theirs, each) = (kb / f64::from(theta * phi), ours.kb() / tables as f64);
        sheet.push(vec![
            format!("{theta} × {phi}"),
            format!("{kb:.0}"),
            figure(theirs),
            ours.label.clone(),
            figure(each),
            ratio(theirs, each),
        ]);
    }
    let note = "The thesis has a table for each of θ × φ directions of the viewer, each of θ × (φ + 1) numbers of 8 bytes; an isotropic \
                material needs none of the azimuths. So KB a table are compared, with those of our smallest uncompressed CDF that is at \
                least as fine in both angles. 1 KB is 1024 bytes, as in the thesis.";
    ThesisTable::new("Table 5.9: memory of CDFs without compression", note, sheet)
}

fn compressed(comparison: &Comparison) -> Option<ThesisTable> {
    let mut costs = Vec::new();
    for material in &comparison.materials {
        if let Some(thesis) = cost_rows(&material.material).compressed {
            costs.extend(CostRow::new(comparison, material, "compressed CDF", thesis));
        }
    }
    let note = format!(
        "The thesis compresses CDFs of 33792 KB with the Douglas–Peucker algorithm; ours are built compressed. {PER_TABLE}"
    );
    ThesisTable::new("Table 5.10: compressed CDFs", &note, cost_sheet(&costs))
}

/// Tables of the thesis's CDFs in tables 5.10 and 6.23: 16 polar angles times 32 azimuths.
const CDF_TABLES: f64 = 512.0;
/// Quadtrees of its discs, one a polar angle.
const DISC_TREES: f64 = 60.0;

/// What the ratios of costs are.
const PER_TABLE: &str = "Its CDFs are 512 tables, for 16 polar angles and 32 azimuths of the viewer, which isotropic materials don't \
                         need, and its discs 60 trees; ours have fewer tables. Ratios are therefore those of KB and seconds a \
                         table. 1 KB is 1024 bytes.";

const COSTS: [&str; 11] = [
    "material",
    "method",
    "ours",
    "thesis KB",
    "ours KB",
    "thesis KB a table",
    "ours KB a table",
    "ratio",
    "thesis s",
    "ours s",
    "ratio",
];

fn precomputation(comparison: &Comparison) -> Option<ThesisTable> {
    let mut costs = Vec::new();
    for material in &comparison.materials {
        for (method, thesis) in cost_rows(&material.material).precompute {
            costs.extend(CostRow::new(comparison, material, method, thesis));
            if method == "adaptive disc" {
                costs.extend(CostRow::new(comparison, material, NEW, thesis));
            }
        }
    }
    let mut sheet = cost_sheet(&costs);
    if !costs.is_empty() {
        push_published_means(&mut sheet);
    }
    let note = format!(
        "Build time in seconds, ours on all threads, and table memory. {PER_TABLE} The thesis has no half-vector \
         table; ours, one for all directions, is compared with the thesis's adaptive disc as a whole. Means are arithmetic, as the \
         thesis's."
    );
    ThesisTable::new("Table 6.23: precomputation and memory", &note, sheet)
}

/// What the thesis has nothing like: held against its adaptive disc.
const NEW: &str = "half-vector, compared with adaptive disc";

/// KB and seconds of a method, the thesis's and ours.
struct CostRow {
    material: String,
    method: &'static str,
    label: String,
    tables: Option<usize>,
    thesis: [f64; 2],
    ours: [f64; 2],
}

impl CostRow {
    /// The row of a material, if ours was measured.
    fn new(
        comparison: &Comparison,
        material: &MaterialComparison,
        method: &'static str,
        (kb, seconds): (f64, f64),
    ) -> Option<Self> {
        let ours = counterpart(comparison, material, method)?;
        Some(Self {
            material: material.material.clone(),
            method,
            tables: ours.tables,
            thesis: [kb, seconds],
            ours: [ours.kb(), ours.build_seconds],
            label: ours.label,
        })
    }

    /// Tables that the costs are divided by, the thesis's and ours: one and one where ours is a table for all directions.
    fn tables(&self) -> [f64; 2] {
        match self.tables {
            Some(ours) if self.method.ends_with("CDF") => [CDF_TABLES, ours as f64],
            Some(ours) => [DISC_TREES, ours as f64],
            None => [1.0, 1.0],
        }
    }

    /// Empty where ours is a table for all directions.
    fn figure_a_table(&self, kb: f64) -> String {
        match self.tables {
            Some(_) => figure(kb),
            None => String::new(),
        }
    }

    fn cells(&self) -> Vec<String> {
        let [theirs, ours] = self.tables();
        let [kb, seconds] = self.thesis;
        let each = [kb / theirs, self.ours[0] / ours];
        vec![
            self.material.clone(),
            self.method.into(),
            self.label.clone(),
            format!("{kb:.0}"),
            figure(self.ours[0]),
            self.figure_a_table(each[0]),
            self.figure_a_table(each[1]),
            ratio(each[0], each[1]),
            figure(seconds),
            figure(self.ours[1]),
            ratio(seconds / theirs, self.ours[1] / ours),
        ]
    }
}

/// The rows, and where there are several materials the arithmetic mean of each method over them.
fn cost_sheet(costs: &[CostRow]) -> Sheet {
    let mut sheet = Sheet::new(&COSTS);
    let mut methods: Vec<&'static str> = Vec::new();
    for row in costs {
        sheet.push(row.cells());
        if !methods.contains(&row.method) {
            methods.push(row.method);
        }
    }
    for method in methods {
        let rows: Vec<&CostRow> = costs.iter().filter(|row| row.method == method).collect();
        if rows.len() > 1 {
            sheet.push(mean(&rows).cells());
        }
    }
    sheet
}

fn mean(rows: &[&CostRow]) -> CostRow {
    let (mut thesis, mut ours) = ([0.0; 2], [0.0; 2]);
    for row in rows {
        for i in 0..2 {
            thesis[i] += row.thesis[i] / rows.len() as f64;
            ours[i] += row.ours[i] / rows.len() as f64;
        }
    }
    CostRow {
        material: format!("mean of {}", rows.len()),
        method: rows[0].method,
        label: rows[0].label.clone(),
        tables: rows[0].tables,
        thesis,
        ours,
    }
}

/// The thesis's means over its own eleven materials, its headline.
fn push_published_means(sheet: &mut Sheet) {
    for (method, (kb, seconds)) in cost_rows("average").precompute {
        let tables = if method.ends_with("CDF") {
            CDF_TABLES
        } else {
            DISC_TREES
        };
        let mut cells = vec![String::new(); COSTS.len()];
        cells[0] = "the thesis's mean of 11".into();
        cells[1] = method.into();
        cells[3] = format!("{kb:.0}");
        cells[5] = figure(kb / tables);
        cells[8] = figure(seconds);
        sheet.push(cells);
    }
}

/// A figure to three digits.
pub(super) fn figure(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 1.0 => format!("{v:.2}"),
        v if v >= 0.001 => format!("{v:.4}"),
        v => format!("{v:.1e}"),
    }
}

/// The thesis's over ours; nothing where ours is 0.
fn ratio(thesis: f64, ours: f64) -> String {
    if ours > 0.0 {
        figure(thesis / ours)
    } else {
        String::new()
    }
}
