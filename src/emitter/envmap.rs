//! An image of the surroundings, infinitely far away: Mitsuba's `envmap`.

use super::{COMMON, InfiniteModel};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DMat3, DVec3, Mat3, Spectrum, SpectrumExt, Vec3, similarity, vec3},
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
/// luminance times their solid angle, uniform by solid angle within each: the poles are no special places.
#[derive(Clone, Debug)]
pub struct EnvMap {
    map: Arc<Map>,
    /// Orthogonal; may mirror.
    to_local: Mat3,
    scale: f32,
    /// Integral of radiance over all directions [W/m^2].
    fluence: DVec3,
}

#[derive(Debug)]
struct Map {
    image: Image,
    cells: Grid,
    /// Cosine to +y at each row, from 1 down to -1.
    cosines: Vec<f64>,
}

/// Where a direction points on the map: the cell, and how far into it.
#[derive(Clone, Copy, Debug)]
struct Spot {
    column: usize,
    row: usize,
    x: f32,
    y: f32,
}

impl EnvMap {
    pub(super) const TABLE: Table = table! {
        "An image of the surroundings in latitude and longitude, +y up.";
        file("filename", "The image: EXR, HDR, PNG, JPEG, BMP, TGA or PPM."),
        factor("scale", 1.0, "A factor on its radiance."),
        transform("to_world", "Turns or mirrors it."),
        ignored("mis_compensation", "the balance heuristic is told of all strategies anyway");
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
        let (map, fluence) = Map::new(image);
        Ok(Self { map: Arc::new(map), to_local, scale, fluence: fluence * f64::from(scale) })
    }
}

impl InfiniteModel for EnvMap {
    #[inline]
    fn radiance(&self, towards: Vec3) -> Spectrum {
        self.map.radiance(&self.map.spot(self.to_local * towards)) * self.scale
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        let Cell { column, row, .. } = self.map.cells.sample(stream);
        let u = stream.square();
        let (top, bottom) = (self.map.cosines[row], self.map.cosines[row + 1]);
        let cosine = (top + f64::from(u.y) * (bottom - top)) as f32;
        let azimuth = (column as f32 + 0.5 + u.x) / self.map.image.width as f32 * TAU;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (s, c) = azimuth.sin_cos();
        (self.to_local.transpose() * vec3(sine * s, cosine, -sine * c)).normalize()
    }

    #[inline]
    fn pdf_sr(&self, towards: Vec3) -> f32 {
        self.map.pdf_sr(&self.map.spot(self.to_local * towards))
    }

    #[inline]
    fn radiance_and_pdf(&self, towards: Vec3) -> (Spectrum, f32) {
        let spot = self.map.spot(self.to_local * towards);
        (self.map.radiance(&spot) * self.scale, self.map.pdf_sr(&spot))
    }

    fn fluence(&self) -> DVec3 {
        self.fluence
    }
}

impl Map {
    /// The map and the integral of its radiance.
    fn new(image: Image) -> (Self, DVec3) {
        let cosines =
            (0..image.height).map(|row| (PI * row as f64 / (image.height - 1) as f64).cos()).collect();
        let mut map = Self { image, cells: Grid::new(1, &[0.0]), cosines };
        let (width, rows) = (map.image.width, map.image.height - 1);
        let mut weights = Vec::with_capacity(width * rows);
        let mut fluence = DVec3::ZERO;
        for row in 0..rows {
            for column in 0..width {
                let corners = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
                let mean = 0.25 * corners.map(|(x, y)| map.pixel(x, y)).iter().sum::<Spectrum>();
                weights.push(f64::from(mean.luminance()) * map.solid_angle(row));
                fluence += mean.as_dvec3() * map.solid_angle(row);
            }
        }
        map.cells = Grid::new(width, &weights);
        (map, fluence)
    }

    #[inline]
    fn radiance(&self, &Spot { column, row, x, y }: &Spot) -> Spectrum {
        let mix = |row| self.pixel(column, row).lerp(self.pixel(column + 1, row), x);
        mix(row).lerp(mix(row + 1), y)
    }

    #[inline]
    fn pdf_sr(&self, &Spot { column, row, .. }: &Spot) -> f32 {
        self.cells.probability(column, row) / self.solid_angle(row) as f32
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
