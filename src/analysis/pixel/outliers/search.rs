//! The brightest contribution to each pixel among all those that a render adds up.

use crate::{
    error::Result,
    film::{Film, moments::Moments},
    math::{Spectrum, SpectrumExt, Vec2},
    passes::{
        blocks::CameraStart,
        observe::BlockObserver,
        pass::{Outcome, Pass},
    },
    render::Stage,
    transport::{
        Contribution,
        observer::{Meeting, Observer},
    },
};
use std::ops::Range;

/// Which of the contributions to a pixel's sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// Of its camera subpath, by its number among those tried.
    Try(u32),
    /// Of this light subpath, through the lens, with `s` light vertices.
    Splat { walk: u64, s: u32 },
}

/// A contribution, and where to find it again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Number of the pass.
    pub sample: u64,
    /// Row-major index.
    pub pixel: u32,
    pub which: Which,
    /// Its luminance, which negative lobes of filters may make negative.
    pub luminance: f32,
}

/// What is seen of a block.
struct Block<'a> {
    light: LightPaths<'a>,
    camera: CameraPath,
    /// The brightest of what each of them contributed.
    found: Vec<Found>,
    /// What camera subpaths contributed to pixels.
    pixels: Vec<(u32, Spectrum)>,
}

impl<'a> Block<'a> {
    fn new(film: &'a Film, sample: u64) -> Self {
        let light = LightPaths { film, sample, walk: 0, pixels: Vec::new(), found: Vec::new() };
        let camera =
            CameraPath { sample, pixel: 0, factor: 1.0, tries: 0, radiance: Spectrum::ZERO, brightest: None };
        Self { light, camera, found: Vec::new(), pixels: Vec::new() }
    }
}

impl BlockObserver for Block<'_> {
    fn light(&mut self, walk: u64) -> &mut dyn Observer {
        self.light.walk = walk;
        &mut self.light
    }

    fn camera(&mut self, pixel: usize, start: &CameraStart) -> &mut dyn Observer {
        let camera = &mut self.camera;
        (camera.pixel, camera.factor) = (pixel as u32, start.weight);
        (camera.tries, camera.radiance, camera.brightest) = (0, Spectrum::ZERO, None);
        camera
    }

    fn ended(&mut self, pixel: usize) {
        self.pixels.push((pixel as u32, self.camera.radiance * self.camera.factor));
        self.found.extend(self.camera.brightest);
    }
}

/// Sees light subpaths.
struct LightPaths<'a> {
    film: &'a Film,
    sample: u64,
    walk: u64,
    pixels: Vec<(u32, Spectrum)>,
    found: Vec<Found>,
}

impl Observer for LightPaths<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    /// It counts once, in the pixel that it makes brightest, however many the filter gives a share of it.
    fn contribute(&mut self, s: u32, _: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(Contribution { value, .. })) = (meeting, contribution) else { return };
        // A render leaves out what is no number, and says so.
        if !value.is_finite() {
            return;
        }
        let (sample, which) = (self.sample, Which::Splat { walk: self.walk, s });
        let (pixels, mut brightest) = (&mut self.pixels, None);
        self.film.spread(film, *value, |pixel, value| {
            let pixel = pixel as u32;
            pixels.push((pixel, value));
            keep(&mut brightest, Found { sample, pixel, which, luminance: value.luminance() });
        });
        self.found.extend(brightest);
    }
}

/// Sees camera subpaths.
struct CameraPath {
    sample: u64,
    pixel: u32,
    /// Of the filter.
    factor: f32,
    /// Strategies tried so far.
    tries: u32,
    radiance: Spectrum,
    brightest: Option<Found>,
}

impl Observer for CameraPath {
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, contribution: Option<&Contribution>) {
        let which = Which::Try(self.tries);
        self.tries += 1;
        let Some(Contribution { value, .. }) = contribution else { return };
        if value.is_finite() {
            self.radiance += *value;
            let (sample, pixel) = (self.sample, self.pixel);
            let luminance = (*value * self.factor).luminance();
            keep(&mut self.brightest, Found { sample, pixel, which, luminance });
        }
    }
}

/// Keeps the brighter one, the first where they are alike. Black is none.
#[inline]
fn keep(brightest: &mut Option<Found>, one: Found) {
    if one.luminance.abs() > brightest.map_or(0.0, |brightest| brightest.luminance.abs()) {
        *brightest = Some(one);
    }
}

/// The brightest contribution to `samples` of each pixel, and the image of them. Says how many samples are done.
pub(super) fn search(
    stage: &Stage<'_>,
    samples: Range<usize>,
    progress: &mut dyn FnMut(u64),
) -> Result<(Vec<Found>, Moments)> {
    let film = stage.instrument.film;
    let (mut pass, mut moments) = (Pass::new(film.len()), Moments::new(film.len()));
    let mut brightest = vec![None; film.len()];
    let see = |sample| Block::new(film, sample as u64);
    let mut take = |Block { light, found, pixels, .. }: Block<'_>, ends_pass| {
        pass.add(&Outcome::of_parts(pixels, light.pixels, Vec::new()));
        let all = light.found.into_iter().chain(found);
        all.for_each(|one| keep(&mut brightest[one.pixel as usize], one));
        if ends_pass {
            pass.finish(None, |image| moments.add(image));
            progress(moments.passes());
        }
    };
    let mut next = samples.start;
    while next < samples.end {
        next = stage.show(next as u64, |instrument, most| {
            let end = samples.end.min(next.saturating_add(most));
            instrument.observe(next..end, see, &mut take);
            end
        })?;
    }
    Ok((brightest.into_iter().flatten().collect(), moments))
}
