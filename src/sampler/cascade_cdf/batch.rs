//! Draws and densities of many lanes at once.
//!
//! A draw is a chain of searches: of a marginal, of its conditional, then of both again in each of two tables for the density.
//! In a batch the searches of all lanes of a block go on side by side.

use glam::{DVec2, Vec2, Vec3};

use super::cascade::{CascadeCdf, Chosen, position_in};
use super::density::{HalfVectorPoint, has_weight, polar_weight};
use crate::batch::Wo;
use crate::direction_sampler::DirectionSample;
use crate::distribution::Segment;
use crate::geometry::{cosine_hemisphere, is_upper, reflect_about, unit_upper};
use crate::sampler::direction_knots::DirectionNeighbours;

/// Lanes of a block; its arrays fit in the first level of cache.
const LANES: usize = 32;
/// TableSearches of a block at most: for its densities, in four tables a lane.
const SEARCHES: usize = 4 * LANES;

/// Draws of a batch.
pub(super) fn sample(
    cascade: &CascadeCdf,
    wo: Wo<'_>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    let mut block = CascadeBlock::new(cascade, wo);
    let mut searches = TableSearches::new();
    for (number, out) in out.chunks_mut(LANES).enumerate() {
        let lanes = number * LANES..number * LANES + out.len();
        block.load_views(wo.lanes(lanes.clone()), out.len());
        block.draw(&u[lanes], &mut searches);
        block.find_densities(&mut searches);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = block.sample(lane);
        }
    }
}

/// Densities of a batch.
pub(super) fn pdf(cascade: &CascadeCdf, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
    let mut block = CascadeBlock::new(cascade, wo);
    let mut searches = TableSearches::new();
    for (number, out) in out.chunks_mut(LANES).enumerate() {
        let lanes = number * LANES..number * LANES + out.len();
        block.load_views(wo.lanes(lanes.clone()), out.len());
        block.load_targets(&wi[lanes]);
        block.find_densities(&mut searches);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = match (&block.near[lane], block.wi[lane]) {
                (Some(_), Some(_)) => block.density[lane],
                _ => 0.0,
            };
        }
    }
}

/// Lanes that go through the steps together.
struct CascadeBlock<'a> {
    cascade: &'a CascadeCdf,
    /// The tables about a `wo` that is the same in all lanes.
    one: Option<DirectionNeighbours>,
    /// The tables about the `wo` of each lane.
    near: [Option<DirectionNeighbours>; LANES],
    /// How many lanes are in use.
    count: usize,
    /// The direction asked for or drawn, among the azimuths that have tables.
    wi: [Option<Vec3>; LANES],
    /// Its density.
    density: [f32; LANES],
}

/// TableSearches of a marginal and then of the conditional of the piece that was found.
struct TableSearches {
    lane: [u8; SEARCHES],
    /// Which of a lane's four tables is searched, or which of two azimuths is drawn from.
    slot: [u8; SEARCHES],
    table: [u32; SEARCHES],
    /// The conditional of the marginal's piece.
    conditional: [u32; SEARCHES],
    /// Probabilities or positions that are searched for, in the marginal and in the conditional.
    x: [f64; SEARCHES],
    y: [f64; SEARCHES],
    row: [Segment; SEARCHES],
    column: [Segment; SEARCHES],
    count: usize,
}

impl TableSearches {
    fn new() -> Self {
        Self {
            lane: [0; SEARCHES],
            slot: [0; SEARCHES],
            table: [0; SEARCHES],
            conditional: [0; SEARCHES],
            x: [0.0; SEARCHES],
            y: [0.0; SEARCHES],
            row: [Segment::default(); SEARCHES],
            column: [Segment::default(); SEARCHES],
            count: 0,
        }
    }

    #[inline(always)]
    fn ask(&mut self, [lane, slot]: [usize; 2], table: usize, at: DVec2) {
        let number = self.count;
        (self.lane[number], self.slot[number]) = (lane as u8, slot as u8);
        self.table[number] = table as u32;
        (self.x[number], self.y[number]) = (at.x, at.y);
        self.count += 1;
    }

    /// The pieces that hold probabilities.
    fn find_probabilities(&mut self, cascade: &CascadeCdf) {
        let asked = 0..self.count;
        let (marginal, conditional) = (&cascade.tables.marginal, &cascade.tables.conditional);
        let rows = &mut self.row[asked.clone()];
        marginal.find_each(&self.table[asked.clone()], &self.x[asked.clone()], rows);
        self.find_conditionals(cascade);
        let columns = &mut self.column[asked.clone()];
        conditional.find_each(&self.conditional[asked.clone()], &self.y[asked], columns);
    }

    /// The pieces that hold positions on the grid.
    fn find_positions(&mut self, cascade: &CascadeCdf) {
        let asked = 0..self.count;
        let (marginal, conditional) = (&cascade.tables.marginal, &cascade.tables.conditional);
        let rows = &mut self.row[asked.clone()];
        marginal.find_each_segment(&self.table[asked.clone()], &self.x[asked.clone()], rows);
        self.find_conditionals(cascade);
        let columns = &mut self.column[asked.clone()];
        conditional.find_each_segment(&self.conditional[asked.clone()], &self.y[asked], columns);
    }

