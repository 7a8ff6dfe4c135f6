//! From description to scene: the tree is walked once, every object is built by its registry row, and related
//! objects refer to each other by index.

mod asked;
mod finish;
mod groups;
mod look;
mod media;
mod shapes;
mod view;

use super::{
    Scene, Surface, batch,
    contact::{Apart, Nature},
    keyframes,
    rebuild::{Before, Parts},
    sections::Sections,
    shutter::{self, Shutter},
    smoke::{self, Taken},
    unseen::{self},
};
use crate::{
    bsdf::{self, Bsdf, BsdfModel},
    description::{Kept, Library, Location, Object, Params, Position, Property, Value, params::Child},
    emitter::{self, Emitter},
    error::{Error, Result},
    film::{
        Film,
        layer::{self, Component},
    },
    format::plugins,
    math::{DAffine3, DVec3},
    medium::{self, MediumDescription, MediumIndex},
    sampling::Sampler,
    settings::{
        Overrides,
        integrator::{self, Integrator},
        only_one,
    },
    shape::Shape,
    volume::{self, Place},
};
use asked::Asked;
use finish::Finished;
pub(super) use groups::Base;
use groups::Bases;
use std::collections::HashMap;

/// A scene with what its file says about rendering it.
pub struct Setup {
    /// What transport needs.
    pub scene: Scene,
    /// Image size and filter.
    pub film: Film,
    /// Which integrator, how deep.
    pub integrator: Integrator,
    /// Samples per pixel that the sampler requests.
    pub samples_per_pixel: u64,
    /// How the sampler distributes random numbers; none for the default.
    pub sampler: Option<Sampler>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Id (or plugin name) of each medium after vacuum, for listings.
    pub medium_names: Vec<String>,
    /// The same of each shape.
    pub shape_names: Vec<String>,
    /// The same of each BSDF.
    pub bsdf_names: Vec<String>,
    /// When the scene is seen (s).
    pub time: f64,
    /// Shapes that were set apart as they touched.
    pub apart: Apart,
    /// What each smoke was made of.
    pub smoke: Vec<Taken>,
    /// What the command line set.
    pub overrides: Overrides,
    /// How it moves while the shutter is open; none if it stands still.
    pub(super) moving: Option<Moving>,
    /// What all of it was built from: the description at that time, without smoke.
    pub(super) root: Object,
    /// What was built from `root`.
    pub(super) parts: Parts,
}

/// A scene that moves while the shutter is open.
pub(super) struct Moving {
    /// Its description, at all times.
    root: Object,
    shutter: Shutter,
    /// What files hold.
    kept: Kept,
}

impl Moving {
    /// Builds the scene as it is `after` seconds past its time. In scenes with keyframes, errors state `after`.
    fn assemble(&self, overrides: Overrides, before: Option<&Before<'_>>, after: f64) -> Result<Setup> {
        let is_told = after != 0.0 && keyframes::has_any(&self.root);
        assemble(self, overrides, before, after).map_err(|error| match is_told {
            false => error,
            true => Error { place: format!("{after} s after the scene's time: {}", error.place), ..error },
        })
    }
}

impl Setup {
    /// When the shutter opens and closes, relative to the scene's time (s); none if nothing moves meanwhile.
    pub fn exposure(&self) -> Option<[f64; 2]> {
        self.moving.as_ref().map(|Moving { shutter, .. }| [shutter.opens, shutter.closes])
    }

    /// The scene in `pass` of renders with `seed`; none if it stands still. The origin of coordinates stays, so static
    /// objects are not rebuilt, and what was learnt stays in place.
    pub fn moment(&self, seed: u64, pass: u64) -> Option<Result<Self>> {
        self.after(self.moving.as_ref()?.shutter.moment(seed, pass)).transpose()
    }

    /// The scene `after` seconds past its time; none if it stands still.
    fn after(&self, after: f64) -> Result<Option<Self>> {
        let Some(moving) = &self.moving else { return Ok(None) };
        moving.assemble(self.overrides, Some(&Before::new(self)?.in_place()), after).map(Some)
    }

    /// What a medium is called; where several overlap, all of them.
    pub fn medium_name(&self, medium: MediumIndex) -> String {
        self.names(self.scene.components(&medium))
    }

