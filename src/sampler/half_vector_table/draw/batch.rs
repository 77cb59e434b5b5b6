//! Batches of draws and densities: the steps of [`super::sample`], each over a block of lanes.
//!
//! Lookups of many lanes overlap, and arithmetic over columns becomes vector code. The functions are those of single calls, so
//! the bits are, too.

use fearless_simd::{Level, dispatch};
use glam::{Vec2, Vec3};

use super::super::tables::IndexedTables;
use super::super::tables::lookup::{AzimuthSegment, InterpolatedRow, InterpolatedTable};
use super::pair::TablePair;
use super::pair_lanes::PairLanes;
use super::point_lanes::{LANES, PointLanes};
use super::sample::{DensityTerms, DrawTerms, TableView};
use crate::batch::Wo;
use crate::direction_sampler::DirectionSample;
use crate::geometry::half_vector_chart::{HalfVectorChart, PARTS};
use crate::geometry::unit_upper;
use crate::lanes::{Columns, UnitDirections};

/// Draws about one `wo` that pay for mixing the two tables beforehand.
const PREMIX_FROM: usize = 256;

/// A draw from each of `u`; the slices are of one length.
pub(in crate::sampler) fn sample_batch(
    tables: &IndexedTables,
    wo: Wo<'_>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => sample_one_wo(&TableView::new(tables, HalfVectorChart::new(wo)), u, out),
            None => out.fill(None),
        },
        Wo::Each(wo) => sample_each_wo(tables, wo, u, out),
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
    dispatch!(Level::new(), _ => sample_view_blocks(view, u, out));
}

#[inline(always)]
fn sample_view_blocks<M: InterpolatedTable + Copy>(
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
    tables: &IndexedTables,
    wo: &[Vec3],
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    dispatch!(Level::new(), _ => sample_blocks(tables, wo, u, out));
}

#[inline(always)]
fn sample_blocks(
    tables: &IndexedTables,
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
        let draws = PairLanes::new(tables, &wo).draw(u);
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = wo.is_upper(lane).then(|| draws.get(lane));
        }
    }
}

/// The density of each of `wi`; the slices are of one length.
pub(in crate::sampler) fn pdf_batch(
    tables: &IndexedTables,
    wo: Wo<'_>,
    wi: &[Vec3],
    out: &mut [f32],
) {
    match wo {
        Wo::One(wo) => match unit_upper(wo) {
            Some(wo) => pdf_one_wo(&TableView::new(tables, HalfVectorChart::new(wo)), wi, out),
            None => out.fill(0.0),
        },
        Wo::Each(wo) => pdf_each_wo(tables, wo, wi, out),
    }
}

fn pdf_one_wo(view: &TableView<TablePair>, wi: &[Vec3], out: &mut [f32]) {
    dispatch!(Level::new(), _ => pdf_view_blocks(view, wi, out));
}

#[inline(always)]
fn pdf_view_blocks(view: &TableView<TablePair>, wi: &[Vec3], out: &mut [f32]) {
    for (wi, out) in wi.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let wi = UnitDirections::load(wi);
        let pdfs = densities(|_| *view, wi.columns(), out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            *out = if wi.is_upper(lane) { pdfs[lane] } else { 0.0 };
        }
    }
}

fn pdf_each_wo(tables: &IndexedTables, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    dispatch!(Level::new(), _ => pdf_blocks(tables, wo, wi, out));
}

