//! Mitsuba's `.vol` files: a header of 48 bytes, then f32 values, channels fastest, then x, y, z; little endian.

use super::file::{Source, Values};
use super::{super::Samples, check_memory};
use crate::{
    error::{Error, Result},
    math::{DAffine3, DMat3, DVec3, Spectrum, vec3},
};
use std::{
    fs::File,
    io::{self, BufReader, Read, Write},
    path::Path,
};

const HEADER: usize = 48;

/// Voxels of a file in memory.
#[derive(Debug)]
struct Voxels<V> {
    size: [usize; 3],
    values: Vec<V>,
}

impl<V: Copy + Send + Sync> Samples<V> for Voxels<V> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    #[inline]
    fn at(&self, [x, y, z]: [usize; 3]) -> V {
        self.values[x + self.size[0] * (y + self.size[1] * z)]
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V> {
        (low == high).then(|| self.at(low))
    }
}

/// The header of the file.
struct Header {
    size: [usize; 3],
    channels: usize,
    bounds: [DVec3; 2],
}

/// Opens a file whose number of channels is one of `channels`: what follows its header, and its length.
fn open(path: &Path, channels: &[usize]) -> Result<(Header, BufReader<File>, u64)> {
    let io = |error| Error::io(path, "read", &error);
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let mut file = BufReader::new(file);
    Ok((Header::read(path, &mut file, length, channels)?, file, length))
}

/// A file of six channels.
pub(super) struct Sixfold {
    pub size: [usize; 3],
    /// All voxels, x fastest.
    pub voxels: Vec<[f32; 6]>,
    /// From the unit cube to where the file says that they lie.
    pub to_file: DAffine3,
}

