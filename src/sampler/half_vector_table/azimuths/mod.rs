//! Half-vector tables for anisotropic materials: one for each of a few azimuths of `wo`.
//!
//! A `wo` between two azimuths is served by both, in proportion to nearness; the density is that of the mixture. Half vectors
//! keep their azimuth on the surface as far as the horizon allows ([`AzimuthShift`]). What the material's symmetry repeats is held once.

mod shift;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use self::shift::AzimuthShift;
use super::draw::pair::TablePair;
use super::draw::point_lanes::{LANES, PointLanes};
use super::draw::sample::{DrawTerms, TableView, raise_above_horizon};
use super::settings::HalfVectorSettings;
use super::table::HalfVectorTable;
use super::tables::Stored;
use super::tables::lookup::InterpolatedTable;
use crate::Result;
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::half_vector_chart::{ChartPoint, HalfVectorChart};
use crate::geometry::{Symmetry, unit_upper};
use crate::lanes::{Columns, UnitDirections};
use crate::sampler::Settings;
use crate::sampler::azimuth_knots::{AzimuthKnots, TurnedBrdf, azimuths_of_isotropic};
use crate::sampler::knots::split_unit;

/// A half-vector table for each of a few azimuths of `wo`.
///
/// See [`SamplerSpec`](crate::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct ByAzimuth {
    settings: HalfVectorSettings,
    azimuths: AzimuthKnots,
    tables: Vec<HalfVectorTable>,
}

/// A table about one azimuth, mixed for one polar angle of `wo`, and how far `wo` is turned from that azimuth.
#[derive(Clone, Copy)]
struct ShiftedTable<'a> {
    pair: TablePair<'a>,
    shift: AzimuthShift,
}

/// What serves one `wo`: the tables of the two azimuths about it.
#[derive(Clone, Copy)]
struct AzimuthPair<'a> {
    /// About `wo` among the azimuths that have tables.
    chart: HalfVectorChart,
    /// The mirror signs that bring `wo` there; the same bring `wi`.
    signs: Vec3,
    tables: [ShiftedTable<'a>; 2],
    /// Weight of the second table.
    weight: f64,
}

impl ByAzimuth {
    /// Tabulates the anisotropic `brdf` on the threads of the current pool; the result does not depend on their number. What
    /// is tabulated is [`HalfVectorSettings::for_anisotropic`].
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains, or a BRDF that is isotropic.
    pub fn build(brdf: &dyn Brdf, settings: HalfVectorSettings) -> Result<Self> {
        let symmetry = brdf.symmetry();
        if symmetry == Symmetry::Isotropic {
            return Err(azimuths_of_isotropic());
        }
        settings.check()?;
        let settings = settings.for_anisotropic();
        let count = settings.azimuths.unwrap_or(1);
        let table = HalfVectorSettings {
            azimuths: None,
            ..settings
        };
        let azimuths = AzimuthKnots::new(symmetry, Some(count));
        let tables = (0..count)
            .into_par_iter()
            .map(|k| {
                let turned = TurnedBrdf::new(brdf, azimuths.azimuth(k));
                HalfVectorTable::build(&turned, table)
            })
            .collect::<Result<_>>()?;
        Ok(Self::from_parts(settings, symmetry, tables))
    }

    /// Puts a sampler together from as many tables as the settings say.
    pub(super) fn from_parts(
        settings: HalfVectorSettings,
        symmetry: Symmetry,
        tables: Vec<HalfVectorTable>,
    ) -> Self {
        Self {
            settings,
            azimuths: AzimuthKnots::new(symmetry, Some(tables.len())),
            tables,
        }
    }

    pub(super) fn to_stored(&self) -> Vec<Stored> {
        self.tables.iter().map(HalfVectorTable::to_stored).collect()
    }

    /// The settings it was built with, the number of azimuths among them.
    pub fn settings(&self) -> &HalfVectorSettings {
        &self.settings
    }

    /// What serves `wo`, above the horizon and of unit length.
    fn pair(&self, wo: Vec3) -> AzimuthPair<'_> {
        // Step 1: wo among the azimuths that have tables, and the two about it.
        let near = self.azimuths.neighbours(wo);
        let chart = HalfVectorChart::new(near.wo);
        // Step 2: either table is used about wo as far from its own azimuth as wo is.
        let shifted = |k: usize, steps: f64| ShiftedTable {
            pair: self.tables[k].interpolate(&chart),
            shift: AzimuthShift::new(steps * self.azimuths.step()),
        };
        AzimuthPair {
            chart,
            signs: near.signs,
            tables: [
                shifted(near.first, near.weight),
                shifted(near.second, near.weight - 1.0),
            ],
            weight: near.weight,
        }
    }
}

impl<'a> ShiftedTable<'a> {
    /// The table about `wo`, azimuths being those of the table.
    #[inline(always)]
    fn view(&self, chart: HalfVectorChart) -> TableView<'a, TablePair<'a>> {
        TableView::from_pair(chart, self.pair)
    }

