//! `tyndall guide`: what is learnt of a scene that is rendered with a guide.

use super::{
    console::{Answer, say},
    estimator::Estimator,
    outputs,
    parsers::{Size, size, threads},
    scene::{self, Scene, load},
};
use crate::{
    analysis::guide::{self, Cells, FILES, Portal, Report},
    error::{Error, Result},
    passes::budget::Budget,
    transport::{self, LightStarts},
};
use clap::Args;
use std::{num::NonZeroUsize, path::PathBuf};

/// Show what a guide learns.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Folder to write to, created if missing [default: the name of the scene followed by -guide, in the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// What the samples of this number follow, counted from 0 for each pixel: the more come before it, the more is learnt
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub sample: u32,

    /// Threads to learn with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// How paths are sampled.
    #[command(flatten)]
    pub estimator: Estimator,

    /// How the numbers are given.
    #[command(flatten)]
    pub answer: Answer,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let setup = load(&arguments.scene, arguments.estimator.overrides(arguments.size))?;
    arguments.answer.check()?;
    let mut settings = arguments.estimator.guided_settings(&setup, Budget::ENDLESS)?;
    let algorithm = settings.options.algorithm;
    if algorithm.is_preview() {
        let remedy = "choose --integrator bdpt, pt or lt";
        return Err(Error::new("--integrator", "an integrator that is no preview", algorithm.name(), remedy));
    }
    let transport::Options { strategies, effort, .. } = &mut settings.options;
    // As renders learn them.
    let usual = || if strategies.need_light_walks() { LightStarts::Learnt } else { LightStarts::Emitted };
    let starts = arguments.estimator.starts.unwrap_or_else(usual);
    let is_aimed = starts == LightStarts::Aimed && !strategies.need_light_walks();
    let applies = strategies.use_starts(&setup.scene, effort.sky) && !is_aimed;
    effort.starts = if applies { starts } else { LightStarts::Emitted };
    let folder = outputs::folder(arguments.output.as_ref(), &arguments.scene, "guide")?;
    outputs::check_short(&FILES.map(|name| folder.join(name)))?;
    let findings = scene::threads(arguments.threads)?
        .install(|| guide::examine(&setup, &settings, arguments.sample as usize));
    let files = findings.write(&folder)?;
    say(&described(&findings.report));
    say(&outputs::listed(&folder, &files));
    arguments.answer.give(&serde_json::json!(findings.report))
}

/// A few lines.
fn described(report: &Report) -> String {
    let Report { seconds, bytes, surfaces, media, second_moment, portals, starts, .. } = report;
    let kind = |name: &str, Cells { cells, guided: [camera, light] }: &Cells| {
        let [camera, light] = [camera, light].map(|part| format!("{:.0} %", 100.0 * part));
        format!(
            "{name:10} {cells} cells; of the directions, {camera} of the camera's walks and {light} of light's are guided"
        )
    };
    let place = |Portal { centre: [x, y, z], radius }: &Portal| {
        format!("of radius {radius:.3} around {x:.3}, {y:.3}, {z:.3}")
    };
    let portal = |portal: &Portal| format!("portal     {}", place(portal));
    let aimed = starts.iter().flat_map(|start| {
        let light = start.emitter;
        start.portals.iter().map(move |portal| {
            format!("starts     light of emitter {light} aims at a portal {}", place(portal))
        })
    });
    let lines = match surfaces.cells + media.cells {
        0 => vec![format!("learnt in {seconds:.1} s: nothing that walks could follow")],
        _ => vec![
            format!("learnt     in {seconds:.1} s, {:.1} MiB", *bytes as f64 / f64::from(1 << 20)),
            kind("surfaces", surfaces),
            kind("media", media),
            format!("moments    {second_moment:.2} of the second moment of what walks bring is left"),
        ],
    };
    lines.into_iter().chain(portals.iter().map(portal)).chain(aimed).collect::<Vec<_>>().join("\n")
}
