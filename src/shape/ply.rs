//! `ply`: Stanford meshes, ascii and binary.

use super::{
    mesh::{FACE_NORMALS, Mesh, MeshData},
    model::COMMON,
    ply_attributes::{Group, groups},
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{Attribute, DMat4, DVec3, Spectrum, Vec2},
    memory,
};
use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType},
};
use std::{fs::File, io::BufReader, path::Path};

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A mesh from a PLY file.";
    file("filename", "The file."),
    boolean("flip_tex_coords", false, "True: flips the texture coordinate v.");
    FACE_NORMALS, COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Mesh> {
    let file = params.file("filename")?;
    let flip = params.boolean("flip_tex_coords")?;
    let source = File::open(&file).map_err(|e| Error::io(&file, "read", &e))?;
    let length = source.metadata().map_err(|e| Error::io(&file, "read", &e))?.len();
    MeshData::check_memory(&file, length, MEMORY_PER_BYTE)?;
    let ply = Ply::open(&file, source)?;
    let unused = ply.unused();
    if !unused.is_empty() {
        let text = format!("{}: not used of it: {}", file.display(), unused.join(", "));
        params.library.warn(params.location(), &text);
    }
    let data = ply.read(flip)?;
    Mesh::build(params, world, &file, data)
}

/// What a byte becomes: a triangle takes 13 of them, and an [`Element`] with its list, before it is one.
const MEMORY_PER_BYTE: u64 = 16;

/// All names under which each number of a vertex is known: position, normal, texture coordinates.
const NAMES: [&[&str]; 8] =
    [&["x"], &["y"], &["z"], &["nx"], &["ny"], &["nz"], &["u", "s", "texture_u"], &["v", "t", "texture_v"]];

/// All names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex, a face, or an element of no interest. One type for all, as the parser is compiled for each.
struct Element {
    /// In the order of `NAMES`.
    numbers: [f64; 8],
    /// None where the list held something else than vertex numbers.
    corners: Option<Vec<u32>>,
    /// All other numbers, in the order of the file.
    others: Vec<f32>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self { numbers: [0.0; 8], corners: None, others: vec![] }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if CORNERS.contains(&name) {
            self.corners = value.to_u32_list();
        } else if let Some(slot) = NAMES.iter().position(|names| names.contains(&name)) {
            let Some(value) = scalar(&value) else { return PropertyAccessResult::UnsupportedType };
            self.numbers[slot] = value;
        } else {
            let Some(value) = scalar(&value) else { return PropertyAccessResult::Ignored };
            self.others.push(value as f32);
        }
        PropertyAccessResult::Set
    }
}

fn scalar(value: &Property) -> Option<f64> {
    Some(match *value {
        Property::Char(x) => x.into(),
        Property::UChar(x) => x.into(),
        Property::Short(x) => x.into(),
        Property::UShort(x) => x.into(),
        Property::Int(x) => x.into(),
        Property::UInt(x) => x.into(),
        Property::Float(x) => x.into(),
        Property::Double(x) => x,
        _ => return None,
    })
}

/// An open file whose header has been read.
struct Ply<'a> {
    file: &'a Path,
    reader: Reader<BufReader<File>>,
    header: Header,
}

impl<'a> Ply<'a> {
    fn open(file: &'a Path, source: File) -> Result<Self> {
        let mut reader = Reader::new(BufReader::new(source));
        let header = Parser::<Element>::new().read_header(&mut reader).map_err(|e| broken(file, &e))?;
        Ok(Self { file, reader, header })
    }

    fn wrong(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        Error::new(self.file.display(), expected, found, "correct the file, or export the mesh again")
    }

    /// Elements and properties that have no meaning here.
    fn unused(&self) -> Vec<String> {
        let unknown = |element: &ElementDef| -> Vec<String> {
            let (others, groups) = colors(element);
            let grouped: Vec<_> = groups.iter().flat_map(|group| &group.slots).map(|i| others[*i]).collect();
            let known = |name: &str| match element.name.as_str() {
                _ if grouped.contains(&name) => true,
                "vertex" => NAMES.iter().any(|names| names.contains(&name)),
                _ => CORNERS.contains(&name),
            };
            let names = element.properties.keys().filter(|name| !known(name));
            names.map(|name| format!("\"{name}\" of \"{}\"", element.name)).collect()
        };
        let of = |element: &ElementDef| match element.name.as_str() {
            "vertex" | "face" => unknown(element),
            name => vec![format!("\"{name}\"")],
        };
        self.header.elements.values().flat_map(of).collect()
    }

    fn read(mut self, flip: bool) -> Result<MeshData> {
        let elements: Vec<ElementDef> = self.header.elements.values().cloned().collect();
        let (mut vertices, mut faces): (Vec<Element>, Vec<Element>) = (vec![], vec![]);
        for element in &elements {
            self.check(element)?;
            match element.name.as_str() {
                "vertex" => vertices = self.payload(element)?,
                "face" => faces = self.payload(element)?,
                _ => drop(self.payload(element)?),
            }
        }
        let has = |names: &[usize]| {
            let vertex = elements.iter().find(|e| e.name == "vertex");
            let given = |slot: &usize| {
                vertex.is_some_and(|v| NAMES[*slot].iter().any(|n| v.properties.contains_key(*n)))
            };
            names.iter().all(given)
        };
        let normals = if has(&[3, 4, 5]) { vertices.iter().map(|v| v.triple(3)).collect() } else { vec![] };
        let uvs = if has(&[6, 7]) { vertices.iter().map(|v| v.uv(flip)).collect() } else { vec![] };
        let triangles = self.triangles(&faces, vertices.len())?;
        self.check_attributes(&elements, vertices.len().max(triangles.len()))?;
        let attributes = self.attributes(&elements, &vertices, &faces)?;
        let positions = vertices.iter().map(|v| v.triple(0)).collect();
        let data = MeshData { positions, normals, uvs, triangles, attributes };
        match vertices.iter().position(|v| !v.numbers.iter().all(|x| x.is_finite())) {
            Some(index) => {
                Err(self.wrong("finite numbers", format!("{:?} in vertex {index}", vertices[index].numbers)))
            }
            None => Ok(data),
        }
    }

