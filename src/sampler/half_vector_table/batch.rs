//! Batches of draws and densities: the steps of [`super::sample`], each over a block of lanes.
//!
//! Lookups of many lanes overlap, and arithmetic over columns becomes vector code. The functions are those of single calls, so
//! the bits are, too.

use glam::{Vec2, Vec3};

use super::HalfVectorTable;
use super::lookup::{InterpolatedTable, PremixedTable};
use super::sample::{DensityTerms, DrawTerms, TableView};
use super::tables::TablePair;
use crate::batch::Wo;
use crate::direction_sampler::DirectionSample;
use crate::geometry::half_vector_chart::{ChartPoint, HalfVectorChart};
use crate::geometry::unit_upper;
use crate::lanes::{Columns, UnitDirections};

/// Lanes that go through the stages of a batch together: their columns fit the fastest cache.
pub(in crate::sampler) const LANES: usize = 64;

/// Draws about one `wo` that pay for mixing the two tables beforehand.
const PREMIX_FROM: usize = 256;

/// A draw from each of `u`; the slices are of one length.
pub(super) fn sample_batch(
    table: &HalfVectorTable,
    wo: Wo<'_>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => sample_one_wo(&table.view(HalfVectorChart::new(wo)), u, out),
            None => out.fill(None),
        },
        Wo::Each(wo) => sample_each_wo(table, wo, u, out),
    }
}

/// Draws about one `wo`, from premixed tables if the draws are many and the tables of an ordinary size.
fn sample_one_wo(view: &TableView<TablePair>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
    if u.len() < PREMIX_FROM {
        return sample_view(*view, u, out);
    }
    match view.interpolated.node_count() {
        0..=1024 => sample_premixed::<1024>(view, u, out),
        1025..=4096 => sample_premixed::<4096>(view, u, out),
        _ => sample_view(*view, u, out),
    }
}

/// Never inlined, so that the stack of other draws does not hold premixed tables.
#[inline(never)]
fn sample_premixed<const NODES: usize>(
    view: &TableView<TablePair>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    let premixed = PremixedTable::<NODES>::new(&view.interpolated);
    sample_view(view.with_premixed(&premixed), u, out);
}

fn sample_view<M: InterpolatedTable + Copy>(
    view: TableView<M>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    for (u, out) in u.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let draws = DrawLanes::new(|_| view, u);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = Some(draws.get(lane));
        }
    }
}

fn sample_each_wo(
    table: &HalfVectorTable,
    wo: &[Vec3],
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    for ((wo, u), out) in wo
        .chunks(LANES)
        .zip(u.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let views = ViewLanes::new(table, &wo, out.len());
        let draws = DrawLanes::new(|lane| views.get(lane), u);
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = wo.is_upper(lane).then(|| draws.get(lane));
        }
    }
}

/// The density of each of `wi`; the slices are of one length.
pub(super) fn pdf_batch(table: &HalfVectorTable, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => pdf_one_wo(&table.view(HalfVectorChart::new(wo)), wi, out),
            None => out.fill(0.0),
        },
        Wo::Each(wo) => pdf_each_wo(table, wo, wi, out),
    }
}

fn pdf_one_wo(view: &TableView<TablePair>, wi: &[Vec3], out: &mut [f32]) {
    for (wi, out) in wi.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let wi = UnitDirections::load(wi);
        let pdfs = densities(|_| *view, wi.columns(), out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = if wi.is_upper(lane) { pdfs[lane] } else { 0.0 };
        }
    }
}

fn pdf_each_wo(table: &HalfVectorTable, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    for ((wo, wi), out) in wo
        .chunks(LANES)
        .zip(wi.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let wi = UnitDirections::load(wi);
        let views = ViewLanes::new(table, &wo, out.len());
        let pdfs = densities(|lane| views.get(lane), wi.columns(), out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            let upper = wo.is_upper(lane) & wi.is_upper(lane);
            *out = if upper { pdfs[lane] } else { 0.0 };
        }
    }
}

/// The table about the `wo` of each lane.
struct ViewLanes<'a> {
    table: &'a HalfVectorTable,
    charts: Columns<f32, 8, LANES>,
    pairs: [TablePair<'a>; LANES],
}

