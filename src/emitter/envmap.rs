//! An image of the surroundings, infinitely far away: Mitsuba's `envmap`.

use super::{COMMON, InfiniteModel, Seen};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DMat3, DVec3, Mat3, Spectrum, SpectrumExt, Vec3, angle, similarity, vec3, warp},
    sampling::{Cell, Grid, Stream},
    texture::image::{self, Image},
};
use std::{
    f32::consts::{FRAC_1_PI, TAU},
    f64::consts::PI,
    ops::{Add, Mul, Sub},
    sync::Arc,
};

/// An environment map in latitude and longitude, local +y up, the middle of the image towards local +z. As in
/// Mitsuba, columns are pixels side by side, rows are interpolated from pole to pole: the first and the last
/// row are the poles.
///
/// Directions are sampled by cells, the squares between four neighbouring pixels, in proportion to mean luminance times
/// solid angle. Within a cell they follow the luminance, which is bilinear in azimuth and cosine there: the poles are
/// no special places. Next-event estimation subtracts half the mean luminance from each pixel (MIS compensation):
/// directions that surfaces and media sample find the rest well enough.
#[derive(Clone, Debug)]
pub struct EnvMap {
    map: Arc<Map>,
    /// Of light subpaths, and of next-event estimation if it has its own.
    starts: Arc<Aim>,
    aimed: Option<Arc<Aim>>,
    /// Orthogonal; may mirror.
    to_local: Mat3,
    scale: f32,
    /// Integral of radiance over all directions (W/m^2).
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
    /// One over the integral of what it is proportional to (1/sr); 0 where that is black.
    scale: f32,
    /// How much less than its luminance a pixel counts.
    spared: f32,
}

/// What `mis_compensation` subtracts, in units of the mean luminance. With half of it, both ways to sample directions
/// together follow the luminance, if surfaces and media sample uniformly and as often as next-event estimation.
const SPARED: f32 = 0.5;

/// The least part of its luminance that a pixel keeps: some strategies have no other way to reach it.
const KEPT: f32 = 0.03;

/// Where a direction points on the map: the cell, and how far into it.
#[derive(Clone, Copy, Debug)]
struct Spot {
    column: usize,
    row: usize,
    x: f32,
    /// By the angle, as radiance is interpolated.
    y: f32,
    /// By the cosine, as densities are.
    descent: f32,
}

/// The four corners of a cell, row by row.
type Corners<T> = [T; 4];

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
        let to_local = to_local(params)?.as_mat3();
        Ok(Self::new(image, to_local, scale, params.boolean("mis_compensation")?))
    }

    /// An `image` of at least 2 x 3 pixels, whose radiance `scale` multiplies.
    pub(super) fn new(image: Image, to_local: Mat3, scale: f32, is_compensated: bool) -> Self {
        let map = Map::new(image);
        let fluence = map.fluence();
        let spared = SPARED * (fluence / (4.0 * PI)).as_vec3().luminance();
        let aim = |spared| Arc::new(Aim::new(&map, spared));
        let aimed = is_compensated.then(|| aim(spared));
        let starts = aim(0.0);
        Self { starts, aimed, map: Arc::new(map), to_local, scale, fluence: fluence * f64::from(scale) }
    }
}

/// What undoes `to_world`, which may rotate and mirror.
pub(super) fn to_local(params: &Params<'_>) -> Result<DMat3> {
    let to_world = params.transform("to_world")?;
    if !similarity::is_rigid(to_world) {
        let expected = "a transform made of rotations and mirrors";
        return Err(params.complain("to_world", expected, "one that scales or shears"));
    }
    Ok(DMat3::from_mat4(to_world).transpose())
}

/// The local direction of the pixel in that `column` and `row` of a map of `width` x `height`.
pub(super) fn of_pixel(column: usize, row: usize, [width, height]: [usize; 2]) -> DVec3 {
    let azimuth = (column as f64 + 0.5) / width as f64 * 2.0 * PI;
    let (sine, cosine) = (PI * row as f64 / (height - 1) as f64).sin_cos();
    DVec3::new(sine * azimuth.sin(), cosine, -sine * azimuth.cos())
}

impl InfiniteModel for EnvMap {
    #[inline]
    fn radiance(&self, towards: Vec3) -> Spectrum {
        self.seen(towards).radiance
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.sample_by(&self.starts, stream).0
    }

    #[inline]
    fn pdf_sr(&self, towards: Vec3) -> f32 {
        self.seen(towards).pdf_sr
    }

    #[inline]
    fn aim(&self, stream: &mut Stream) -> (Vec3, Seen) {
        self.sample_by(self.aimed.as_ref().unwrap_or(&self.starts), stream)
    }

    #[inline]
    fn seen(&self, towards: Vec3) -> Seen {
        let spot = self.map.spot(self.to_local * towards);
        self.seen_at(&spot, &self.map.corners(spot.column, spot.row))
    }

    fn fluence(&self) -> DVec3 {
        self.fluence
    }
}

