//! `tyndall info`: what a scene holds, and how it would be rendered.

use super::{
    candidates,
    console::{Answer, say},
    estimator::Estimator,
    fit::Fit,
    overview::{Overview, brief},
    parsers::positive_u32,
    picture,
    plan::{self, Plan},
    scene::{self, load},
    volumes,
};
use crate::{
    emitter::Kind,
    error::Result,
    film::{
        Film, Window,
        filter::Filter,
        format::{Component, FileKind},
        layer::Layer,
    },
    inputs::{self, Reader},
    learning::training,
    medium::{DistanceMethod, Heterogeneous, MediumIndex, distance::DistanceSampler},
    passes::{Settings, budget::Budget},
    phase::PhaseModel,
    scene::{
        Scene,
        build::Setup,
        contact::Contact,
        lights::{Light, Lights},
        media::{Infinity, MediaMap},
    },
    settings::integrator::Restriction,
    shape::ShapeModel,
    transport::{Algorithm, Options},
    volume::grid::is_volume,
};
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Print a summary of a scene.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Info {
    /// Which scene.
    #[command(flatten)]
    pub scene: scene::Scene,

    /// How paths would be sampled.
    #[command(flatten)]
    pub estimator: Estimator,

    /// Also show what the pilot foretells of all that it could choose: error, time, and why the winner won
    #[arg(long)]
    pub pilot: bool,

    /// Samples per pixel of the render that the pilot chooses for [default: the scene's sample_count]
    #[arg(long, value_name = "N", value_parser = positive_u32, allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// How the summary is given.
    #[command(flatten)]
    pub answer: Answer,
}

/// Runs the command.
pub(super) fn run(arguments: &Info) -> Result<()> {
    inputs::note(&arguments.scene.file, Reader::Command);
    arguments.answer.check()?;
    if let Some(made) = picture::made(&arguments.scene.file)? {
        return picture::show(&made, &arguments.answer);
    }
    if is_volume(&arguments.scene.file) {
        return volumes::run(&arguments.scene.file, &arguments.answer);
    }
    let mut setup = load(&arguments.scene, arguments.estimator.overrides(None))?;
    setup.samples_per_pixel = arguments.spp.map_or(setup.samples_per_pixel, u64::from);
    arguments.answer.check()?;
    let budget = Budget::samples(setup.samples_per_pixel);
    let (settings, report) = arguments.estimator.reported(&setup, 0, budget)?;
    let chosen = report.as_ref().map(|report| report.choice);
    let plan = Plan::new(&setup, settings, chosen, None);
    let learnt = training::learn_for(&setup.scene, &setup.film, &settings).bytes();
    let overview = Overview::of(&setup);
    let fit = Fit::of(&setup, &settings);
    say(&describe(&setup, &settings, &plan, &overview, &fit));
    if learnt > 0 {
        let later = if settings.options.effort.is_guided() {
            ", and more for later samples or small errors"
        } else {
            ""
        };
        say(&format!(
            "learnt      {:.1} MiB, before the image is begun{}",
            learnt as f64 / f64::from(1 << 20),
            later
        ));
    }
    let mut figures = figures(&setup, &plan, learnt, overview.json());
    figures["profile"] = fit.json();
    if let Some(report) = report.filter(|_| arguments.pilot) {
        say(&candidates::table(&report));
        figures["pilot"] = candidates::json(&report);
    }
    arguments.answer.give(&figures)
}

fn describe(setup: &Setup, settings: &Settings, plan: &Plan, overview: &Overview, fit: &Fit) -> String {
    let Setup { scene, film, integrator, samples_per_pixel, .. } = setup;
    let estimator = describe_integrator(plan.integrator, &settings.options, integrator.restriction);
    let mut lines = overview.lines();
    let image = lines.len();
    lines.extend([
        format!("image       {}", describe_film(film)),
        format!("integrator  {estimator}, {samples_per_pixel} samples/pixel"),
        format!("shapes      {}", describe_shapes(scene)),
    ]);
    if !integrator.layers.is_empty() {
        lines.insert(image + 2, format!("layers      {}", describe_layers(&integrator.layers)));
    }
    lines.extend(
        scene.lights.all.iter().map(|light| format!("emitter     {}", describe_emitter(setup, light))),
    );
    lines.extend(setup.smoke.iter().map(|taken| format!("smoke       {taken}")));
    if scene.lights.has_infinite() {
        lines.push(format!("infinity    {}", describe_infinity(setup)));
    }
    lines
        .extend((1..=setup.medium_names.len()).map(|i| format!("medium      {}", describe_medium(setup, i))));
    lines.extend(describe_contacts(setup));
    lines.extend(overlapping(setup).map(|names| format!("overlap     {names}: coefficients add")));
    lines.push(format!("profile     {fit}"));
    lines.push(format!("plan        {}", plan.line()));
    lines.extend(plan.unreached());
    lines.join("\n")
}

