//! `obj`: Wavefront meshes. Read here rather than by a crate: coordinates keep their f64 digits until the scene
//! is recentred, every error has its line, and faces of which only some have normals stay aligned.

use super::{
    mesh::{FACE_NORMALS, Mesh, MeshData},
    model::COMMON,
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DMat4, DVec3, vec2},
};
use std::{collections::HashMap, path::Path};

/// Its parameters.
pub(super) const TABLE: Table = table! {
    "A mesh from a Wavefront file (.obj).";
    file("filename", "The file."),
    boolean("flip_tex_coords", true, "True: flips the texture coordinate v.");
    FACE_NORMALS, COMMON
};

pub(super) fn build(params: &Params<'_>, world: DMat4) -> Result<Mesh> {
    let file = params.file("filename")?;
    let flip = params.boolean("flip_tex_coords")?;
    let unread = |e| Error::io(&file, "read", &e);
    let length = std::fs::metadata(&file).map_err(unread)?.len();
    MeshData::check_memory(&file, length, MEMORY_PER_BYTE)?;
    let text = std::fs::read(&file).map_err(unread)?;
    let data = Reader::new(&file, flip).read(&text)?;
    Mesh::build(params, world, &file, data)
}

/// What a byte of text becomes, the text included: a short line of a face makes a triangle and perhaps three vertices.
const MEMORY_PER_BYTE: u64 = 12;

/// Numbers of position, texture coordinate and normal of a face's corner, from 0; `ABSENT` where not given.
type Corner = [u32; 3];
const ABSENT: u32 = u32::MAX;
const LISTS: [&str; 3] = ["v", "vt", "vn"];

struct Reader<'a> {
    file: &'a Path,
    flip: bool,
    line: usize,
    /// What the lines v, vt and vn have given so far.
    lists: [Vec<DVec3>; 3],
    vertices: HashMap<Corner, u32>,
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Reader<'a> {
    fn new(file: &'a Path, flip: bool) -> Self {
        let (lists, vertices) = (Default::default(), HashMap::new());
        Self { file, flip, line: 0, lists, vertices, corners: vec![], triangles: vec![] }
    }

    fn read(mut self, text: &[u8]) -> Result<MeshData> {
        // Some editors mark UTF-8 with a byte-order mark, which is no part of the first line's word.
        let text = text.strip_prefix("\u{feff}".as_bytes()).unwrap_or(text);
        for line in text.split(|byte| *byte == b'\n') {
            self.line += 1;
            // Names and comments may be in any encoding.
            let line = String::from_utf8_lossy(line);
            let mut words = line.split('#').next().unwrap_or_default().split_whitespace();
            match words.next() {
                Some("v") => self.number_line(0, 3, words)?,
                Some("vt") => self.number_line(1, 2, words)?,
                Some("vn") => self.number_line(2, 3, words)?,
                Some("f") => self.face(words)?,
                // Groups, materials, lines, curves: nothing that a ray could hit.
                _ => {}
            }
        }
        Ok(self.finish())
    }

    fn wrong(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        let place = format!("{}:{}", self.file.display(), self.line);
        Error::new(place, expected, found, "correct the line, or export the mesh again")
    }

    /// The first `count` numbers of a v, vt or vn line; what follows (weights, colours) has no meaning here.
    fn number_line<'w>(
        &mut self,
        list: usize,
        count: usize,
        words: impl Iterator<Item = &'w str>,
    ) -> Result<()> {
        let mut values = DVec3::ZERO;
        let mut given = 0;
        for (axis, word) in words.take(count).enumerate() {
            let value = word.parse().ok().filter(|x: &f64| x.is_finite());
            let expected = || format!("{count} finite numbers after {}", LISTS[list]);
            values[axis] = value.ok_or_else(|| self.wrong(expected(), format!("\"{word}\"")))?;
            given += 1;
        }
        if given < count {
            return Err(self.wrong(format!("{count} numbers after {}", LISTS[list]), format!("{given}")));
        }
        self.lists[list].push(values);
        Ok(())
    }

    /// A polygon becomes a fan around its first corner.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<()> {
        let mut fan = [0; 2];
        let mut count = 0;
        for word in words {
            let corner = self.corner(word)?;
            let vertex = self.vertex(corner)?;
            if count >= 2 {
                self.triangles.push([fan[0], fan[1], vertex]);
            }
            fan[count.min(1)] = vertex;
            count += 1;
        }
        if count < 3 {
            return Err(self.wrong("a face of three or more corners", format!("{count}")));
        }
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<Corner> {
        let mut corner = [ABSENT; 3];
        let wrong = || self.wrong("a corner as v, v/vt, v//vn or v/vt/vn", format!("\"{word}\""));
        for (kind, part) in word.split('/').enumerate() {
            let slot = corner.get_mut(kind).ok_or_else(wrong)?;
            if !part.is_empty() {
                *slot = self.index(kind, part.parse().map_err(|_| wrong())?)?;
            }
        }
        if corner[0] == ABSENT { Err(wrong()) } else { Ok(corner) }
    }

    /// From 1, or from the end where negative.
    fn index(&self, kind: usize, number: i64) -> Result<u32> {
        let count = self.lists[kind].len() as i64;
        let index = if number < 0 { number.saturating_add(count) } else { number - 1 };
        if (0..count.min(i64::from(ABSENT))).contains(&index) {
            return Ok(index as u32);
        }
        let expected = format!("the number of one of the {count} {} lines above", LISTS[kind]);
        Err(self.wrong(expected, number.to_string()))
    }

    fn vertex(&mut self, corner: Corner) -> Result<u32> {
        let next = self.corners.len() as u32;
        if next == ABSENT {
            return Err(self.wrong("at most 2^32 - 1 different vertices", "more"));
        }
        let vertex = *self.vertices.entry(corner).or_insert(next);
        if vertex == next {
            self.corners.push(corner);
        }
        Ok(vertex)
    }

    /// One vertex for each distinct corner. What some corners have and others lack is null there.
    fn finish(self) -> MeshData {
        let [positions, uvs, normals] = &self.lists;
        let take = |list: &[DVec3], kind: usize| -> Vec<DVec3> {
            let value = |corner: &Corner| list.get(corner[kind] as usize).copied().unwrap_or_default();
            let given = self.corners.iter().any(|corner| corner[kind] != ABSENT);
            if given { self.corners.iter().map(value).collect() } else { vec![] }
        };
        let turn = |uv: DVec3| vec2(uv.x as f32, if self.flip { 1.0 - uv.y } else { uv.y } as f32);
        MeshData {
            attributes: vec![],
            positions: take(positions, 0),
            normals: take(normals, 2),
            uvs: take(uvs, 1).into_iter().map(turn).collect(),
            triangles: self.triangles,
        }
    }
}
