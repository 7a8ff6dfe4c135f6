//! An image of the surroundings, infinitely far away: Mitsuba's `envmap`.

use super::{COMMON, InfiniteModel, Seen};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DMat3, DVec3, Mat3, Spectrum, SpectrumExt, Vec3, similarity, vec3, warp},
    sampling::{Cell, Grid, Stream},
    texture::image::{self, Image},
};
use std::{
    f32::consts::{FRAC_1_PI, TAU},
    f64::consts::PI,
    sync::Arc,
};

/// An environment map in latitude and longitude, local +y up, the middle of the image towards local +z. As in
/// Mitsuba, columns are pixels side by side, rows are interpolated from pole to pole: the first and the last
/// row are the poles.
///
/// Directions are chosen by cells, the squares between four neighbouring pixels, in proportion to their mean
/// luminance times their solid angle, and within each by luminance too, which is bilinear in azimuth and cosine there: the
/// poles are no special places. Next-event estimation counts each pixel less by half the mean luminance: directions that surfaces
/// and media choose find the rest well enough.
#[derive(Clone, Debug)]
pub struct EnvMap {
    map: Arc<Map>,
    /// Of light subpaths, and of next-event estimation if it has its own.
    starts: Arc<Aim>,
    aimed: Option<Arc<Aim>>,
    /// Orthogonal; may mirror.
    to_local: Mat3,
    scale: f32,
    /// Integral of radiance over all directions [W/m^2].
    fluence: DVec3,
}

#[derive(Debug)]
struct Map {
    image: Image,
    /// Cosine to +y at each row, from 1 down to -1.
    cosines: Vec<f64>,
}

/// A distribution of directions.
#[derive(Debug)]
struct Aim {
    cells: Grid,
    /// One over the integral of [`Self::at`], [1/sr]; 0 where that is black.
    scale: f32,
    /// How much less than its luminance a pixel counts.
    spared: f32,
}

/// What `mis_compensation` spares, in units of the mean luminance: by half of it both ways to choose directions follow the
/// luminance together, if surfaces and media choose all alike, and as often as next-event estimation.
const SPARED: f32 = 0.5;

/// The least part of its luminance that a pixel keeps: some strategies have no other way to reach it.
const KEPT: f32 = 0.03;

/// Where a direction points on the map: the cell, and how far into it by angles.
#[derive(Clone, Copy, Debug)]
struct Spot {
    column: usize,
    row: usize,
    x: f32,
    y: f32,
}

impl EnvMap {
    pub(super) const TABLE: Table = table! {
        "An environment map in latitude and longitude, +y up.";
        file("filename", "The image: EXR, HDR, PNG, JPEG, BMP, TGA or PPM."),
        factor("scale", 1.0, "Scales the radiance."),
        transform("to_world", "Rotates or mirrors it."),
        boolean("mis_compensation", true, "Next-event estimation samples what exceeds half the mean luminance; surfaces and media sample the rest (Karlik et al. 2019). Mitsuba's default is false.");
        COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let path = params.file("filename")?;
        let scale = params.float("scale")? as f32;
        let image = image::read(&path, false, f32::INFINITY, params.library)?;
        if image.width < 2 || image.height < 3 {
            let found = format!("{} x {}", image.width, image.height);
            let remedy = "give a larger image (a constant environment needs none)";
            return Err(Error::new(path.display(), "an image of at least 2 x 3 pixels", found, remedy));
        }
        let to_world = params.transform("to_world")?;
        if !similarity::is_rigid(to_world) {
            let expected = "a transform made of rotations and mirrors";
            return Err(params.complain("to_world", expected, "one that scales or shears"));
        }
        let to_local = DMat3::from_mat4(to_world).transpose().as_mat3();
        let map = Map::new(image);
        let fluence = map.fluence();
        let spared = SPARED * (fluence / (4.0 * PI)).as_vec3().luminance();
        let aim = |spared| Arc::new(Aim::new(&map, spared));
        let aimed = params.boolean("mis_compensation")?.then(|| aim(spared));
        let starts = aim(0.0);
        Ok(Self { starts, aimed, map: Arc::new(map), to_local, scale, fluence: fluence * f64::from(scale) })
    }
}

impl InfiniteModel for EnvMap {
    #[inline]
    fn radiance(&self, towards: Vec3) -> Spectrum {
        self.map.radiance(&self.map.spot(self.to_local * towards)) * self.scale
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.sample_by(&self.starts, stream)
    }

    #[inline]
    fn pdf_sr(&self, towards: Vec3) -> f32 {
        let local = self.to_local * towards;
        self.starts.pdf_sr(&self.map, local, &self.map.spot(local))
    }

    #[inline]
    fn aim(&self, stream: &mut Stream) -> Vec3 {
        self.sample_by(self.aimed.as_ref().unwrap_or(&self.starts), stream)
    }

    #[inline]
    fn seen(&self, towards: Vec3) -> Seen {
        let local = self.to_local * towards;
        let spot = self.map.spot(local);
        let radiance = self.map.radiance(&spot) * self.scale;
        let pdf_sr = self.starts.pdf_sr(&self.map, local, &spot);
        let aimed_sr = self.aimed.as_ref().map_or(pdf_sr, |aimed| aimed.pdf_sr(&self.map, local, &spot));
        Seen { radiance, pdf_sr, aimed_sr }
    }