    /// The drawn direction, among the azimuths that have tables.
    #[inline(always)]
    fn direction(&self, chart: HalfVectorChart, terms: DrawTerms) -> Vec3 {
        let (cap, fraction) = self.view(chart).chart_coordinates(terms);
        let fraction = self
            .shift
            .to_surface(fraction, chart.max_quarter_tan_of_cap(cap));
        raise_above_horizon(chart.direction(cap, fraction))
    }

    /// The density at a point of the chart, of which `max_quarter_tan` is the unit of the azimuth fraction.
    #[inline(always)]
    fn density(&self, chart: HalfVectorChart, point: &ChartPoint, max_quarter_tan: f32) -> f32 {
        let view = self.view(chart);
        let (azimuth_fraction, slope) =
            self.shift.to_table(point.azimuth_fraction, max_quarter_tan);
        let shifted = ChartPoint {
            azimuth_fraction,
            ..*point
        };
        let terms = view.look_up_density(&shifted);
        (view.density(&shifted, terms) * slope).min(f32::MAX)
    }
}

impl AzimuthPair<'_> {
    /// The table that a point of the unit square chooses, and the point that is left to draw from it.
    #[inline(always)]
    fn choose_table(&self, u: Vec2) -> (usize, Vec2) {
        let (second, rest) = split_unit(f64::from(u.x), self.weight);
        let x = (rest as f32).min(1f32.next_down());
        (usize::from(second), Vec2::new(x, u.y))
    }

    /// The density of the mixture from those of both tables.
    #[inline(always)]
    fn mix(&self, [first, second]: [f32; 2]) -> f32 {
        (f64::from(first) * (1.0 - self.weight) + f64::from(second) * self.weight) as f32
    }

    /// The density of a direction among the azimuths that have tables.
    fn pdf(&self, wi: Vec3) -> f32 {
        let point = self.chart.locate(wi);
        let max_quarter_tan = self.chart.max_quarter_tan_of_cap(point.cap);
        self.mix(
            self.tables
                .map(|table| table.density(self.chart, &point, max_quarter_tan)),
        )
    }

    fn sample(&self, u: Vec2) -> DirectionSample {
        let (chosen, u) = self.choose_table(u);
        let table = &self.tables[chosen];
        let wi = table.direction(self.chart, table.view(self.chart).look_up_draw(u));
        DirectionSample {
            wi: wi * self.signs,
            pdf: self.pdf(wi),
        }
    }
}

impl DirectionSampler for ByAzimuth {
    /// Never fails for a `wo` above the horizon.
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        unit_upper(wo).map(|wo| self.pair(wo).sample(u))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        unit_upper(wo).zip(unit_upper(wi)).map_or(0.0, |(wo, wi)| {
            let pair = self.pair(wo);
            pair.pdf(wi * pair.signs)
        })
    }

    fn bytes(&self) -> usize {
        self.tables.iter().map(DirectionSampler::bytes).sum()
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        match wo {
            Wo::One(wo) => match unit_upper(wo) {
                Some(wo) => sample_one(&self.pair(wo), u, out),
                None => out.fill(None),
            },
            Wo::Each(wo) => sample_each(self, wo, u, out),
        }
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        match wo {
            Wo::One(wo) => match unit_upper(wo) {
                Some(wo) => pdf_one(&self.pair(wo), wi, out),
                None => out.fill(0.0),
            },
            Wo::Each(wo) => pdf_each(self, wo, wi, out),
        }
    }
}

// Batches: the functions of single calls, each over a block of lanes, so the same bits.

fn sample_one(pair: &AzimuthPair<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
    for (u, out) in u.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let draws = AzimuthDraws::new(|_| *pair, u);
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = Some(draws.get(lane, pair.signs));
        }
    }
}

fn sample_each(sampler: &ByAzimuth, wo: &[Vec3], u: &[Vec2], out: &mut [Option<DirectionSample>]) {
    for ((wo, u), out) in wo
        .chunks(LANES)
        .zip(u.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let pairs = AzimuthLanes::new(sampler, &wo, u.len());
        let draws = AzimuthDraws::new(|lane| pairs.get(lane), u);
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            let upper = wo.is_upper(lane);
            *out = upper.then(|| draws.get(lane, pairs.get(lane).signs));
        }
    }
}

fn pdf_one(pair: &AzimuthPair<'_>, wi: &[Vec3], out: &mut [f32]) {
    for (wi, out) in wi.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let wi = UnitDirections::<LANES>::load(wi);
        let pdfs = densities(|_| *pair, |lane| wi.get(lane) * pair.signs, out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = if wi.is_upper(lane) { pdfs[lane] } else { 0.0 };
        }
    }
}

fn pdf_each(sampler: &ByAzimuth, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    for ((wo, wi), out) in wo
        .chunks(LANES)
        .zip(wi.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let wi = UnitDirections::<LANES>::load(wi);
        let pairs = AzimuthLanes::new(sampler, &wo, out.len());
        let folded = |lane: usize| wi.get(lane) * pairs.get(lane).signs;
        let pdfs = densities(|lane| pairs.get(lane), folded, out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            let upper = wo.is_upper(lane) & wi.is_upper(lane);
            *out = if upper { pdfs[lane] } else { 0.0 };
        }
    }
}

