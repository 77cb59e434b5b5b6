//! What is seen past the objects of a scene.

use std::str::FromStr;

use merlkit::color::Rgb;

/// What is seen past the objects of a scene. A colour is only seen: it lights nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The lights: a map, or black.
    #[default]
    Lights,
    /// Nothing: pictures have alpha.
    Nothing,
    /// A linear colour.
    Colour(Rgb),
}

/// Reads `env`, `none`, `white`, `black`, `grey`, and `#RRGGBB` in sRGB. The error says what was expected.
impl FromStr for Background {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let colour = match word {
            "env" => return Ok(Self::Lights),
            "none" => return Ok(Self::Nothing),
            "white" => "#ffffff",
            "black" => "#000000",
            "grey" | "gray" => "#808080",
            other => other,
        };
        let bits = colour.strip_prefix('#').and_then(parse_digits);
        let bits =
            bits.ok_or("expected env, none, white, black, grey or a colour such as #ffcc00")?;
        let [_, bytes @ ..] = bits.to_be_bytes();
        Ok(Self::Colour(Rgb::from_array(bytes.map(decode_srgb))))
    }
}

/// Six hexadecimal digits as a number.
fn parse_digits(digits: &str) -> Option<u32> {
    let are_hex = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    match are_hex {
        true => u32::from_str_radix(digits, 16).ok(),
        false => None,
    }
}

/// The linear value of a byte, 0 to 1: the inverse of sRGB's transfer function (IEC 61966-2-1).
pub fn decode_srgb(byte: u8) -> f32 {
    let encoded = f32::from(byte) / 255.0;
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds_have_names_and_numbers() {
        assert_eq!("none".parse(), Ok(Background::Nothing));
        assert_eq!("white".parse(), Ok(Background::Colour(Rgb::ONE)));
        assert_eq!("#000000".parse(), "black".parse::<Background>());
        let Ok(Background::Colour(orange)) = "#ff8000".parse() else {
            panic!("a colour");
        };
        let expected = Rgb::new(1.0, 0.215_86, 0.0);
        assert!((orange - expected).abs().max_element() < 1e-5, "{orange}");
        for word in ["", "red", "#fff", "#12345g", "#+12345", "1,2,3"] {
            assert!(word.parse::<Background>().is_err(), "{word}");
        }
    }
}
