//! An image projected from a point: Mitsuba's `projector`.

use super::{COMMON, PointModel};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::{DMat3, DVec3, Mat3, Spectrum, SpectrumExt, Vec2, Vec3, similarity, vec2, vec3},
    sampling::{Cell, Grid, Stream},
    sensor,
    texture::{self, Texture},
};
use std::{f32::consts::PI, sync::Arc};

/// A pinhole camera run backwards: what lies at distance 1 across its axis is lit by the image, at
/// irradiance pi times that of the texture (so Mitsuba scales it).
#[derive(Clone, Debug)]
pub struct Projector {
    position: DVec3,
    irradiance: Texture,
    scale: f32,
    to_local: Mat3,
    /// Half the width and height of the image at distance 1.
    half: Vec2,
    /// Texture cells by brightness.
    cells: Arc<Cells>,
}

#[derive(Debug)]
struct Cells {
    grid: Grid,
    columns: usize,
    rows: usize,
}

/// Part of the directions that are uniform over the image: no bright spot that the grid may miss is lost.
const UNIFORM: f32 = 0.1;
/// The most cells along one side.
const FINEST: usize = 1024;

impl Projector {
    pub(super) const TABLE: Table = table! {
        "A point light that projects an image along +z.";
        transform("to_world", "Position and direction; scales must be uniform."),
        light_texture("irradiance", "W/m^2", Required, "The image: irradiance at a distance of 1."),
        factor("scale", 1.0, "Scales it.");
        sensor::FIELD_OF_VIEW, COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let irradiance = texture::parameter(params, "irradiance")?;
        let to_world = params.transform("to_world")?;
        let Some(size) = similarity::scale_of(to_world) else {
            let expected = "a transform that neither shears nor stretches";
            return Err(params.complain("to_world", expected, "one that does"));
        };
        let [width, height] = irradiance.resolution().map(|n| n as f64);
        let half = sensor::half_width(params, width / height)?;
        Ok(Self {
            position: to_world.transform_point3(DVec3::ZERO),
            // Mitsuba's projector grows brighter with its size.
            scale: (params.float("scale")? * size) as f32,
            to_local: DMat3::from_mat4(to_world).inverse().as_mat3(),
            half: vec2(half as f32, (half * height / width) as f32),
            cells: Arc::new(Cells::new(&irradiance)),
            irradiance,
        })
    }

    /// The texture position that unit `direction` goes through, and its cosine to the axis; none outside.
    #[inline]
    fn through(&self, direction: Vec3) -> Option<(Vec2, f32)> {
        let local = (self.to_local * direction).normalize();
        if local.z <= 0.0 {
            return None;
        }
        let uv = Vec2::splat(0.5) - local.truncate() / (local.z * 2.0 * self.half);
        (uv.min_element() >= 0.0 && uv.max_element() <= 1.0).then_some((uv, local.z))
    }
}

impl PointModel for Projector {
    fn position(&self) -> DVec3 {
        self.position
    }

    #[inline]
    fn intensity(&self, direction: Vec3) -> Spectrum {
        match self.through(direction) {
            Some((uv, cosine)) => self.irradiance.eval(uv) * (PI * self.scale / cosine.powi(3)),
            None => Spectrum::ZERO,
        }
    }

    /// A direction through the image, by its brightness.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        let uv = self.cells.sample(stream);
        let plane = (Vec2::splat(0.5) - uv) * (2.0 * self.half);
        let local = vec3(plane.x, plane.y, 1.0);
        (self.to_local.inverse() * local).normalize()
    }

    #[inline]
    fn pdf_sr(&self, direction: Vec3) -> f32 {
        let Some((uv, cosine)) = self.through(direction) else { return 0.0 };
        let area = 4.0 * self.half.x * self.half.y;
        self.cells.pdf(uv) / (area * cosine.powi(3))
    }

    /// Of the texture the mean counts. At distance 1 it falls on an area of `area`.
    fn power(&self) -> DVec3 {
        let area = 4.0 * self.half.x * self.half.y;
        self.irradiance.mean().as_dvec3() * f64::from(PI * area) * f64::from(self.scale)
    }
}

impl Cells {
    fn new(texture: &Texture) -> Self {
        let [columns, rows] = texture.resolution().map(|n| n.clamp(32, FINEST));
        let place = |i: usize, n: usize| i as f32 / n as f32;
        let value = |x: usize, y: usize| {
            f64::from(
                texture.eval(vec2(place(2 * x + 1, 2 * columns), place(2 * y + 1, 2 * rows))).luminance(),
            )
        };
        let weights: Vec<f64> =
            (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
        Self { grid: Grid::new(columns, &weights), columns, rows }
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec2 {
        if self.grid.is_empty() || stream.uniform() < UNIFORM {
            return stream.square();
        }
        let Cell { column, row, within } = self.grid.sample(stream);
        (vec2(column as f32, row as f32) + within) / vec2(self.columns as f32, self.rows as f32)
    }

    /// Density over the unit square.
    #[inline]
    fn pdf(&self, uv: Vec2) -> f32 {
        if self.grid.is_empty() {
            return 1.0;
        }
        let index = |u: f32, n: usize| ((u * n as f32) as usize).min(n - 1);
        let chosen = self.grid.probability(index(uv.x, self.columns), index(uv.y, self.rows));
        UNIFORM + (1.0 - UNIFORM) * chosen * (self.columns * self.rows) as f32
    }
}