    /// The names of `media`, joined.
    pub fn names(&self, media: &[MediumIndex]) -> String {
        let name = |medium: &MediumIndex| Some(self.medium_names[medium.0.checked_sub(1)? as usize].as_str());
        let names: Vec<&str> = media.iter().filter_map(name).collect();
        if names.is_empty() { "vacuum".to_owned() } else { names.join(" + ") }
    }
}

/// Builds the scene that `root` describes.
pub fn build(root: &Object, overrides: Overrides) -> Result<Setup> {
    build_again(root, overrides, None)
}

/// [`build`] with `before`, built from the same file and overrides for another time: unchanged parts are reused.
pub fn build_again(root: &Object, overrides: Overrides, before: Option<&Setup>) -> Result<Setup> {
    plugins::check(root)?;
    let moving = Moving { root: root.clone(), shutter: Shutter::of(root)?, kept: Kept::default() };
    let (shutter, before) = (moving.shutter, before.map(Before::new).transpose()?);
    let built = moving.assemble(overrides, before.as_ref(), shutter.middle())?;
    if shutter.is_instant() || !(keyframes::has_any(root) || shutter::has_drifting(&built.root)) {
        return Ok(built);
    }
    let scene = Scene { moves: true, ..built.scene };
    let setup = Setup { scene, moving: Some(moving), ..built };
    // Errors show now, not after hours of rendering.
    setup.after(shutter.opens)?;
    setup.after(shutter.closes)?;
    Ok(setup)
}

/// Builds the scene as it is `after` seconds past its time.
fn assemble(moving: &Moving, overrides: Overrides, before: Option<&Before<'_>>, after: f64) -> Result<Setup> {
    let Moving { root, shutter, kept } = moving;
    let root = &batch::expand(root)?;
    let root = &keyframes::resolve(root, smoke::time_of(root) + after);
    let (root, smoke) = smoke::expand(root, *shutter, kept)?;
    let mut library = Library::new(&root)?;
    (library.is_strict, library.soften) = (overrides.strict, overrides.soften);
    library.kept = kept.clone();
    let sections = Sections::sort(&root, &library)?;
    let kept = before.and_then(|before| before.recentre);
    let recentre = kept.map_or_else(|| sections.viewpoint(&library), Ok)?;
    let now = sections.time + after;
    library.place.set((recentre, now));
    let mut builder = Builder::new(&library, Place { after, ..Place::new(recentre, now) }, before);
    builder.add_shapes(&root, &sections.shapes)?;
    for child in &sections.emitters {
        builder.emitter(child)?;
    }
    let view = builder.view(sections.sensor, overrides)?;
    let integrator = match sections.integrator {
        Some(object) => integrator::build(object, &library)?,
        None => Integrator::default(),
    }
    .overridden(&overrides);
    let medium_names = builder.medium_names.clone();
    let medium_overrides = overrides.media.over(integrator.restriction.medium_overrides());
    let time = sections.time;
    let parts = std::mem::take(&mut builder.parts);
    let Finished { scene, shape_names, bsdf_names, apart } =
        builder.finish(view.camera, &medium_overrides)?;
    unseen::warn_of_darkness(&scene.lights, &integrator, &root.location, &library);
    let groups = if overrides.groups { scene.lights.groups() } else { Vec::new() };
    let components = if overrides.components { &Component::ALL[..] } else { &[] };
    let integrator = integrator.with_layers(layer::parts(&groups, components), &root.location)?;
    if let Some(object) = sections.integrator {
        warn_of_counted_nulls(object, &integrator, &scene, &library);
        if object.plugin == "direct" && !medium_names.is_empty() {
            let text = "light scatters once in media here; Mitsuba's direct integrator sees no media: remove them, or use volpath";
            library.warn(&object.location, text);
        }
    }
    Ok(Setup {
        scene,
        film: view.film,
        integrator,
        samples_per_pixel: view.sampling.samples_per_pixel,
        sampler: view.sampling.sampler,
        warnings: library.take_warnings(),
        medium_names,
        shape_names,
        bsdf_names,
        time,
        apart,
        smoke,
        overrides,
        parts,
        moving: None,
        root: root.into_owned(),
    })
}

