//! Colour spaces.

use super::DVec3;

/// CIE XYZ to linear sRGB (ITU-R BT.709 primaries, white D65), rounded as Mitsuba rounds it: pictures agree.
pub fn xyz_to_rgb(xyz: DVec3) -> DVec3 {
    DVec3::new(
        xyz.dot(DVec3::new(3.240_479, -1.537_150, -0.498_535)),
        xyz.dot(DVec3::new(-0.969_256, 1.875_991, 0.041_556)),
        xyz.dot(DVec3::new(0.055_648, -0.204_043, 1.057_311)),
    )
}
