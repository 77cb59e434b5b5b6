//! Draws and densities of many lanes, each about its own `wo`: the steps of [`super::sample`], each over a block of lanes.
//!
//! Loops are of two kinds. Some look things up, lane after lane, and leave integers in columns; their reads overlap, as no lane
//! waits for another. The others mix, compare and compute over whole columns, and become vector code. Every number is that
//! of the single call, to the bit.
#![allow(clippy::needless_range_loop)] // Several columns are read at the same lane.

use glam::Vec2;

use super::super::tables::IndexedTables;
use super::super::tables::lookup::{AzimuthSegment, ROW_UNIT, row_target, segment_target};
use super::super::tables::packed::{BLOCK, PackedPair};
use super::point_lanes::{LANES, PointLanes};
use super::sample::{DensityTerms, DrawTerms, density, unfold, unit_azimuth};
use crate::direction_sampler::DirectionSample;
use crate::geometry::half_vector_chart::{ChartEdge, HalfVectorChart, MERL_PARTS};
use crate::geometry::merl_axes::AxisBins;
use crate::lanes::{Columns, UnitDirections};

/// The tables about the `wo` of each lane.
pub(super) struct PairLanes<'a> {
    tables: &'a IndexedTables,
    charts: Columns<f32, 8, LANES>,
    /// Numbers of the two tables.
    first: [u32; LANES],
    second: [u32; LANES],
    /// Weight of the second.
    weight: [u32; LANES],
}

/// Directions drawn and their densities.
pub(super) struct PairDraws {
    wi: Columns<f32, 3, LANES>,
    pdf: [f32; LANES],
}

impl PairDraws {
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> DirectionSample {
        DirectionSample {
            wi: self.wi.get(lane).into(),
            pdf: self.pdf[lane],
        }
    }
}

impl<'a> PairLanes<'a> {
    #[inline(always)]
    pub(super) fn new(tables: &'a IndexedTables, wo: &UnitDirections<LANES>) -> Self {
        // Steps 1 and 2: the charts.
        let mut charts = Columns::splat([0.0; 8]);
        for lane in 0..LANES {
            let chart = HalfVectorChart::new(wo.get(lane));
            charts.set(lane, chart.to_array());
        }
        // Step 4: b = number of cosines above cosO.
        let cos_o = charts.column(HalfVectorChart::COS_O);
        let mut above = [0u32; LANES];
        for &cosine in tables.cosines() {
            for lane in 0..LANES {
                above[lane] += u32::from(cosine > cos_o[lane]);
            }
        }
        // Step 4: the two tables, and the weight of the second.
        let (mut first, mut second, mut weight) = ([0; LANES], [0; LANES], [0; LANES]);
        for lane in 0..LANES {
            let pair = tables.pair_at(above[lane] as usize, cos_o[lane]);
            [first[lane], second[lane]] = pair.numbers();
            weight[lane] = pair.weight();
        }
        Self {
            tables,
            charts,
            first,
            second,
            weight,
        }
    }

    #[inline(always)]
    fn chart(&self, lane: usize) -> HalfVectorChart {
        HalfVectorChart::from_array(self.charts.get(lane))
    }

