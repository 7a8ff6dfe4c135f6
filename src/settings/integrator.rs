//! The integrator of a scene. All are one estimator with strategies left out; `aov` and `moment` hold another
//! one and request more channels. `fog` is a preview that makes no paths; `single_scattering` and
//! `non_scattering` restrict what media do.

use crate::{
    description::{
        Build, Library, Location, Object, Params, Plugin, Property, Registry, Table, Value,
        parameter::Parameter, params::Child, rows, suggest, table,
    },
    error::{Error, Result},
    film::layer::{Content, Layer, QUANTITIES},
    math::Spectrum,
    medium::{DistanceMethod, MediumOverrides},
    settings::{
        Overrides,
        heuristic::HEURISTIC,
        options::{
            Algorithm, CONNECTIONS, Connections, FIRST_PASS, FORCED, FirstPass, GUIDE, MAX_DEPTH, MIN_DEPTH,
            Options, PATHS,
        },
    },
};

/// What light does in media.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Restriction {
    /// All that the media say.
    #[default]
    None,
    /// It is scattered once at most, in media that vary found by ray marching (P03 eq. 18-19).
    SingleScattering {
        /// The longest interval (m), in place of the media's own.
        step: Option<f64>,
        /// The error of transmittance, in place of the media's own steps and errors.
        march_error: Option<f64>,
    },
    /// It is absorbed and emitted (P03T eq. 2.9).
    NonScattering,
}

impl Restriction {
    /// Most segments of a path that single scattering has.
    pub const SINGLE: u32 = 2;

    /// Each as typed: how often media scatter light.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("multiple", Self::None),
        ("single", Self::SingleScattering { step: None, march_error: None }),
        ("none", Self::NonScattering),
    ];

    /// As typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "multiple",
            Self::SingleScattering { .. } => "single",
            Self::NonScattering => "none",
        }
    }

    /// Its overrides of all media.
    pub fn medium_overrides(&self) -> MediumOverrides {
        match *self {
            Self::None => MediumOverrides::default(),
            Self::SingleScattering { step, march_error } => MediumOverrides {
                tracker: Some(DistanceMethod::RayMarching),
                step,
                march_error,
                absorbing: false,
            },
            Self::NonScattering => MediumOverrides { absorbing: true, ..MediumOverrides::default() },
        }
    }
}

/// How the preview `fog` looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FogSettings {
    /// L_fog: radiance of the fog (W/(m^2 sr)); where none is given, the mean radiance of the surroundings, else the
    /// mean of the surfaces that are seen.
    pub color: Option<Spectrum>,
    /// Radiance that surfaces are lit by from everywhere, besides the emitters (W/(m^2 sr)); where none is given, that
    /// of the fog where nothing surrounds the scene, else 0.
    pub ambient: Option<Spectrum>,
    /// What is further than this is fog alone (m); none for no limit.
    pub threshold: Option<f32>,
}

/// An integrator as described by a scene file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integrator {
    /// How paths are sampled.
    pub options: Options,
    /// What light does in media.
    pub restriction: Restriction,
    /// How a preview looks.
    pub fog: FogSettings,
    /// What is written besides the image.
    pub layers: Vec<Layer>,
}

/// Every integrator. Mitsuba's path tracers say no more than that an image of the scene is wanted: strategies are chosen here.
pub const ROWS: Registry<Plugin<Build<Integrator>>> = Registry::new(
    "an integrator",
    &[
        ("bdpt", plugin(BDPT, build_bdpt)),
        ("path", plugin(SAME, build_bdpt)),
        ("volpath", plugin(SAME, build_bdpt)),
        ("volpathmis", plugin(VOLPATHMIS, build_bdpt)),
        ("direct", plugin(DIRECT, build_bdpt)),
        ("ptracer", plugin(PTRACER, |p| build_as(p, Algorithm::Lt))),
        ("gather", plugin(GATHER, build_gather)),
        ("first_pass", plugin(FIRST_PASS_VIEW, build_first_pass)),
        ("fog", plugin(FOG, build_fog)),
        ("single_scattering", plugin(SINGLE_SCATTERING, build_single_scattering)),
        ("non_scattering", plugin(NON_SCATTERING, build_non_scattering)),
        ("aov", plugin(AOV, build_aov)),
        ("moment", plugin(MOMENT, build_moment)),
    ],
);

impl FogSettings {
    /// These, and where they leave something open, `others`.
    fn over(self, others: Self) -> Self {
        Self {
            color: self.color.or(others.color),
            ambient: self.ambient.or(others.ambient),
            threshold: self.threshold.or(others.threshold),
        }
    }
}

