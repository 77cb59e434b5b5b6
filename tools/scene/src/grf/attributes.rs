//! How faces look: colours, BRDFs, samplers and textures, as they are written.

use merlkit::Result;

use super::tokens::{Token, Tokens};
use super::tree::{Attribute, AttributeValue, BrdfWords, ModelWords, ParameterValue};
use super::values::{expect_sign, read_number, read_vec3};

/// Terms of a combination, at most.
const MOST_TERMS: usize = 64;

/// Reads an attribute, or a use of one that has a name. `None` if something else comes, which is not read.
///
/// # Errors
/// [`merlkit::Error::Argument`] with the line of what is not in the grammar.
pub(super) fn read_attribute(tokens: &mut Tokens<'_>) -> Result<Option<Attribute>> {
    match tokens.peek()? {
        Token::Word("use") => {
            tokens.next()?;
            read_used(tokens).map(Some)
        }
        Token::Word("color") => read_used(tokens).map(Some),
        Token::Word("rgb" | "brdf" | "pdf" | "texture") => read_body(tokens).map(Some),
        Token::Word("emission") => {
            tokens.next()?;
            let line = tokens.last_line_number();
            let value = AttributeValue::Emission(read_vec3(tokens)?);
            Ok(Some(Attribute { value, line }))
        }
        _ => Ok(None),
    }
}

/// The kind and the name behind `use`.
fn read_used(tokens: &mut Tokens<'_>) -> Result<Attribute> {
    let kind = tokens.next()?;
    let line = tokens.last_line_number();
    if !matches!(kind, Token::Word("texture" | "color" | "brdf" | "pdf")) {
        return Err(tokens.unexpected("texture, color, brdf or pdf", kind));
    }
    let name = match tokens.next()? {
        Token::Word(name) => name.to_owned(),
        other => return Err(tokens.unexpected("a name", other)),
    };
    let words = ModelWords {
        name,
        parameters: Vec::new(),
    };
    let value = match kind {
        Token::Word("brdf") => AttributeValue::Brdf(BrdfWords::Model(words)),
        Token::Word("pdf") => AttributeValue::Pdf(words),
        Token::Word("color") => AttributeValue::NamedRgb(words.name),
        _ => AttributeValue::Texture,
    };
    Ok(Attribute { value, line })
}

/// What an attribute or a definition says: `rgb`, `brdf`, `pdf` or `texture` and what belongs to it.
///
/// # Errors
/// As [`read_attribute`].
pub(super) fn read_body(tokens: &mut Tokens<'_>) -> Result<Attribute> {
    let kind = tokens.next()?;
    let line = tokens.last_line_number();
    let value = match kind {
        Token::Word("rgb") => AttributeValue::Rgb(read_vec3(tokens)?),
        Token::Word("brdf") => AttributeValue::Brdf(read_brdf(tokens)?),
        Token::Word("pdf") => AttributeValue::Pdf(read_model(tokens)?),
        Token::Word("texture") => match tokens.next()? {
            Token::Text(_) | Token::Word(_) => AttributeValue::Texture,
            other => return Err(tokens.unexpected("a file in quotes, or a name", other)),
        },
        other => return Err(tokens.unexpected("rgb, brdf, pdf or texture", other)),
    };
    Ok(Attribute { value, line })
}

fn read_brdf(tokens: &mut Tokens<'_>) -> Result<BrdfWords> {
    match tokens.peek()? {
        Token::Text(file) => {
            tokens.next()?;
            Ok(BrdfWords::Measured(file.to_owned()))
        }
        Token::Word("measured") => {
            tokens.next()?;
            match tokens.next()? {
                Token::Text(file) => Ok(BrdfWords::Measured(file.to_owned())),
                other => Err(tokens.unexpected("a file in quotes", other)),
            }
        }
        Token::Word("combine") => {
            tokens.next()?;
            read_terms(tokens).map(BrdfWords::Combine)
        }
        _ => read_model(tokens).map(BrdfWords::Model),
    }
}

/// `WEIGHT NAME, WEIGHT NAME`.
fn read_terms(tokens: &mut Tokens<'_>) -> Result<Vec<(f64, String)>> {
    let mut terms = Vec::new();
    loop {
        let weight = read_number(tokens)?;
        match tokens.next()? {
            Token::Word(name) => terms.push((weight, name.to_owned())),
            other => return Err(tokens.unexpected("the name of a BRDF", other)),
        }
        if terms.len() > MOST_TERMS {
            let what = format!("a combination of more than {MOST_TERMS} BRDFs");
            return Err(tokens.fault(what, "combine fewer"));
        }
        if tokens.peek()? != Token::Sign(',') {
            return Ok(terms);
        }
        tokens.next()?;
    }
}

/// `NAME KEY=VALUE KEY=VALUE`.
fn read_model(tokens: &mut Tokens<'_>) -> Result<ModelWords> {
    let name = match tokens.next()? {
        Token::Word(name) => name.to_owned(),
        other => return Err(tokens.unexpected("the name of a model", other)),
    };
    let mut parameters = Vec::new();
    while let Some((key, value)) = read_parameter(tokens)? {
        if parameters.iter().any(|(known, _)| *known == key) {
            return Err(tokens.fault(format!("{key} is given twice"), "give it once"));
        }
        parameters.push((key, value));
    }
    Ok(ModelWords { name, parameters })
}

/// A parameter; `None`, and nothing is read, if what comes is none. `NAME = brdf …` is the next definition.
fn read_parameter(tokens: &mut Tokens<'_>) -> Result<Option<(String, ParameterValue)>> {
    let mut ahead = *tokens;
    let Token::Word(key) = ahead.next()? else {
        return Ok(None);
    };
    if ahead.peek()? != Token::Sign('=') {
        return Ok(None);
    }
    expect_sign(&mut ahead, '=')?;
    let value = match ahead.next()? {
        Token::Number(number) => ParameterValue::Number(number),
        Token::Word("true" | "T") => ParameterValue::Flag(true),
        Token::Word("false" | "F") => ParameterValue::Flag(false),
        _ => return Ok(None),
    };
    *tokens = ahead;
    Ok(Some((key.to_owned(), value)))
}
