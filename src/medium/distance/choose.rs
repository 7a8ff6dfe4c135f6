//! Measurements before a render: which tracker costs least, and how long a marching step may be. Costs are counted,
//! not timed, so that the same scene is rendered the same way on any machine.

use super::{DistanceMethod, DistanceSampler, Extinction, NullCollision, RayMarching};
use crate::{
    math::{Channels, RaySegment, Spectrum, Vec3, vec3, warp},
    sampling::{Stream, stream::Purpose},
    volume::VolumeModel,
};

/// Number of sections that are tried.
const SECTIONS: u64 = 256;
/// Estimates of the transmittance of each; their variance counts as cost.
const ESTIMATES: u64 = 8;
/// The shortest sections, over the box's diagonal.
const SHORTEST: f32 = 1e-3;
/// Marching steps are at least the box's diagonal over this.
const FINEST: f32 = 16_384.0;
/// The same for its shortest side.
const THINNEST: f32 = 4_096.0;

/// The method `choice`, ready for work.
pub fn choose(
    medium: &Extinction,
    choice: DistanceMethod,
    step: Option<f64>,
    march_error: f64,
) -> DistanceSampler {
    let tracking = |method| Box::new(NullCollision::new(medium, method));
    match choice {
        DistanceMethod::ClosedForm => DistanceSampler::ClosedForm,
        DistanceMethod::RegularTracking => DistanceSampler::RegularTracking,
        DistanceMethod::RayMarching => DistanceSampler::RayMarching(RayMarching {
            step: step.map_or_else(|| longest_step(medium, march_error), |s| s as f32),
        }),
        DistanceMethod::RatioTracking | DistanceMethod::ResidualRatioTracking => {
            DistanceSampler::NullCollision(tracking(choice))
        }
        DistanceMethod::Auto if DistanceMethod::ClosedForm.applies_to(&medium.volume) => {
            DistanceSampler::ClosedForm
        }
        DistanceMethod::Auto => {
            let tracking = tracking(DistanceMethod::ResidualRatioTracking);
            match DistanceMethod::RegularTracking.applies_to(&medium.volume)
                && pays_exactly(medium, &tracking)
            {
                true => DistanceSampler::RegularTracking,
                false => DistanceSampler::NullCollision(tracking),
            }
        }
    }
}

/// True if a grid's cells cost less than `tracking` and its noise.
fn pays_exactly(medium: &Extinction, tracking: &NullCollision) -> bool {
    let exact = COST_OF_CELL * mean(medium, |segment, _| cells(medium, segment));
    let work = work_of_tracking(medium, tracking);
    // Noise only makes tracking more expensive. Where tracking costs a lot, so would measuring its noise.
    exact <= work || exact <= work * (1.0 + noise_of_tracking(medium, tracking))
}

/// Costs of integrating a cell of a grid, entering a coarse cell, and looking up a density, in one unit (about a
/// nanosecond where it was measured; see the timing test of the trackers).
const COST_OF_CELL: f64 = 16.0;
const COST_OF_PIECE: f64 = 10.0;
const COST_OF_LOOKUP: f64 = 45.0;

/// Cells of a grid that a segment crosses.
fn cells(medium: &Extinction, segment: &RaySegment) -> f64 {
    medium.volume.grid().map_or(0.0, |grid| grid.cells_crossed(segment))
}

/// Cost of an estimate of transmittance by null collisions.
fn work_of_tracking(medium: &Extinction, tracking: &NullCollision) -> f64 {
    mean(medium, |segment, _| {
        let [pieces, lookups] = tracking.work(medium, segment);
        COST_OF_PIECE * pieces + COST_OF_LOOKUP * lookups
    })
}

/// The relative variance that these estimates add to that of the light they attenuate (whose standard deviation is
/// taken to be its mean).
fn noise_of_tracking(medium: &Extinction, tracking: &NullCollision) -> f64 {
    let estimate = |segment: &RaySegment, stream: &mut Stream| {
        let found = tracking.attenuation::<Spectrum>(medium, segment, stream);
        found.map_or(0.0, |found| f64::from(found.transmittance.max_element()))
    };
    let first = mean(medium, |segment, stream| {
        (0..ESTIMATES).map(|_| estimate(segment, stream)).sum::<f64>().powi(2)
            / (ESTIMATES * ESTIMATES) as f64
    });
    let second = mean(medium, |segment, stream| {
        (0..ESTIMATES).map(|_| estimate(segment, stream).powi(2)).sum::<f64>() / ESTIMATES as f64
    });
    if first > 0.0 { (second / first - 1.0).max(0.0) } else { 0.0 }
}

/// The longest step for which no segment's transmittance is off by more than `error`, in steps of a factor of 2.
fn longest_step(medium: &Extinction, error: f64) -> f32 {
    let diagonal = (medium.high - medium.low).length();
    let finest = finest(medium, diagonal);
    let transmittance = |segment: &RaySegment, step: f32| -> Spectrum {
        RayMarching { step }.depth::<Spectrum>(medium, segment).exp_neg()
    };
    let truth: Vec<Spectrum> = sections(medium)
        .map(|(segment, _)| match medium.volume.has_integral() {
            true => super::closed_form::depth::<Spectrum>(medium, &segment).exp_neg(),
            false => transmittance(&segment, 2.0 * finest),
        })
        .collect();
    let mut step = 0.25 * diagonal;
    while step > 4.0 * finest {
        let off = |((segment, _), truth): ((RaySegment, Stream), &Spectrum)| {
            f64::from((transmittance(&segment, step) - *truth).abs().max_element())
        };
        if sections(medium).zip(&truth).map(off).fold(0.0, f64::max) <= error {
            break;
        }
        step *= 0.5;
    }
    step
}

/// The least step that is considered (m). A flat box is sampled as finely as it is thin where that costs little, that
/// is, where there is an integral to compare with.
fn finest(medium: &Extinction, diagonal: f32) -> f32 {
    let shortest = (medium.high - medium.low).min_element();
    let least = diagonal / FINEST;
    if medium.volume.has_integral() { (shortest / THINNEST).clamp(least / 64.0, least) } else { least }
}

/// The mean over the sections that are tried.
fn mean(medium: &Extinction, of: impl Fn(&RaySegment, &mut Stream) -> f64) -> f64 {
    let sum: f64 = sections(medium).map(|(segment, mut stream)| of(&segment, &mut stream)).sum();
    sum / SECTIONS as f64
}

/// Sections from random points of the medium's box, each with random numbers of its own. Half of them lead to other
/// such points. The other half have random lengths of all orders of magnitude and random directions: a flat box is
/// crossed steeply too, and where extinction is strong only what is near is seen.
fn sections(medium: &Extinction) -> impl Iterator<Item = (RaySegment, Stream)> + use<'_> {
    (0..SECTIONS).map(|index| {
        let mut stream = Stream::new(0, index, 0, Purpose::Pilot);
        let size = medium.high - medium.low;
        let mut point = || medium.low + vec3(stream.uniform(), stream.uniform(), stream.uniform()) * size;
        let (a, b) = (point(), point());
        let (direction, length) = if index % 2 == 0 {
            let length = a.distance(b);
            (if length > 0.0 { (b - a) / length } else { Vec3::X }, length)
        } else {
            let shortening = SHORTEST.powf(stream.uniform());
            (warp::to_sphere(stream.square()), size.length() * shortening)
        };
        (RaySegment { origin: a, direction, length }, stream)
    })
}
