//! Boxes along the axes, given by least and greatest corner, in f64.

use glam::{DAffine3, DVec3};

/// The part of `range` in which origin + t direction is in the box; its end is not after its beginning where there is
/// none. Corners may be infinite.
#[inline]
pub fn narrowed(
    origin: DVec3,
    direction: DVec3,
    [low, high]: [DVec3; 2],
    [mut first, mut last]: [f64; 2],
) -> [f64; 2] {
    for axis in 0..3 {
        let (origin, direction) = (origin[axis], direction[axis]);
        if direction == 0.0 {
            if !(low[axis] <= origin && origin <= high[axis]) {
                return [first, f64::NEG_INFINITY];
            }
            continue;
        }
        let inverse = 1.0 / direction;
        let (a, b) = ((low[axis] - origin) * inverse, (high[axis] - origin) * inverse);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    [first, last]
}

/// The box around the image of a finite box.
pub fn image(map: &DAffine3, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let (centre, half) = (map.transform_point3(0.5 * (low + high)), 0.5 * (high - low));
    let m = &map.matrix3;
    let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
    [centre - extent, centre + extent]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_holds_every_corner_and_touches_it() {
        let map = DAffine3::from_rotation_z(0.7) * DAffine3::from_scale(DVec3::new(2.0, -1.0, 0.5));
        let (low, high) = (DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 3.0, 4.0));
        let corner = |i: u32| {
            let side = |axis: u32| if i >> axis & 1 == 1 { high } else { low };
            map.transform_point3(DVec3::new(side(0).x, side(1).y, side(2).z))
        };
        let least = (0..8).map(corner).fold(DVec3::INFINITY, DVec3::min);
        let most = (0..8).map(corner).fold(DVec3::NEG_INFINITY, DVec3::max);
        let [a, b] = image(&map, [low, high]);
        assert!((a - least).abs().max_element() < 1e-12 && (b - most).abs().max_element() < 1e-12);
    }
}
