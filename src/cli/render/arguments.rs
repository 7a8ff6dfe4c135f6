//! The arguments of `tyndall render`.

use super::{
    super::{
        console::Answer,
        display::Display,
        estimator::Estimator,
        heading,
        parsers::{
            Frames, Samples, Size, VIEWER, address, batches, confidence, crop, duration, fps, frames,
            image_file, positive_u32, relative_error, samples, seed, size, threads,
        },
        scene::Scene,
    },
    preview::Preview,
    progressive::Progressive,
};
use crate::{
    render::progressive,
    settings::{Crop, Overrides},
};
use clap::Args;
use std::{num::NonZeroUsize, path::PathBuf, time::Duration};

/// Render a scene to an image.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Render {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Image to write: linear OpenEXR (.exr), float map (.pfm) or Radiance (.rgbe, .hdr); a tone-mapped PNG
    /// (.png) is written next to it
    ///
    /// Its folder is made if there is none. Default: the name of the scene, in the current folder, in the file format of its film.
    #[arg(short, long, value_name = "FILE", value_parser = image_file, help_heading = heading::OUTPUT)]
    pub output: Option<PathBuf>,

    /// Where the statistics of the render go: time, samples, noise, how paths were sampled.
    #[command(flatten, next_help_heading = heading::OUTPUT)]
    pub answer: Answer,

    /// Also print how paths are sampled: strategies, the pilot's choice, the sampler, trackers; `tyndall info` prints more
    #[arg(short, long, help_heading = heading::OUTPUT)]
    pub verbose: bool,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, alias = "resolution", value_name = "WxH", value_parser = size, allow_hyphen_values = true, help_heading = heading::OUTPUT)]
    pub size: Option<Size>,

    /// Render only the part of the image of WIDTHxHEIGHT pixels whose top left corner is at pixel X, Y
    ///
    /// With --sums it is a part for tyndall merge, which puts together parts that cover the image; an image of the part is
    /// written only if -o is given. Every part traces light subpaths of its own, as many as it has pixels: what they
    /// contribute by the strategy lens is noisier than in a render of the whole image, so prefer --samples to cut a render
    /// without --error. --error is relative to the mean luminance of the part.
    #[arg(long, value_name = "WIDTHxHEIGHT+X+Y", value_parser = crop, allow_hyphen_values = true, help_heading = heading::OUTPUT)]
    pub crop: Option<Crop>,

    /// Render frames A to B of an animation, both included, or the single frame A; frame k shows the scene at the
    /// time of the scene + k / FPS
    ///
    /// Volumes inside a "wind" move; the scene is loaded once. The frame number is added to the file name with at
    /// least four digits: fog.0007.exr and fog.0007.png. --spp and --time-limit apply to each frame. The random
    /// numbers of a frame depend on --seed and its number only: a frame rendered alone is the same image.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true, help_heading = heading::OUTPUT)]
    pub frames: Option<Frames>,

    /// Frames per second [default: 24]
    #[arg(long, value_name = "FPS", value_parser = fps, requires = "frames", allow_negative_numbers = true, help_heading = heading::OUTPUT)]
    pub fps: Option<f64>,

    /// Also write what each group of emitters contributes, as layers of the EXR (group.NAME.R, ...)
    ///
    /// The parameter "group" of emitters and emissive media names their group; those that name none are the group rest. The
    /// layers add up to the image, and an image of lights that are weaker, stronger or of another colour is a sum of layers
    /// times factors.
    #[arg(long, help_heading = heading::OUTPUT)]
    pub groups: bool,

    /// Also write unscattered, emitted and scattered light (Premoze 2003, eq. 17), as layers of the EXR
    ///
    /// Unscattered light comes from what is behind the media (unscattered.R, ...). Emitted light comes from the media
    /// between the camera and the first surface (emitted.R, ...). Scattered light is scattered there; media scattered it once
    /// on its whole way (scattered.single.R, ...) or more often (scattered.multiple.R, ...).
    /// The layers add up to the image. With --groups, those of each group are written (group.NAME.unscattered.R, ...).
    #[arg(long, help_heading = heading::OUTPUT)]
    pub components: bool,

    /// Also write the image denoised (NAME.denoised.exr and .png), by Open Image Denoise, which the Python package brings
    ///
    /// The image gets layers of albedo and normals, by which edges stay sharp. See tyndall denoise.
    #[arg(long, help_heading = heading::OUTPUT)]
    pub denoise: bool,

    /// Write the image so far, and its PNG, every five seconds
    #[arg(long, help_heading = heading::OUTPUT)]
    pub preview: bool,

    /// Show the image so far in the viewer tev
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = VIEWER, value_parser = address, help_heading = heading::OUTPUT)]
    pub tev: Option<String>,

    /// Samples per pixel [default: the scene's sample_count]
    ///
    /// With --time-limit and without --spp: as many as the time allows.
    #[arg(long, alias = "samples-per-pixel", value_name = "N", value_parser = positive_u32, allow_negative_numbers = true, help_heading = heading::BUDGET)]
    pub spp: Option<u32>,

    /// Stop after this time: a number with the unit s, m or h (90, 90s, 5m, 1.5h; seconds without a unit)
    /// [default: no limit]
    ///
    /// The samples completed by then are written. The limit includes the pilot and training; before the first sample these
    /// take at most half of it. The first pass of gather and first-pass is always made whole, however long it takes. With
    /// --spp as well, the render stops at whichever limit is reached first. Alpha and the layers of an aov integrator are
    /// rendered afterwards, within a tenth of a second or one pass over the image.
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true, help_heading = heading::BUDGET)]
    pub time_limit: Option<Duration>,

    /// Sample every pixel until its relative error is below this value, such as 0.02
    ///
    /// The error is estimated from the samples of each pixel, in every channel, and holds for each pixel with the
    /// probability --confidence. It is relative to the pixel's value plus 1 % of the image's mean luminance, as in the
    /// MAPE of tyndall diff. Noisier pixels get more samples, pixels that are still black as many as the noisiest; the
    /// image stays unbiased. With --spp or --time-limit as well, the render stops at whichever limit is reached first;
    /// without them there is no other limit. In EXR files the channel samples.N is the number of samples of each
    /// pixel.
    #[arg(long, value_name = "E", value_parser = relative_error, allow_negative_numbers = true, help_heading = heading::BUDGET)]
    pub error: Option<f64>,

    /// Probability that a pixel is within --error [default: 0.95]
    #[arg(long, value_name = "C", value_parser = confidence, requires = "error", allow_negative_numbers = true, help_heading = heading::BUDGET)]
    pub confidence: Option<f64>,

    /// Which pixels are shaded.
    #[command(flatten, next_help_heading = heading::BUDGET)]
    pub pixels: Progressive,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true, help_heading = heading::BUDGET)]
    pub threads: Option<NonZeroUsize>,

    /// Continue from the checkpoint of an interrupted render, or, with --sums in both commands, add samples to a finished one
    ///
    /// The image is the same, bit for bit, as if the render had never stopped. --spp is the total; if it differs from before,
    /// the pilot may choose other strategies for the samples that follow, unless --strategies names them. Scene, files and
    /// options that decide about the image must be the same. Without a checkpoint, the render starts from the beginning.
    #[arg(long, overrides_with = "resume", conflicts_with_all = ["batches", "frames"], help_heading = heading::SHARE)]
    pub resume: bool,

    /// Checkpoint: the sums of all samples, from which --resume continues and tyndall merge makes one image
    /// [default: the image's name and .sums, such as fog.exr.sums, once the render has taken a minute]
    ///
    /// It is written at the end and every minute (--sums-every), or less often if writing would take more than 1 % of the
    /// time. A file that is named here stays. The default one is removed once the image has all the samples, or the error,
    /// that were asked for. The format is safetensors.
    #[arg(long, visible_alias = "checkpoint", value_name = "FILE", conflicts_with_all = ["batches", "frames"], help_heading = heading::SHARE)]
    pub sums: Option<PathBuf>,

    /// Shortest time between two checkpoints [default: 1m]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true, help_heading = heading::SHARE)]
    pub sums_every: Option<Duration>,

    /// Render only the samples A to B - 1 of every pixel, for tyndall merge
    ///
    /// Parts with other samples of the same scene, options and seed, rendered anywhere, add up to exactly the image of
    /// --samples 0..N. That of --spp N may be another one: its pilot knows how few samples it prepares, and parts must all
    /// make the same choice. An image is written only if -o is given. Renders with --error are cut by --crop instead.
    #[arg(long, value_name = "A..B", value_parser = samples, requires = "sums", allow_hyphen_values = true,
        conflicts_with_all = ["spp", "error", "batches", "frames"], help_heading = heading::SHARE)]
    pub samples: Option<Samples>,

    /// How its PNG shows it.
    #[command(flatten, next_help_heading = heading::LOOK)]
    pub display: Display,

    /// How the preview looks.
    #[command(flatten, next_help_heading = heading::LOOK)]
    pub fog: Preview,

    /// How paths are sampled.
    #[command(flatten, next_help_heading = heading::METHOD)]
    pub estimator: Estimator,

    /// Seed of all random numbers; the same seed gives the same image
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0, allow_negative_numbers = true, help_heading = heading::STUDIES)]
    pub seed: u64,

    /// Render N images with the seeds --seed, --seed + 1, ... and write their mean
    ///
    /// The EXR also holds the standard error of the mean (standard_error.R, ...) and every image (batch.0.R,
    /// batch.1.R, ...), for uses that need independent images. --spp and --time-limit apply to each image; the
    /// scene is loaded once.
    #[arg(long, value_name = "N", value_parser = batches, conflicts_with = "error", allow_negative_numbers = true, help_heading = heading::STUDIES)]
    pub batches: Option<u32>,
}

