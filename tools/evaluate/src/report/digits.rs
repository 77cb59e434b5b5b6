//! Numbers with as many digits as their errors leave.

/// More decimals than this are never written.
const MOST_DECIMALS: f64 = 12.0;

/// A value to two digits of its standard error: "0.72" for 0.7239 ± 0.56, "-3470" for -3471 ± 560. An error that is 0 or no
/// number leaves three digits of the value.
pub(super) fn rounded(value: f64, standard_error: f64) -> String {
    if standard_error.is_finite() && standard_error > 0.0 {
        to_step(value, standard_error.log10().floor() - 1.0)
    } else {
        significant(value, 3)
    }
}

/// The same with a sign in front of every value but 0.
pub(super) fn with_sign(value: f64, standard_error: f64) -> String {
    let text = rounded(value, standard_error);
    if value > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// A value to that many significant digits, without an exponent: "0.0012", "26", "1200".
pub(super) fn significant(value: f64, digits: u8) -> String {
    if !value.is_finite() || value == 0.0 {
        return value.to_string();
    }
    let first = value.abs().log10().floor();
    to_step(value, first + 1.0 - f64::from(digits))
}

/// Digits of a number in groups of three from 10,000 on, with narrow spaces that don't break.
pub(super) fn grouped(number: &str) -> String {
    let whole = number.split('.').next().unwrap_or_default().len();
    if whole < 5 {
        return number.to_owned();
    }
    let mut text = String::new();
    for (i, c) in number.chars().enumerate() {
        if i > 0 && i < whole && (whole - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    text
}

/// A value to a multiple of a power of ten.
fn to_step(value: f64, exponent: f64) -> String {
    if exponent >= 0.0 {
        let step = 10f64.powf(exponent);
        return format!("{:.0}", (value / step).round() * step);
    }
    let decimals = (-exponent).min(MOST_DECIMALS) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_end_with_the_error() {
        assert_eq!(rounded(0.7239, 0.56), "0.72");
        assert_eq!(rounded(0.7239, 0.056), "0.724");
        assert_eq!(rounded(-3471.0, 560.0), "-3470");
        assert_eq!(rounded(0.5, 0.0), "0.500");
        assert_eq!(with_sign(13.15, 4.749), "+13.2");
        assert_eq!(with_sign(-0.7, 0.6), "-0.70");
    }

    #[test]
    fn long_numbers_are_grouped() {
        assert_eq!(grouped("9876"), "9876");
        assert_eq!(grouped("120000"), "120\u{202f}000");
        assert_eq!(grouped("1200000.5"), "1\u{202f}200\u{202f}000.5");
    }

    #[test]
    fn significant_digits_need_no_exponent() {
        assert_eq!(significant(26.2, 2), "26");
        assert_eq!(significant(1234.0, 2), "1200");
        assert_eq!(significant(0.001234, 2), "0.0012");
        assert_eq!(significant(0.0, 2), "0");
        assert_eq!(significant(f64::INFINITY, 2), "inf");
    }
}