#[inline(always)]
fn pdf_blocks(tables: &IndexedTables, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
    for ((wo, wi), out) in wo
        .chunks(LANES)
        .zip(wi.chunks(LANES))
        .zip(out.chunks_mut(LANES))
    {
        let wo = UnitDirections::load(wo);
        let wi = UnitDirections::load(wi);
        let pdfs = PairLanes::new(tables, &wo).densities(wi.columns(), out.len());
        for (lane, out) in out.iter_mut().enumerate().take(LANES) {
            let upper = wo.is_upper(lane) & wi.is_upper(lane);
            *out = if upper { pdfs[lane] } else { 0.0 };
        }
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

/// A pair of tables mixed beforehand, for many draws about one `wo`: that halves the time of a draw and takes as long as some
/// hundred draws (`cargo bench --bench sample`). It has room for `NODES` nodes, on the stack, as batches allocate nothing.
#[derive(Clone, Debug)]
pub struct PremixedTable<const NODES: usize> {
    row_count: usize,
    segments: usize,
    /// The first row that the guide's cell can mean.
    guide: [u8; GUIDE],
    rows: [InterpolatedRow; PARTS],
    slopes: [f32; PARTS],
    /// `[row, node]`.
    nodes: [f32; NODES],
    /// `[row, segment]`: sums up to and with each.
    sums: [u32; NODES],
}

/// Cells of the guide; a power of two.
const GUIDE: usize = 256;
const GUIDE_SHIFT: u32 = u32::BITS - GUIDE.trailing_zeros();

impl<const NODES: usize> PremixedTable<NODES> {
    /// Mixes a pair of tables that have at most `NODES` nodes.
    pub fn new(pair: &TablePair) -> Self {
        let mut mixed = Self {
            row_count: pair.tables.row_count(),
            segments: pair.segments(),
            guide: [0; GUIDE],
            rows: [InterpolatedRow::default(); PARTS],
            slopes: [0.0; PARTS],
            nodes: [0.0; NODES],
            sums: [0; NODES],
        };
        for row in 0..mixed.row_count {
            mixed.rows[row] = pair.row(row);
            mixed.slopes[row] = pair.slope(row);
            mixed.mix_row(pair, row);
        }
        mixed.fill_guide();
        mixed
    }

    /// Nodes and sums of a row.
    fn mix_row(&mut self, pair: &TablePair, row: usize) {
        let (first, second) = pair.nodes(row);
        let nodes = &mut self.nodes[row * (self.segments + 1)..][..self.segments + 1];
        let sums = &mut self.sums[row * self.segments..][..self.segments];
        let mut last = pair.mix(first[0], second[0]);
        nodes[0] = last as f32;
        let mut sum = 0;
        for segment in 0..self.segments {
            let node = pair.mix(first[segment + 1], second[segment + 1]);
            nodes[segment + 1] = node as f32;
            sum += last + node;
            sums[segment] = sum;
            last = node;
        }
    }

    fn fill_guide(&mut self) {
        let mut row = 0;
        for (cell, first) in self.guide.iter_mut().enumerate() {
            let target = (cell as u32) << GUIDE_SHIFT;
            while row + 1 < self.row_count && self.rows[row].end() <= target {
                row += 1;
            }
            *first = row as u8;
        }
    }
}

impl<const NODES: usize> InterpolatedTable for &PremixedTable<NODES> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.segments
    }

    #[inline(always)]
    fn find_row_index(&self, target: u32) -> usize {
        let mut row = usize::from(self.guide[(target >> GUIDE_SHIFT) as usize]);
        while row + 1 < self.row_count && self.rows[row].end() <= target {
            row += 1;
        }
        row
    }

    #[inline(always)]
    fn row(&self, index: usize) -> InterpolatedRow {
        self.rows[index]
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        self.slopes[row]
    }

    #[inline(always)]
    fn find_segment_index(&self, row: usize, target: u32) -> (usize, u32) {
        let sums = &self.sums[row * self.segments..][..self.segments];
        let mut passed = 0u32;
        for sum in &sums[..self.segments - 1] {
            passed += u32::from(*sum <= target);
        }
        let index = passed as usize;
        (index, if index > 0 { sums[index - 1] } else { 0 })
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> AzimuthSegment {
        let nodes = &self.nodes[row * (self.segments + 1) + index..][..2];
        AzimuthSegment {
            index: index as u32 as f32,
            low: nodes[0],
            high: nodes[1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{HalfVectorSettings, HalfVectorTable};
    use super::*;
    use crate::geometry::spherical;
    use crate::material::merl::{LookupRule, MerlBrdf, decode_embedded};
    use crate::points::Stream;

    /// What is compiled for the oldest processor and what is compiled for this one give the same bits.
    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let table = std::sync::Arc::new(decode_embedded("nickel").unwrap());
        let brdf = MerlBrdf::new(table, LookupRule::Floor);
        for (_, settings) in &HalfVectorSettings::PRESETS[..6] {
            let table = HalfVectorTable::build(&brdf, *settings).unwrap();
            let tables = table.indexed();
            let mut stream = Stream::new(5);
            let (mut wo, mut u) = (Vec::new(), Vec::new());
            for _ in 0..1000 {
                let (theta, phi) = (stream.next_f64() * 1.57, stream.next_f64() * 6.2);
                wo.push(spherical(theta, phi).as_vec3());
                u.push(Vec2::new(stream.next_f32(), stream.next_f32()));
            }
            let (mut oldest, mut newest) = (vec![None; 1000], vec![None; 1000]);
            sample_blocks(tables, &wo, &u, &mut oldest);
            sample_each_wo(tables, &wo, &u, &mut newest);
            assert_eq!(oldest, newest);
            let mut wi = Vec::new();
            for draw in &oldest {
                wi.push(draw.unwrap().wi);
            }
            wi.rotate_left(1);
            let (mut oldest, mut newest) = (vec![0.0; 1000], vec![0.0; 1000]);
            pdf_blocks(tables, &wo, &wi, &mut oldest);
            pdf_each_wo(tables, &wo, &wi, &mut newest);
            assert_eq!(oldest, newest);
        }
    }
}