impl Integrator {
    /// The same as the command line wants it.
    pub fn overridden(self, overrides: &Overrides) -> Self {
        let fog = overrides.fog.over(self.fog);
        match overrides.scattering {
            Some(wanted) if wanted.name() != self.restriction.name() => {
                let options = Options { max_depth: self.depth_by(wanted), ..self.options };
                Self { options, restriction: wanted, fog, ..self }
            }
            _ => Self { fog, ..self },
        }
    }

    /// The limit of paths under another restriction: what single scattering was limited by is no limit without it.
    fn depth_by(&self, wanted: Restriction) -> Option<u32> {
        let is_single = |restriction| matches!(restriction, Restriction::SingleScattering { .. });
        match self.options.max_depth {
            depth if is_single(wanted) => {
                Some(depth.map_or(Restriction::SINGLE, |d| d.min(Restriction::SINGLE)))
            }
            Some(Restriction::SINGLE) if is_single(self.restriction) => None,
            depth => depth,
        }
    }

    /// The same with more layers of a scene that is at `location`.
    pub fn with_layers(mut self, layers: Vec<Layer>, location: &Location) -> Result<Self> {
        self.layers.extend(layers);
        check_names(location, &self.layers)?;
        Ok(self)
    }
}

const fn plugin(table: Table, build: Build<Integrator>) -> Plugin<Build<Integrator>> {
    Plugin { table, build }
}

/// What all integrators have.
const COMMON: &[Parameter] = rows! {
    ignored("samples_per_pass", "Tyndall divides the work itself"),
    ignored("block_size", "Tyndall divides the work itself"),
    ignored("timeout", "Tyndall divides the work itself"),
};

const BDPT: Table = table! {
    "Bidirectional path tracing, the default. A pilot chooses among its strategies."; ;
    MAX_DEPTH, MIN_DEPTH, PATHS, HEURISTIC, GUIDE, CONNECTIONS, FORCED, COMMON
};

const SAME: Table = Table { about: "The same as `bdpt`; `--integrator pt` is path tracing.", ..BDPT };

const VOLPATHMIS: Table = table! {
    "The same as `bdpt`; `--integrator pt` is path tracing.";
    ignored("use_spectral_mis", "samples are weighted over all channels anyway");
    MAX_DEPTH, MIN_DEPTH, PATHS, HEURISTIC, GUIDE, CONNECTIONS, FORCED, COMMON
};

const DIRECT: Table = table! {
    "Emitters, and surfaces lit by them directly: `bdpt` with paths of at most two segments. Media scatter once.";
    integer("max_depth", within(0.0, 2.0), Is(2.0), "Maximum number of segments of a path.").ours(),
    ignored("emitter_samples", "the pilot chooses how many samples each strategy takes"),
    ignored("bsdf_samples", "the pilot chooses how many samples each strategy takes"),
    ignored("shading_samples", "the pilot chooses how many samples each strategy takes");
    MIN_DEPTH, PATHS, HEURISTIC, GUIDE, CONNECTIONS, FORCED, COMMON
};

const PTRACER: Table = table! {
    "Light tracing: light subpaths connect to the camera; `--integrator lt`.";
    ignored("forced_interaction", "light subpaths have no primary rays");
    MAX_DEPTH, MIN_DEPTH, PATHS, HEURISTIC, GUIDE, COMMON
};

const GATHER: Table = table! {
    "A biased preview: paths end at their second scattering; the rest is looked up in a first pass (P03T sec. 5.3)."; ;
    MAX_DEPTH, PATHS, FIRST_PASS, COMMON
};

const FIRST_PASS_VIEW: Table = table! {
    "A biased preview: a first pass as it is, a coarse solution in elements of surfaces and media (P03T ch. 4).";
    boolean("flat", false, "Every element has one colour; otherwise colours are interpolated.").ours();
    MAX_DEPTH, PATHS, FIRST_PASS, COMMON
};

const FOG: Table = table! {
    "A biased preview: visible surfaces, lit without shadows, behind fog of constant radiance (BMA02 eq. 5). Fog in a scene is a medium, such as `homogeneous`.";
    light("fog_color", "W/(m^2 sr)", Said("the mean of the sky, else of the lit surfaces"), "Radiance of the fog."),
    light("ambient", "W/(m^2 sr)", Said("0 under a sky, else the fog's"),
        "Ambient radiance, added to the emitters."),
    number("threshold", "m", above(0.0, MAX), Said("no limit"), "Beyond this distance only fog is seen."),
    ignored("max_depth", "a preview shows the first surfaces only");
    PATHS, COMMON
};

