//! Linear sRGB colour triples: radiance, reflectance, extinction per channel.

use glam::{Vec3, vec3};

/// One value per linear-sRGB channel.
pub type Spectrum = Vec3;

/// What each channel counts for luminance (Rec. 709).
pub const LUMINANCE: Spectrum = vec3(0.212_671, 0.715_160, 0.072_169);

/// Operations on colours beyond vector arithmetic.
pub trait SpectrumExt {
    /// Rec. 709 luminance.
    fn luminance(self) -> f32;
    /// Channels equal to the last bit.
    fn is_grey(&self) -> bool;
    /// exp of each channel.
    fn exp_each(self) -> Self;
}

impl SpectrumExt for Spectrum {
    #[inline]
    fn luminance(self) -> f32 {
        self.dot(LUMINANCE)
    }
    #[inline]
    fn is_grey(&self) -> bool {
        self.x == self.y && self.y == self.z
    }
    #[inline]
    fn exp_each(self) -> Self {
        vec3(self.x.exp(), self.y.exp(), self.z.exp())
    }
}
