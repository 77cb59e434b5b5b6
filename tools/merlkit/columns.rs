//! Sheets with a meaning of their columns: samplers or values of a parameter, each against a reference.

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::image::Image;
use merlkit::material::Material;
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::measure::difference::{PictureDifference, Viewing};
use merlkit_evaluate::plot::viridis;
use merlkit_evaluate::report::Sheet;
use merlkit_scene::decode_srgb;

use crate::grid::Cell;
use crate::progress::Progress;

/// What is different from column to column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ColumnsBy {
    /// The sampler.
    Sampler,
    /// The value of parameters of a formula, one for all of them.
    Parameter {
        /// Their names.
        names: Vec<String>,
        /// The values, as they are written in a formula.
        values: Vec<String>,
    },
}

impl ColumnsBy {
    /// "sampler", or parameters and values: "ax=ay=0.05,0.1,0.2".
    ///
    /// # Errors
    /// What was expected, for other texts.
    pub fn parse(argument: &str) -> Result<Self, String> {
        if argument == "sampler" {
            return Ok(Self::Sampler);
        }
        let mut parts: Vec<String> = argument.split('=').map(|p| p.trim().to_owned()).collect();
        let list = parts.pop().unwrap_or_default();
        let values: Vec<String> = list.split(',').map(|v| v.trim().to_owned()).collect();
        if parts.is_empty() || parts.iter().chain(&values).any(String::is_empty) {
            return Err(
                "expected sampler, or parameters and values such as sx=sy=0.1,0.2,0.4".into(),
            );
        }
        Ok(Self::Parameter {
            names: parts,
            values,
        })
    }

    /// What is written over the columns, after that of the reference.
    pub fn headings(&self, samplers: &[SamplerSpec]) -> Vec<String> {
        match self {
            Self::Sampler => samplers.iter().map(SamplerSpec::to_string).collect(),
            Self::Parameter { names, values } => {
                let name = names.join("=");
                values.iter().map(|v| format!("{name}={v}")).collect()
            }
        }
    }

    /// The material of each column.
    ///
    /// # Errors
    /// [`Error::Argument`] for a material without such parameters.
    pub fn materials(&self, material: &Material, count: usize) -> Result<Vec<Material>, Error> {
        match self {
            Self::Sampler => Ok(vec![material.clone(); count]),
            Self::Parameter { names, values } => {
                let varied = values.iter().map(|value| vary(material, names, value));
                varied.collect()
            }
        }
    }
}

/// The same formula with another value of some parameters.
fn vary(material: &Material, names: &[String], value: &str) -> Result<Material, Error> {
    let Some(mut text) = material.formula()? else {
        return Err(Error::argument(
            format!("{} has no parameters", material.name()),
            "name analytic models or stored fits: `merlkit fit MATERIAL --format json -o FIT.json` writes one",
        ));
    };
    for name in names {
        text = with_named(&text, name, value).ok_or_else(|| {
            Error::argument(
                format!("{text} has no parameter {name} that can be {value}"),
                "`merlkit models` lists parameters and their domains",
            )
        })?;
    }
    Material::resolve(&text)
}

/// A formula with a parameter set. What is called alpha in the field is here ax and ay, but where a term has a parameter of that
/// name.
fn with_named(text: &str, name: &str, value: &str) -> Option<String> {
    let own = with_parameter(text, name, value);
    if own.is_some() || name != "alpha" {
        return own;
    }
    with_parameter(&with_parameter(text, "ax", value)?, "ay", value)
}

/// A formula with a parameter set, in the last term that has it; `None` if none does.
fn with_parameter(text: &str, name: &str, value: &str) -> Option<String> {
    let terms: Vec<&str> = text.split('+').collect();
    for (number, term) in terms.iter().enumerate().rev() {
        let (model, settings) = term.split_once(':').unwrap_or((term, ""));
        let others = settings.split(',').filter(|setting| {
            let key = setting.split('=').next().unwrap_or_default();
            !setting.is_empty() && key != name
        });
        let mut settings: Vec<String> = others.map(str::to_owned).collect();
        settings.push(format!("{name}={value}"));
        let varied = format!("{model}:{}", settings.join(","));
        let mut all: Vec<String> = terms.iter().map(|&t| t.to_owned()).collect();
        all[number] = varied;
        let formula = all.join("+");
        if Material::resolve(&formula).is_ok_and(|m| m.facts().is_ok()) {
            return Some(formula);
        }
    }
    None
}

/// The rows of a sheet: for each material its reference and its columns, and their errors.
pub struct ComparedRows {
    /// In the order of the grid.
    pub cells: Vec<Cell>,
    /// The errors as a table.
    pub sheet: Sheet,
}

