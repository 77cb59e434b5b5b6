//! PLY, as text or binary.

use std::io::Cursor;

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult};

use super::{Complaint, MeshLimits, push_polygon};
use crate::mesh_data::MeshData;

/// A vertex; its normal is read if it has one.
struct VertexEntry {
    position: DVec3,
    normal: DVec3,
}

impl PropertyAccess for VertexEntry {
    fn new() -> Self {
        Self {
            position: DVec3::NAN,
            normal: DVec3::NAN,
        }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let target = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            _ => return PropertyAccessResult::Ignored,
        };
        match read_number(&value) {
            Some(number) => *target = number,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

/// The corners of a polygon.
struct FaceEntry(Vec<u32>);

impl PropertyAccess for FaceEntry {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        match value.to_u32_list() {
            Some(corners) => self.0 = corners,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

/// What is passed over.
struct OtherEntry;

impl PropertyAccess for OtherEntry {
    fn new() -> Self {
        Self
    }
}

/// All faces of a file; polygons are cut into triangles.
pub(super) fn parse(bytes: &[u8], limits: MeshLimits) -> Result<MeshData, Complaint> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<OtherEntry>::new().read_header(&mut reader);
    let header = header.map_err(explain)?;
    let mut data = MeshData::default();
    for (_, element) in &header.elements {
        check_element(element, bytes.len())?;
        match element.name.as_str() {
            "vertex" => {
                limits.check(data.vertices.len().saturating_add(element.count), 0)?;
                read_vertices(&mut reader, element, &header, &mut data)?;
            }
            "face" => {
                limits.check(0, data.faces.len().saturating_add(element.count))?;
                read_faces(&mut reader, element, &header, &mut data, limits)?;
            }
            _ => {
                let others = Parser::<OtherEntry>::new();
                others
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(explain)?;
            }
        }
    }
    Ok(data)
}

/// Each element takes a byte at least. One without properties would take none, and could be there any number of times.
fn check_element(element: &ElementDef, bytes: usize) -> Result<(), Complaint> {
    let has_properties = element.properties.iter().next().is_some();
    if element.count > 0 && (element.count > bytes || !has_properties) {
        let what = format!(
            "a PLY file of {bytes} bytes that promises {} elements \"{}\"",
            element.count, element.name
        );
        return Err(Complaint::new(what, "name a file that is complete"));
    }
    Ok(())
}

fn read_vertices(
    reader: &mut Reader<Cursor<&[u8]>>,
    element: &ElementDef,
    header: &Header,
    data: &mut MeshData,
) -> Result<(), Complaint> {
    let parser = Parser::<VertexEntry>::new();
    let entries = parser.read_payload_for_element(reader, element, header);
    for entry in entries.map_err(explain)? {
        data.vertices.push(entry.position);
        data.normals.push(entry.normal);
    }
    let has_normals = ["nx", "ny", "nz"]
        .iter()
        .all(|name| element.properties.iter().any(|(key, _)| key == name));
    if !has_normals {
        data.normals.clear();
    }
    Ok(())
}

fn read_faces(
    reader: &mut Reader<Cursor<&[u8]>>,
    element: &ElementDef,
    header: &Header,
    data: &mut MeshData,
    limits: MeshLimits,
) -> Result<(), Complaint> {
    let parser = Parser::<FaceEntry>::new();
    let entries = parser.read_payload_for_element(reader, element, header);
    for entry in entries.map_err(explain)? {
        push_polygon(&mut data.faces, &entry.0, limits)?;
    }
    Ok(())
}

fn read_number(value: &Property) -> Option<f64> {
    Some(match value {
        Property::Char(n) => f64::from(*n),
        Property::UChar(n) => f64::from(*n),
        Property::Short(n) => f64::from(*n),
        Property::UShort(n) => f64::from(*n),
        Property::Int(n) => f64::from(*n),
        Property::UInt(n) => f64::from(*n),
        Property::Float(n) => f64::from(*n),
        Property::Double(n) => *n,
        _ => return None,
    })
}

fn explain(error: ParseError) -> Complaint {
    let what = match error.line() {
        Some(line) => format!("a PLY file with a fault in line {line} ({error})"),
        None => format!("a PLY file with a fault ({error})"),
    };
    Complaint::new(what, "name a file that is complete")
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat FORMAT 1.0\nelement vertex 4\nproperty float x\nproperty double y\n\
                          property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    fn corners() -> [[f64; 3]; 4] {
        [
            [0.0, 0.0, 0.5],
            [1.0, 0.0, 0.5],
            [1.0, 0.1, 0.5],
            [0.0, 1.0, 0.5],
        ]
    }

    #[test]
    fn text_and_binary_of_either_order_are_the_same_mesh() {
        let mut text = HEADER.replace("FORMAT", "ascii");
        for [x, y, z] in corners() {
            text += &format!("{x} {y} {z}\n");
        }
        text += "4 0 1 2 3\n";
        let data = parse(text.as_bytes(), MeshLimits::default()).unwrap();
        assert_eq!(data.faces, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(data.vertices[2], DVec3::new(1.0, 0.1, 0.5));
        assert!(data.normals.is_empty());
        let mut little = HEADER
            .replace("FORMAT", "binary_little_endian")
            .into_bytes();
        let mut big = HEADER.replace("FORMAT", "binary_big_endian").into_bytes();
        for [x, y, z] in corners() {
            little.extend((x as f32).to_le_bytes());
            little.extend(y.to_le_bytes());
            little.extend((z as f32).to_le_bytes());
            big.extend((x as f32).to_be_bytes());
            big.extend(y.to_be_bytes());
            big.extend((z as f32).to_be_bytes());
        }
        little.push(4);
        big.push(4);
        for corner in 0..4i32 {
            little.extend(corner.to_le_bytes());
            big.extend(corner.to_be_bytes());
        }
        assert_eq!(parse(&little, MeshLimits::default()).unwrap(), data);
        assert_eq!(parse(&big, MeshLimits::default()).unwrap(), data);
    }

    #[test]
    fn promises_that_a_file_does_not_keep_are_refused_before_memory_is_taken() {
        let many = HEADER
            .replace("FORMAT", "ascii")
            .replace("vertex 4", "vertex 4000000000");
        assert!(
            parse(many.as_bytes(), MeshLimits::default())
                .unwrap_err()
                .what
                .contains("promises")
        );
        let empty = "ply\nformat binary_little_endian 1.0\nelement ghost 4\nend_header\n";
        assert!(parse(empty.as_bytes(), MeshLimits::default()).is_err());
        assert!(parse(b"ply\n", MeshLimits::default()).is_err());
    }
}