impl<'a> ViewLanes<'a> {
    /// For the first `count` lanes, at least one.
    fn new(table: &'a HalfVectorTable, wo: &UnitDirections<LANES>, count: usize) -> Self {
        // Steps 1 and 2: the charts.
        let mut charts = Columns::splat([0.0; 8]);
        for lane in 0..count.min(LANES) {
            let chart = HalfVectorChart::new(wo.get(lane));
            charts.set(lane, chart.to_array());
        }
        // Step 4: the tables about each polar angle.
        let pair = |lane| table.interpolate(&HalfVectorChart::from_array(charts.get(lane)));
        let mut pairs = [pair(0); LANES];
        for (lane, out) in pairs.iter_mut().enumerate().take(count).skip(1) {
            *out = pair(lane);
        }
        Self {
            table,
            charts,
            pairs,
        }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> TableView<'a, TablePair<'a>> {
        let chart = HalfVectorChart::from_array(self.charts.get(lane));
        TableView::new(self.table, chart, self.pairs[lane])
    }
}

/// Directions drawn and their densities.
struct DrawLanes {
    wi: Columns<f32, 3, LANES>,
    pdf: [f32; LANES],
}

impl DrawLanes {
    /// A draw in each lane from the view of that lane.
    #[inline(always)]
    fn new<'a, M: InterpolatedTable + 'a>(
        view: impl Fn(usize) -> TableView<'a, M>,
        u: &[Vec2],
    ) -> Self {
        let count = u.len().min(LANES);
        // Steps 7 and 8, the row. A search waits for each of its steps: alone in a loop, many searches overlap.
        let mut rows = [(0, 0.0); LANES];
        for lane in 0..count {
            let (row, fraction) = view(lane).interpolated.find_row(u[lane].x);
            rows[lane] = (row.index, fraction);
        }
        // Steps 5 and 10 to 13, the segment.
        let mut terms = Columns::<f32, 9, LANES>::splat([0.0; 9]);
        for lane in 0..count {
            let (row, fraction) = rows[lane];
            let found = view(lane).look_up_draw_in_row(row, fraction, u[lane].y);
            terms.set(lane, found.to_array());
        }
        // Steps 8 to 17, arithmetic.
        let mut wi = Columns::splat([0.0; 3]);
        for lane in 0..count {
            let terms = DrawTerms::from_array(terms.get(lane));
            wi.set(lane, view(lane).direction(terms).to_array());
        }
        let pdf = densities(view, &wi, count);
        Self { wi, pdf }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> DirectionSample {
        DirectionSample {
            wi: self.wi.get(lane).into(),
            pdf: self.pdf[lane],
        }
    }
}

/// Points of charts, in columns.
pub(in crate::sampler) struct PointLanes {
    numbers: Columns<f32, 3, LANES>,
    tan2_theta_h: [f64; LANES],
}

impl PointLanes {
    pub(in crate::sampler) fn new() -> Self {
        Self {
            numbers: Columns::splat([0.0; 3]),
            tan2_theta_h: [0.0; LANES],
        }
    }

    #[inline(always)]
    pub(in crate::sampler) fn get(&self, lane: usize) -> ChartPoint {
        let [cap, azimuth_fraction, jacobian] = self.numbers.get(lane);
        ChartPoint {
            cap,
            tan2_theta_h: self.tan2_theta_h[lane],
            azimuth_fraction,
            jacobian,
        }
    }

    #[inline(always)]
    pub(in crate::sampler) fn set(&mut self, lane: usize, point: ChartPoint) {
        let numbers = [point.cap, point.azimuth_fraction, point.jacobian];
        self.numbers.set(lane, numbers);
        self.tan2_theta_h[lane] = point.tan2_theta_h;
    }
}

/// Densities of the first `count` of `wi`, each by the view of its lane.
#[inline(always)]
fn densities<'a, M: InterpolatedTable + 'a>(
    view: impl Fn(usize) -> TableView<'a, M>,
    wi: &Columns<f32, 3, LANES>,
    count: usize,
) -> [f32; LANES] {
    let count = count.min(LANES);
    // Steps 18 to 20, arithmetic.
    let mut points = PointLanes::new();
    for lane in 0..count {
        points.set(lane, view(lane).chart.locate(wi.get(lane).into()));
    }
    // Steps 19 and 21, the row and the segment.
    let mut terms = Columns::<f32, 8, LANES>::splat([0.0; 8]);
    for lane in 0..count {
        let found = view(lane).look_up_density(&points.get(lane));
        terms.set(lane, found.to_array());
    }
    // Step 22, arithmetic.
    let mut pdf = [0.0; LANES];
    for (lane, pdf) in pdf[..count].iter_mut().enumerate() {
        let terms = DensityTerms::from_array(terms.get(lane));
        *pdf = view(lane).density(&points.get(lane), terms);
    }
    pdf
}
