//! What pinhole and thin lens share: place, orientation, field of view, clip distances.

use super::{Clip, Crop};
use crate::{
    description::{Params, parameter::Parameter, rows},
    error::Result,
    math::{DMat4, DVec3, Frame, Vec2, Vec3, similarity, vec2, vec3},
};

/// A place to look from, and a film plane at distance 1 in front of it.
#[derive(Clone, Debug)]
pub(super) struct Lens {
    pub position: Vec3,
    /// Left-handed where the transform mirrors.
    pub frame: Frame,
    pub clip: Clip,
    /// Pixels per unit of the film plane.
    scale: f32,
    /// Film position straight ahead.
    centre: Vec2,
}

/// What cameras with a lens have.
pub(super) const LENS: &[Parameter] = rows! {
    transform("to_world", "Position and direction: rotations, translations and mirrors."),
    number("principal_point_offset_x", "widths of the film", ANY, Is(0.0), "Horizontal offset of the axis from the centre."),
    number("principal_point_offset_y", "heights of the film", ANY, Is(0.0), "Vertical offset of the axis from the centre, downwards."),
};

/// Two ways to give a field of view.
pub(crate) const FIELD_OF_VIEW: &[Parameter] = rows! {
    number("fov", "degrees", between(0.0, 180.0), Said("by `focal_length`"), "Field of view along `fov_axis`."),
    choice("fov_axis", &["x", "y", "diagonal", "smaller", "larger"], "x", "Side of the film that `fov` spans.").said("x"),
    text("focal_length", "a length such as \"50mm\"", Word("50mm"), "In place of `fov`: focal length of a 35 mm camera."),
};

impl Lens {
    /// Reads Mitsuba's parameters of projective cameras.
    pub(super) fn build(params: &Params<'_>, recentre: DVec3, crop: Crop) -> Result<Self> {
        let to_world = DMat4::from_translation(-recentre) * params.transform("to_world")?;
        if !similarity::is_rigid(to_world) {
            let expected = "a transform made of rotations, translations and mirrors";
            return Err(params.complain("to_world", expected, "one that scales or shears"));
        }
        let axis = |axis| to_world.transform_vector3(axis).normalize().as_vec3();
        let [tangent, bitangent, normal] = [DVec3::X, DVec3::Y, DVec3::Z].map(axis);
        let frame = Frame { tangent, bitangent, normal };
        let [width, height] = crop.film.map(f64::from);
        let half_width = half_width(params, width / height)?;
        let offset = [params.float("principal_point_offset_x")?, params.float("principal_point_offset_y")?];
        let centre = vec2(((0.5 - offset[0]) * width) as f32, ((0.5 - offset[1]) * height) as f32);
        let corner = vec2(crop.offset[0] as f32, crop.offset[1] as f32);
        Ok(Self {
            position: to_world.transform_point3(DVec3::ZERO).as_vec3(),
            frame,
            clip: Clip::build(params)?,
            scale: (0.5 * width / half_width) as f32,
            centre: centre - corner,
        })
    }

    /// The point of the film plane (camera space, z = 1 left out) that corresponds to a film position.
    #[inline(always)]
    pub(super) fn plane(&self, film: Vec2) -> Vec2 {
        (self.centre - film) / self.scale
    }

    /// The film position that corresponds to a point of the film plane.
    #[inline(always)]
    pub(super) fn film(&self, plane: Vec2) -> Vec2 {
        self.centre - plane * self.scale
    }

    /// Density per solid angle of directions whose film positions have density 1 per pixel area
    /// (pixels/sr): scale^2 / cos^3. It holds through any point of a lens: what a lens in focus at distance F
    /// spreads over F^2 times the area lies F^2 times further away.
    #[inline(always)]
    pub(super) fn pdf(&self, cosine: f32) -> f32 {
        self.scale * self.scale / (cosine * cosine * cosine)
    }

    /// `point` in camera space.
    #[inline(always)]
    pub(super) fn to_local(&self, point: Vec3) -> Vec3 {
        self.frame.to_local(point - self.position)
    }

    /// A point of the aperture in the world.
    #[inline(always)]
    pub(super) fn at(&self, aperture: Vec2) -> Vec3 {
        self.position + self.frame.tangent * aperture.x + self.frame.bitangent * aperture.y
    }

    /// Camera direction through a point of the film plane.
    #[inline(always)]
    pub(super) fn through(plane: Vec2) -> Vec3 {
        vec3(plane.x, plane.y, 1.0).normalize()
    }
}

/// Tangent of half the horizontal field of view, whichever way it is given; `aspect` is width / height.
pub(crate) fn half_width(params: &Params<'_>, aspect: f64) -> Result<f64> {
    let diagonal = (1.0 + 1.0 / (aspect * aspect)).sqrt();
    let degrees = params.optional_float("fov")?;
    let Some(degrees) = degrees.filter(|_| !params.has("focal_length")) else {
        if degrees.is_some() {
            return Err(params.complain("fov", "fov or focal_length, not both", "both"));
        }
        let text = params.string("focal_length")?;
        let length = text.strip_suffix("mm").unwrap_or(text).trim().parse::<f64>();
        return match length {
            Ok(mm) if mm > 0.0 && mm.is_finite() => Ok(36f64.hypot(24.0) / (2.0 * mm) / diagonal),
            _ => Err(params.complain("focal_length", "a length such as \"50mm\"", format!("\"{text}\""))),
        };
    };
    let (smaller, larger) = if aspect > 1.0 { (aspect, 1.0) } else { (1.0, aspect) };
    // The tangent along the given axis, times this, is the tangent along x.
    let axes =
        [("x", 1.0), ("y", aspect), ("diagonal", 1.0 / diagonal), ("smaller", smaller), ("larger", larger)];
    let axis = if params.has("fov_axis") { params.choice("fov_axis", &axes)? } else { 1.0 };
    Ok((0.5 * degrees.to_radians()).tan() * axis)
}
