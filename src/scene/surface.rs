//! What a shape is made of.

use super::media::boundary::Boundary;

/// The properties of a shape: its BSDF, emitter and media.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Index of its BSDF.
    pub bsdf: u32,
    /// Index of its emitter.
    pub emitter: Option<u32>,
    /// The media on its sides.
    pub boundary: Boundary,
    /// Light can get to the other side.
    pub transmits: bool,
    /// Some of its scattering is not Dirac: the answer of its BSDF, stored because every vertex needs it.
    pub connectible: bool,
    /// Its textures ask for more than texture coordinates.
    pub detailed: bool,
}