/// Mitsuba's `path` counts the passage through a null surface, a mask or a thin pane as a bounce; its volumetric
/// integrators do not, and neither does anything here.
fn warn_of_counted_nulls(object: &Object, integrator: &Integrator, scene: &Scene, library: &Library) {
    let limited = integrator.options.max_depth.is_some() || integrator.options.hide_emitters;
    let nulls = scene.surfaces.iter().any(|surface| scene.bsdfs[surface.bsdf as usize].has_null());
    if ["path", "direct"].contains(&object.plugin.as_str()) && limited && nulls {
        let plugin = &object.plugin;
        let text = format!(
            "passing through a null surface, a mask or a thin pane does not count as a bounce here, as in volpath; Mitsuba's {plugin} integrator counts it"
        );
        library.warn(&object.location, &text);
    }
}

/// Its id, or the name of its plugin.
fn name_of(object: &Object) -> String {
    object.id.clone().unwrap_or_else(|| object.plugin.clone())
}

/// An emitter as the file places it.
struct Placed<'a> {
    emitter: Emitter,
    shape: Option<u32>,
    /// The medium that the file says it is in.
    stated: Option<MediumIndex>,
    location: &'a Location,
}

struct Builder<'a> {
    library: &'a Library,
    recentre: DVec3,
    shapes: Vec<Shape>,
    shape_names: Vec<String>,
    shape_locations: Vec<Location>,
    surfaces: Vec<Surface>,
    natures: Vec<Nature>,
    apart: Apart,
    bsdfs: Vec<Bsdf>,
    bsdf_names: Vec<String>,
    bsdf_index: HashMap<*const Object, u32>,
    place: Place,
    media: Vec<MediumDescription>,
    medium_locations: Vec<Location>,
    medium_names: Vec<String>,
    medium_ids: Vec<Option<String>>,
    medium_objects: Vec<&'a Object>,
    medium_places: Vec<DAffine3>,
    emitters: Vec<Placed<'a>>,
    /// BSDF of shapes that name none: diffuse 0.5, and black on emitters.
    default_bsdf: [Option<u32>; 2],
    before: Option<&'a Before<'a>>,
    /// True if all shapes so far are those of before.
    has_old_shapes: bool,
    bases: Bases,
    parts: Parts,
}

impl<'a> Builder<'a> {
    fn new(library: &'a Library, place: Place, before: Option<&'a Before<'a>>) -> Self {
        Self {
            library,
            recentre: place.recentre,
            shapes: Vec::new(),
            shape_names: Vec::new(),
            shape_locations: Vec::new(),
            surfaces: Vec::new(),
            natures: Vec::new(),
            apart: Apart::default(),
            bsdfs: Vec::new(),
            bsdf_names: Vec::new(),
            bsdf_index: HashMap::new(),
            place,
            media: vec![MediumDescription::vacuum()],
            medium_locations: Vec::new(),
            medium_names: Vec::new(),
            medium_ids: Vec::new(),
            medium_objects: Vec::new(),
            medium_places: Vec::new(),
            emitters: Vec::new(),
            default_bsdf: [None; 2],
            before,
            has_old_shapes: before.is_some(),
            bases: Bases::default(),
            parts: Parts::default(),
        }
    }

    fn emitter(&mut self, child: &Child<'a>) -> Result<()> {
        let emitter = self.built_emitter(child.object)?;
        if emitter.needs_shape() {
            let expected = format!("the {} emitter on a shape", emitter.name);
            let remedy = "put it inside the shape that emits";
            return Err(Error::new(child.location, expected, "one in the scene", remedy));
        }
        let surrounds = |emitter: &Emitter| emitter.environment().is_some();
        if surrounds(&emitter) && self.emitters.iter().any(|other| surrounds(&other.emitter)) {
            return Err(only_one(child, "environment"));
        }
        let stated = self.stated_medium(&emitter::ROWS.read(child.object, self.library)?.0)?;
        self.emitters.push(Placed { emitter, shape: None, stated, location: child.location });
        Ok(())
    }

    fn built_emitter(&mut self, object: &Object) -> Result<Emitter> {
        self.parts.emitters.insert(object.location.clone(), self.emitters.len());
        Asked::by(object, self.library).refuse()?;
        let old = self.before.and_then(|before| before.emitter(object, self.library));
        old.cloned().map_or_else(|| emitter::build(object, self.library), Ok)
    }