    /// An error unless memory holds all colours, of `count` vertices or triangles each.
    fn check_attributes(&self, elements: &[ElementDef], count: usize) -> Result<()> {
        let groups: usize = elements.iter().map(|element| colors(element).1.len()).sum();
        let needed = (groups as u64).checked_mul(count as u64 * size_of::<Spectrum>() as u64);
        let size = format!("{groups} colours of {count} vertices or triangles each");
        memory::check(self.file.display(), "a mesh", &size, needed, "take colours out of the file")
    }

    /// Colours of vertices and, for each triangle that a face becomes, of faces.
    fn attributes(
        &self,
        elements: &[ElementDef],
        vertices: &[Element],
        faces: &[Element],
    ) -> Result<Vec<Attribute>> {
        let mut attributes = Vec::new();
        for element in elements {
            let (all, is_of_faces) = match element.name.as_str() {
                "vertex" => (vertices, false),
                "face" => (faces, true),
                _ => continue,
            };
            for Group { name, slots } in colors(element).1 {
                let count =
                    |e: &Element| if is_of_faces { e.corners.as_ref().map_or(0, Vec::len) - 2 } else { 1 };
                let values: Vec<_> =
                    all.iter().flat_map(|e| std::iter::repeat_n(e.color(&slots), count(e))).collect();
                if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                    let found = format!("{} as number {index} of \"{name}\"", values[index]);
                    return Err(self.wrong("finite numbers", found));
                }
                attributes.push(Attribute { name, values });
            }
        }
        Ok(attributes)
    }

    /// Elements of nothing would be read for ever from no bytes at all.
    fn check(&self, element: &ElementDef) -> Result<()> {
        let ElementDef { name, count, properties } = element;
        if properties.is_empty() && *count > 0 {
            return Err(
                self.wrong(format!("properties of \"{name}\""), format!("{count} of them without any"))
            );
        }
        let needed: &[&str] = if name == "vertex" { &["x", "y", "z"] } else { &[] };
        if let Some(missing) = needed.iter().find(|p| !properties.contains_key(**p)) {
            return Err(self.wrong(format!("a property \"{missing}\" of vertices"), "none"));
        }
        Ok(())
    }

    fn payload(&mut self, element: &ElementDef) -> Result<Vec<Element>> {
        let read = Parser::new().read_payload_for_element(&mut self.reader, element, &self.header);
        read.map_err(|e| broken(self.file, &e))
    }

    /// Polygons become fans around their first corners.
    fn triangles(&self, faces: &[Element], vertices: usize) -> Result<Vec<[u32; 3]>> {
        let mut triangles = Vec::with_capacity(faces.len());
        for (number, face) in faces.iter().enumerate() {
            let corners = face.corners.as_deref().unwrap_or_default();
            if corners.len() < 3 || corners.iter().any(|i| (*i as usize) >= vertices) {
                let expected = format!("three or more vertex numbers below {vertices} in every face");
                return Err(self.wrong(expected, format!("{corners:?} in face {number}")));
            }
            triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        }
        Ok(triangles)
    }
}

/// The numbers of an element that have no other meaning, and the colours among them.
fn colors(element: &ElementDef) -> (Vec<&str>, Vec<Group>) {
    let is_known = |name: &str| CORNERS.contains(&name) || NAMES.iter().any(|names| names.contains(&name));
    let is_number = |kind: &PropertyType| matches!(kind, PropertyType::Scalar(_));
    let others = element.properties.iter().filter(|(name, p)| !is_known(name) && is_number(&p.data_type));
    let others: Vec<&str> = others.map(|(name, _)| name.as_str()).collect();
    let groups = groups(&element.name, &others);
    (others, groups)
}

impl Element {
    /// Of three of the other numbers, or of one for all channels.
    fn color(&self, slots: &[usize]) -> Spectrum {
        let channel = |i: usize| slots.get(i.min(slots.len() - 1)).and_then(|slot| self.others.get(*slot));
        Spectrum::from([0, 1, 2].map(|i| channel(i).copied().unwrap_or(0.0)))
    }

    fn triple(&self, first: usize) -> DVec3 {
        DVec3::new(self.numbers[first], self.numbers[first + 1], self.numbers[first + 2])
    }

    fn uv(&self, flip: bool) -> Vec2 {
        Vec2::new(self.numbers[6] as f32, if flip { 1.0 - self.numbers[7] } else { self.numbers[7] } as f32)
    }
}

fn broken(file: &Path, error: &ParseError) -> Error {
    let line = error.line().map(|l| format!(":{l}")).unwrap_or_default();
    let message = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    // What follows is the parser's view of itself.
    let message = message.split(" Error: ").next().unwrap_or_default();
    let found: String = message.chars().take(300).collect();
    let place = format!("{}{line}", file.display());
    Error::new(place, "a well-formed PLY file", found, "correct the file, or export the mesh again")
}
