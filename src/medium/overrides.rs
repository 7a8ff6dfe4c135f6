//! Settings of an integrator or the command line for all media of a scene, over their descriptions.

use super::distance::DistanceMethod;

/// Changes to the media of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MediumOverrides {
    /// The tracker of those that vary, in place of their own choice.
    pub tracker: Option<DistanceMethod>,
    /// The longest interval of ray marching (m), in place of their own.
    pub step: Option<f64>,
    /// The error of transmittance that ray marching may make, in place of their own steps and errors.
    pub march_error: Option<f64>,
    /// They absorb as before but do not scatter: sigma_t becomes sigma_a (P03T eq. 2.9).
    pub absorbing: bool,
}

impl MediumOverrides {
    /// These overrides, and `others` where these are unset. A step or an error replaces both of `others`: each says how
    /// fine the march is.
    pub fn over(self, others: Self) -> Self {
        let is_fineness = self.step.is_some() || self.march_error.is_some();
        let Self { step, march_error, .. } = if is_fineness { self } else { others };
        let absorbing = self.absorbing || others.absorbing;
        Self { tracker: self.tracker.or(others.tracker), step, march_error, absorbing }
    }
}
