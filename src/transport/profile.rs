//! What a compiled estimator contains; `profiles` lists the profiles.

use super::mis::MisSums;
use crate::medium::MediaProfile;

/// Compile-time constants that remove code.
pub trait Profile: MediaProfile {
    /// What walks carry for the weights of strategies.
    type MisSums: MisSums<Channels = Self::Channels>;
    /// Some medium has extinction.
    const MEDIA: bool;
    /// Rays can pass surfaces undeflected, so segments cross boundaries.
    const NULLS: bool;
    /// The rays of some emitter, at infinity or not, or those of the sensor are parallel.
    const INFINITE: bool;
    /// Some medium emits light.
    const EMISSIVE: bool;
    /// Walks follow a guide.
    const GUIDED: bool = false;
    /// Name in scene files and on the command line.
    const NAME: &'static str;
}