/// Reads a whole file of six channels.
pub(super) fn sixfold(path: &Path) -> Result<Sixfold> {
    let (header, mut file, length) = open(path, &[6])?;
    let voxels = numbers(path, &mut file, length, |voxel| voxel)?;
    Ok(Sixfold { size: header.size, voxels, to_file: header.to_file() })
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Source> {
    let (header, mut file, length) = open(path, &[1, 3])?;
    let (size, to_file) = (header.size, header.to_file());
    let values = match header.channels {
        1 => Values::Grey(Box::new(Voxels { size, values: numbers(path, &mut file, length, |[x]| x)? })),
        _ => {
            let values = numbers(path, &mut file, length, |[r, g, b]| vec3(r, g, b))?;
            Values::Chromatic(Box::new(Voxels::<Spectrum> { size, values }))
        }
    };
    Ok(Source { values, to_file, name: String::new(), others: vec![] })
}

/// A grid as a file of this format is to hold it.
pub struct Vol {
    header: Vec<u8>,
    values: Values,
}

impl Vol {
    /// The grid that the file at `path` holds, all of its voxels: those that a sparse file leaves out are among them.
    pub fn new(path: &Path, Source { values, to_file, .. }: Source) -> Result<Self> {
        let (size, channels) = match &values {
            Values::Grey(samples) => (samples.size(), 1),
            Values::Chromatic(samples) => (samples.size(), 3),
        };
        let bytes = size.iter().try_fold(4 * channels as u64, |product, n| product.checked_mul(*n as u64));
        check_memory(path, size, bytes)?;
        Ok(Self { header: Header { size, channels, bounds: box_of(path, to_file)? }.bytes(), values })
    }

    /// Writes the file.
    pub fn write(&self, file: &mut dyn Write) -> io::Result<()> {
        file.write_all(&self.header)?;
        match &self.values {
            Values::Grey(samples) => write_rows(file, &**samples, |value| [value]),
            Values::Chromatic(samples) => write_rows(file, &**samples, |value| value.to_array()),
        }
    }
}

fn write_rows<V, const N: usize>(
    file: &mut dyn Write,
    samples: &dyn Samples<V>,
    numbers: impl Fn(V) -> [f32; N],
) -> io::Result<()> {
    let size = samples.size();
    let mut rows = (0..size[2]).flat_map(|z| (0..size[1]).map(move |y| [y, z]));
    rows.try_for_each(|[y, z]| {
        let row = (0..size[0]).flat_map(|x| numbers(samples.at([x, y, z])));
        file.write_all(&row.flat_map(f32::to_le_bytes).collect::<Vec<_>>())
    })
}

/// The corners of a grid along the axes, the only ones that a file can name.
fn box_of(path: &Path, to_file: DAffine3) -> Result<[DVec3; 2]> {
    let (axes, low) = (to_file.matrix3, to_file.translation);
    let sides = DVec3::new(axes.x_axis.x, axes.y_axis.y, axes.z_axis.z);
    if axes == DMat3::from_diagonal(sides) && sides.min_element() > 0.0 {
        return Ok([low, low + sides]);
    }
    let remedy = "export the grid without a rotation, and turn the gridvolume by its to_world";
    Err(Error::new(
        path.display(),
        "a grid along the axes",
        "one that is turned, sheared or mirrored",
        remedy,
    ))
}

impl Header {
    /// From the unit cube to the box that the file names.
    fn to_file(&self) -> DAffine3 {
        let [low, high] = self.bounds;
        DAffine3 { matrix3: DMat3::from_diagonal(high - low), translation: low }
    }

    fn bytes(&self) -> Vec<u8> {
        let integers = [1, self.size[0], self.size[1], self.size[2], self.channels].map(|n| n as i32);
        let corners = self.bounds.map(|corner| corner.as_vec3().to_array());
        let numbers = integers.into_iter().flat_map(i32::to_le_bytes);
        let places = corners.into_iter().flatten().flat_map(f32::to_le_bytes);
        b"VOL\x03".iter().copied().chain(numbers).chain(places).collect()
    }

    /// Reads it and compares it with the length of its file.
    fn read(path: &Path, file: &mut impl Read, length: u64, wanted: &[usize]) -> Result<Self> {
        let mut bytes = [0; HEADER];
        if length < HEADER as u64 {
            let expected = format!("a .vol file, with a header of {HEADER} bytes");
            let remedy = "save the grid again; the file may have been cut off";
            return Err(Error::new(path.display(), expected, format!("{length} bytes"), remedy));
        }
        file.read_exact(&mut bytes).map_err(|error| Error::io(path, "read", &error))?;
        check_kind(path, &bytes)?;
        let header = Self {
            size: dimensions(path, &bytes)?,
            channels: channels(path, &bytes, wanted)?,
            bounds: [bounds(&bytes, 24), bounds(&bytes, 36)],
        };
        header.check_length(path, length)?;
        Ok(header)
    }

    fn check_length(&self, path: &Path, length: u64) -> Result<()> {
        let product = |factors: &[usize]| {
            factors.iter().try_fold(1u64, |product, factor| product.checked_mul(*factor as u64))
        };
        let [x, y, z] = self.size;
        let data = product(&[x, y, z, self.channels, 4]);
        let whole = data.and_then(|data| data.checked_add(HEADER as u64));
        if whole == Some(length) {
            return check_memory(path, self.size, data);
        }
        let needed = whole.map_or("more than 2^64".into(), |whole| whole.to_string());
        let channels = self.channels;
        let expected = format!("{needed} bytes, for {x} x {y} x {z} voxels of {channels} channel(s)");
        let found = format!("{length} bytes");
        Err(Error::new(path.display(), expected, found, "save the grid again; header and data disagree"))
    }
}

fn check_kind(path: &Path, bytes: &[u8; HEADER]) -> Result<()> {
    let remedy = "save the grid as Mitsuba 3's .vol: version 3, 32-bit floats";
    let wrong = |expected: &str, found: String| Err(Error::new(path.display(), expected, found, remedy));
    if &bytes[..3] != b"VOL" {
        return wrong("\"VOL\" as the first three bytes", format!("\"{}\"", bytes[..3].escape_ascii()));
    }
    if bytes[3] != 3 {
        return wrong("version 3 of the .vol format", format!("version {}", bytes[3]));
    }
    match integer(bytes, 4) {
        1 => Ok(()),
        kind => wrong("values of type 1 (32-bit float)", format!("type {kind}")),
    }
}

fn dimensions(path: &Path, bytes: &[u8; HEADER]) -> Result<[usize; 3]> {
    let size = [8, 12, 16].map(|at| integer(bytes, at));
    if size.iter().all(|n| *n > 0) {
        return Ok(size.map(|n| n as usize));
    }
    let found = format!("{} x {} x {}", size[0], size[1], size[2]);
    Err(Error::new(
        path.display(),
        "at least one voxel along every axis",
        found,
        "save a grid that is not empty",
    ))
}

fn channels(path: &Path, bytes: &[u8; HEADER], wanted: &[usize]) -> Result<usize> {
    let found = integer(bytes, 20);
    if let Some(channels) = wanted.iter().find(|n| i64::try_from(**n) == Ok(i64::from(found))) {
        return Ok(*channels);
    }
    let words: Vec<String> = wanted.iter().map(usize::to_string).collect();
    let remedy = match wanted {
        [6] => "save xx, yy, zz, xy, xz and yz of the matrix in every voxel",
        _ => "use a grid of densities or colours; one of 6 channels is the \"S\" of an sggx",
    };
    let expected = format!("{} channels", words.join(" or "));
    Err(Error::new(path.display(), expected, format!("{found} channels"), remedy))
}

fn word(bytes: &[u8; HEADER], at: usize) -> [u8; 4] {
    [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
}

fn integer(bytes: &[u8; HEADER], at: usize) -> i32 {
    i32::from_le_bytes(word(bytes, at))
}

fn bounds(bytes: &[u8; HEADER], at: usize) -> DVec3 {
    DVec3::from([0, 4, 8].map(|offset| f64::from(f32::from_le_bytes(word(bytes, at + offset)))))
}

/// The rest of the file as values of `N` numbers.
fn numbers<V, const N: usize>(
    path: &Path,
    file: &mut impl Read,
    length: u64,
    value: impl Fn([f32; N]) -> V,
) -> Result<Vec<V>> {
    let count = (length as usize - HEADER) / (4 * N);
    let mut values = Vec::with_capacity(count);
    let mut buffer = vec![0; 4 * N * (1 << 14)];
    while values.len() < count {
        let bytes = (count - values.len()).min(1 << 14) * 4 * N;
        let buffer = &mut buffer[..bytes];
        file.read_exact(buffer).map_err(|error| Error::io(path, "read", &error))?;
        let numbers = |bytes: &[u8]| std::array::from_fn(|i| number(&bytes[4 * i..]));
        values.extend(buffer.chunks_exact(4 * N).map(|bytes| value(numbers(bytes))));
    }
    Ok(values)
}

fn number(bytes: &[u8]) -> f32 {
    bytes.first_chunk().map_or(0.0, |bytes| f32::from_le_bytes(*bytes))
}