    /// A draw in each of the first lanes from its point of the unit square.
    #[inline(always)]
    pub(super) fn draw(&self, u: &[Vec2]) -> PairDraws {
        let count = u.len().min(LANES);
        let tables = self.tables;
        // Step 7: t = ⌊u1·65535·65536⌋. Step 10: v = u2 or |2·u2 − 1|, and its side. Step 11: t = ⌊v·65534·65536⌋.
        let mut row_targets = [0u32; LANES];
        let mut targets = [0u32; LANES];
        let mut sides = [1.0f32; LANES];
        for lane in 0..count {
            row_targets[lane] = row_target(u[lane].x);
            let (v, side) = unfold(u[lane].y, tables.fold());
            sides[lane] = side;
            targets[lane] = segment_target(v);
        }
        // Step 7: the row in which the probability passes t.
        let mut rows = [0u32; LANES];
        let mut row_below = [0u32; LANES];
        let mut row_end = [1u32; LANES];
        let search = tables.row_search();
        for lane in 0..count {
            let found = search.find(
                [self.first[lane], self.second[lane]],
                self.weight[lane],
                row_targets[lane],
            );
            rows[lane] = found.index;
            row_below[lane] = found.below;
            row_end[lane] = found.end;
        }
        // Step 12: the block of segments in which the sum passes t, the sum below it, and the nodes at its segments' ends.
        let mut blocks = [0u32; LANES];
        let mut below = [0u32; LANES];
        let mut nodes =
            Columns::<PackedPair, { BLOCK + 1 }, LANES>::splat([PackedPair::default(); BLOCK + 1]);
        let records = tables.records();
        for lane in 0..count {
            let pair = [self.first[lane], self.second[lane]];
            let record = records.pair(rows[lane], pair);
            let (block, sum) = record.find_block(self.weight[lane], targets[lane]);
            blocks[lane] = block;
            below[lane] = sum;
            nodes.set(lane, record.block_nodes(block));
        }
        let mut terms = self.find_segments(&blocks, &below, &nodes, &targets);
        // Step 8: x = (t − to(r − 1))/mass(r).
        for lane in 0..LANES {
            let mass = row_end[lane] - row_below[lane];
            let fraction = row_targets[lane].saturating_sub(row_below[lane]) as f32 / mass as f32;
            terms.column_mut(3)[lane] = fraction.min(1.0);
        }
        *terms.column_mut(8) = sides;
        // Step 5: the spans of the rows and their slopes.
        let slopes = tables.slopes();
        let mut edges = EdgeLanes::new();
        let mut packed = [PackedPair::default(); LANES];
        for lane in 0..count {
            edges.set(lane, tables.edges(rows[lane] as usize));
            packed[lane] = slopes.pair(rows[lane], [self.first[lane], self.second[lane]]);
        }
        let (low, width) = edges.spans(self.charts.column(HalfVectorChart::CAP_MAX));
        *terms.column_mut(0) = low;
        *terms.column_mut(1) = width;
        for lane in 0..LANES {
            terms.column_mut(2)[lane] = packed[lane].mix_slopes(self.weight[lane]);
        }
        // Steps 8 to 17, arithmetic.
        let per_segment = tables.per_segment();
        let mut wi = Columns::splat([0.0; 3]);
        for lane in 0..LANES {
            let found = DrawTerms::from_array(terms.get(lane));
            let direction = found.direction(&self.chart(lane), per_segment, tables.fold());
            wi.set(lane, direction.to_array());
        }
        let pdf = self.densities(&wi, count);
        PairDraws { wi, pdf }
    }

    /// Step 12, fine: the segment of a block in which the sum passes the target; terms 4 to 7 of a draw.
    #[inline(always)]
    fn find_segments(
        &self,
        blocks: &[u32; LANES],
        below: &[u32; LANES],
        nodes: &Columns<PackedPair, { BLOCK + 1 }, LANES>,
        targets: &[u32; LANES],
    ) -> Columns<f32, 9, LANES> {
        let segments = self.tables.segments as u32;
        let mut terms = Columns::<f32, 9, LANES>::splat([0.0; 9]);
        for lane in 0..LANES {
            let start = BLOCK as u32 * blocks[lane];
            let mut index = start;
            let mut before = below[lane];
            let mut sum = before;
            let mut last = nodes.column(0)[lane].mix(self.weight[lane]);
            let mut next = nodes.column(1)[lane].mix(self.weight[lane]);
            let (mut low, mut high) = (last, next);
            for k in 1..BLOCK {
                // The sum up to the end of segment k − 1 of the block; what would pass the row's end is not counted.
                sum = sum.wrapping_add(last).wrapping_add(next);
                last = next;
                next = nodes.column(k + 1)[lane].mix(self.weight[lane]);
                let passed = (sum <= targets[lane]) & (start + (k as u32) < segments);
                index += u32::from(passed);
                before = if passed { sum } else { before };
                low = if passed { last } else { low };
                high = if passed { next } else { high };
            }
            terms.column_mut(4)[lane] = index as i32 as f32;
            terms.column_mut(5)[lane] = low as f32;
            terms.column_mut(6)[lane] = high as f32;
            terms.column_mut(7)[lane] = targets[lane].saturating_sub(before) as f32;
        }
        terms
    }