    /// The one object behind an id, for all references to it and for its definition.
    fn original(&self, object: &'a Object) -> Result<&'a Object> {
        object.id.as_ref().map_or(Ok(object), |id| self.library.resolve(id, &object.location))
    }

    fn bsdf(&mut self, object: &'a Object) -> Result<u32> {
        let object = self.original(object)?;
        if let Some(index) = self.bsdf_index.get(&std::ptr::from_ref(object)) {
            return Ok(*index);
        }
        let is_placed = Asked::by(object, self.library).is_any();
        let old = self.before.filter(|_| !is_placed);
        let old = old.and_then(|before| before.bsdf(object, self.library));
        let bsdf = old.cloned().map_or_else(|| bsdf::build(object, self.library), Ok)?;
        let index = self.add_bsdf(bsdf, name_of(object));
        self.parts.bsdfs.insert(object.location.clone(), index as usize);
        self.bsdf_index.insert(std::ptr::from_ref(object), index);
        Ok(index)
    }

    fn add_bsdf(&mut self, bsdf: Bsdf, name: String) -> u32 {
        self.bsdfs.push(bsdf);
        self.bsdf_names.push(name);
        self.bsdfs.len() as u32 - 1
    }

    fn default_bsdf(&mut self, emits: bool) -> Result<u32> {
        if let Some(index) = self.default_bsdf[usize::from(emits)] {
            return Ok(index);
        }
        let location =
            Location { file: std::sync::Arc::default(), position: Position::Path("(default bsdf)".into()) };
        let value = Value::Float(if emits { 0.0 } else { 0.5 });
        let properties = vec![Property { name: "reflectance".into(), value, location: location.clone() }];
        let object = Object { tag: None, plugin: "diffuse".into(), id: None, properties, location };
        let index = self.add_bsdf(bsdf::build(&object, self.library)?, "default".to_owned());
        self.default_bsdf[usize::from(emits)] = Some(index);
        Ok(index)
    }

    fn medium(&mut self, object: &'a Object) -> Result<MediumIndex> {
        let object = self.original(object)?;
        // Two equal descriptions are one medium: boundaries with it on both sides do not contradict each other.
        let place = if varies(object, self.library) { self.place.instance } else { DAffine3::IDENTITY };
        let is_known = |(known, there): (&&Object, &DAffine3)| *there == place && known.says_what(object);
        if let Some(index) = self.medium_objects.iter().zip(&self.medium_places).position(is_known) {
            if let (None, Some(id)) = (&self.medium_ids[index], &object.id) {
                (self.medium_ids[index], self.medium_names[index]) = (Some(id.clone()), id.clone());
            }
            return Ok(MediumIndex(index as u32 + 1));
        }
        let index = MediumIndex(self.media.len() as u32);
        let is_moved = place != DAffine3::IDENTITY;
        let before = self.before.filter(|_| !is_moved);
        let old = before.and_then(|before| before.medium(object, self.library, self.recentre));
        let medium = old.cloned().map_or_else(|| medium::build(object, self.library, &self.place), Ok)?;
        if !is_moved {
            self.parts.media.insert(object.location.clone(), medium.clone());
        }
        self.media.push(medium);
        self.medium_places.push(place);
        self.medium_names.push(name_of(object));
        self.medium_locations.push(object.location.clone());
        self.medium_ids.push(object.id.clone());
        self.medium_objects.push(object);
        Ok(index)
    }

    /// The medium that a camera or emitter says it is in.
    fn stated_medium(&mut self, params: &Params<'a>) -> Result<Option<MediumIndex>> {
        match params.children("medium", |child| medium::ROWS.has(child.object))?.as_slice() {
            [] => Ok(None),
            [one] => self.medium(one.object).map(Some),
            [_, second, ..] => Err(only_one(second, "medium")),
        }
    }
}

/// True if a medium varies in space, so that each instance of a group has its own.
fn varies(object: &Object, library: &Library) -> bool {
    let is_volume = volume::ROWS.has(object) && object.plugin != "constvolume";
    let below = |property: &Property| match &property.value {
        Value::Object(child) => varies(child, library),
        Value::Reference(id) => library.find(id).is_some_and(|child| varies(child, library)),
        _ => false,
    };
    is_volume || object.plugin == "heterogeneous" || object.properties.iter().any(below)
}
