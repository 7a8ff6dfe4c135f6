//! Media that emit, as emitters of a scene.

use super::{clearings::Clearings, light::Light};
use crate::{
    emitter::{Emitter, VolumeEmitter},
    math::{SpectrumExt, Vec3, warp},
    medium::{Emission, Medium, MediumIndex},
    sampling::{Stream, stream::Purpose},
    scene::media::{
        locate::{Certainty, Located, Locator},
        overlap::{Overlaps, lies_in},
    },
};
use std::sync::Arc;

/// Points of an emissive medium's box that are located.
const POINTS: u32 = 4096;

/// The emissive ones among `media`, which may overlap or contradict each other; `outside` is the medium of points about
/// which nothing is known.
pub(crate) fn emissive<'a>(
    media: &'a [Medium],
    locator: Locator<'a>,
    overlaps: Option<&'a Overlaps>,
    contradict: bool,
    outside: MediumIndex,
) -> impl Iterator<Item = Light> + use<'a> {
    (0..).zip(media).filter_map(move |(index, medium)| {
        let (emission, medium) = (medium.emission.clone()?, MediumIndex(index));
        let is_plain = overlaps.is_none() && !contradict && !locator.known.is_uniform();
        let clearings = is_plain.then(|| Arc::new(clearings(&emission, medium, locator, outside)));
        let mut lit = |point: Vec3, direction: Vec3| {
            if let Some(known) =
                clearings.as_ref().and_then(|clearings| clearings.holds(point, locator.geometry))
            {
                return known;
            }
            let base = locator.along(point, direction).unwrap_or(outside);
            lies_in(overlaps, base, medium, point, direction)
        };
        let filled = filled(&emission, medium, &mut lit);
        let emitter = Emitter::of_medium(VolumeEmitter { emission, filled });
        Some(Light { emitter, position: Vec3::ZERO, shape: None, medium, straddles: false, clearings })
    })
}

/// Where the box around `emission` holds its `medium`, and where another.
fn clearings(
    emission: &Emission,
    medium: MediumIndex,
    locator: Locator<'_>,
    outside: MediumIndex,
) -> Clearings {
    let mut stream = Stream::new(3, u64::from(medium.0), 0, Purpose::Pilot);
    Clearings::of(emission.bounds(), locator.geometry, |point| match locator.locate(point, &mut stream) {
        Some(Located { certainty: Certainty::Contradicted(_), .. }) => None,
        Some(located) => Some(located.medium == medium),
        None => Some(outside == medium),
    })
}

/// The part of the power of `emission` that is emitted where `lit` finds `medium`, above 0.
fn filled(emission: &Emission, medium: MediumIndex, lit: &mut impl FnMut(Vec3, Vec3) -> bool) -> f64 {
    let mut stream = Stream::new(2, u64::from(medium.0), 0, Purpose::Pilot);
    let mut sum = [0.0, 0.0];
    for _ in 0..POINTS {
        let point = emission.sample(&mut stream);
        let direction = warp::to_sphere(stream.square());
        let pdf = emission.pdf_vol(point);
        // Rounding may have put it just outside.
        let share = if pdf > 0.0 { f64::from(emission.at(point).luminance() / pdf) } else { 0.0 };
        sum[0] += share;
        sum[1] += if lit(point, direction) { share } else { 0.0 };
    }
    (sum[1] / sum[0]).max(1.0 / f64::from(POINTS))
}
