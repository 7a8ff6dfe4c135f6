//! Distributions of microfacet normals, their shadowing and the sampling of the visible ones (Walter et al.
//! 2007; Heitz 2018). All in a shading frame turned so that the direction in question has z > 0.

use super::beckmann::View;
use super::bounded;
use crate::description::{Params, parameter::Parameter, rows};
use crate::error::{Error, Result};
use crate::math::{Spectrum, Uv, Vec2, Vec3, vec2, vec3};
use crate::texture::Texture;
use std::f32::consts::{PI, TAU};

/// Mitsuba's least roughness: below it the peak leaves what an f32 direction can resolve.
const LEAST_ALPHA: f32 = 1e-4;

/// Greatest roughness taken: beyond it the surface is no surface any more.
const GREATEST_ALPHA: f64 = 10.0;

/// How the slopes of the facets are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Normally.
    Beckmann,
    /// With the long tails of Trowbridge & Reitz.
    Ggx,
}

/// Roughness as given in a scene: per direction of the shading frame, over the surface.
#[derive(Clone, Debug)]
pub(super) struct Roughness {
    kind: Kind,
    alpha: [Texture; 2],
    /// The distribution, where it is the same everywhere.
    even: Option<Microfacets>,
}

/// A distribution at one point of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacets {
    kind: Kind,
    alpha_u: f32,
    alpha_v: f32,
}

/// What rough surfaces have.
pub(super) const ROUGHNESS: &[Parameter] = rows! {
    choice("distribution", &["beckmann", "ggx"], "beckmann", "Distribution of the microfacets."),
    texture("alpha", GREATEST_ALPHA, Is(0.1), "Roughness: about the RMS slope of the microfacets; one number for `roughplastic`."),
    boolean("sample_visible", true, "False is ignored with a warning: visible normals are always sampled."),
};

/// The two of them by direction.
pub(super) const ANISOTROPY: &[Parameter] = rows! {
    texture("alpha_u", GREATEST_ALPHA, Optional, "Roughness along u, with `alpha_v` in place of `alpha`; `roughplastic` needs both equal."),
    texture("alpha_v", GREATEST_ALPHA, Optional, "Roughness along v."),
};

impl Roughness {
    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let kinds = [("beckmann", Kind::Beckmann), ("ggx", Kind::Ggx)];
        let kind = params.choice("distribution", &kinds)?;
        if !params.boolean("sample_visible")? {
            let place = params.given("sample_visible").map_or(params.location(), |p| &p.location);
            params.library.warn(place, "visible normals are always sampled: it changes noise only");
        }
        let anisotropic = ["alpha_u", "alpha_v"].map(|name| params.has(name));
        let alpha = match (params.has("alpha"), anisotropic) {
            (_, [false, false]) => {
                let alpha = bounded(params, "alpha", "")?;
                [alpha.clone(), alpha]
            }
            (false, [true, true]) => [bounded(params, "alpha_u", "")?, bounded(params, "alpha_v", "")?],
            _ => {
                let expected = "either \"alpha\" or both \"alpha_u\" and \"alpha_v\"";
                let found = "another choice of them";
                return Err(Error::new(params.location(), expected, found, "give one or the other"));
            }
        };
        Ok(Self::of(kind, alpha))
    }

    /// The same everywhere and in all directions.
    pub(super) fn even(alpha: f64) -> Self {
        let alpha = Texture::constant(Spectrum::splat(alpha as f32));
        Self::of(Kind::Beckmann, [alpha.clone(), alpha])
    }

    fn of(kind: Kind, alpha: [Texture; 2]) -> Self {
        let even = alpha.iter().all(|alpha| matches!(alpha, Texture::Uniform(_)));
        let roughness = Self { kind, alpha, even: None };
        Self { even: even.then(|| roughness.at(Vec2::ZERO.into())), ..roughness }
    }

    /// The same for a model that takes one number for the whole surface.
    pub(super) fn build_even(params: &Params<'_>) -> Result<Microfacets> {
        let Self { kind, alpha: [u, v], .. } = Self::build(params)?;
        match (&u, &v) {
            (Texture::Uniform(along), Texture::Uniform(across)) if along.0 == across.0 => {
                let alpha = u.number(Vec2::ZERO.into());
                Ok(Microfacets::new(kind, alpha, alpha))
            }
            _ => Err(Error::new(
                params.location(),
                "a roughness that is the same everywhere and in all directions",
                "a texture, or two that differ",
                format!("give the {} one number as \"alpha\"", params.object.plugin),
            )),
        }
    }

    /// The largest roughness anywhere.
    pub(super) fn max(&self) -> f32 {
        self.alpha[0].max().max(self.alpha[1].max()).max_element().max(LEAST_ALPHA)
    }

    /// The distribution at texture position `uv`.
    #[inline]
    pub(super) fn at(&self, uv: Uv) -> Microfacets {
        let alpha = |i: usize| self.alpha[i].number(uv);
        self.even.unwrap_or_else(|| Microfacets::new(self.kind, alpha(0), alpha(1)))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let alphas = [(0.5, 0.5), (0.12, 0.12), (0.2, 0.6), (1.0, 1.0)];
        let texture = |x| Texture::constant(Spectrum::splat(x));
        let with = |kind| alphas.map(|(u, v)| Self::of(kind, [texture(u), texture(v)]));
        [Kind::Beckmann, Kind::Ggx].into_iter().flat_map(with).collect()
    }
}

