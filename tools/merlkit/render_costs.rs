//! What a picture costs: seconds of each stage and bytes of each sampler, measured while it is rendered.
//!
//! Draws and densities are too short to be timed one by one. The renderer asks for them in batches, one in [`PERIOD`] of which is timed
//! where the picture's costs are asked for. With t the seconds of the timed batches, n their directions and N all directions, all
//! batches take about t·N/n seconds of all threads together, which is t·N/(n·threads) by the clock.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use glam::{Vec2, Vec3};
use merlkit::Wo;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit_evaluate::report::Sheet;
use serde::Serialize;

/// One batch in so many is timed.
const PERIOD: u64 = 8;

/// What the stages of a picture took.
#[derive(Default)]
pub struct RenderCosts {
    stages: Mutex<Stages>,
    calls: Arc<SamplerCalls>,
}

/// Seconds by the clock.
#[derive(Default)]
struct Stages {
    loading: Duration,
    building: Duration,
    rendering: Duration,
    samplers: Vec<UsedSampler>,
}

/// A sampler that was built or read for a picture.
#[derive(Clone, Debug, Serialize)]
pub struct UsedSampler {
    /// The material.
    pub material: String,
    /// The method with its settings, and the file that it was read from.
    pub sampler: String,
    /// Bytes of its tables in memory.
    pub bytes: usize,
    /// Seconds by the clock of building or reading it.
    pub building: f64,
}

/// A part of a picture's work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostStage {
    /// Reading materials and lights.
    Loading,
    /// Tracing paths, with all draws.
    Rendering,
}

impl RenderCosts {
    /// Adds what a stage took since `start`.
    pub fn add(&self, stage: CostStage, start: Instant) {
        let mut stages = self.lock();
        match stage {
            CostStage::Loading => stages.loading += start.elapsed(),
            CostStage::Rendering => stages.rendering += start.elapsed(),
        }
    }

    /// Adds a sampler, whose building took since `start`.
    pub fn add_sampler(&self, start: Instant, mut cost: UsedSampler) {
        let took = start.elapsed();
        cost.building = took.as_secs_f64();
        let mut stages = self.lock();
        stages.building += took;
        stages.samplers.push(cost);
    }

    /// What loading and building took so far.
    pub fn preparation(&self) -> Duration {
        let stages = self.lock();
        stages.loading + stages.building
    }

    /// Counts as loading what preparing a scene took since `start`, apart from the materials and samplers that were counted since
    /// `before`: its lights and their tables.
    pub fn add_lights(&self, start: Instant, before: Duration) {
        let counted = self.preparation().saturating_sub(before);
        let rest = start.elapsed().saturating_sub(counted);
        self.lock().loading += rest;
    }

    /// The same sampler, whose calls are counted and timed.
    pub fn meter(&self, sampler: Arc<dyn DirectionSampler>) -> Arc<dyn DirectionSampler> {
        Arc::new(MeteredSampler {
            sampler,
            calls: self.calls.clone(),
        })
    }

    /// All costs of a command that began at `start` and worked on so many threads.
    pub fn summarise(&self, start: Instant, threads: usize) -> CostSummary {
        let stages = self.lock();
        let rendering = stages.rendering.as_secs_f64();
        let threads = threads.max(1);
        let drawing = self.calls.draws.seconds() / threads as f64;
        let densities = self.calls.densities.seconds() / threads as f64;
        CostSummary {
            threads,
            seconds: StageSeconds {
                loading: stages.loading.as_secs_f64(),
                building: stages.building.as_secs_f64(),
                drawing,
                densities,
                tracing: (rendering - drawing - densities).max(0.0),
                total: start.elapsed().as_secs_f64(),
            },
            draws: self.calls.draws.count(),
            densities: self.calls.densities.count(),
            samplers: stages.samplers.clone(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Stages> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Seconds by the clock of the stages of a picture.
#[derive(Clone, Debug, Serialize)]
pub struct StageSeconds {
    /// Reading materials and lights, with the tables of lights.
    pub loading: f64,
    /// Building or reading samplers.
    pub building: f64,
    /// Drawing directions.
    pub drawing: f64,
    /// Densities of directions that lights chose.
    pub densities: f64,
    /// The rest of rendering.
    pub tracing: f64,
    /// The command as a whole, with the writing of its files.
    pub total: f64,
}

/// How often samplers were called.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CallCount {
    /// Directions.
    pub directions: u64,
    /// Those in batches that were timed.
    pub timed: u64,
}

impl CallCount {
    fn describe(self) -> String {
        format!(
            "{} directions, {} of them timed",
            self.directions, self.timed
        )
    }
}

/// What a command measured of its own picture.
#[derive(Clone, Debug, Serialize)]
pub struct CostSummary {
    /// Threads that rendered.
    pub threads: usize,
    /// Seconds by the clock.
    pub seconds: StageSeconds,
    /// Directions that were drawn.
    pub draws: CallCount,
    /// Densities that were computed.
    pub densities: CallCount,
    /// The samplers.
    pub samplers: Vec<UsedSampler>,
}

impl CostSummary {
    /// The seconds, for people.
    pub fn stage_sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&["stage", "s", "what is in it"]);
        let seconds = &self.seconds;
        for (name, value, what) in [
            ("loading", seconds.loading, "materials and lights".into()),
            ("building", seconds.building, "samplers".into()),
            ("drawing", seconds.drawing, self.draws.describe()),
            ("densities", seconds.densities, self.densities.describe()),
            ("tracing", seconds.tracing, "the rest of rendering".into()),
            ("total", seconds.total, "with the writing of files".into()),
        ] {
            sheet.push(vec![name.into(), format!("{value:.3}"), what]);
        }
        sheet
    }

    /// The samplers, for people; `None` if there are none.
    pub fn sampler_sheet(&self) -> Option<Sheet> {
        let mut sheet = Sheet::new(&["material", "sampler", "bytes", "s to build"]);
        for cost in &self.samplers {
            sheet.push(vec![
                cost.material.clone(),
                cost.sampler.clone(),
                cost.bytes.to_string(),
                format!("{:.3}", cost.building),
            ]);
        }
        (!self.samplers.is_empty()).then_some(sheet)
    }
}

/// Calls of all samplers of a picture.
#[derive(Default)]
struct SamplerCalls {
    draws: CallMeter,
    densities: CallMeter,
}

/// Counts directions and times some of the batches that they come in.
#[derive(Default)]
struct CallMeter {
    batches: AtomicU64,
    directions: AtomicU64,
    timed: AtomicU64,
    nanoseconds: AtomicU64,
}

impl CallMeter {
    /// Counts a batch of so many directions. Returns the time if it is to be timed.
    fn begin(&self, directions: usize) -> Option<Instant> {
        self.directions
            .fetch_add(directions as u64, Ordering::Relaxed);
        let number = self.batches.fetch_add(1, Ordering::Relaxed);
        is_timed(number).then(Instant::now)
    }