const SINGLE_SCATTERING: Table = table! {
    "Light scatters at most once, surfaces are lit directly; media that vary are ray-marched (P03 eq. 18-19).";
    integer("max_depth", within(0.0, Restriction::SINGLE as f64), Is(2.0), "Maximum number of segments of a path."),
    number("step", "m", above(0.0, f64::MAX), Said("that of each medium"), "Step of the ray marching."),
    number("march_error", "", within(1e-7, 1.0), Said("that of each medium"), "Maximum error of transmittance.");
    MIN_DEPTH, PATHS, HEURISTIC, GUIDE, FORCED, COMMON
};

const NON_SCATTERING: Table = table! {
    "Media absorb and emit, but do not scatter; surfaces are unchanged (P03T eq. 2.9)."; ;
    MAX_DEPTH, MIN_DEPTH, PATHS, HEURISTIC, GUIDE, FORCED, COMMON
};

/// What integrators have that hold another.
const OUTER: &[Parameter] = rows! {
    ignored("hide_emitters", "the nested integrator decides"),
};

const AOV: Table = table! {
    "Adds layers of what is seen first to the image of the nested integrator: Mitsuba's quantities of the first surface, and \
     `first_albedo` and `first_normal` of the first interaction, in media too (for denoisers).";
    text("aovs", "a list such as \"dd:depth,nn:sh_normal\"", Required, "Names and quantities of the layers."),
    nested("integrator", Optional, "The integrator of the image; without one the image is black.");
    OUTER, COMMON
};

const MOMENT: Table = table! {
    "Adds layers to the image of the nested integrator: second moments and, in Tyndall, the variance of the mean.";
    nested("integrator", Required, "The integrator of the image.");
    OUTER, COMMON
};

/// Builds the integrator that `object` describes.
pub fn build(object: &Object, library: &Library) -> Result<Integrator> {
    let integrator = ROWS.build(object, library)?;
    check_names(&object.location, &integrator.layers)?;
    Ok(integrator)
}

/// Every channel of a file has a name of its own, which OpenEXR can hold.
fn check_names(location: &Location, layers: &[Layer]) -> Result<()> {
    let names: Vec<String> = layers.iter().flat_map(Layer::channel_names).collect();
    let remedy = "rename one of the layers";
    if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        let found = format!("\"{name}\" twice");
        return Err(Error::new(location, "channels with distinct names", found, remedy));
    }
    let fits = |name: &&String| name.len() < 256 && name.chars().all(|c| c.is_ascii_graphic());
    match names.iter().find(|name| !fits(name)) {
        None => Ok(()),
        Some(name) => {
            let expected = "channel names of ASCII letters, digits and signs, at most 255 of them";
            Err(Error::new(location, expected, format!("\"{name}\""), remedy))
        }
    }
}

fn build_as(params: &Params<'_>, algorithm: Algorithm) -> Result<Integrator> {
    Ok(Integrator { options: Options::read(params, algorithm)?, ..Integrator::default() })
}

fn build_bdpt(params: &Params<'_>) -> Result<Integrator> {
    let connections = params.choice("connections", &Connections::NAMES)?;
    let integrator = build_as(params, Algorithm::Bdpt)?;
    Ok(Integrator { options: Options { connections, ..integrator.options }, ..integrator })
}

/// `gather`, which follows a guide unless it shall not.
fn build_gather(params: &Params<'_>) -> Result<Integrator> {
    let hide_emitters = params.boolean("hide_emitters")?;
    let max_depth = u32::try_from(params.integer("max_depth")?).ok();
    let first_pass = match params.has("first_pass") {
        true => params.choice("first_pass", &FirstPass::NAMES)?,
        false => FirstPass::Usual,
    };
    let options = Options { hide_emitters, max_depth, first_pass, ..Options::of(Algorithm::Gather) };
    Ok(Integrator { options, ..Integrator::default() })
}

/// `first_pass`, the view of what `gather` ends in.
fn build_first_pass(params: &Params<'_>) -> Result<Integrator> {
    let flat = params.boolean("flat")?;
    let integrator = build_gather(params)?;
    let options = Options { algorithm: Algorithm::FirstPass, flat, ..integrator.options };
    Ok(Integrator { options, ..integrator })
}

/// `fog` (BMA02 sec. 3.1 and 4.2).
fn build_fog(params: &Params<'_>) -> Result<Integrator> {
    let threshold = params.optional_float("threshold")?.map(|far| far as f32);
    let (color, ambient) = (params.optional_color("fog_color")?, params.optional_color("ambient")?);
    let fog = FogSettings { color, ambient, threshold };
    let hide_emitters = params.boolean("hide_emitters")?;
    let options = Options { hide_emitters, ..Options::of(Algorithm::Fog) };
    Ok(Integrator { options, fog, ..Integrator::default() })
}

