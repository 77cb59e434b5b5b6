//! Vectors, whole numbers and expected words.

use glam::{DVec2, DVec3};
use merlkit::Result;

use super::tokens::{Token, Tokens};

/// Reads a word that must come now.
pub(super) fn expect_word(tokens: &mut Tokens<'_>, word: &str) -> Result<()> {
    match tokens.next()? {
        Token::Word(found) if found == word => Ok(()),
        other => Err(tokens.unexpected(word, other)),
    }
}

/// Reads a sign that must come now.
pub(super) fn expect_sign(tokens: &mut Tokens<'_>, sign: char) -> Result<()> {
    match tokens.next()? {
        Token::Sign(found) if found == sign => Ok(()),
        other => Err(tokens.unexpected(&sign.to_string(), other)),
    }
}

pub(super) fn read_number(tokens: &mut Tokens<'_>) -> Result<f64> {
    match tokens.next()? {
        Token::Number(number) => Ok(number),
        other => Err(tokens.unexpected("a number", other)),
    }
}

/// `(x, y, z)`.
pub(super) fn read_vec3(tokens: &mut Tokens<'_>) -> Result<DVec3> {
    read_vector(tokens).map(DVec3::from_array)
}

/// `(x, y)`.
pub(super) fn read_vec2(tokens: &mut Tokens<'_>) -> Result<DVec2> {
    read_vector(tokens).map(DVec2::from_array)
}

fn read_vector<const N: usize>(tokens: &mut Tokens<'_>) -> Result<[f64; N]> {
    let mut vector = [0.0; N];
    expect_sign(tokens, '(')?;
    for (i, value) in vector.iter_mut().enumerate() {
        if i > 0 {
            expect_sign(tokens, ',')?;
        }
        *value = read_number(tokens)?;
    }
    expect_sign(tokens, ')')?;
    Ok(vector)
}

/// A whole number from 0 to below `count`, which are so many `what`.
pub(super) fn read_index(tokens: &mut Tokens<'_>, count: usize, what: &str) -> Result<u32> {
    let number = read_number(tokens)?;
    if number >= 0.0 && number.fract() == 0.0 && number < count.min(u32::MAX as usize) as f64 {
        return Ok(number as u32);
    }
    Err(tokens.fault(
        format!("{number} is none of the {count} {what}, which are counted from 0"),
        "give a whole number that is there",
    ))
}