    fn fluence(&self) -> DVec3 {
        self.fluence
    }
}

impl EnvMap {
    #[inline]
    fn sample_by(&self, aim: &Aim, stream: &mut Stream) -> Vec3 {
        let Cell { column, row, within } = aim.cells.sample(stream);
        let [[a, b], [c, d]] = aim.corners(&self.map, column, row);
        let y = warp::linear(a + b, c + d, within.y);
        let x = warp::linear(a + y * (c - a), b + y * (d - b), within.x);
        let (top, bottom) = (self.map.cosines[row], self.map.cosines[row + 1]);
        let cosine = (top + f64::from(y) * (bottom - top)) as f32;
        let azimuth = (column as f32 + 0.5 + x) / self.map.image.width as f32 * TAU;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (s, c) = azimuth.sin_cos();
        (self.to_local.transpose() * vec3(sine * s, cosine, -sine * c)).normalize()
    }
}

impl Aim {
    /// In proportion to luminance, of which `spared` is left out.
    fn new(map: &Map, spared: f32) -> Self {
        let mut aim = Self { cells: Grid::new(1, &[0.0]), scale: 0.0, spared };
        let weight = |(x, y)| {
            let corners = aim.corners(map, x, y);
            corners.as_flattened().iter().map(|aim| f64::from(0.25 * aim)).sum::<f64>() * map.solid_angle(y)
        };
        let weights: Vec<f64> = map.places().map(weight).collect();
        aim.cells = Grid::new(map.image.width, &weights);
        aim.scale = if aim.cells.is_empty() { 0.0 } else { aim.cells.total().recip() as f32 };
        aim
    }

    /// Density at `local` [1/sr], which is at `spot`.
    #[inline]
    fn pdf_sr(&self, map: &Map, local: Vec3, &Spot { column, row, x, .. }: &Spot) -> f32 {
        let (top, bottom) = (map.cosines[row], map.cosines[row + 1]);
        let y = ((top - cosine(local)) / (top - bottom)).clamp(0.0, 1.0) as f32;
        let [[a, b], [c, d]] = self.corners(map, column, row);
        let (left, right) = (a + y * (c - a), b + y * (d - b));
        (left + x * (right - left)) * self.scale
    }

    /// What the density is in proportion to, at the corners of a cell, row by row.
    #[inline]
    fn corners(&self, map: &Map, column: usize, row: usize) -> [[f32; 2]; 2] {
        [row, row + 1].map(|row| [column, column + 1].map(|column| self.at(map.pixel(column, row))))
    }

    /// The same at a pixel.
    #[inline]
    fn at(&self, pixel: Spectrum) -> f32 {
        let luminance = pixel.luminance();
        (luminance - self.spared).max(KEPT * luminance)
    }
}

impl Map {
    fn new(image: Image) -> Self {
        let cosine = |row| (PI * row as f64 / (image.height - 1) as f64).cos();
        Self { cosines: (0..image.height).map(cosine).collect(), image }
    }

    /// The integral of its radiance.
    fn fluence(&self) -> DVec3 {
        self.places().map(|(x, y)| self.mean(x, y).as_dvec3() * self.solid_angle(y)).sum()
    }

    /// Column and row of every cell, row by row.
    fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let width = self.image.width;
        (0..self.image.height - 1).flat_map(move |row| (0..width).map(move |column| (column, row)))
    }

    /// The mean over a cell.
    fn mean(&self, column: usize, row: usize) -> Spectrum {
        let corners = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
        0.25 * corners.map(|(x, y)| self.pixel(x, y)).iter().sum::<Spectrum>()
    }

    #[inline]
    fn radiance(&self, &Spot { column, row, x, y }: &Spot) -> Spectrum {
        let mix = |row| self.pixel(column, row).lerp(self.pixel(column + 1, row), x);
        mix(row).lerp(mix(row + 1), y)
    }

    #[inline]
    fn pixel(&self, column: usize, row: usize) -> Spectrum {
        let column = if column == self.image.width { 0 } else { column };
        self.image.pixels[row * self.image.width + column]
    }

    /// Solid angle of a cell between `row` and the next [sr].
    #[inline]
    fn solid_angle(&self, row: usize) -> f64 {
        2.0 * PI / self.image.width as f64 * (self.cosines[row] - self.cosines[row + 1])
    }

    #[inline]
    fn spot(&self, local: Vec3) -> Spot {
        let (width, rows) = (self.image.width as f32, (self.image.height - 1) as f32);
        let turn = local.x.atan2(-local.z) * (0.5 * FRAC_1_PI);
        let x = (turn - turn.floor()) * width - 0.5;
        let x = if x < 0.0 { x + width } else { x };
        // Precise near the poles too, where the cosine is not.
        let y = local.x.hypot(local.z).atan2(local.y) * FRAC_1_PI * rows;
        let column = (x as usize).min(self.image.width - 1);
        let row = (y as usize).min(self.image.height - 2);
        Spot { column, row, x: (x - column as f32).min(1.0), y: (y - row as f32).clamp(0.0, 1.0) }
    }
}

/// Of a direction to +y, as precise near the poles as between them.
#[inline]
fn cosine(local: Vec3) -> f64 {
    let across = f64::from(local.x).powi(2) + f64::from(local.z).powi(2);
    let y = f64::from(local.y);
    if across < 0.5 { (1.0 - across).sqrt().copysign(y) } else { y }
}