/// `single_scattering`: path tracing of at most two segments, with marching by `step` (m) or within `march_error`.
fn build_single_scattering(params: &Params<'_>) -> Result<Integrator> {
    let is_integer = |property: &Property| matches!(property.value, Value::Integer(_));
    params.integer("max_depth").map_err(|error| match params.given("max_depth").is_some_and(is_integer) {
        true => Error { remedy: "light scatters once here: use volpath for longer paths".into(), ..error },
        false => error,
    })?;
    let (step, march_error) = (params.optional_float("step")?, params.optional_float("march_error")?);
    let restriction = Restriction::SingleScattering { step, march_error };
    Ok(Integrator { restriction, ..build_as(params, Algorithm::Pt)? })
}

/// `non_scattering`: media absorb and emit only, among surfaces as they are.
fn build_non_scattering(params: &Params<'_>) -> Result<Integrator> {
    let integrator = build_as(params, Algorithm::Bdpt)?;
    Ok(Integrator { restriction: Restriction::NonScattering, ..integrator })
}

/// `aov`: what the first surface is like, and the image of the integrator inside. Without one the image is
/// black.
fn build_aov(params: &Params<'_>) -> Result<Integrator> {
    let mut built = match nested(params)? {
        None => {
            let options = Options { max_depth: Some(0), ..Options::of(Algorithm::Pt) };
            Integrator { options, ..Integrator::default() }
        }
        Some(child) => {
            let name = name_of(&child);
            let inner = ROWS.build(child.object, params.library)?;
            let mut layers = vec![Layer { name: name.into(), content: Content::Image }];
            layers.extend(inner.layers.iter().map(|layer| within(name, layer)));
            Integrator { layers, ..inner }
        }
    };
    built.layers.extend(surface_layers(params)?);
    Ok(built)
}

/// `moment`: the integrator inside, with second moments of its image and, beyond Mitsuba, the variance of its
/// mean.
fn build_moment(params: &Params<'_>) -> Result<Integrator> {
    let Some(child) = nested(params)? else { return Err(params.missing("integrator")) };
    let inner = ROWS.build(child.object, params.library)?;
    if !inner.layers.is_empty() {
        let found = format!("\"{}\"", child.object.plugin);
        let remedy =
            "put the moment integrator inside the aov integrator, and one that makes paths inside it";
        return Err(Error::new(child.location, "an integrator that makes paths", found, remedy));
    }
    let name = name_of(&child);
    let layers = vec![
        Layer { name: name.into(), content: Content::Mean },
        Layer { name: format!("m2_{name}"), content: Content::SecondMoment },
        Layer { name: "variance".into(), content: Content::Variance },
    ];
    Ok(Integrator { layers, ..inner })
}

/// The integrator inside another.
fn nested<'a>(params: &Params<'a>) -> Result<Option<Child<'a>>> {
    let children = params.children("integrator", |child| {
        ROWS.has(child.object) || child.object.tag.as_deref() == Some("integrator")
    })?;
    match children.as_slice() {
        [] => Ok(None),
        [one] => Ok(Some(*one)),
        [_, second, ..] => Err(Error::new(
            second.location,
            "one integrator inside",
            "a second integrator",
            "remove one of them, and render the scene once for each",
        )),
    }
}

/// Mitsuba's name of a child: its own, or what it calls the first without.
fn name_of<'a>(child: &Child<'a>) -> &'a str {
    if child.name.is_empty() { "_arg_0" } else { child.name }
}

fn within(outer: &str, layer: &Layer) -> Layer {
    Layer { name: format!("{outer}.{}", layer.name), content: layer.content }
}

/// The list `aovs`: name:quantity, separated by commas or spaces.
fn surface_layers(params: &Params<'_>) -> Result<Vec<Layer>> {
    let text = params.string("aovs")?;
    text.split([',', ' ']).filter(|item| !item.is_empty()).map(|item| surface_layer(params, item)).collect()
}

fn surface_layer(params: &Params<'_>, item: &str) -> Result<Layer> {
    let expected = "name:quantity, such as dd:depth";
    let (name, quantity) = match item.split_once(':') {
        Some((name, quantity)) if !name.is_empty() => (name, quantity),
        _ => return Err(params.complain("aovs", expected, format!("\"{item}\""))),
    };
    let Some(found) = QUANTITIES.get(quantity) else {
        let error = params.complain("aovs", "a quantity", format!("\"{quantity}\""));
        return Err(Error { remedy: suggest(quantity, "known", &QUANTITIES.names()), ..error });
    };
    Ok(Layer { name: name.into(), content: Content::Surface(*found) })
}
