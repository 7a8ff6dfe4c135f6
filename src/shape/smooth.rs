//! Vertex normals for meshes that come without.

use crate::math::{DVec3, Vec3};

/// Face normals around each vertex, weighted by the angle of the face there, as Mitsuba does (Thuermer &
/// Wuethrich 1998). Null for vertices of no face.
pub(super) fn vertex_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let p = triangle.map(|i| positions[i as usize].as_dvec3());
        let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for (k, vertex) in triangle.iter().enumerate() {
            let (to_next, to_last) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            sums[*vertex as usize] += normal * to_next.angle_between(to_last);
        }
    }
    sums.iter().map(|sum| sum.normalize_or_zero().as_vec3()).collect()
}