/// Compares the pictures of each row with its first. `images` may end early; a row has `headings` and one more.
///
/// # Errors
/// As [`PictureDifference::measure`].
pub fn compare_rows(
    images: Vec<Image>,
    names: &[&str],
    headings: &[String],
    with_difference: bool,
    exposure: f32,
) -> Result<ComparedRows, Error> {
    let mut rows = ComparedRows {
        cells: Vec::new(),
        sheet: Sheet::new(&["material", "column", "relMSE", "FLIP"]),
    };
    let width = headings.len() + 1;
    let progress = Progress::new("comparing", names.len() * headings.len());
    let mut images = images.into_iter();
    for name in names {
        let Some(reference) = images.next() else {
            break;
        };
        let mut differences = vec![Cell::default()];
        let mut shown = vec![];
        for heading in headings {
            let Some(image) = images.next() else { break };
            let difference = measure(&image, &reference)?;
            progress.advance();
            let [error, flip] = match &difference {
                Some(d) => [format_error(d.rel_mse), format_error(d.flip)],
                None => ["black".to_owned(), "black".to_owned()],
            };
            differences.push(Cell {
                image: difference.map(|d| error_map(&d, exposure)).transpose()?,
                label: format!("FLIP {flip}"),
            });
            shown.push(Cell {
                image: Some(image),
                label: format!("relMSE {error}"),
            });
            let row = [(*name).to_owned(), heading.clone(), error, flip];
            rows.sheet.push(row.to_vec());
        }
        rows.cells.push(Cell {
            image: Some(reference),
            label: (*name).to_owned(),
        });
        shown.resize_with(width - 1, Cell::default);
        rows.cells.extend(shown);
        if with_difference {
            differences.resize_with(width, Cell::default);
            rows.cells.extend(differences);
        }
    }
    Ok(rows)
}

/// Three digits, without an exponent where few zeros are needed.
fn format_error(error: f64) -> String {
    let digits = match error {
        e if e >= 10.0 => 1,
        e if e >= 1.0 => 2,
        e if e >= 0.1 => 3,
        e if e >= 0.01 => 4,
        e if e >= 0.001 || e == 0.0 => 5,
        _ => return format!("{error:.2e}"),
    };
    format!("{error:.digits$}")
}

/// The difference from a reference; `None` if that is black.
fn measure(image: &Image, reference: &Image) -> Result<Option<PictureDifference>, Error> {
    let is_black = reference.pixels().iter().all(|pixel| *pixel == Rgb::ZERO);
    match is_black {
        true => Ok(None),
        false => PictureDifference::measure(image, reference, Viewing::Radiance).map(Some),
    }
}

/// FLIP of each pixel in the colours of plots, as radiance that the PNG shows in these colours.
fn error_map(difference: &PictureDifference, exposure: f32) -> Result<Image, Error> {
    let map = &difference.map;
    let mut pixels = Vec::with_capacity(map.errors.len());
    for &error in &map.errors {
        let seen = viridis(error).map(|byte| radiance_of(byte) / exposure.exp2());
        pixels.push(Rgb::from_array(seen));
    }
    let [width, height] = difference.size;
    Image::new(width, height, pixels)
}

/// The radiance that a PNG shows as a byte: the inverse of the transfer function and of [`merlkit::image::tone_map`].
fn radiance_of(byte: u8) -> f32 {
    match decode_srgb(byte) {
        // y = ½ + ½(1 − exp(1 − 2x)) gives x = ½(1 − ln(2(1 − y))).
        y if y > 0.5 => 0.5 * (1.0 - (2.0 * (1.0 - y.min(0.999))).ln()),
        y => y,
    }
}

#[cfg(test)]
mod tests {
    use merlkit::image::encode_srgb;

    use super::*;

    #[test]
    fn columns_are_samplers_or_parameters() {
        assert_eq!(ColumnsBy::parse("sampler"), Ok(ColumnsBy::Sampler));
        let parsed = ColumnsBy::parse("sx=sy=0.1, 0.2").unwrap();
        assert_eq!(parsed.headings(&[]), ["sx=sy=0.1", "sx=sy=0.2"]);
        for wrong in ["", "samplers", "sx=", "=1", "sx=1,,2"] {
            assert!(ColumnsBy::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn parameters_are_set_in_the_term_that_has_them() {
        let vary = |text: &str, name: &str, value: &str| with_parameter(text, name, value);
        let ward = vary("ward:sx=0.1,sy=0.3", "sx", "0.2").unwrap();
        assert_eq!(ward, "ward:sy=0.3,sx=0.2");
        let sum = vary("lambert:reflectance=0.2+ward", "reflectance", "0.5/0.1/0.1").unwrap();
        assert_eq!(sum, "lambert:reflectance=0.5/0.1/0.1+ward");
        assert_eq!(
            with_named("ggx:ax=0.1,ay=0.3+lambert", "alpha", "0.2").unwrap(),
            "ggx:ax=0.2,ay=0.2+lambert"
        );
        assert_eq!(with_named("lambert", "alpha", "0.2"), None);
        assert_eq!(vary("lambert", "sx", "0.2"), None);
        assert_eq!(vary("ward", "sx", "-1"), None);
        let nickel = Material::resolve("nickel").unwrap();
        let by = ColumnsBy::parse("sx=0.1").unwrap();
        assert!(by.materials(&nickel, 1).is_err());
    }

    #[test]
    fn errors_have_three_digits() {
        let shown = [123.45, 9.714, 0.2716, 0.010_44, 1.044e-5].map(format_error);
        assert_eq!(shown, ["123.5", "9.71", "0.272", "0.0104", "1.04e-5"]);
    }

    #[test]
    fn colours_of_a_map_are_seen_as_they_are_meant() {
        for byte in [0, 7, 128, 188, 200, 253] {
            let image = Image::new(1, 1, vec![Rgb::splat(radiance_of(byte) / 2.0)]).unwrap();
            assert_eq!(encode_srgb(&image, 1.0), [byte; 3]);
        }
    }
}
