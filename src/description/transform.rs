//! Transforms as lists of steps, in f64: a scene far from the origin loses nothing before it is recentred.

use crate::math::{DMat4, DVec3};

/// One step of a transform, in XML's words.
#[derive(Clone, Debug, PartialEq)]
pub enum TransformStep {
    /// Scaling per axis.
    Scale([f64; 3]),
    /// Rotation about `axis` by `angle` degrees.
    Rotate {
        /// Any non-zero vector.
        axis: [f64; 3],
        /// Degrees, counter-clockwise looking against the axis.
        angle: f64,
    },
    /// Translation.
    Translate([f64; 3]),
    /// Camera-style placement: local z towards `target`, local y as near to `up` as can be.
    LookAt {
        /// Where it is.
        origin: [f64; 3],
        /// What it looks at.
        target: [f64; 3],
        /// Roughly upwards.
        up: [f64; 3],
    },
    /// Any matrix, row major.
    Matrix([f64; 16]),
}

impl TransformStep {
    /// The turn by which +z becomes +y, exactly: (x, y, z) becomes (x, z, -y).
    pub const Z_TO_Y: Self = Self::Matrix([1., 0., 0., 0., 0., 0., 1., 0., 0., -1., 0., 0., 0., 0., 0., 1.]);

    /// The step as a matrix on column vectors.
    pub fn matrix(&self) -> DMat4 {
        match self {
            Self::Scale(s) => DMat4::from_scale(DVec3::from(*s)),
            Self::Rotate { axis, angle } => {
                DMat4::from_axis_angle(DVec3::from(*axis).normalize(), angle.to_radians())
            }
            Self::Translate(t) => DMat4::from_translation(DVec3::from(*t)),
            Self::LookAt { origin, target, up } => {
                look_at(DVec3::from(*origin), DVec3::from(*target), DVec3::from(*up))
            }
            Self::Matrix(rows) => DMat4::from_cols_array(rows).transpose(),
        }
    }
}

/// Mitsuba's `lookat`: columns left = up x dir, new up = dir x left, dir.
fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let dir = (target - origin).normalize();
    let left = up.cross(dir).normalize();
    let new_up = dir.cross(left);
    DMat4::from_cols(left.extend(0.0), new_up.extend(0.0), dir.extend(0.0), origin.extend(1.0))
}

/// The product of all steps, the first applied first.
pub fn compose(steps: &[TransformStep]) -> DMat4 {
    steps.iter().fold(DMat4::IDENTITY, |product, step| step.matrix() * product)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_any_length_rotate() {
        let turned = |axis| compose(&[TransformStep::Rotate { axis, angle: 90.0 }]);
        for length in [1e-3, 1.0, 2.0, 1e3] {
            let matrix = turned([0.0, length, 0.0]);
            assert!(matrix.transform_vector3(DVec3::Z).distance(DVec3::X) < 1e-15, "{length}");
            assert!((matrix.determinant() - 1.0).abs() < 1e-15, "{length}");
        }
    }
}
