//! The parameters of a key.

use std::ops::RangeInclusive;

use glam::{DVec3, Vec3};
use merlkit::geometry::spherical;

use crate::refusal::Refusal;

/// Seeds are integers that JavaScript has exactly.
const LARGEST_SEED: f64 = 9_007_199_254_740_991.0;

/// The parameters of a key by their names, each given once.
pub(crate) struct Query {
    pairs: Vec<(String, String)>,
}

impl Query {
    /// Reads the text behind `?`, which must have the parameters `names` and no others.
    pub fn parse(text: &str, names: &[&str]) -> Result<Self, Refusal> {
        let mut pairs: Vec<(String, String)> = Vec::with_capacity(names.len());
        for (name, value) in form_urlencoded::parse(text.as_bytes()) {
            if !names.contains(&&*name) {
                return Err(Refusal::bad(format!(
                    "there is no parameter \"{}\"; give {}",
                    shorten(&name),
                    describe_names(names)
                )));
            }
            if pairs.iter().any(|pair| pair.0 == name) {
                return Err(Refusal::bad(format!("{name} is given twice; give it once")));
            }
            pairs.push((name.into_owned(), value.into_owned()));
        }
        if let Some(missing) = names.iter().find(|n| !pairs.iter().any(|p| p.0 == **n)) {
            return Err(Refusal::bad(format!(
                "the parameter {missing} is missing; give {}",
                describe_names(names)
            )));
        }
        Ok(Self { pairs })
    }

    /// The text of a parameter.
    pub fn text(&self, name: &str) -> &str {
        let found = self.pairs.iter().find(|pair| pair.0 == name);
        found.map_or("", |pair| &pair.1)
    }

    /// A number within `domain`.
    pub fn number(&self, name: &str, domain: RangeInclusive<f64>) -> Result<f64, Refusal> {
        let parsed = self.text(name).parse::<f64>().ok();
        match parsed.filter(|number| domain.contains(number)) {
            Some(number) => Ok(number),
            None => Err(self.outside(name, &domain)),
        }
    }

    /// An integer within `domain`.
    pub fn count(&self, name: &str, domain: RangeInclusive<usize>) -> Result<usize, Refusal> {
        let parsed = self.text(name).parse::<usize>().ok();
        match parsed.filter(|count| domain.contains(count)) {
            Some(count) => Ok(count),
            None => Err(self.outside(name, &domain)),
        }
    }

    fn outside<T: std::fmt::Display>(&self, name: &str, domain: &RangeInclusive<T>) -> Refusal {
        Refusal::bad(format!(
            "{name}={} is outside its domain; give {} to {}",
            shorten(self.text(name)),
            domain.start(),
            domain.end()
        ))
    }

    /// The number of a material.
    pub fn material(&self) -> Result<usize, Refusal> {
        self.count("material", 0..=usize::MAX)
    }

    /// The seed of random numbers.
    pub fn seed(&self) -> Result<u64, Refusal> {
        Ok(self.count("seed", 0..=LARGEST_SEED as usize)? as u64)
    }

    /// The polar angle of `wo` in degrees, 0 to below 90.
    pub fn theta(&self) -> Result<f64, Refusal> {
        let theta = self.number("theta", 0.0..=90.0)?;
        // A direction that lies on the horizon once rounded to f32 is none that anything is known of.
        if theta < 90.0 && f64::from(theta.to_radians().cos() as f32) > 1e-7 {
            return Ok(theta);
        }
        Err(Refusal::bad("theta must be below 90 degrees"))
    }

    /// The azimuth of `wo` in degrees.
    pub fn phi(&self) -> Result<f64, Refusal> {
        self.number("phi", -360.0..=360.0)
    }

    /// `wo` by its angles.
    pub fn wo(&self) -> Result<Vec3, Refusal> {
        let (theta, phi) = (self.theta()?, self.phi()?);
        let wo: DVec3 = spherical(theta.to_radians(), phi.to_radians());
        Ok(wo.as_vec3())
    }
}

/// The beginning of a text that others wrote, for a message.
pub(crate) fn shorten(text: &str) -> String {
    text.chars().take(60).collect()
}

fn describe_names(names: &[&str]) -> String {
    match names {
        [] => "no parameters".into(),
        _ => names.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_is_given_once_and_no_other() {
        let query = Query::parse("theta=45&phi=-90", &["theta", "phi"]).unwrap();
        assert_eq!(query.theta().unwrap(), 45.0);
        assert_eq!(query.phi().unwrap(), -90.0);
        for text in ["theta=45", "theta=45&phi=0&phi=0", "theta=1&phi=2&path=x"] {
            assert!(Query::parse(text, &["theta", "phi"]).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_outside_their_domain_are_refused() {
        for theta in ["90", "nan", "inf", "-1", "", "1e999", "89.999999"] {
            let text = format!("theta={theta}");
            let query = Query::parse(&text, &["theta"]).unwrap();
            assert_eq!(query.theta().unwrap_err().status, 400, "{theta}");
        }
        let query = Query::parse("count=-1", &["count"]).unwrap();
        assert!(query.count("count", 0..=10).is_err());
    }
}
