//! One photon's way through the medium.

use super::{
    Experiment, Method, Shape,
    tally::{
        ABSORBED, COUNT, DIRECT, DIRECT_SIDES, REFLECTED, Record, SCATTERED, SCATTERINGS, SIDES, TRANSMITTED,
    },
};
use crate::{
    math::{DVec3, Vec3, vec3},
    phase::PhaseModel,
    sampling::{Stream, stream::Purpose},
};

/// Where a photon leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Face {
    Near,
    Far,
    Side,
}

struct Photon {
    position: DVec3,
    direction: Vec3,
    power: f64,
    is_scattered: bool,
}

/// Below this power a photon is worth little: one of ten goes on, with ten times the power.
const FAINT: f64 = 1e-3;
const SURVIVAL: f64 = 0.1;

/// Sends photons by one method.
pub(super) struct Walker<'a> {
    experiment: &'a Experiment,
    method: Method,
    sigma_t: f64,
    albedo: f64,
    /// Of constant steps: the share that one lets pass unabsorbed.
    passing: f64,
    /// Of constant steps: the probability of being scattered at the end of one.
    scattering: f64,
}

impl<'a> Walker<'a> {
    pub(super) fn new(experiment: &'a Experiment, method: Method) -> Self {
        let Experiment { sigma_a, sigma_s, .. } = *experiment;
        let sigma_t = sigma_a + sigma_s;
        let albedo = if sigma_t > 0.0 { sigma_s / sigma_t } else { 0.0 };
        let step = if let Method::Constant(step) = method { step } else { 0.0 };
        let (passing, scattering) = ((-sigma_a * step).exp(), -(-sigma_s * step).exp_m1());
        Self { experiment, method, sigma_t, albedo, passing, scattering }
    }

    /// The record of a photon: a pure function of seed, index of the run, and its number.
    pub(super) fn walk(&self, seed: u64, index: u64, number: u64) -> Record {
        let mut stream = Stream::new(seed, index, number, Purpose::Study);
        let mut record = [0.0; COUNT];
        let mut photon = self.enter();
        if self.method == Method::Forced {
            self.force(&mut photon, &mut record, &mut stream);
        }
        while photon.power > 0.0 {
            let (limit, face) = self.exit(&photon);
            if !self.fly(&mut photon, limit, &mut record, &mut stream) {
                leave(&photon, face, &mut record);
                break;
            }
            self.scatter(&mut photon, &mut record, &mut stream);
        }
        record
    }

    fn enter(&self) -> Photon {
        let (sine, cosine) = self.experiment.angle.sin_cos();
        let direction = vec3(sine as f32, 0.0, cosine as f32);
        Photon { position: DVec3::ZERO, direction, power: 1.0, is_scattered: false }
    }

    /// How far it is to the border, and which face is there.
    fn exit(&self, photon: &Photon) -> (f64, Face) {
        let size = self.experiment.size;
        let (p, d) = (photon.position, photon.direction.as_dvec3());
        let (far, face) = if d.z > 0.0 { (size - p.z, Face::Far) } else { (p.z, Face::Near) };
        let depth = (way(far, d.z), face);
        if self.experiment.shape == Shape::Slab {
            return depth;
        }
        let side = |p: f64, d: f64| (way(0.5 * size - p * d.signum(), d), Face::Side);
        let nearer = |a: (f64, Face), b: (f64, Face)| if b.0 < a.0 { b } else { a };
        nearer(depth, nearer(side(p.x, d.x), side(p.y, d.y)))
    }

    /// Flies to a collision, or to the border at `limit`; true if it is still within.
    fn fly(&self, photon: &mut Photon, limit: f64, record: &mut Record, stream: &mut Stream) -> bool {
        match self.method {
            Method::Constant(step) => self.stride(photon, step, limit, record, stream),
            Method::ByExtinction | Method::Forced => {
                let length = f64::from(stream.exponential()) / self.sigma_t;
                let collides = length < limit;
                if collides {
                    self.collide(photon, length, record);
                }
                collides
            }
            Method::ByScattering => {
                let length = f64::from(stream.exponential()) / self.experiment.sigma_s;
                let flown = length.min(limit);
                absorb(photon, (-self.experiment.sigma_a * flown).exp(), record);
                advance(photon, flown);
                length < limit
            }
        }
    }