    fn find_conditionals(&mut self, cascade: &CascadeCdf) {
        for number in 0..self.count {
            let table = self.table[number] as usize;
            let conditional = cascade.tables.find_conditional(table, &self.row[number]);
            self.conditional[number] = conditional as u32;
        }
    }
}

impl<'a> CascadeBlock<'a> {
    fn new(cascade: &'a CascadeCdf, wo: Wo<'_>) -> Self {
        let one = match wo {
            Wo::One(wo) => unit_upper(wo).map(|wo| cascade.knots.neighbours(wo)),
            Wo::Each(_) => None,
        };
        Self {
            cascade,
            one,
            near: [None; LANES],
            count: 0,
            wi: [None; LANES],
            density: [0.0; LANES],
        }
    }

    /// Takes the `wo` of up to [`LANES`] lanes.
    fn load_views(&mut self, wo: Wo<'_>, count: usize) {
        self.count = count;
        for lane in 0..count {
            self.near[lane] = match wo {
                Wo::One(_) => self.one,
                Wo::Each(wo) => unit_upper(wo[lane]).map(|wo| self.cascade.knots.neighbours(wo)),
            };
        }
    }

    /// Takes the directions whose density is asked for.
    fn load_targets(&mut self, wi: &[Vec3]) {
        for (lane, &wi) in wi.iter().enumerate() {
            self.wi[lane] = match (&self.near[lane], unit_upper(wi)) {
                (Some(near), Some(wi)) => Some(wi * near.signs),
                _ => None,
            };
        }
    }

    /// Draws a direction for each lane.
    fn draw(&mut self, u: &[Vec2], searches: &mut TableSearches) {
        // Step 1: what each lane draws from.
        searches.count = 0;
        for (lane, &u) in u.iter().enumerate() {
            self.wi[lane] = None;
            let Some(near) = &self.near[lane] else {
                continue;
            };
            match self.cascade.choose(near, u) {
                Chosen::Cosine(u) => {
                    let wi = cosine_hemisphere(u).as_vec3();
                    self.wi[lane] = is_upper(wi).then_some(wi);
                }
                Chosen::Table { table, azimuth, u } => searches.ask([lane, azimuth], table, u),
            }
        }
        // Step 2: the pieces of the curves in which the probabilities are reached.
        searches.find_probabilities(self.cascade);
        // Step 3: the half vectors there, and the directions that they reflect `wo` to.
        for number in 0..searches.count {
            let lane = usize::from(searches.lane[number]);
            let Some(near) = &self.near[lane] else {
                continue;
            };
            let at = DVec2::new(
                position_in(&searches.row[number], searches.x[number]),
                position_in(&searches.column[number], searches.y[number]),
            );
            let axis = near.axes[usize::from(searches.slot[number])];
            let h = self.cascade.half_vector(axis, at);
            let wi = reflect_about(near.wo.as_dvec3(), h).as_vec3();
            self.wi[lane] = is_upper(wi).then_some(wi);
        }
    }

    /// The density at the direction of each lane.
    fn find_densities(&mut self, searches: &mut TableSearches) {
        // Step 1: where each half vector lies on the grids of the tables with weight.
        searches.count = 0;
        let mut points = [None; LANES];
        let mut densities = [[0.0; 4]; LANES];
        for lane in 0..self.count {
            let (Some(near), Some(wi)) = (&self.near[lane], self.wi[lane]) else {
                continue;
            };
            let (wo, wi) = (near.wo.as_dvec3(), wi.as_dvec3());
            let point = HalfVectorPoint::new(&self.cascade.axis, wo, wi);
            points[lane] = Some(point);
            for azimuth in 0..2 {
                if !has_weight(near, azimuth) {
                    continue;
                }
                let at = self.cascade.grid_position(&point, near.axes[azimuth]);
                for (polar, knot) in [near.polar.first, near.polar.second]
                    .into_iter()
                    .enumerate()
                {
                    let (slot, table) = (2 * azimuth + polar, near.starts[azimuth] + knot);
                    if polar_weight(near, polar) <= 0.0 {
                        continue;
                    }
                    if self.cascade.tables.marginal.is_void(table) {
                        densities[lane][slot] = point.cosine;
                    } else {
                        searches.ask([lane, slot], table, at);
                    }
                }
            }
        }
        // Step 2: the pieces of the curves that hold these positions, and the densities there.
        searches.find_positions(self.cascade);
        for number in 0..searches.count {
            let lane = usize::from(searches.lane[number]);
            if let Some(point) = &points[lane] {
                let (row, column) = (&searches.row[number], &searches.column[number]);
                densities[lane][usize::from(searches.slot[number])] =
                    self.cascade.density_in(row, column, point);
            }
        }
        // Step 3: the mixtures.
        for lane in 0..self.count {
            if let (Some(near), Some(point)) = (&self.near[lane], &points[lane]) {
                self.density[lane] = self.cascade.mix(near, &densities[lane], point.cosine);
            }
        }
    }

    /// What a lane drew.
    fn sample(&self, lane: usize) -> Option<DirectionSample> {
        let (near, wi) = (self.near[lane].as_ref()?, self.wi[lane]?);
        self.cascade.finish(near, wi, self.density[lane])
    }
}
