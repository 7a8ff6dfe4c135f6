//! The options of the command line that say how paths are made.

use crate::{
    cli::{
        depth::{MaxDepth, max_depth, min_depth},
        heading,
        media::Media,
        parsers::{algorithm, one_of},
    },
    film::sharing::FilmSamples,
    sampling::{Basis, Sampler},
    transport::{
        Algorithm, Connections, FirstPass, Guiding, Heuristic, LightStarts, Sky, strategy::StrategyKind,
    },
};
use clap::{Args, ValueEnum};

/// How paths are sampled and weighted.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Estimator {
    /// How light goes through media.
    #[command(flatten)]
    pub media: Media,

    /// Light transport algorithm [default: the scene's integrator]
    ///
    /// bdpt: bidirectional path tracing; pt: path tracing from the camera; lt: light tracing (particle tracing)
    /// from the emitters; first-pass: a preview, a coarse solution in elements of surfaces and media, biased by blur; gather: a preview by
    /// path tracing that ends at the second scattering, in a first pass: it is biased by blur, far less noisy than pt where surfaces light
    /// each other, and noisier in a dense cloud; fog: a preview of the first visible surfaces without
    /// shadows, behind fog of constant radiance; 4 samples per pixel are enough. In scenes with the integrator single_scattering or
    /// non_scattering its restriction of media still applies, unless --scattering says otherwise. Mitsuba's path, volpath and
    /// volpathmis are pt here, its ptracer is lt.
    #[arg(long, value_name = "NAME", value_parser = algorithm())]
    pub integrator: Option<Algorithm>,

    /// Light subpaths, which reach pixels by chance, do not connect to the lens.
    #[arg(skip)]
    pub without_lens: bool,

    /// Sampling strategies to use, separated by commas [default: those that the pilot of bdpt finds worth their time]
    ///
    /// The pilot takes 1 in 128 of the samples to come, 768 at least. It chooses the strategies, how many samples each takes, when walks
    /// end, and where light subpaths start. tyndall info --pilot shows the candidates. Images of fewer than 25,000 samples,
    /// over all pixels, have no pilot: all strategies but equiangular take equal numbers of samples. So do strategies that
    /// are named here; nothing is learnt for them unless --starts or --guide asks for it.
    ///
    /// hit: the camera subpath hits an emitter; next-event: it connects to a point sampled on an emitter; join: one of its
    /// vertices connects to one of a light subpath, or to a lamp by way of a smooth shape; lens: a light subpath connects to the lens; equiangular: a point of the
    /// primary ray in a medium, sampled near an emitter, connects to that emitter.
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1, value_parser = one_of(&StrategyKind::NAMES))]
    pub strategies: Vec<StrategyKind>,

    /// Heuristic of multiple importance sampling: balance, power, maximum, cutoff (or cutoff:ALPHA, ALPHA is 0.1
    /// by default; needs a --max-depth of at most 32) or uniform [default: the scene's, or balance]
    ///
    /// The expected image is the same; the noise differs. All heuristics except balance use the profile "everything".
    #[arg(long, value_name = "NAME", value_parser = heuristic, help_heading = heading::STUDIES)]
    pub heuristic: Option<Heuristic>,

    /// Light vertices that each camera vertex connects to (the strategy join) [default: the scene's, or cached]
    ///
    /// cached: some of those that the light subpaths of many pixels left; all: every vertex of the sample's own light subpath,
    /// as in Lafortune and Willems (1996). The expected image is the same. With all there is no pilot: each strategy takes
    /// one sample.
    #[arg(long, value_name = "NAME", value_parser = one_of(&Connections::NAMES), help_heading = heading::STUDIES)]
    pub connections: Option<Connections>,

    /// Where light subpaths start [default: a pilot decides; emitted with --strategies]
    ///
    /// emitted: as emitters emit; aimed: a part of them sets out for glass, mirrors and bodies of fog, which light from far away
    /// hardly meets by chance; learnt: where about a second of training found that light reaches the image, such as through
    /// a small opening. Next-event estimation then aims at the sky through the same openings. No pilot chooses this for
    /// --integrator pt. The expected image is the same.
    #[arg(long, value_name = "NAME", value_parser = one_of(&LightStarts::NAMES), help_heading = heading::STUDIES)]
    pub starts: Option<LightStarts>,

    /// Which strategies find the light of the sky, in scenes that have other emitters too
    /// [default: a pilot decides; next-event with --strategies]
    ///
    /// next-event: camera subpaths hit it, and the strategy next-event connects to it; hit: they hit it, and next-event is left to
    /// the other emitters. The expected image is the same. White clouds under sun and sky have less noise with hit.
    #[arg(long, value_name = "NAME", value_parser = one_of(&Sky::NAMES), help_heading = heading::STUDIES)]
    pub sky: Option<Sky>,

    /// When path guiding is used: walks sample directions that training found to bring light
    /// [default: the scene's, or auto with gather and with the pilot of bdpt, else never]
    ///
    /// auto: where it pays. It does where light comes through a small opening, such as a keyhole, and for pt where light comes
    /// round corners. For bdpt, a pilot that follows a guide is held against one that does not; else the first quarter of the
    /// training decides. Both are tried only in noisy scenes, and only for images of two million samples or more over all
    /// pixels, in very noisy ones of 250,000. always: in any case. Training takes about a second before the first sample. It
    /// goes on during long renders, except with --error. The expected image is the same. Needs the heuristic balance.
    #[arg(long, value_name = "WHEN", value_parser = one_of(&Guiding::NAMES))]
    pub guide: Option<Guiding>,

    /// How a guide stores directions, for comparison [default: the scene's, or quadtree]
    ///
    /// quadtree: finer where much light comes from; bins: 16 x 16 everywhere; haar: by wavelets; links: the elements of a first pass that
    /// light comes from (P03T sec. 5.2.3), for pt. The expected image is the same.
    #[arg(long, value_name = "NAME", value_parser = one_of(&Basis::NAMES), help_heading = heading::STUDIES)]
    pub basis: Option<Basis>,

    /// How the first pass of the integrators first-pass and gather is solved [default: the scene's, else walks for gather, particles
    /// for first-pass]
    ///
    /// walks: walks from the camera find the radiance of cells where they come; particles: particles go from element to element, and
    /// pass mirrors and glass (P03T sec. 4.3); links: links join elements and clusters, most of them where most light goes (P03T
    /// sec. 4.2). They see no mirrors.
    #[arg(long, value_name = "NAME", value_parser = one_of(&FirstPass::NAMES))]
    pub first_pass: Option<FirstPass>,

    /// With the integrator first-pass, show each element in one colour, not interpolated
    #[arg(long)]
    pub flat: bool,

    /// Maximum number of segments of a path, as Mitsuba's max_depth: 1 shows emitters only, -1 means no limit
    /// [default: the scene's]
    #[arg(long, value_name = "N", value_parser = max_depth, allow_negative_numbers = true)]
    pub max_depth: Option<MaxDepth>,

    /// Minimum number of segments of a path; shorter paths do not count: 2 leaves out emitters in direct view
    /// [default: the scene's]
    ///
    /// With --max-depth of the same number, the image shows the light of paths of exactly that length.
    #[arg(long, value_name = "N", value_parser = min_depth, allow_negative_numbers = true)]
    pub min_depth: Option<u32>,

    /// Source of random numbers for the samples of a pixel and for light subpaths [default: sobol, but independent where
    /// the scene asks for layers of variances]
    ///
    /// independent: independent random numbers; sobol: the first dimensions of every subpath are points of
    /// Owen-scrambled Sobol sequences, one for the even and one for the odd samples, whose difference shows the noise.
    /// Variances of single pixels, which layers and --error are about, are estimated as if samples were
    /// independent: with sobol they are upper bounds.
    #[arg(long, value_name = "NAME", value_parser = one_of(&Sampler::NAMES))]
    pub sampler: Option<Sampler>,

    /// Which camera samples a pixel takes [default: shared; own with --error, --progressive, layers of moments or variances;
    /// apart with --denoise, and with the layers first_albedo and first_normal, which denoisers need]
    ///
    /// shared: all that its filter reaches, also those of the pixels around it; own: its own, distributed by its filter
    /// (filter importance sampling); apart: its own, and what a light subpath contributes to the image goes to one pixel
    /// in place of all whose filter reaches it. The expected image is the same. Under the default filter, shared samples
    /// leave a third of the variance. They make the noise of neighbouring pixels alike, which denoisers do not expect:
    /// with apart it is independent. No pixels share samples with a filter that ends within the pixel (box), with a film
    /// that is sampled beyond its border, and with --crop.
    #[arg(long, value_name = "NAME", value_parser = one_of(&FilmSamples::NAMES))]
    pub film_samples: Option<FilmSamples>,

    /// Continue every primary ray that crosses media twice: from a forced collision in the media and from the
    /// surface behind them [default: the scene's forced_interaction]
    ///
    /// Reduces noise in thin media, where few rays collide by chance; the expected image is the same.
    #[arg(long, overrides_with = "no_forced_interaction")]
    pub forced_interaction: bool,

    /// Do not force collisions of primary rays, overriding the scene
    #[arg(long, overrides_with = "forced_interaction")]
    pub no_forced_interaction: bool,

    /// Show what is behind emitters in place of the emitters that the camera sees; emissive media stay [default: the scene's
    /// hide_emitters]
    #[arg(long, overrides_with = "no_hide_emitters")]
    pub hide_emitters: bool,

    /// Show emitters to the camera, overriding the scene
    #[arg(long, overrides_with = "hide_emitters")]
    pub no_hide_emitters: bool,

    /// Render smooth glass and metal as slightly rough, by this alpha of Beckmann's microfacets, from 0.0001 to 0.5
    ///
    /// Some light is sampled by no strategy where surfaces are smooth: it goes from a lamp without extent by way of glass to a
    /// place, and from there by way of glass to the camera. With this option it reaches the image. The image is biased: what is
    /// seen by way of glass is blurred by about alpha radians, and so are caustics. A study shows how much
    /// (--contender "soft: --soften 0.01"). The surfaces thindielectric and plastic stay as they are.
    #[arg(long, value_name = "ALPHA", value_parser = soften, allow_negative_numbers = true)]
    pub soften: Option<f64>,

    /// Specialisation of the compiled code; the expected image is the same, only the time differs
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Profile::Fitted, help_heading = heading::STUDIES)]
    pub profile: Profile,
}

/// Specialisation of the rendering code.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub enum Profile {
    /// Without the features that the scene does not use (media, colour, ...)
    Fitted,
    /// General code with every feature, for comparison
    Everything,
}

fn soften(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|alpha| (1e-4..=0.5).contains(alpha));
    number.ok_or_else(|| "expected a roughness from 0.0001 to 0.5, such as 0.01".to_owned())
}

fn heuristic(text: &str) -> Result<Heuristic, String> {
    Heuristic::parse(text).map_err(|expected| format!("expected {expected}"))
}
