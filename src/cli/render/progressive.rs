//! Progressive pictures: a preview by few pixels (P03T ch. 6).

use crate::{
    cli::{console::complain, estimator::Estimator, parsers::one_of, progress::percent},
    error::{Error, Result},
    film::layer::Layer,
    render::progressive::{Method, Shaded},
    scene::build::Setup,
    transport::{Algorithm, strategy::StrategyKind},
};
use clap::Args;
use serde_json::{Value, json};

/// Which pixels are shaded, where not all are.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub struct Progressive {
    /// Biased preview: shade only the pixels that tell most about the image, and interpolate the rest
    ///
    /// One ray a pixel finds where normals, depth, albedo and media change. straight: triangles between shaded pixels are
    /// divided there, and where colours differ; regions: the outlines of regions that look alike are shaded first. Each
    /// shaded pixel takes --spp samples. The strategy lens is left out, as its light subpaths reach pixels by chance. The
    /// channel samples.N of EXR files shows which pixels are shaded. Files and the report say that this is a preview. In four
    /// measured scenes, all pixels at as many samples in all were further from the truth. With --denoise they were nearer to it.
    #[arg(long, value_name = "METHOD", value_parser = one_of(&Method::NAMES), conflicts_with_all =
        ["error", "batches", "samples", "sums", "resume", "groups", "components"])]
    pub progressive: Option<Method>,

    /// Part of the pixels to shade, above 0 to 1 [default: 0.1, or as many as --time-limit allows]
    #[arg(long, value_name = "PART", value_parser = fraction, requires = "progressive", allow_negative_numbers = true)]
    pub fraction: Option<f64>,
}

fn fraction(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|part: &f64| *part > 0.0 && *part <= 1.0);
    number.ok_or_else(|| "expected a part of the pixels above 0, at most 1, such as 0.1".to_owned())
}

/// The estimator that makes progressive pictures of `setup`: `given` without the strategy lens.
pub(super) fn estimator(given: &Estimator, setup: &Setup) -> Result<Estimator> {
    if given.strategies.contains(&StrategyKind::Lens) {
        let expected =
            "strategies that shade single pixels, for --progressive: hit, next-event, join, equiangular";
        let remedy = "leave out lens, or leave out --progressive";
        return Err(Error::new(
            "--strategies",
            expected,
            "lens, whose light subpaths reach any pixel",
            remedy,
        ));
    }
    if given.algorithm(setup) == Algorithm::Lt {
        let place = if given.integrator.is_some() { "--integrator" } else { "the scene's integrator" };
        let expected = "one that can shade single pixels, for --progressive";
        let found = "lt, whose light subpaths reach any pixel";
        return Err(Error::new(
            place,
            expected,
            found,
            "use --integrator bdpt or pt, or leave out --progressive",
        ));
    }
    Ok(Estimator { without_lens: true, ..given.clone() })
}

/// An error where the image cannot be interpolated, or layers are of all of its samples.
pub(super) fn check(setup: &Setup) -> Result<()> {
    if setup.exposure().is_some() {
        complain(
            "warning: a progressive picture shows the scene halfway through the exposure, without motion blur",
        );
    }
    let (width, height) = (setup.film.width, setup.film.height);
    if width.min(height) < 2 {
        let found = format!("{width} x {height} pixels");
        let expected = "an image of 2 x 2 pixels or more, for --progressive";
        return Err(Error::new(
            "the film",
            expected,
            found,
            "choose a larger --size, or leave out --progressive",
        ));
    }
    match setup.integrator.layers.iter().find(|layer| layer.needs_squares()) {
        None => Ok(()),
        Some(Layer { name, .. }) => {
            let expected = "layers of what primary rays see, for --progressive";
            let remedy = "leave out the scene's moment integrator, or leave out --progressive";
            Err(Error::new(
                "the scene's layers",
                expected,
                format!("{name}, the moments of all pixels"),
                remedy,
            ))
        }
    }
}

/// What files say of a picture that is not finished.
pub(super) fn begun(method: Method) -> Value {
    format!("{}, a biased preview that is not finished", method.name()).into()
}

/// True if the picture lacks what light subpaths that the lens sees would bring.
pub(super) fn is_without_lens(given: &Estimator, setup: &Setup) -> bool {
    given.strategies.is_empty() && given.algorithm(setup).strategies().lens
}

/// The same of one that is finished, with or without the strategy lens.
pub(super) fn text(shaded: &Shaded, is_without_lens: bool) -> String {
    let share = percent(shaded.pixels as f64 / shaded.of as f64);
    let lens = if is_without_lens { "; without the strategy lens" } else { "" };
    let method = shaded.method.name();
    format!("{method}, {share} of pixels shaded: a biased preview, the others are interpolated{lens}")
}

/// The same for scripts.
pub(super) fn json(shaded: &Shaded) -> Value {
    json!({
        "method": shaded.method.name(),
        "pixels_shaded": shaded.pixels,
        "pixels": shaded.of,
        "is_biased": shaded.pixels < shaded.of,
        "seconds_of_maps": shaded.maps.as_secs_f64(),
        "seconds_of_shading": shaded.shading.as_secs_f64(),
    })
}
