//! The pinhole camera. Camera space: +z forwards, +y up, +x to the image's left, as in Mitsuba.

use crate::{
    description::Params,
    error::Result,
    math::{DMat4, DVec3, Frame, Vec2, Vec3, vec2, vec3},
};

/// A pinhole with a rectangular film. Film positions are in pixels, (0, 0) the top left corner.
#[derive(Clone, Debug)]
pub struct Perspective {
    /// The pinhole.
    pub position: Vec3,
    frame: Frame,
    /// Pixels per unit of the image plane at distance 1.
    scale: f32,
    /// Film position straight ahead.
    centre: Vec2,
    /// Nothing nearer (measured along the axis) is seen [m].
    pub near: f32,
    /// Nothing further (measured along the axis) is seen [m].
    pub far: f32,
}

/// A point as the camera sees it.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Where on the film [pixels]; may lie outside the image.
    pub film: Vec2,
    /// Unit direction from the pinhole to the point.
    pub direction: Vec3,
    /// Cosine between that direction and the axis, > 0.
    pub cosine: f32,
    /// Distance from the pinhole [m].
    pub distance: f32,
}

impl Perspective {
    /// Reads Mitsuba's parameters (except film, sampler and medium) for a film of `width` x `height` pixels.
    pub fn build(params: &Params<'_>, recentre: DVec3, width: u32, height: u32) -> Result<Self> {
        let to_world = DMat4::from_translation(-recentre) * params.transform("to_world")?;
        let near = params.float_within("near_clip", 1e-2, 0.0, f64::MAX)?;
        let far = params.float_within("far_clip", 1e4, near, f64::MAX)?;
        let (width, height) = (f64::from(width), f64::from(height));
        let half_width = half_width(params, width / height)?;
        let offset =
            [params.float("principal_point_offset_x", 0.0)?, params.float("principal_point_offset_y", 0.0)?];
        params.accept_unused(&["shutter_open", "shutter_close"], "nothing moves");
        let axis = |v: DVec3| to_world.transform_vector3(v).normalize();
        let (x, y, z) = (axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z));
        Ok(Self {
            position: to_world.transform_point3(DVec3::ZERO).as_vec3(),
            frame: Frame { tangent: x.as_vec3(), bitangent: y.as_vec3(), normal: z.as_vec3() },
            scale: (0.5 * width / half_width) as f32,
            centre: vec2(((0.5 - offset[0]) * width) as f32, ((0.5 - offset[1]) * height) as f32),
            near: near as f32,
            far: far as f32,
        })
    }

    /// The same camera, its film positions counted from `offset` [pixels] on.
    pub fn counted_from(mut self, offset: [u32; 2]) -> Self {
        self.centre -= vec2(offset[0] as f32, offset[1] as f32);
        self
    }

    /// Unit direction through a film position, and its cosine to the axis.
    #[inline]
    pub fn direction(&self, film: Vec2) -> (Vec3, f32) {
        let p = (self.centre - film) / self.scale;
        let local = vec3(p.x, p.y, 1.0).normalize();
        (self.frame.to_world(local), local.z)
    }

    /// Density per solid angle of directions whose film positions have density 1 per pixel area
    /// [pixels/sr]: scale^2 / cos^3.
    #[inline]
    pub fn density(&self, cosine: f32) -> f32 {
        self.scale * self.scale / (cosine * cosine * cosine)
    }

    /// How the camera sees `point`; none where it lies outside the clip distances.
    #[inline]
    pub fn project(&self, point: Vec3) -> Option<Projection> {
        let local = self.frame.to_local(point - self.position);
        if local.z <= self.near || local.z >= self.far {
            return None;
        }
        let distance = local.length();
        let film = self.centre - vec2(local.x, local.y) * (self.scale / local.z);
        let direction = self.frame.to_world(local / distance);
        Some(Projection { film, direction, cosine: local.z / distance, distance })
    }

    /// How the camera sees the point at infinity in unit `direction`; none behind it.
    #[inline]
    pub fn project_direction(&self, direction: Vec3) -> Option<Projection> {
        let local = self.frame.to_local(direction);
        if local.z <= 0.0 {
            return None;
        }
        let film = self.centre - vec2(local.x, local.y) * (self.scale / local.z);
        Some(Projection { film, direction, cosine: local.z, distance: f32::INFINITY })
    }
}

/// Tangent of half the horizontal field of view, whichever way it is given.
fn half_width(params: &Params<'_>, aspect: f64) -> Result<f64> {
    let diagonal = (1.0 + 1.0 / (aspect * aspect)).sqrt();
    if params.has("focal_length") || !params.has("fov") {
        let text = params.string("focal_length", "50mm")?;
        let length = text.strip_suffix("mm").unwrap_or(text).trim().parse::<f64>();
        return match length {
            Ok(mm) if mm > 0.0 && mm.is_finite() => Ok(36f64.hypot(24.0) / (2.0 * mm) / diagonal),
            _ => Err(params.complain("focal_length", "a length such as \"50mm\"", format!("\"{text}\""))),
        };
    }
    let degrees = params.float("fov", 0.0)?;
    if !(degrees > 0.0 && degrees < 180.0) {
        return Err(params.complain("fov", "an angle between 0 and 180 degrees", degrees.to_string()));
    }
    let (smaller, larger) = if aspect > 1.0 { (aspect, 1.0) } else { (1.0, aspect) };
    // The tangent along the given axis, times this, is the tangent along x.
    let axes =
        [("x", 1.0), ("y", aspect), ("diagonal", 1.0 / diagonal), ("smaller", smaller), ("larger", larger)];
    Ok((0.5 * degrees.to_radians()).tan() * params.choice("fov_axis", 1.0, &axes)?)
}
