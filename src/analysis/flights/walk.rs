//! One photon's way through the medium.

use super::{
    Experiment, Method, Shape,
    cells::{Matter, Section, Way, depth},
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
    /// What a constant step within one cell does, cell by cell.
    steps: Vec<Step>,
}

/// What a constant step does.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// The share that it lets pass unabsorbed.
    passing: f64,
    /// The probability of being scattered at its end.
    scattering: f64,
}

impl Step {
    /// Of the optical depths of the step.
    fn of(absorption: f64, scattering: f64) -> Self {
        Self { passing: (-absorption).exp(), scattering: -(-scattering).exp_m1() }
    }
}

impl<'a> Walker<'a> {
    pub(super) fn new(experiment: &'a Experiment, method: Method) -> Self {
        let length = if let Method::Constant(step) = method { step } else { 0.0 };
        let step = |matter: &Matter| Step::of(matter.sigma_a * length, matter.sigma_s * length);
        Self { experiment, method, steps: experiment.cells.matter().iter().map(step).collect() }
    }

    /// Where a photon flies next, as far as `limit`.
    fn way(&self, photon: &Photon, limit: f64) -> Way {
        let Experiment { cells, size, .. } = self.experiment;
        cells.way(*size, photon.position, photon.direction.as_dvec3(), limit)
    }

    fn matter(&self, section: Section) -> Matter {
        self.experiment.cells.matter()[section.cell]
    }

    /// The integral of `sigma` from a photon as far as `limit`.
    fn depth(&self, photon: &Photon, limit: f64, sigma: fn(Matter) -> f64) -> f64 {
        let part = |s: Section| depth(sigma(self.matter(s)), s.end - s.start);
        self.way(photon, limit).map(part).sum()
    }

    /// How far it is to where the integral of `sigma` is `depth`, and what is there; none if that is not before `limit`.
    fn reach(
        &self,
        photon: &Photon,
        limit: f64,
        mut left: f64,
        sigma: fn(Matter) -> f64,
    ) -> Option<(f64, Matter)> {
        for section in self.way(photon, limit) {
            let matter = self.matter(section);
            let here = depth(sigma(matter), section.end - section.start);
            if left < here {
                return Some((section.start + left / sigma(matter), matter));
            }
            left -= here;
        }
        None
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
                let collision = self.reach(photon, limit, f64::from(stream.exponential()), Matter::sigma_t);
                if let Some((length, matter)) = collision {
                    collide(photon, length, matter, record);
                }
                collision.is_some()
            }
            Method::ByScattering => {
                let depth = f64::from(stream.exponential());
                let collision = self.reach(photon, limit, depth, |matter| matter.sigma_s);
                let flown = collision.map_or(limit, |(length, _)| length);
                absorb(photon, (-self.depth(photon, flown, |matter| matter.sigma_a)).exp(), record);
                advance(photon, flown);
                collision.is_some()
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
        let mut way = self.way(photon, limit);
        let Some(mut here) = way.next() else { return false };
        let mut flown = 0.0;
        // A way without end, along a layer, is flown only where something ends it.
        let has_end = limit.is_finite() || self.matter(here).sigma_s > 0.0;
        while has_end && limit - flown >= step {
            let end = flown + step;
            let Step { passing, scattering } = match end <= here.end {
                true => self.steps[here.cell],
                false => self.across(&mut here, &mut way, flown, end),
            };
            absorb(photon, passing, record);
            advance(photon, step);
            if stream.uniform_precisely() < scattering {
                return true;
            }
            flown = end;
        }
        absorb(photon, self.across(&mut here, &mut way, flown, limit).passing, record);
        false
    }

    /// A step from `from` to `to` along a `way` that may leave the cell it is in.
    fn across(&self, here: &mut Section, way: &mut Way, mut from: f64, to: f64) -> Step {
        let (mut absorption, mut scattering) = (0.0, 0.0);
        loop {
            let (matter, end) = (self.matter(*here), here.end.min(to));
            absorption += depth(matter.sigma_a, end - from);
            scattering += depth(matter.sigma_s, end - from);
            from = end;
            let next = if end < to { way.next() } else { None };
            let Some(next) = next else { return Step::of(absorption, scattering) };
            *here = next;
        }
    }

    /// Lets leave what does not collide, and makes the rest collide on the way to the border.
    fn force(&self, photon: &mut Photon, record: &mut Record, stream: &mut Stream) {
        let (limit, face) = self.exit(photon);
        let colliding = -(-self.depth(photon, limit, Matter::sigma_t)).exp_m1();
        let all = photon.power;
        photon.power = all * (1.0 - colliding);
        leave(photon, face, record);
        photon.power = all * colliding;
        let depth = -(-stream.uniform_precisely() * colliding).ln_1p();
        // Below the whole depth, up to rounding; where that is 0, no power is left.
        let last = || self.way(photon, limit).last().map(|section| (limit, self.matter(section)));
        if let Some((length, matter)) = self.reach(photon, limit, depth, Matter::sigma_t).or_else(last) {
            collide(photon, length, matter, record);
            self.scatter(photon, record, stream);
        }
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

/// Absorption and scattering together at the end of a flight.
fn collide(photon: &mut Photon, length: f64, matter: Matter, record: &mut Record) {
    advance(photon, length);
    absorb(photon, matter.albedo(), record);
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
        let passing = (-walker.depth(&walker.enter(), limit, Matter::sigma_t)).exp();
        let nowhere =
            |sigma: fn(&Matter) -> f64| self.cells.matter().iter().all(|matter| sigma(matter) == 0.0);
        let mut known = [None; COUNT];
        known[DIRECT] = Some(if face == Face::Far { passing } else { 0.0 });
        known[DIRECT_SIDES] = Some(if face == Face::Side { passing } else { 0.0 });
        if self.shape == Shape::Slab {
            known[SIDES] = Some(0.0);
        }
        if nowhere(|matter| matter.sigma_a) {
            known[ABSORBED] = Some(0.0);
            known[SCATTERED] = Some(1.0 - passing);
        }
        if nowhere(|matter| matter.sigma_s) {
            known[ABSORBED] = Some(1.0 - passing);
            for quantity in [REFLECTED, TRANSMITTED, SIDES, SCATTERED, SCATTERINGS] {
                known[quantity] = Some(0.0);
            }
        }
        known
    }
}
