//! The vertices and faces of a mesh.

use glam::DVec3;
use merlkit::Result;

use super::attributes::read_attribute;
use super::tokens::{Token, Tokens};
use super::tree::{FaceGroup, MeshBlock};
use super::values::{expect_sign, expect_word, read_index, read_number, read_vec2, read_vec3};

/// Reads what follows `begin mesh`, up to `end mesh`.
///
/// # Errors
/// [`merlkit::Error::Argument`] with the line of what is not in the grammar, and of a corner without a vertex.
pub(super) fn read_mesh_block(tokens: &mut Tokens<'_>, line: usize) -> Result<MeshBlock> {
    let mut mesh = MeshBlock {
        line,
        ..MeshBlock::default()
    };
    while let Some(attribute) = read_attribute(tokens)? {
        mesh.attributes.push(attribute);
    }
    expect_word(tokens, "begin")?;
    expect_word(tokens, "vertexs")?;
    let mut with_normals = 0;
    while tokens.peek()? != Token::Word("end") {
        let (vertex, normal) = read_vertex(tokens)?;
        with_normals += usize::from(normal.is_some());
        mesh.vertices.push(vertex);
        mesh.normals.push(normal.unwrap_or_default());
    }
    if with_normals < mesh.vertices.len() {
        mesh.normals.clear();
    }
    for word in ["end", "vertexs", "begin", "faces"] {
        expect_word(tokens, word)?;
    }
    read_faces(tokens, &mut mesh)?;
    for word in ["end", "faces", "end", "mesh"] {
        expect_word(tokens, word)?;
    }
    Ok(mesh)
}

/// A place, with its normal. Irradiance and texture coordinates are passed over.
fn read_vertex(tokens: &mut Tokens<'_>) -> Result<(DVec3, Option<DVec3>)> {
    let mut normal = None;
    loop {
        match tokens.peek()? {
            Token::Sign('(') => return Ok((read_vec3(tokens)?, normal)),
            Token::Word("normal") => {
                tokens.next()?;
                normal = Some(read_vec3(tokens)?);
            }
            Token::Word("irad") => {
                tokens.next()?;
                read_vec3(tokens)?;
            }
            Token::Word("uv") => {
                tokens.next()?;
                read_vec2(tokens)?;
            }
            Token::Word("begin") => skip_irradiance(tokens)?,
            _ => {
                let found = tokens.next()?;
                return Err(tokens.unexpected("a vertex (x,y,z), or end vertexs", found));
            }
        }
    }
}

/// `begin list (ray (x,y,z) irad (r,g,b))* end list`.
fn skip_irradiance(tokens: &mut Tokens<'_>) -> Result<()> {
    expect_word(tokens, "begin")?;
    expect_word(tokens, "list")?;
    while tokens.peek()? != Token::Word("end") {
        expect_word(tokens, "ray")?;
        read_vec3(tokens)?;
        expect_word(tokens, "irad")?;
        read_vec3(tokens)?;
    }
    expect_word(tokens, "end")?;
    expect_word(tokens, "list")
}

/// Faces up to `end`, in groups of the same attributes.
fn read_faces(tokens: &mut Tokens<'_>, mesh: &mut MeshBlock) -> Result<()> {
    let mut group = FaceGroup::default();
    loop {
        let corners = match tokens.peek()? {
            Token::Word("end") => break,
            Token::Sign('(') => read_listed(tokens, mesh.vertices.len())?,
            Token::Number(_) => read_counted(tokens, mesh.vertices.len())?,
            _ => match read_attribute(tokens)? {
                Some(attribute) => {
                    if !group.faces.is_empty() {
                        mesh.groups.push(std::mem::take(&mut group));
                    }
                    group.attributes.push(attribute);
                    continue;
                }
                None => {
                    let found = tokens.next()?;
                    return Err(tokens.unexpected("a face, an attribute or end faces", found));
                }
            },
        };
        if corners.len() < 3 {
            let what = format!("a face of {} corners", corners.len());
            return Err(tokens.fault(what, "give three or more"));
        }
        // A convex polygon is a fan of triangles about its first corner.
        for pair in corners[1..].windows(2) {
            group.faces.push([corners[0], pair[0], pair[1]]);
        }
    }
    mesh.groups.push(group);
    Ok(())
}

/// `(0, 1, 2)`.
fn read_listed(tokens: &mut Tokens<'_>, vertices: usize) -> Result<Vec<u32>> {
    let mut corners = Vec::new();
    expect_sign(tokens, '(')?;
    loop {
        corners.push(read_index(tokens, vertices, "vertices")?);
        match tokens.next()? {
            Token::Sign(',') => {}
            Token::Sign(')') => return Ok(corners),
            other => return Err(tokens.unexpected(", or )", other)),
        }
    }
}

/// `3 0 1 2`.
fn read_counted(tokens: &mut Tokens<'_>, vertices: usize) -> Result<Vec<u32>> {
    let count = read_number(tokens)?;
    if !(3.0..=1e9).contains(&count) || count.fract() != 0.0 {
        return Err(tokens.fault(format!("a face of {count} corners"), "give three or more"));
    }
    // The count is believed as far as there are corners in the file.
    let mut corners = Vec::new();
    for _ in 0..count as usize {
        corners.push(read_index(tokens, vertices, "vertices")?);
    }
    Ok(corners)
}