/// The part of the pixels that a progressive picture shades, unless the user wants another.
const FRACTION: f64 = 0.1;

impl Render {
    /// The progressive picture that is wanted, if one is.
    pub fn progressive(&self) -> Option<progressive::Progressive> {
        let all = if self.time_limit.is_some() { 1.0 } else { FRACTION };
        let fraction = self.pixels.fraction.unwrap_or(all);
        self.pixels.progressive.map(|method| progressive::Progressive { method, fraction })
    }

    /// What the options override in the scene.
    pub fn overrides(&self) -> Overrides {
        let Self { crop, groups, components, .. } = *self;
        let fog = self.fog.settings();
        let strict = self.scene.strict;
        Overrides { crop, groups, components, fog, strict, ..self.estimator.overrides(self.size) }
    }

    /// Seed of the random numbers: of parts of an image, no two share one, or the noise of one would be repeated in others.
    pub fn seed_of_part(&self) -> u64 {
        let Some(Crop { corner: [x, y], .. }) = self.crop else { return self.seed };
        let corner = u64::from(y) << 32 | u64::from(x);
        self.seed ^ corner.wrapping_add(1).wrapping_mul(0xd1b5_4a32_d192_ed03)
    }

    /// True if no image is to be written but sums, for tyndall merge.
    pub fn is_part(&self) -> bool {
        let is_cut = self.samples.is_some() || self.crop.is_some();
        is_cut && self.sums.is_some() && self.output.is_none()
    }
}
