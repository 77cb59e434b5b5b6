//! From the text of a GRF file to its blocks.

use glam::DVec3;
use merlkit::Result;

use super::attributes::{read_attribute, read_body};
use super::meshes::read_mesh_block;
use super::tokens::{Token, Tokens};
use super::tree::{Definition, GrfBlock, LightBlock, TransformStep};
use super::values::{expect_sign, expect_word, read_vec3};

/// How deep blocks may lie in one another.
const MOST_NESTED: usize = 64;

/// Reads a whole file.
///
/// A closing `end` too many, as in the second example of the thesis, is passed over at the end of the file.
///
/// # Errors
/// [`merlkit::Error::Argument`] with the line of what is not in the grammar.
pub(super) fn read_blocks(name: &str, text: &str) -> Result<Vec<GrfBlock>> {
    let mut tokens = Tokens::new(name, text);
    let blocks = read_list(&mut tokens, 0)?;
    match tokens.next()? {
        Token::End => Ok(blocks),
        end => match tokens.peek()? {
            Token::End if end == Token::Word("end") => Ok(blocks),
            _ => Err(tokens.unexpected("a block", end)),
        },
    }
}

/// Blocks up to an `end` or the end of the file, neither of which is read.
fn read_list(tokens: &mut Tokens<'_>, depth: usize) -> Result<Vec<GrfBlock>> {
    if depth > MOST_NESTED {
        let what = format!("blocks that lie more than {MOST_NESTED} deep in one another");
        return Err(tokens.fault(what, "nest fewer blocks"));
    }
    let mut blocks = Vec::new();
    loop {
        match tokens.peek()? {
            Token::End | Token::Word("end") => return Ok(blocks),
            _ => blocks.push(read_block(tokens, depth)?),
        }
    }
}

fn read_block(tokens: &mut Tokens<'_>, depth: usize) -> Result<GrfBlock> {
    let before = *tokens;
    let first = tokens.next()?;
    let line = tokens.last_line_number();
    match first {
        Token::Word("begin") => {
            expect_word(tokens, "mesh")?;
            Ok(GrfBlock::Mesh(read_mesh_block(tokens, line)?))
        }
        Token::Word("light") => Ok(GrfBlock::Light(read_light(tokens, line)?)),
        Token::Word("include") => match tokens.next()? {
            Token::Text(file) => Ok(GrfBlock::Include {
                file: file.to_owned(),
                line,
            }),
            other => Err(tokens.unexpected("the name of a file in quotes", other)),
        },
        Token::Word("transform") => {
            let steps = read_steps(tokens)?;
            Ok(GrfBlock::Transform {
                steps,
                blocks: read_body_blocks(tokens, depth)?,
                line,
            })
        }
        Token::Word("def") => {
            let definitions = read_definitions(tokens)?;
            Ok(GrfBlock::Define {
                definitions,
                blocks: read_body_blocks(tokens, depth)?,
                line,
            })
        }
        Token::Word("params") => read_params(tokens),
        _ => {
            *tokens = before;
            read_attribute_block(tokens)
        }
    }
}

fn read_attribute_block(tokens: &mut Tokens<'_>) -> Result<GrfBlock> {
    if let Some(attribute) = read_attribute(tokens)? {
        return Ok(GrfBlock::Attribute(attribute));
    }
    let found = tokens.next()?;
    let expected = "begin mesh, light, include, transform, def, params or an attribute";
    Err(tokens.unexpected(expected, found))
}

/// `begin … end`.
fn read_body_blocks(tokens: &mut Tokens<'_>, depth: usize) -> Result<Vec<GrfBlock>> {
    expect_word(tokens, "begin")?;
    let blocks = read_list(tokens, depth + 1)?;
    expect_word(tokens, "end")?;
    Ok(blocks)
}

fn read_light(tokens: &mut Tokens<'_>, line: usize) -> Result<LightBlock> {
    expect_word(tokens, "begin")?;
    let corner = read_vec3(tokens)?;
    let edges = [read_vec3(tokens)?, read_vec3(tokens)?];
    let mut rgb = DVec3::ONE;
    if tokens.peek()? == Token::Word("rgb") {
        tokens.next()?;
        rgb = read_vec3(tokens)?;
    }
    expect_word(tokens, "end")?;
    Ok(LightBlock {
        corner,
        edges,
        rgb,
        line,
    })
}

/// Steps up to `begin`, at least one.
fn read_steps(tokens: &mut Tokens<'_>) -> Result<Vec<TransformStep>> {
    let mut steps = Vec::new();
    loop {
        let step = match tokens.peek()? {
            Token::Word("scale") => TransformStep::Scale,
            Token::Word("rotation") => TransformStep::Rotation,
            Token::Word("translation") => TransformStep::Translation,
            Token::Word("begin") if !steps.is_empty() => return Ok(steps),
            _ => {
                let found = tokens.next()?;
                return Err(tokens.unexpected("scale, rotation or translation", found));
            }
        };
        tokens.next()?;
        steps.push(step(read_vec3(tokens)?));
    }
}

/// `NAME = MEANING` up to `begin`, at least one.
fn read_definitions(tokens: &mut Tokens<'_>) -> Result<Vec<Definition>> {
    let mut definitions = Vec::new();
    loop {
        match tokens.next()? {
            Token::Word(name) if name != "begin" => {
                expect_sign(tokens, '=')?;
                definitions.push(Definition {
                    name: name.to_owned(),
                    meaning: read_body(tokens)?,
                });
            }
            other => return Err(tokens.unexpected("a name", other)),
        }
        if tokens.peek()? == Token::Word("begin") {
            return Ok(definitions);
        }
    }
}

/// `params begin dependent view (x,y,z) end`.
fn read_params(tokens: &mut Tokens<'_>) -> Result<GrfBlock> {
    for word in ["begin", "dependent", "view"] {
        expect_word(tokens, word)?;
    }
    let view = read_vec3(tokens)?;
    expect_word(tokens, "end")?;
    Ok(GrfBlock::View(view))
}