/// What serves the `wo` of each lane.
struct AzimuthLanes<'a> {
    charts: Columns<f32, 8, LANES>,
    signs: Columns<f32, 3, LANES>,
    tables: [[ShiftedTable<'a>; LANES]; 2],
    weight: [f64; LANES],
}

impl<'a> AzimuthLanes<'a> {
    /// For the first `count` lanes, at least one.
    fn new(sampler: &'a ByAzimuth, wo: &UnitDirections<LANES>, count: usize) -> Self {
        let first = sampler.pair(wo.get(0));
        let mut pairs = Self {
            charts: Columns::splat(first.chart.to_array()),
            signs: Columns::splat(first.signs.to_array()),
            tables: first.tables.map(|table| [table; LANES]),
            weight: [first.weight; LANES],
        };
        for lane in 1..count.min(LANES) {
            let pair = sampler.pair(wo.get(lane));
            pairs.charts.set(lane, pair.chart.to_array());
            pairs.signs.set(lane, pair.signs.to_array());
            pairs.tables[0][lane] = pair.tables[0];
            pairs.tables[1][lane] = pair.tables[1];
            pairs.weight[lane] = pair.weight;
        }
        pairs
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> AzimuthPair<'a> {
        AzimuthPair {
            chart: HalfVectorChart::from_array(self.charts.get(lane)),
            signs: self.signs.get(lane).into(),
            tables: [self.tables[0][lane], self.tables[1][lane]],
            weight: self.weight[lane],
        }
    }
}

/// Directions drawn, among the azimuths that have tables, and their densities.
struct AzimuthDraws {
    wi: Columns<f32, 3, LANES>,
    pdf: [f32; LANES],
}

impl AzimuthDraws {
    #[inline(always)]
    fn new<'a>(pair: impl Fn(usize) -> AzimuthPair<'a>, u: &[Vec2]) -> Self {
        let count = u.len().min(LANES);
        // Choose a table, and in it a row: a search waits for each of its steps, but alone in a loop many searches overlap.
        let mut chosen = [0; LANES];
        let mut rows = [(0, 0.0); LANES];
        for (lane, &u) in u[..count].iter().enumerate() {
            let pair = pair(lane);
            let (table, left) = pair.choose_table(u);
            let (row, fraction) = pair.tables[table].pair.find_row(left.x);
            chosen[lane] = table;
            rows[lane] = (row.index, fraction);
        }
        // Look up what the row and the azimuth within it hold.
        let mut terms = Columns::<f32, 9, LANES>::splat([0.0; 9]);
        for lane in 0..count {
            let pair = pair(lane);
            let view = pair.tables[chosen[lane]].view(pair.chart);
            let (row, fraction) = rows[lane];
            let found = view.look_up_draw_in_row(row, fraction, u[lane].y);
            terms.set(lane, found.to_array());
        }
        // Arithmetic from there to a direction.
        let mut wi = Columns::splat([0.0; 3]);
        for (lane, &table) in chosen[..count].iter().enumerate() {
            let pair = pair(lane);
            let terms = DrawTerms::from_array(terms.get(lane));
            let direction = pair.tables[table].direction(pair.chart, terms);
            wi.set(lane, direction.to_array());
        }
        let pdf = densities(pair, |lane| wi.get(lane).into(), count);
        Self { wi, pdf }
    }

    /// The draw of a lane on the surface.
    #[inline(always)]
    fn get(&self, lane: usize, signs: Vec3) -> DirectionSample {
        DirectionSample {
            wi: Vec3::from(self.wi.get(lane)) * signs,
            pdf: self.pdf[lane],
        }
    }
}

/// Densities of the first `count` of `wi`, among the azimuths that have tables.
#[inline(always)]
fn densities<'a>(
    pair: impl Fn(usize) -> AzimuthPair<'a>,
    wi: impl Fn(usize) -> Vec3,
    count: usize,
) -> [f32; LANES] {
    let count = count.min(LANES);
    // Arithmetic from a direction to its point in the chart.
    let mut points = PointLanes::new();
    let mut max_quarter_tans = [0.0; LANES];
    for (lane, max_quarter_tan) in max_quarter_tans[..count].iter_mut().enumerate() {
        let chart = pair(lane).chart;
        let point = chart.locate(wi(lane));
        *max_quarter_tan = chart.max_quarter_tan_of_cap(point.cap);
        points.set(lane, point);
    }
    // The density of either table there.
    let mut both = [[0.0; 2]; LANES];
    for lane in 0..count {
        let pair = pair(lane);
        let point = points.get(lane);
        for (density, table) in both[lane].iter_mut().zip(&pair.tables) {
            *density = table.density(pair.chart, &point, max_quarter_tans[lane]);
        }
    }
    let mut pdf = [0.0; LANES];
    for (lane, pdf) in pdf[..count].iter_mut().enumerate() {
        *pdf = pair(lane).mix(both[lane]);
    }
    pdf
}
