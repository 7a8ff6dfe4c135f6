//! Transforms that keep the shape of things.

use super::{DMat3, DMat4};

/// By what factor `transform` makes everything larger; none where it shears or stretches. Mirrors are allowed,
/// and matrices typed with four digits are taken for what they mean.
pub fn scale_of(transform: DMat4) -> Option<f64> {
    const TOLERANCE: f64 = 1e-3;
    let linear = DMat3::from_mat4(transform);
    let scale = linear.determinant().abs().cbrt();
    let turned = linear * (1.0 / scale);
    let square = turned.transpose() * turned;
    (scale.is_normal() && square.abs_diff_eq(DMat3::IDENTITY, TOLERANCE)).then_some(scale)
}

/// True if it keeps lengths too: rotations, translations, mirrors.
pub fn is_rigid(transform: DMat4) -> bool {
    scale_of(transform).is_some_and(|scale| (scale - 1.0).abs() < 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn rotations_mirrors_and_even_scales_keep_shapes() {
        let turn = DMat4::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
        let scale = |x, y, z| DMat4::from_scale(DVec3::new(x, y, z));
        for (transform, expected) in [
            (DMat4::IDENTITY, Some(1.0)),
            (turn * scale(-1.0, 1.0, 1.0), Some(1.0)),
            (scale(2.0, 2.0, 2.0) * turn, Some(2.0)),
            (turn * scale(1e-9, 1e-9, -1e-9), Some(1e-9)),
            (scale(1.0, 2.0, 1.0), None),
            (scale(1.0, 0.0, 1.0), None),
            (
                DMat4::from_cols_array_2d(&[
                    [1.0, 0.0, 0.0, 0.0],
                    [0.5, 1.0, 0.0, 0.0],
                    [0.0, 0.0, 1.0, 0.0],
                    [0.0, 0.0, 0.0, 1.0],
                ]),
                None,
            ),
        ] {
            let found = scale_of(transform);
            assert_eq!(found.is_some(), expected.is_some(), "{transform}");
            assert!(found.zip(expected).is_none_or(|(a, b): (f64, f64)| (a / b - 1.0).abs() < 1e-9));
            assert_eq!(is_rigid(transform), expected == Some(1.0));
        }
    }
}