/// The same for scripts.
fn figures(setup: &Setup, plan: &Plan, learnt: usize, overview: Value) -> Value {
    let Setup { scene, film, .. } = setup;
    let primitives: usize = scene.geometry.shapes().iter().map(|shape| shape.primitive_count()).sum();
    let emitters = scene.lights.all.iter();
    json!({
        "width": film.width,
        "height": film.height,
        "channels": film.format.names().concat(),
        "layers": setup.integrator.layers.iter().map(|layer| &layer.name).collect::<Vec<_>>(),
        "samples_per_pixel": setup.samples_per_pixel,
        "shapes": scene.surfaces.len(),
        "primitives": primitives,
        "emitters": emitters
            .map(|light| {
                let group = Lights::group_of(light);
                json!({ "type": light.emitter.name, "medium": setup.medium_name(light.medium), "group": group })
            })
            .collect::<Vec<_>>(),
        "smoke": setup.smoke.iter().map(volumes::taken).collect::<Vec<_>>(),
        "box": overview["box"],
        "camera": overview["camera"],
        "thickness": overview["thickness"],
        "media": (1..=setup.medium_names.len()).map(|index| medium_figures(setup, index)).collect::<Vec<_>>(),
        "contacts": setup.apart.contacts.iter().map(|contact| contact_figures(setup, contact)).collect::<Vec<_>>(),
        "overlaps": overlapping(setup).collect::<Vec<_>>(),
        "plan": plan.json(),
        "learnt_bytes": learnt,
        "warnings": setup.warnings,
    })
}

fn contact_figures(setup: &Setup, contact: &Contact) -> Value {
    let [moved, other] = contact.shapes.map(|shape| setup.shape_names[shape as usize].as_str());
    json!({ "moved": moved, "from": other, "by": contact.by })
}

/// Shapes that touch, and how far the first was moved away from the other. Of very many, some.
fn describe_contacts(setup: &Setup) -> Vec<String> {
    const MOST: usize = 8;
    let contacts = &setup.apart.contacts;
    let describe = |contact: &Contact| {
        let [moved, other] = contact.shapes.map(|shape| setup.shape_names[shape as usize].as_str());
        format!("contact     {moved} touches {other}; its faces there are moved by {:.1e} m", contact.by)
    };
    let mut lines: Vec<String> = contacts.iter().take(MOST).map(describe).collect();
    if contacts.len() > MOST {
        lines.push(format!("contact     and {} more pairs of shapes", contacts.len() - MOST));
    }
    lines
}

/// The names of media that may lie in one place.
fn overlapping(setup: &Setup) -> impl Iterator<Item = String> {
    let regions = setup.scene.media_map.overlaps.iter().flat_map(|overlaps| overlaps.regions());
    let several: BTreeSet<_> =
        regions.filter(|members| members.len() > 1).map(|members| setup.names(members)).collect();
    several.into_iter()
}

fn medium_figures(setup: &Setup, index: usize) -> Value {
    let medium = &setup.scene.media[index];
    json!({
        "name": setup.medium_name(MediumIndex(index as u32)),
        "heterogeneous": medium.heterogeneous().is_some(),
        "largest_sigma_t": medium.bound().sigma_t.to_array(),
        "largest_albedo": medium.bound().albedo.to_array(),
        "mean_cosine": medium.phase.mean_cosine(),
        "free_flights": plan::flight(medium).name(),
    })
}

fn describe_film(film: &Film) -> String {
    let Window { full_size: [width, height], offset: [x, y], .. } = film.window;
    let part = if film.window.is_whole() {
        String::new()
    } else {
        format!(" (the window at {x}, {y} of {width} x {height})")
    };
    let border = if film.border != [[0; 2]; 2] { ", sampled beyond its border" } else { "" };
    let format = film.format;
    let numbers = match (format.file, format.component) {
        (FileKind::Rgbe, _) => "a common exponent",
        (_, Component::Float16) => "float16",
        (_, Component::Float32) => "float32",
        (_, Component::Uint32) => "uint32",
    };
    format!(
        "{} x {}{part}, {}{border}, {} as {numbers} in .{}",
        film.width,
        film.height,
        describe_filter(film.filter),
        format.names().concat(),
        format.file.extension()
    )
}

fn describe_filter(filter: Filter) -> String {
    match filter {
        Filter::Box => "box filter".to_owned(),
        Filter::Tent { radius } => format!("tent filter (radius {radius})"),
        Filter::Gaussian { stddev } => format!("Gaussian filter (stddev {stddev})"),
        Filter::Cubic { b: 0.0, c: 0.5 } => "Catmull-Rom filter".to_owned(),
        Filter::Cubic { b, c } => format!("Mitchell-Netravali filter (B {b}, C {c})"),
        Filter::Lanczos { lobes } => format!("Lanczos filter ({lobes} lobes)"),
    }
}

