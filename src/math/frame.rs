//! Orthonormal frames around a direction.

use glam::{Vec3, vec3};

/// A right-handed orthonormal basis; local z is `normal`.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x in world space.
    pub tangent: Vec3,
    /// Local y in world space.
    pub bitangent: Vec3,
    /// Local z in world space.
    pub normal: Vec3,
}

impl Frame {
    /// Any frame around the unit vector `normal` (Duff et al. 2017, branch-free and exact at both poles).
    #[inline]
    pub fn around(normal: Vec3) -> Self {
        let sign = 1f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: vec3(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: vec3(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The frame around the unit vector `normal` whose tangent lies as near to `hint` as can be; any frame
    /// where `hint` is null, not finite or along the normal.
    #[inline]
    pub fn along(normal: Vec3, hint: Vec3) -> Self {
        let across = hint - normal * normal.dot(hint);
        let squared = across.length_squared();
        // Below this share of the hint's length what is left is rounding, not direction.
        if squared > 1e-10 * hint.length_squared() && squared.is_finite() {
            let tangent = across / squared.sqrt();
            Self { tangent, bitangent: normal.cross(tangent), normal }
        } else {
            Self::around(normal)
        }
    }

    /// World direction to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        vec3(v.dot(self.tangent), v.dot(self.bitangent), v.dot(self.normal))
    }

    /// Local direction to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_at_poles_and_between() {
        for n in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::X,
            vec3(1e-4, -1e-4, -1.0).normalize(),
            vec3(0.3, -0.5, 0.7).normalize(),
        ] {
            let f = Frame::around(n);
            for (a, b, dot) in [
                (f.tangent, f.bitangent, 0.0),
                (f.tangent, n, 0.0),
                (f.bitangent, n, 0.0),
                (f.tangent, f.tangent, 1.0),
                (f.bitangent, f.bitangent, 1.0),
            ] {
                assert!((a.dot(b) - dot).abs() < 1e-5, "{n}: {}", a.dot(b));
            }
            assert!((f.tangent.cross(f.bitangent) - n).length() < 1e-5);
            let v = vec3(0.2, -0.9, 0.4);
            assert!((f.to_world(f.to_local(v)) - v).length() < 1e-5);
        }
    }
}