impl EnvMap {
    /// A direction, and what there is.
    #[inline]
    fn sample_by(&self, aim: &Aim, stream: &mut Stream) -> (Vec3, Seen) {
        let Cell { column, row, within } = aim.cells.sample(stream);
        let corners = self.map.corners(column, row);
        let [a, b, c, d] = each(&corners, |pixel| aim.of(pixel.luminance()));
        let descent = warp::linear(a + b, c + d, within.y);
        let x = warp::linear(a + descent * (c - a), b + descent * (d - b), within.x);
        let (top, bottom) = (self.map.cosines[row], self.map.cosines[row + 1]);
        let cosine = (top + f64::from(descent) * (bottom - top)) as f32;
        let azimuth = (column as f32 + 0.5 + x) / self.map.image.width as f32 * TAU;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (s, c) = azimuth.sin_cos();
        let towards = (self.to_local.transpose() * vec3(sine * s, cosine, -sine * c)).normalize();
        let y = (self.map.rows_down(sine, cosine) - row as f32).clamp(0.0, 1.0);
        (towards, self.seen_at(&Spot { column, row, x, y, descent }, &corners))
    }

    /// What there is at a place whose cell has these `corners`.
    #[inline]
    fn seen_at(&self, &Spot { x, y, descent, .. }: &Spot, corners: &Corners<Spectrum>) -> Seen {
        let luminance = each(corners, |pixel| pixel.luminance());
        let pdf_sr = self.starts.pdf_sr(&luminance, x, descent);
        Seen {
            radiance: between(corners, x, y) * self.scale,
            pdf_sr,
            aimed_sr: self.aimed.as_ref().map_or(pdf_sr, |aimed| aimed.pdf_sr(&luminance, x, descent)),
        }
    }
}

impl Aim {
    /// In proportion to luminance, of which `spared` is left out.
    fn new(map: &Map, spared: f32) -> Self {
        let mut aim = Self { cells: Grid::new(1, &[0.0]), scale: 0.0, spared };
        let weight = |(x, y)| {
            let corners = each(&map.corners(x, y), |pixel| aim.of(pixel.luminance()));
            corners.iter().map(|aim| f64::from(0.25 * aim)).sum::<f64>() * map.solid_angle(y)
        };
        let weights: Vec<f64> = map.places().map(weight).collect();
        aim.cells = Grid::new(map.image.width, &weights);
        aim.scale = if aim.cells.is_empty() { 0.0 } else { aim.cells.total().recip() as f32 };
        aim
    }

    /// Density within a cell (1/sr), of whose corners the `luminance` is given.
    #[inline]
    fn pdf_sr(&self, luminance: &Corners<f32>, x: f32, descent: f32) -> f32 {
        between(&each(luminance, |luminance| self.of(*luminance)), x, descent) * self.scale
    }

    /// What the density is in proportion to, at a pixel.
    #[inline]
    fn of(&self, luminance: f32) -> f32 {
        (luminance - self.spared).max(KEPT * luminance)
    }
}

/// Something of all corners. The standard library's way to map arrays is not always inlined.
#[inline(always)]
fn each<T, U>([a, b, c, d]: &Corners<T>, of: impl Fn(&T) -> U) -> Corners<U> {
    [of(a), of(b), of(c), of(d)]
}

/// What is so far into a cell, between its corners.
#[inline(always)]
fn between<T>(&[a, b, c, d]: &Corners<T>, x: f32, y: f32) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    let (left, right) = (a + (c - a) * y, b + (d - b) * y);
    left + (right - left) * x
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
        0.25 * self.corners(column, row).iter().sum::<Spectrum>()
    }

    #[inline]
    fn corners(&self, column: usize, row: usize) -> Corners<Spectrum> {
        let (pixels, width) = (&self.image.pixels, self.image.width);
        let (left, right) =
            (row * width + column, row * width + if column + 1 == width { 0 } else { column + 1 });
        [pixels[left], pixels[right], pixels[left + width], pixels[right + width]]
    }

    /// Solid angle of a cell between `row` and the next (sr).
    #[inline]
    fn solid_angle(&self, row: usize) -> f64 {
        2.0 * PI / self.image.width as f64 * (self.cosines[row] - self.cosines[row + 1])
    }

    #[inline]
    fn spot(&self, local: Vec3) -> Spot {
        let width = self.image.width as f32;
        let turn = angle::atan2(local.x, -local.z) * (0.5 * FRAC_1_PI);
        let x = (if turn < 0.0 { turn + 1.0 } else { turn }) * width - 0.5;
        let x = if x < 0.0 { x + width } else { x };
        let y = self.rows_down((local.x * local.x + local.z * local.z).sqrt(), local.y);
        let column = (x as usize).min(self.image.width - 1);
        let row = (y as usize).min(self.image.height - 2);
        let (top, bottom) = (self.cosines[row], self.cosines[row + 1]);
        let descent = ((top - cosine(local)) / (top - bottom)).clamp(0.0, 1.0) as f32;
        let (x, y) = ((x - column as f32).min(1.0), (y - row as f32).clamp(0.0, 1.0));
        Spot { column, row, x, y, descent }
    }

    /// From the first row, of a direction of that `sine` and `cosine` to +y: precise near the poles too, where the cosine is not.
    #[inline]
    fn rows_down(&self, sine: f32, cosine: f32) -> f32 {
        angle::atan2(sine, cosine) * FRAC_1_PI * (self.image.height - 1) as f32
    }
}

/// Of a direction to +y, as precise near the poles as between them.
#[inline]
fn cosine(local: Vec3) -> f64 {
    let across = f64::from(local.x).powi(2) + f64::from(local.z).powi(2);
    let y = f64::from(local.y);
    if across < 0.5 { (1.0 - across).sqrt().copysign(y) } else { y }
}