    /// Steps of equal length, until one ends in a collision or the next would end outside.
    fn stride(
        &self,
        photon: &mut Photon,
        step: f64,
        limit: f64,
        record: &mut Record,
        stream: &mut Stream,
    ) -> bool {
        let mut left = limit;
        while left >= step {
            absorb(photon, self.passing, record);
            advance(photon, step);
            if stream.uniform_precisely() < self.scattering {
                return true;
            }
            left -= step;
        }
        absorb(photon, (-self.experiment.sigma_a * left).exp(), record);
        false
    }

    /// Absorption and scattering together at the end of a flight.
    fn collide(&self, photon: &mut Photon, length: f64, record: &mut Record) {
        advance(photon, length);
        absorb(photon, self.albedo, record);
    }

    /// Lets leave what does not collide, and makes the rest collide on the way to the border.
    fn force(&self, photon: &mut Photon, record: &mut Record, stream: &mut Stream) {
        let (limit, face) = self.exit(photon);
        let colliding = -(-self.sigma_t * limit).exp_m1();
        let all = photon.power;
        photon.power = all * (1.0 - colliding);
        leave(photon, face, record);
        photon.power = all * colliding;
        let length = -(-stream.uniform_precisely() * colliding).ln_1p() / self.sigma_t;
        self.collide(photon, length.min(limit), record);
        self.scatter(photon, record, stream);
    }

    fn scatter(&self, photon: &mut Photon, record: &mut Record, stream: &mut Stream) {
        record[SCATTERINGS] += photon.power;
        photon.is_scattered = true;
        if photon.power < FAINT {
            let survives = stream.uniform_precisely() < SURVIVAL;
            photon.power = if survives { photon.power / SURVIVAL } else { 0.0 };
        }
        photon.direction = self.experiment.phase.sample(photon.direction, stream);
    }
}

/// Length of flight over `distance` along an axis along which the direction has the component `part`.
fn way(distance: f64, part: f64) -> f64 {
    if part == 0.0 { f64::INFINITY } else { distance.max(0.0) / part.abs() }
}

fn advance(photon: &mut Photon, length: f64) {
    photon.position += photon.direction.as_dvec3() * length;
}

/// Leaves the share `passing` of the power.
fn absorb(photon: &mut Photon, passing: f64, record: &mut Record) {
    record[ABSORBED] += photon.power * (1.0 - passing);
    photon.power *= passing;
}

fn leave(photon: &Photon, face: Face, record: &mut Record) {
    let place = match (face, photon.is_scattered) {
        // Light that was never scattered cannot turn back.
        (Face::Near, _) => REFLECTED,
        (Face::Far, true) => TRANSMITTED,
        (Face::Far, false) => DIRECT,
        (Face::Side, true) => SIDES,
        (Face::Side, false) => DIRECT_SIDES,
    };
    record[place] += photon.power;
    if photon.is_scattered {
        record[SCATTERED] += photon.power;
    }
}

impl Experiment {
    /// What is known of each quantity without a run: light that passes is exp(-sigma_t d); of matter that only
    /// absorbs or only scatters nothing is scattered or absorbed; a slab has no sides.
    pub(super) fn closed_forms(&self) -> [Option<f64>; COUNT] {
        let walker = Walker::new(self, Method::ByExtinction);
        let (limit, face) = walker.exit(&walker.enter());
        let passing = (-walker.sigma_t * limit).exp();
        let mut known = [None; COUNT];
        known[DIRECT] = Some(if face == Face::Far { passing } else { 0.0 });
        known[DIRECT_SIDES] = Some(if face == Face::Side { passing } else { 0.0 });
        if self.shape == Shape::Slab {
            known[SIDES] = Some(0.0);
        }
        if self.sigma_a == 0.0 {
            known[ABSORBED] = Some(0.0);
            known[SCATTERED] = Some(1.0 - passing);
        }
        if self.sigma_s == 0.0 {
            known[ABSORBED] = Some(1.0 - passing);
            for quantity in [REFLECTED, TRANSMITTED, SIDES, SCATTERED, SCATTERINGS] {
                known[quantity] = Some(0.0);
            }
        }
        known
    }
}
