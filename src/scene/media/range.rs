//! Limits of single precision: densities and sizes of media for which the image is right. Media beyond them are
//! reported when the scene is built.

use super::extents::Extents;
use crate::{
    description::{Library, Location},
    error::{Error, Result},
    math::{
        Bounds,
        offset::{
            LEAST_MEAN_FREE_PATH, LEAST_VOLUME_DENSITY, RESOLVED_STEPS, ROUNDOFF, SHORTEST_MEAN_FREE_PATH,
        },
    },
    medium::{DistanceMethod, Heterogeneous, Medium, MediumIndex},
};

/// Scatterings of one path that take longer than anybody waits for a sample: some seconds.
const ENDLESS: f64 = 1e8;

/// Reports every one of `media` (all but vacuum) that is too dense, or too thin for the size of the scene.
pub(crate) fn check(
    media: &[Medium],
    locations: &[Location],
    extents: &Extents<'_>,
    library: &Library,
) -> Result<()> {
    for (index, (medium, location)) in media.iter().zip(locations).enumerate() {
        let densest = medium.densest().max_element();
        if densest <= 0.0 {
            continue;
        }
        let reached = medium.extent().unwrap_or_else(|| extents.of(MediumIndex(index as u32 + 1)).1);
        check_mean_free_path(medium, 1.0 / densest, farthest(reached), location, library)?;
        let size = f64::from(extents.scene().size().length());
        if f64::from(densest) / (size * size) < LEAST_VOLUME_DENSITY {
            let text = format!(
                "expected sigma_t over the square of the scene's size of at least {LEAST_VOLUME_DENSITY:e} per cubic \
                 metre, found sigma_t {densest:e} per metre in a scene of {size:.0e} m: densities of paths \
                 are too small for single precision, and light will be lost. Use a larger unit of length"
            );
            library.warn(location, &text);
        }
    }
    Ok(())
}

/// Scatterings of a path before it is absorbed or leaves a medium `thickness` mean free paths thick.
fn scatterings(medium: &Medium, thickness: f32) -> f64 {
    let absorbed = 1.0 - f64::from(medium.bound().survival());
    f64::from(thickness).powi(2).min(1.0 / absorbed.max(0.0))
}

/// The largest coordinate of a box (m from the camera).
fn farthest(Bounds { low, high }: Bounds) -> f32 {
    low.abs().max(high.abs()).max_element()
}

/// A mean free path (m) against the steps of positions where the medium reaches `farthest` metres from the camera.
fn check_mean_free_path(
    medium: &Medium,
    free_path: f32,
    farthest: f32,
    location: &Location,
    library: &Library,
) -> Result<()> {
    if free_path < SHORTEST_MEAN_FREE_PATH {
        return Err(Error::new(
            location,
            format!("sigma_t of at most {:.0e} per metre (single precision)", 1.0 / SHORTEST_MEAN_FREE_PATH),
            format!("{:.1e} per metre", 1.0 / free_path),
            "lower sigma_t or scale; an opaque surface shows what so dense a medium would",
        ));
    }
    let step = 2.0 * ROUNDOFF;
    let tracker = medium.heterogeneous().map(|varying: &Heterogeneous| varying.tracker().choice());
    let by_collisions = [DistanceMethod::RatioTracking, DistanceMethod::ResidualRatioTracking];
    if tracker.is_some_and(|tracker| by_collisions.contains(&tracker)) && free_path < step * farthest {
        return Err(Error::new(
            location,
            format!(
                "a mean free path of at least {:.1e} m for null collisions (the rounding error of positions)",
                step * farthest
            ),
            format!(
                "{free_path:.1e} m, 1 over the largest sigma_t, in a medium that reaches {farthest:.2e} m from the camera"
            ),
            "lower sigma_t or scale, or choose another tracker: \"march\" works for every medium",
        ));
    }
    let resolved = free_path / (RESOLVED_STEPS * step);
    if farthest > resolved || free_path < LEAST_MEAN_FREE_PATH {
        // What starts behind the boundary loses the light that is scattered before it, and keeps what is not absorbed there.
        let wrong = if medium.emission.is_some() { "wrong, most likely too bright," } else { "too dark" };
        let endless = if scatterings(medium, farthest / free_path) > ENDLESS {
            ", and a path that gets deep into it scatters for seconds to hours unless max_depth ends it"
        } else {
            ""
        };
        let text = format!(
            "expected a mean free path of at least {:.1e} m, found {free_path:.1e} m (1 over the largest sigma_t), in a \
             medium that reaches {farthest:.2e} m from the camera: positions are rounded to {:.1e} m there, and its \
             boundaries will be {wrong} beyond {resolved:.1e} m{endless}. Lower sigma_t, or bring the medium closer",
            (RESOLVED_STEPS * step * farthest).max(LEAST_MEAN_FREE_PATH),
            step * farthest,
        );
        library.warn(location, &text);
    }
    Ok(())
}