/// Every layer with the ends of its channels' names.
fn describe_layers(layers: &[Layer]) -> String {
    let described = layers.iter().map(|layer| format!("{} ({})", layer.name, layer.suffixes().concat()));
    described.collect::<Vec<_>>().join(", ")
}

fn describe_integrator(name: &str, options: &Options, restriction: Restriction) -> String {
    let Options { algorithm, heuristic, max_depth, min_depth, .. } = *options;
    match algorithm {
        Algorithm::Fog => return "fog, a preview of first surfaces".to_owned(),
        Algorithm::FirstPass => {
            return format!(
                "first-pass, a preview: the first pass by {}",
                options.first_pass.by(options.algorithm).name()
            );
        }
        Algorithm::Gather => {
            return format!(
                "gather, a preview by paths that end in a first pass by {}",
                options.first_pass.by(options.algorithm).name()
            );
        }
        _ => {}
    }
    let media = match restriction {
        Restriction::None => "",
        Restriction::SingleScattering { .. } => ", single scattering",
        Restriction::NonScattering => ", media absorb and emit only",
    };
    let length = match (min_depth, max_depth) {
        (0 | 1, Some(most)) => format!("at most {most} segments"),
        (0 | 1, None) => "any length".to_owned(),
        (least, Some(most)) if least == most => format!("{most} segments"),
        (least, Some(most)) => format!("{least} to {most} segments"),
        (least, None) => format!("{least} segments or more"),
    };
    format!("{name}, paths of {length}{media}, weighted by the {heuristic} heuristic")
}

fn describe_shapes(scene: &Scene) -> String {
    let primitives: usize = scene.geometry.shapes().iter().map(|shape| shape.primitive_count()).sum();
    let others = scene.surfaces.iter().filter(|surface| surface.boundary.is_known()).count();
    let boundaries = others + scene.media_map.overlaps.as_ref().map_or(0, |overlaps| overlaps.len());
    format!(
        "{} ({primitives} primitives), {boundaries} of them are boundaries of media",
        scene.surfaces.len()
    )
}

fn describe_infinity(setup: &Setup) -> String {
    let MediaMap { known, outside, .. } = &setup.scene.media_map;
    let name = setup.medium_name(*outside);
    match known.infinity {
        Infinity::Uniform(_) | Infinity::Unseen(_) => format!("in {name}"),
        Infinity::Directional(_) => format!("in {name} and, in other directions, in other media"),
    }
}

fn describe_emitter(setup: &Setup, light: &Light) -> String {
    let (name, medium) = (light.emitter.name, setup.medium_name(light.medium));
    let group = light.emitter.group.as_ref().map_or(String::new(), |group| format!(", group {group}"));
    let Kind::Medium(glow) = &light.emitter.kind else { return format!("{name} in {medium}{group}") };
    let [low, high] = glow.emission.bounds().map(|corner| corner.as_dvec3() + setup.scene.recentre);
    let [r, g, b] = glow.power().to_array().map(brief);
    format!("{name} {medium} itself, {r} {g} {b} W, from {low:.3} to {high:.3}{group}")
}

fn describe_medium(setup: &Setup, index: usize) -> String {
    let medium = &setup.scene.media[index];
    let [r, g, b] = medium.bound().sigma_t.to_array();
    let [ar, ag, ab] = medium.bound().albedo.to_array();
    let (kind, most) =
        if medium.heterogeneous().is_some() { ("heterogeneous", "at most ") } else { ("homogeneous", "") };
    format!(
        "{}: {kind}, sigma_t {most}{r} {g} {b} /m, albedo {most}{ar} {ag} {ab}, mean cosine {}{:.3}; {}",
        setup.medium_name(MediumIndex(index as u32)),
        if medium.phase.varies() { "about " } else { "" },
        medium.phase.mean_cosine(),
        medium
            .heterogeneous()
            .map_or("closed-form tracker".into(), |varying| describe_tracker(setup, varying))
    )
}

/// Which tracker a medium has, and who wanted it.
fn describe_tracker(setup: &Setup, varying: &Heterogeneous) -> String {
    let tracker = varying.tracker();
    let march = match tracker {
        DistanceSampler::RayMarching(march) => format!(" by steps of at most {} m", march.step),
        _ => String::new(),
    };
    let restricted = setup.integrator.restriction.medium_overrides().tracker;
    let why = match (varying.forced(), varying.requested()) {
        (Some(DistanceMethod::Auto), _) | (None, DistanceMethod::Auto) => "chosen by cost",
        (Some(forced), _) if restricted == Some(forced) => "set by the integrator",
        (Some(_), _) if march.is_empty() => "forced by --tracker",
        (Some(_), _) => "forced by the command line",
        (None, requested) if requested == tracker.choice() => "set by the scene",
        (None, _) => "chosen by cost",
    };
    format!("tracker {}{march}, {why}", tracker.choice().name())
}
