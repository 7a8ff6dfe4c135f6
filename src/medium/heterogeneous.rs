//! A medium whose extinction and albedo vary in space.

use super::{
    Choice, Extinction, Leg, Matter,
    emission::Within,
    tracker::{self, Tracker},
};
use crate::{
    density::{Volume, VolumeModel},
    description::Location,
    error::{Error, Result},
    math::{DVec3, Lanes, Section, Spectrum, Vec3},
    sampling::Stream,
};

/// What is given.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Extinction before `scale`.
    pub sigma_t: Volume,
    /// Factor on it [1/m].
    pub scale: f32,
    /// sigma_s / sigma_t.
    pub albedo: Volume,
    /// Asked for.
    pub tracker: Choice,
    /// Longest interval of ray marching [m], if asked for.
    pub step: Option<f64>,
    /// Error of transmittance that ray marching may make where no step is asked for.
    pub march_error: f64,
    /// The origin of positions in the file's coordinates [m].
    pub recentre: DVec3,
    /// Where the medium stands in the file.
    pub location: Location,
}

/// Extinction, albedo, and how flights through them are sampled.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    extinction: Extinction,
    albedo: Volume,
    tracker: Tracker,
}

impl Heterogeneous {
    /// Looks at `fields` within their own bounds, or the box `around` where they have none, and chooses a tracker.
    pub fn new(fields: Fields, around: [Vec3; 2], forced: Option<Choice>) -> Result<Self> {
        let location = &fields.location;
        let [low, high] = fields.sigma_t.domain().unwrap_or(around);
        let extinction = Extinction { volume: fields.sigma_t, scale: fields.scale, low, high };
        let checks = [
            (extinction.bound().max_element() < f32::INFINITY, "sigma_t", "a finite product with scale"),
            (fields.albedo.range(low, high)[1].max_element() <= 1.0, "albedo", "values from 0 to 1"),
        ];
        if let Some((_, name, expected)) = checks.iter().find(|(fine, ..)| !fine) {
            let remedy = format!("change \"{name}\" of the medium");
            return Err(Error::new(location, format!("{expected} for \"{name}\""), "larger ones", remedy));
        }
        let choice = forced.unwrap_or(fields.tracker);
        if !choice.applies_to(&extinction.volume) {
            return Err(inapplicable(choice, &extinction.volume, location));
        }
        let tracker = tracker::choose(&extinction, choice, fields.step, fields.march_error);
        Ok(Self { extinction, albedo: fields.albedo, tracker })
    }

    /// Bounds on extinction [1/m] and albedo.
    pub fn bounds(&self) -> (Spectrum, Spectrum) {
        let Extinction { low, high, .. } = self.extinction;
        (self.extinction.bound(), self.albedo.range(low, high)[1].min(Spectrum::ONE))
    }

    /// True if extinction differs between channels.
    pub fn is_chromatic(&self) -> bool {
        !self.extinction.volume.is_grey()
    }

    /// Where it is, and how much.
    pub fn extinction(&self) -> &Extinction {
        &self.extinction
    }

    /// How its flights are sampled.
    pub fn tracker(&self) -> &Tracker {
        &self.tracker
    }

    /// What it is made of at a world position.
    #[inline]
    pub fn at<L: Lanes>(&self, position: Vec3) -> Matter {
        let sigma_t = self.extinction.at::<L>(position).to_spectrum();
        Matter { sigma_t, albedo: self.albedo.eval::<Spectrum>(position) }
    }

    /// What absorbs, for what shines there.
    pub(super) fn within(&self) -> Within {
        Within::Varying(Box::new((self.extinction.clone(), self.albedo.clone())))
    }

    /// See [`Tracker::depth`].
    #[inline]
    pub fn depth<L: Lanes>(&self, section: &Section) -> L {
        self.tracker.depth(&self.extinction, section)
    }

    /// See [`Tracker::transmittance`].
    #[inline]
    pub fn transmittance<L: Lanes>(&self, section: &Section, depth: L, stream: &mut Stream) -> L {
        self.tracker.transmittance(&self.extinction, section, depth, stream)
    }

    /// See [`Tracker::ratio`].
    #[inline]
    pub fn ratio<L: Lanes>(&self, section: &Section, depth: L, hero: usize, stream: &mut Stream) -> L {
        self.tracker.ratio(&self.extinction, section, depth, hero, stream)
    }

    /// See [`Tracker::fly`].
    #[inline]
    pub fn fly<L: Lanes>(
        &self,
        section: &Section,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Leg<L> {
        self.tracker.fly(&self.extinction, section, hero, remaining, stream)
    }
}

fn inapplicable(choice: Choice, volume: &Volume, location: &Location) -> Error {
    let fitting: Vec<_> =
        Choice::NAMES.iter().filter(|(_, other)| other.applies_to(volume)).map(|(name, _)| *name).collect();
    let expected = match choice {
        Choice::Exact => "a gridvolume for sigma_t, which the exact tracker needs",
        _ => "a sigma_t with an integral in closed form",
    };
    let remedy = format!("choose a tracker that works here: {}", fitting.join(", "));
    Error::new(location, expected, format!("the tracker \"{}\"", choice.name()), remedy)
}
