//! Lights as they are described, before anything is loaded: the one list of them, and the words that name them.

use std::sync::Arc;

use super::environment::EnvironmentSource;
use super::light_source::{LightSource, Placement};
use super::{Area, Directional, Light, Point, SkySampling};
use crate::error::list_words;
use crate::{Error, Result};

/// Defines [`LightSpec`] from the list of lights, and passes every question on to the light that it holds.
macro_rules! lights {
    ($($(#[$doc:meta])* $variant:ident($light:ty)),+ $(,)?) => {
        /// A light as it is described: numbers and names; nothing is loaded.
        ///
        /// # Examples
        /// ```
        /// use merlkit::glam::DVec3;
        /// use merlkit::light::{LightSpec, Placement, SkySampling};
        ///
        /// let placement = Placement { subject: DVec3::Y, key: DVec3::new(-1.0, 3.0, 2.0) };
        /// let spec = LightSpec::from_name("uniform:2", &placement)?;
        /// assert_eq!(spec.describe(), "environment (uniform)");
        /// assert!(!spec.is_delta());
        /// let light = spec.load(SkySampling::Importance)?;
        /// let emitted = light.emitted_along(DVec3::Y, DVec3::X, f64::INFINITY).expect("it surrounds us");
        /// assert!((emitted.radiance.x - 2.0).abs() < 1e-6);
        /// # Ok::<(), merlkit::Error>(())
        /// ```
        #[derive(Clone, Debug, PartialEq)]
        pub enum LightSpec {
            $($(#[$doc])* $variant($light)),+
        }

        impl LightSpec {
            /// The light that a word names, one of [`Self::words`].
            ///
            /// # Errors
            /// [`Error::Argument`] for another word, or for a value outside its domain.
            pub fn from_name(name: &str, placement: &Placement) -> Result<Self> {
                $(
                    if let Some(light) = <$light>::from_word(name, placement) {
                        return light.map(Self::$variant);
                    }
                )+
                Err(Error::argument(
                    format!("no light is called \"{name}\""),
                    format!("give {}", Self::words()),
                ))
            }

            /// All words that name lights, as a list for people.
            pub fn words() -> String {
                list_words(&[$(<$light>::WORDS),+].concat())
            }

            /// What kind of light it is, in a word or two.
            pub fn describe(&self) -> String {
                match self { $(Self::$variant(light) => LightSource::describe(light)),+ }
            }

            /// Whether it is a point or parallel: no direction drawn by chance can hit it.
            pub fn is_delta(&self) -> bool {
                match self { $(Self::$variant(light) => LightSource::is_delta(light)),+ }
            }

            /// Whether its description alone shows that it gives no light.
            pub fn is_dark(&self) -> bool {
                match self { $(Self::$variant(light) => light.is_dark()),+ }
            }

            /// Whether its numbers are finite and its emission is not negative.
            pub fn is_valid(&self) -> bool {
                match self { $(Self::$variant(light) => light.is_valid()),+ }
            }

            /// Whether it surrounds the scene, so that tables may choose directions to it.
            pub fn is_environment(&self) -> bool {
                match self { $(Self::$variant(light) => light.is_environment()),+ }
            }

            /// The light, ready to be sampled; `sampling` is for environments.
            ///
            /// # Errors
            /// Those of reading its file, where it has one.
            pub fn load(&self, sampling: SkySampling) -> Result<Box<dyn Light>> {
                match self { $(Self::$variant(light) => light.load(sampling)),+ }
            }
        }
    };
}

lights! {
    /// A point.
    Point(Point),
    /// Parallel light.
    Directional(Directional),
    /// A luminous rectangle.
    Area(Area),
    /// Light from all around.
    Environment(EnvironmentSource),
    /// A luminous object: a light of any kind that is loaded already. It stays where it is when lights are turned, as the object
    /// does.
    Object(Arc<dyn Light>),
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const PLACEMENT: Placement = Placement {
        subject: DVec3::Y,
        key: DVec3::new(-1.0, 3.0, 2.0),
    };

    #[test]
    fn every_word_names_a_light_and_no_other_does() {
        for (word, description) in [
            ("point", "point"),
            ("directional", "directional"),
            ("point:1,2,-3", "point"),
            ("point:1, 2, -3, 0.5", "point"),
            ("directional:30,-45", "directional"),
            ("directional:30,-45,2", "directional"),
            ("area", "area"),
            ("environment", "environment (built-in studio)"),
            ("studio", "environment (built-in studio)"),
            ("lamps", "environment (two broad lamps)"),
            ("uniform", "environment (uniform)"),
            ("uniform:0.5,1,2", "environment (uniform)"),
            ("sky.EXR", "environment sky.EXR"),
        ] {
            let light = LightSpec::from_name(word, &PLACEMENT).unwrap();
            assert_eq!(light.describe(), description);
            assert!(light.is_valid() && !light.is_dark(), "{word}");
            let is_delta = word.starts_with("point") || word.starts_with("directional");
            assert_eq!(light.is_delta(), is_delta);
        }
        for word in [
            "",
            "Point",
            "lamp",
            "uniform:",
            "uniform:-1",
            "area:2.5",
            "point:1,2",
            "point:1,2,x",
            "point:1,2,3,-4",
            "point:1,2,nan",
            "directional:30",
            "directional:30,0,-1",
            "directional:inf,0",
        ] {
            assert!(LightSpec::from_name(word, &PLACEMENT).is_err(), "{word}");
        }
        let LightSpec::Directional(right) =
            LightSpec::from_name("directional:90,90,2", &PLACEMENT).unwrap()
        else {
            panic!("directional light");
        };
        assert!(right.towards.abs_diff_eq(DVec3::X, 1e-12) && right.irradiance.x == 2.0);
        let error = LightSpec::from_name("lamp", &PLACEMENT)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("point, point:X,Y,Z[,INTENSITY], directional"),
            "{error}"
        );
        assert!(error.contains("or FILE[:clamp[=MAX]]"), "{error}");
    }
}
