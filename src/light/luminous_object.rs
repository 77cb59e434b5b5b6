//! The light of an object that emits, of a shape that this library does not know.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::light_source::{LightSource, Placement};
use super::{Emission, Light, LightSample, MapNotes, SkySampling};
use crate::Result;

/// Two are equal if they are one in memory.
impl PartialEq for dyn Light {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::addr_eq(self, other)
    }
}

impl LightSource for Arc<dyn Light> {
    /// It comes with its object, and no word names it.
    const WORDS: &'static [&'static str] = &[];

    fn from_word(_word: &str, _placement: &Placement) -> Option<Result<Self>> {
        None
    }

    fn describe(&self) -> String {
        "luminous object".into()
    }

    fn is_delta(&self) -> bool {
        Light::is_delta(self)
    }

    fn is_dark(&self) -> bool {
        false
    }

    fn is_valid(&self) -> bool {
        true
    }

    fn load(&self, _sampling: SkySampling) -> Result<Box<dyn Light>> {
        Ok(Box::new(self.clone()))
    }
}

impl Light for Arc<dyn Light> {
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        self.as_ref().sample(from, u)
    }

    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        self.as_ref().emitted_along(from, direction, reach)
    }

    fn sample_batch(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        self.as_ref().sample_batch(from, u, out);
    }

    fn emitted_batch(
        &self,
        from: &[DVec3],
        directions: &[DVec3],
        reach: &[f64],
        out: &mut [Option<Emission>],
    ) {
        self.as_ref().emitted_batch(from, directions, reach, out);
    }

    fn is_delta(&self) -> bool {
        self.as_ref().is_delta()
    }

    fn surrounds(&self) -> bool {
        self.as_ref().surrounds()
    }

    fn notes(&self) -> Option<&MapNotes> {
        self.as_ref().notes()
    }

    fn hull(&self) -> Vec<DVec3> {
        self.as_ref().hull()
    }
}
