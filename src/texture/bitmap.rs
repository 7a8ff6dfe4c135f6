//! An image as a texture: Mitsuba's `bitmap`.

use super::{
    TO_UV, TextureModel, ToUv,
    image::{self, Image},
};
use crate::description::{Params, Table, table};
use crate::error::{Error, Result};
use crate::math::{DVec3, Spectrum, SpectrumExt, Uv, Vec2, Wrap, vec2};
use std::sync::Arc;

/// Interpolation between pixel centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Bilinear,
    Nearest,
}

/// An image over the unit square. As in Mitsuba, v runs down the rows: v = 0 is the top edge.
#[derive(Clone, Debug)]
pub struct Bitmap {
    image: Arc<Image>,
    filter: Filter,
    wrap: Wrap,
    to_uv: ToUv,
}

impl Bitmap {
    pub(super) const TABLE: Table = table! {
        "An image over the unit square, v down the rows.";
        file("filename", "The image: EXR, HDR, PNG, JPEG, BMP, TGA or PPM."),
        choice("filter_type", &["bilinear", "nearest"], "bilinear", "Interpolation."),
        choice("wrap_mode", &words::<3, _>(&Wrap::NAMES), "repeat", "Lookup outside the unit square."),
        boolean("raw", false, "True: values are linear. False: those of integer formats are sRGB-encoded."),
        TO_UV,
        ignored("format", "images are kept in single precision"),
        ignored("accel", "images are kept in single precision"),
    };

    pub(super) fn build(params: &Params<'_>, most: f32) -> Result<Self> {
        if params
            .object
            .properties
            .iter()
            .any(|property| ["data", "bitmap"].contains(&property.name.as_str()))
        {
            let remedy = "save the image to a file and give its name as \"filename\"";
            return Err(Error::new(params.location(), "an image file", "an image in memory", remedy));
        }
        let path = params.file("filename")?;
        let filters = [("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)];
        let raw = params.boolean("raw")?;
        Ok(Self {
            filter: params.choice("filter_type", &filters)?,
            wrap: params.choice("wrap_mode", &Wrap::NAMES)?,
            to_uv: ToUv::read(params)?,
            image: Arc::new(image::read(&path, raw, most, params.library)?),
        })
    }

    #[inline]
    fn pixel(&self, x: i64, y: i64) -> Spectrum {
        let Image { width, height, pixels } = &*self.image;
        pixels[self.wrap.index(y, *height) * width + self.wrap.index(x, *width)]
    }

    /// The size of the image, and a position in pixels, which knows no fractions from 2^24 on: the limit only keeps absurd ones
    /// inside i64.
    #[inline]
    fn position(&self, uv: Uv) -> (Vec2, Vec2) {
        let (size, limit) = (vec2(self.image.width as f32, self.image.height as f32), Vec2::splat(1e9));
        (size, (self.to_uv.apply(uv) * size).clamp(-limit, limit))
    }

    /// The four pixels around, how far between them, and the size of the image.
    #[inline]
    fn around(&self, uv: Uv) -> (Vec2, Vec2, [[Spectrum; 2]; 2]) {
        let (size, position) = self.position(uv);
        let position = position - Vec2::splat(0.5);
        let cell = position.floor();
        let (x, y) = (cell.x as i64, cell.y as i64);
        let row = |y| [self.pixel(x, y), self.pixel(x + 1, y)];
        (position - cell, size, [row(y), row(y + 1)])
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use crate::math::{DMat4, DVec3};
        let grey = |x: &f32| Spectrum::splat(*x);
        let pixels = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6].iter().map(grey).collect();
        let image = Arc::new(Image { width: 3, height: 2, pixels });
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
    fn eval(&self, uv: Uv) -> Spectrum {
        if self.filter == Filter::Nearest {
            let cell = self.position(uv).1.floor();
            return self.pixel(cell.x as i64, cell.y as i64);
        }
        let (t, _, [[a, b], [c, d]]) = self.around(uv);
        a.lerp(b, t.x).lerp(c.lerp(d, t.x), t.y)
    }

    fn number(&self, uv: Uv) -> f32 {
        self.eval(uv).luminance()
    }

    /// Of what is interpolated; by the nearest pixel, nothing changes but in steps. Where `to_uv` turns an image that is not
    /// square, Mitsuba's is another, which is not how its values change.
    fn gradient(&self, uv: Uv) -> Vec2 {
        if self.filter == Filter::Nearest {
            return Vec2::ZERO;
        }
        let (t, size, [[a, b], [c, d]]) = self.around(uv);
        let [a, b, c, d] = [a, b, c, d].map(SpectrumExt::luminance);
        let [along, down] = [(b - a) * (1.0 - t.y) + (d - c) * t.y, (c - a) * (1.0 - t.x) + (d - b) * t.x];
        let steps = vec2(along, down) * size;
        let [u, v, _] = self.to_uv.columns;
        vec2(u.dot(steps), v.dot(steps))
    }

    fn max(&self) -> Spectrum {
        self.image.pixels.iter().fold(Spectrum::ZERO, |max, color| max.max(*color))
    }

    fn resolution(&self) -> [usize; 2] {
        [self.image.width, self.image.height]
    }

    fn mean(&self) -> Spectrum {
        let sum: DVec3 = self.image.pixels.iter().map(|color| color.as_dvec3()).sum();
        (sum / self.image.pixels.len() as f64).as_vec3()
    }
}