    /// Adds a batch that was timed.
    fn end(&self, start: Option<Instant>, directions: usize) {
        let Some(start) = start else {
            return;
        };
        let nanoseconds = start.elapsed().as_nanos() as u64;
        self.timed.fetch_add(directions as u64, Ordering::Relaxed);
        self.nanoseconds.fetch_add(nanoseconds, Ordering::Relaxed);
    }

    fn count(&self) -> CallCount {
        CallCount {
            directions: self.directions.load(Ordering::Relaxed),
            timed: self.timed.load(Ordering::Relaxed),
        }
    }

    /// Estimated seconds of all batches on all threads: t·N/n.
    fn seconds(&self) -> f64 {
        let CallCount { directions, timed } = self.count();
        let measured = self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9;
        match timed {
            0 => 0.0,
            _ => measured * directions as f64 / timed as f64,
        }
    }
}

/// Whether the batch of this number is timed: the first, and one in [`PERIOD`] after it. The multiples of the golden ratio spread them so
/// that they follow no rhythm of bounces.
fn is_timed(number: u64) -> bool {
    number.wrapping_mul(0x9E37_79B9_7F4A_7C15) < u64::MAX / PERIOD
}

/// A sampler whose calls are counted.
struct MeteredSampler {
    sampler: Arc<dyn DirectionSampler>,
    calls: Arc<SamplerCalls>,
}

impl DirectionSampler for MeteredSampler {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let start = self.calls.draws.begin(1);
        let drawn = self.sampler.sample(wo, u);
        self.calls.draws.end(start, 1);
        drawn
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let start = self.calls.densities.begin(1);
        let density = self.sampler.pdf(wo, wi);
        self.calls.densities.end(start, 1);
        density
    }

    fn bytes(&self) -> usize {
        self.sampler.bytes()
    }

    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        let start = self.calls.draws.begin(u.len());
        self.sampler.sample_batch(wo, u, out);
        self.calls.draws.end(start, u.len());
    }

    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        let start = self.calls.densities.begin(wi.len());
        self.sampler.pdf_batch(wo, wi, out);
        self.calls.densities.end(start, wi.len());
    }

    fn draw_stratified(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        let start = self.calls.draws.begin(count);
        let drawn = self.sampler.draw_stratified(wo, count, seed);
        self.calls.draws.end(start, count);
        drawn
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::sampler::Cosine;

    #[test]
    fn one_batch_in_eight_is_timed() {
        let timed = (0..8000).filter(|&number| is_timed(number)).count();
        assert!(is_timed(0) && (990..=1010).contains(&timed), "{timed}");
        // In each rhythm of up to nine bounces, too.
        for bounces in 2..10 {
            let first = (0..8000).filter(|&n| is_timed(n * bounces)).count();
            assert!((900..=1100).contains(&first), "{bounces}: {first}");
        }
    }

    #[test]
    fn a_metered_sampler_draws_the_same_and_counts() {
        let costs = RenderCosts::default();
        let metered = costs.meter(Arc::new(Cosine));
        let points = [Vec2::new(0.2, 0.7), Vec2::new(0.9, 0.1)];
        let mut drawn = [None; 2];
        let wo = Vec3::new(0.6, 0.0, 0.8);
        metered.sample_batch(Wo::One(wo), &points, &mut drawn);
        for (sample, point) in drawn.iter().zip(points) {
            assert_eq!(*sample, Cosine.sample(wo, point));
            let wi = sample.unwrap().wi;
            assert_eq!(metered.pdf(wo, wi), Cosine.pdf(wo, wi));
        }
        let summary = costs.summarise(Instant::now(), 2);
        assert_eq!((summary.draws.directions, summary.draws.timed), (2, 2));
        assert_eq!(summary.densities.directions, 2);
        assert!(summary.seconds.drawing > 0.0);
    }
}
