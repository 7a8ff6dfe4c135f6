//! An image as a texture: Mitsuba's `bitmap`.

use super::{TextureModel, ToUv};
use crate::description::Params;
use crate::error::{Error, Result};
use crate::math::{DVec3, Spectrum, Vec2, vec2, vec3};
use image::{DynamicImage, ImageReader};
use std::{path::Path, sync::Arc};

/// How colours between pixel centres come about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Bilinear,
    Nearest,
}

/// What lies beyond the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

/// An image over the unit square. As in Mitsuba, v runs down the rows: v = 0 is the top edge.
#[derive(Clone, Debug)]
pub struct Bitmap {
    image: Arc<Pixels>,
    filter: Filter,
    wrap: Wrap,
    to_uv: ToUv,
}

#[derive(Debug)]
struct Pixels {
    width: usize,
    height: usize,
    /// Linear sRGB, row by row from the top.
    colors: Vec<Spectrum>,
}

impl Bitmap {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let path = params.file("filename")?;
        let filters = [("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)];
        let wraps = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
        let raw = params.boolean("raw", false)?;
        Ok(Self {
            filter: params.choice("filter_type", Filter::Bilinear, &filters)?,
            wrap: params.choice("wrap_mode", Wrap::Repeat, &wraps)?,
            to_uv: ToUv::build(params)?,
            image: Arc::new(Pixels::read(&path, raw)?),
        })
    }

    #[inline]
    fn pixel(&self, x: i64, y: i64) -> Spectrum {
        let Pixels { width, height, colors } = &*self.image;
        colors[wrap(self.wrap, y, *height) * width + wrap(self.wrap, x, *width)]
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use crate::math::{DMat4, DVec3};
        let grey = |x: &f32| Spectrum::splat(*x);
        let colors = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6].iter().map(grey).collect();
        let image = Arc::new(Pixels { width: 3, height: 2, colors });
        let turned = DMat4::from_axis_angle(DVec3::Z, 0.5) * DMat4::from_scale(DVec3::splat(2.0));
        let mut all = Vec::new();
        for filter in [Filter::Bilinear, Filter::Nearest] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for to_uv in [DMat4::IDENTITY, turned].map(ToUv::new) {
                    all.push(Self { image: image.clone(), filter, wrap, to_uv });
                }
            }
        }
        all
    }
}

impl TextureModel for Bitmap {
    fn eval(&self, uv: Vec2) -> Spectrum {
        let size = vec2(self.image.width as f32, self.image.height as f32);
        // From 2^24 on an f32 knows no fractions: the limit only keeps absurd positions inside i64.
        let limit = Vec2::splat(1e9);
        let position = (self.to_uv.apply(uv) * size).clamp(-limit, limit);
        if self.filter == Filter::Nearest {
            let cell = position.floor();
            return self.pixel(cell.x as i64, cell.y as i64);
        }
        let position = position - Vec2::splat(0.5);
        let cell = position.floor();
        let (t, x, y) = (position - cell, cell.x as i64, cell.y as i64);
        let row = |y| self.pixel(x, y).lerp(self.pixel(x + 1, y), t.x);
        row(y).lerp(row(y + 1), t.y)
    }

    fn max(&self) -> Spectrum {
        self.image.colors.iter().fold(Spectrum::ZERO, |max, color| max.max(*color))
    }

    fn mean(&self) -> Spectrum {
        let sum: DVec3 = self.image.colors.iter().map(|color| color.as_dvec3()).sum();
        (sum / self.image.colors.len() as f64).as_vec3()
    }
}

/// The index in 0..`size` that stands for `index` beyond it.
#[inline]
fn wrap(mode: Wrap, index: i64, size: usize) -> usize {
    let n = size as i64;
    let wrapped = match mode {
        Wrap::Repeat => index.rem_euclid(n),
        Wrap::Clamp => index.clamp(0, n - 1),
        Wrap::Mirror => {
            let twice = index.rem_euclid(2 * n);
            twice.min(2 * n - 1 - twice)
        }
    };
    wrapped as usize
}

impl Pixels {
    /// Reads an image; integer formats hold sRGB and are made linear unless `raw`.
    fn read(path: &Path, raw: bool) -> Result<Self> {
        let image = decode(path)?;
        let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
        let buffer = image.to_rgb32f();
        let (width, height) = (buffer.width() as usize, buffer.height() as usize);
        let decode = |x: f32| if raw || is_float { x } else { srgb_to_linear(x) };
        let colors: Vec<_> =
            buffer.pixels().map(|pixel| vec3(decode(pixel[0]), decode(pixel[1]), decode(pixel[2]))).collect();
        if colors.iter().all(|color| color.is_finite() && color.min_element() >= 0.0) && !colors.is_empty() {
            return Ok(Self { width, height, colors });
        }
        let remedy = "mend the image: a texture is made of finite colours >= 0";
        Err(Error::new(path.display(), "finite values >= 0", "pixels that are not, or no pixels", remedy))
    }
}

fn decode(path: &Path) -> Result<DynamicImage> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let reader = reader.map_err(|error| Error::io(path, "read", &error))?;
    reader.decode().map_err(|error| {
        let remedy = "give a png, jpeg, hdr or exr file";
        Error::new(path.display(), "an image", format!("something that does not decode: {error}"), remedy)
    })
}

/// The transfer function of IEC 61966-2-1, from encoded to linear, both in [0, 1].
fn srgb_to_linear(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}