impl Microfacets {
    /// Roughnesses along the tangent and the bitangent; those below Mitsuba's least are raised to it.
    #[inline]
    pub(super) fn new(kind: Kind, alpha_u: f32, alpha_v: f32) -> Self {
        Self { kind, alpha_u: alpha_u.max(LEAST_ALPHA), alpha_v: alpha_v.max(LEAST_ALPHA) }
    }

    /// D(m) (1/sr) of the unit normal `m`; 0 unless m.z > 0.
    #[inline]
    pub(super) fn distribution(&self, m: Vec3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let (x, y, square) = (m.x / self.alpha_u, m.y / self.alpha_v, m.z * m.z);
        let slope = x * x + y * y;
        let scale = PI * self.alpha_u * self.alpha_v;
        match self.kind {
            Kind::Ggx => 1.0 / (scale * (slope + square) * (slope + square)),
            // Beyond 80 the exponential is below 1e-34, and further on it would be 0/0.
            Kind::Beckmann if slope > 80.0 * square => 0.0,
            Kind::Beckmann => (-slope / square).exp() / (scale * square * square),
        }
    }

    /// Smith's masking G1 divided by the cosine v.z, which has a limit at grazing; v.z > 0 and `m` in front.
    #[inline]
    pub(super) fn masking_over_cosine(&self, v: Vec3) -> f32 {
        match self.kind {
            Kind::Ggx => 2.0 / (v.z + self.stretched_length(v)),
            Kind::Beckmann => self.beckmann_masking_over_cosine(v),
        }
    }

    /// Walter et al. 2007, sec. 5.2: a rational fit, which Mitsuba uses too.
    #[inline]
    fn beckmann_masking_over_cosine(&self, v: Vec3) -> f32 {
        let width = self.stretched_width(v);
        if v.z >= 1.6 * width {
            return 1.0 / v.z;
        }
        let a = v.z / width;
        (3.535 + 2.181 * a) / ((1.0 + (2.276 + 2.577 * a) * a) * width)
    }

    /// Length of `v`'s horizontal part in the frame in which the roughness is 1.
    #[inline]
    fn stretched_width(&self, v: Vec3) -> f32 {
        vec2(self.alpha_u * v.x, self.alpha_v * v.y).length()
    }

    /// Length of `v` in the frame in which the GGX distribution is a unit hemisphere.
    #[inline]
    fn stretched_length(&self, v: Vec3) -> f32 {
        vec3(self.alpha_u * v.x, self.alpha_v * v.y, v.z).length()
    }