    /// Densities of the first `count` of `wi`.
    #[inline(always)]
    pub(super) fn densities(&self, wi: &Columns<f32, 3, LANES>, count: usize) -> [f32; LANES] {
        let count = count.min(LANES);
        let tables = self.tables;
        // Steps 18 to 20, arithmetic.
        let mut points = PointLanes::new();
        for lane in 0..LANES {
            points.set(lane, self.chart(lane).locate(wi.get(lane).into()));
        }
        // Step 19: the part beyond MERL's bins. Step 21: y = (β + 1)/2, or |β| if folded, its segment, and the position in it.
        let segments = tables.segments as f32;
        let mut upper_parts = [0u32; LANES];
        let mut indices = [0u32; LANES];
        let mut positions = [0.0f32; LANES];
        for lane in 0..LANES {
            let point = points.get(lane);
            upper_parts[lane] = self.chart(lane).find_upper_part(&point) as u32;
            let coordinate = unit_azimuth(point.azimuth_fraction, tables.fold()) * segments;
            let index = (coordinate as i32 as u32).min(tables.segments as u32 - 1);
            indices[lane] = index;
            positions[lane] = coordinate - index as i32 as f32;
        }
        // Step 19: the row. Then what the tables say of it and of the segment.
        let bins = &AxisBins::get().theta_h;
        let (search, records, slopes) = (tables.row_search(), tables.records(), tables.slopes());
        let mut edges = EdgeLanes::new();
        let mut ends = Columns::<PackedPair, 2, LANES>::splat([PackedPair::default(); 2]);
        let mut nodes = Columns::<PackedPair, 2, LANES>::splat([PackedPair::default(); 2]);
        let mut packed_slopes = [PackedPair::default(); LANES];
        for lane in 0..count {
            let bin = bins.bin(points.tan2_theta_h(lane));
            let part = if bin < MERL_PARTS {
                bin
            } else {
                upper_parts[lane] as usize
            };
            let row = tables.row_of_part(part);
            let pair = [self.first[lane], self.second[lane]];
            edges.set(lane, tables.edges(row));
            ends.set(lane, search.ends(row as u32, pair));
            packed_slopes[lane] = slopes.pair(row as u32, pair);
            nodes.set(
                lane,
                records.pair(row as u32, pair).segment_nodes(indices[lane]),
            );
        }
        let (low, width) = edges.spans(self.charts.column(HalfVectorChart::CAP_MAX));
        // Step 22, arithmetic.
        let unit = tables.density_unit();
        let mut pdf = [0.0; LANES];
        for lane in 0..LANES {
            let weight = self.weight[lane];
            let below = ends.column(0)[lane].mix(weight);
            let mass = ends.column(1)[lane].mix(weight).wrapping_sub(below);
            let terms = DensityTerms {
                low: low[lane],
                width: width[lane],
                slope: packed_slopes[lane].mix_slopes(weight),
                mass: mass as f32 * ROW_UNIT,
                segment: AzimuthSegment {
                    index: 0.0,
                    low: nodes.column(0)[lane].mix(weight) as f32,
                    high: nodes.column(1)[lane].mix(weight) as f32,
                },
                position: positions[lane],
            };
            pdf[lane] = density(&points.get(lane), &terms, unit);
        }
        pdf
    }
}

/// Edges of rows, in columns.
struct EdgeLanes(Columns<f32, 4, LANES>);

impl EdgeLanes {
    #[inline(always)]
    fn new() -> Self {
        Self(Columns::splat([0.0, 0.0, 1.0, 0.0]))
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, [low, high]: [ChartEdge; 2]) {
        let numbers = [low.fixed(), low.weight(), high.fixed(), high.weight()];
        self.0.set(lane, numbers);
    }

    /// Step 5: caps where the rows begin, and their widths.
    #[inline(always)]
    fn spans(&self, cap_max: &[f32; LANES]) -> ([f32; LANES], [f32; LANES]) {
        let (mut low, mut width) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let [low_fixed, low_weight, high_fixed, high_weight] = self.0.get(lane);
            low[lane] = low_fixed + low_weight * cap_max[lane];
            width[lane] = high_fixed + high_weight * cap_max[lane] - low[lane];
        }
        (low, width)
    }
}