    /// Projected area of the facets that `v` (z > 0) sees, per area of the surface: its cosine over the exact masking.
    #[inline]
    fn visible_area(&self, v: Vec3) -> f32 {
        match self.kind {
            Kind::Ggx => 0.5 * (v.z + self.stretched_length(v)),
            Kind::Beckmann => View { z: v.z, width: self.stretched_width(v) }.area(),
        }
    }

    /// Density (1/sr) of `sample_visible` at the normal `m` seen from `v`, divided by their cosine v.m
    /// (Heitz 2018, eq. 3).
    #[inline]
    pub(super) fn visible_pdf_over_cosine(&self, v: Vec3, m: Vec3) -> f32 {
        self.distribution(m) / self.visible_area(v)
    }

    /// A normal that `v` (z > 0) sees.
    #[inline]
    pub(super) fn sample_visible(&self, v: Vec3, u: Vec2) -> Vec3 {
        let stretched = vec3(self.alpha_u * v.x, self.alpha_v * v.y, v.z).normalize();
        let across = vec3(-stretched.y, stretched.x, 0.0).try_normalize().unwrap_or(Vec3::X);
        let normal = match self.kind {
            Kind::Ggx => visible_in_ggx(stretched, across, u),
            Kind::Beckmann => {
                let width = stretched.truncate().length();
                let slope = View { z: stretched.z, width }.sample(u);
                across.cross(Vec3::Z) * slope.x + across * slope.y + Vec3::Z
            }
        };
        vec3(self.alpha_u * normal.x, self.alpha_v * normal.y, normal.z.max(0.0)).normalize()
    }
}

/// A normal of the unit hemisphere as `v` sees it, `across` horizontal and at right angles to it (Heitz 2018, sec. 4).
#[inline]
fn visible_in_ggx(v: Vec3, across: Vec3, u: Vec2) -> Vec3 {
    let upwards = v.cross(across);
    let (sine, cosine) = (TAU * u.y).sin_cos();
    let radius = u.x.sqrt();
    let (a, b) = (radius * cosine, radius * sine);
    let share = 0.5 * (1.0 + v.z);
    let b = (1.0 - share) * (1.0 - a * a).max(0.0).sqrt() + share * b;
    let c = (1.0 - a * a - b * b).max(0.0).sqrt();
    across * a + upwards * b + v * c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;

    /// Integral over the hemisphere, by the midpoint rule in cosine and azimuth.
    fn integral(f: impl Fn(Vec3) -> f32) -> f64 {
        let n = 512;
        let at = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
        let directions = (0..n * n).map(|i| warp::spherical(at(i / n, n), TAU * at(i % n, n)));
        directions.map(|m| f64::from(f(m))).sum::<f64>() * std::f64::consts::TAU / (n * n) as f64
    }

    #[test]
    fn the_projected_area_of_all_normals_is_one() {
        for kind in [Kind::Beckmann, Kind::Ggx] {
            for (u, v) in [(0.3, 0.3), (0.2, 0.7), (1.0, 1.0)] {
                let microfacets = Microfacets::new(kind, u, v);
                let area = integral(|m| microfacets.distribution(m) * m.z);
                assert!((area - 1.0).abs() < 2e-3, "{microfacets:?}: {area}");
            }
        }
    }

    #[test]
    fn the_density_of_visible_normals_is_normalised() {
        let roughnesses = [(0.3, 0.3), (0.2, 0.7), (1.0, 1.0)];
        let both =
            [Kind::Beckmann, Kind::Ggx].map(|kind| roughnesses.map(|(u, v)| Microfacets::new(kind, u, v)));
        for microfacets in both.into_iter().flatten() {
            for cosine in [1.0, 0.5, 0.1, 0.01] {
                let from = warp::spherical(cosine, 0.7);
                let pdf = |m: Vec3| microfacets.visible_pdf_over_cosine(from, m) * from.dot(m).max(0.0);
                let total = integral(pdf);
                assert!((total - 1.0).abs() < 2e-3, "{microfacets:?} from {from}: {total}");
            }
        }
    }
}
