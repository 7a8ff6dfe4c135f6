//! From description to scene: the tree is walked once, every object is built by its registry row, and related
//! objects refer to each other by index.

mod finish;
mod media;
mod view;

use super::{
    Scene, Surface,
    contact::{Apart, Nature, Rank},
    keyframes,
    media::Boundary,
    rebuild::{Before, Parts},
    sections::Sections,
    smoke::{self, Taken},
    unseen::{self},
};
use crate::{
    bsdf::{self, Bsdf, BsdfModel},
    description::{Library, Location, Object, Params, Position, Property, Value, params::Child},
    emitter::{self, Emitter},
    error::{Error, Result},
    film::{
        Film,
        layer::{self, Component},
    },
    format::plugins,
    math::DVec3,
    medium::{self, MediumDescription, MediumIndex},
    sampling::Sampler,
    settings::{
        Overrides,
        integrator::{self, Integrator},
        only_one,
    },
    shape::{self, Shape, ShapeModel as _},
    volume::Place,
};
use finish::Finished;
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
    /// What all of it was built from: the description at that time, without smoke.
    pub(super) root: Object,
    /// What became of that.
    pub(super) parts: Parts,
}

impl Setup {
    /// What a medium is called; where several overlap, all of them.
    pub fn medium_name(&self, medium: MediumIndex) -> String {
        self.names(self.scene.components(&medium))
    }

    /// The same of several.
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

/// The same, if `before` was built from the same file and with the same overrides for another time: what has not changed
/// since is taken from there.
pub fn build_again(root: &Object, overrides: Overrides, before: Option<&Setup>) -> Result<Setup> {
    plugins::check(root)?;
    let root = &keyframes::resolve(root);
    let (root, smoke) = smoke::expand(root)?;
    let mut library = Library::new(&root)?;
    library.is_strict = overrides.strict;
    let sections = Sections::sort(&root, &library)?;
    let recentre = sections.viewpoint(&library)?;
    let before = before.map(Before::new).transpose()?;
    let mut builder = Builder::new(&library, Place::new(recentre, sections.time), before.as_ref());
    for child in &sections.shapes {
        builder.shape(child)?;
    }
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
    let time = builder.place.time;
    let parts = std::mem::take(&mut builder.parts);
    let Finished { scene, shape_names, bsdf_names, apart } =
        builder.finish(view.camera, &medium_overrides)?;
    unseen::warn_of_darkness(&scene.lights, &integrator, &root.location, &library);
    let groups = if overrides.groups { scene.lights.groups() } else { Vec::new() };
    let components = if overrides.components { &Component::ALL[..] } else { &[] };
    let integrator = integrator.with_layers(layer::parts(&groups, components), &root.location)?;
    if let Some(object) = sections.integrator {
        warn_of_counted_nulls(object, &integrator, &scene, &library);
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
        root: root.into_owned(),
    })
}

/// Mitsuba's `path` counts the passage through a null surface, a mask or a thin pane as a bounce; its volumetric
/// integrators do not, and neither does anything here.
fn warn_of_counted_nulls(object: &Object, integrator: &Integrator, scene: &Scene, library: &Library) {
    let limited = integrator.options.max_depth.is_some() || integrator.options.hide_emitters;
    let nulls = scene.surfaces.iter().any(|surface| scene.bsdfs[surface.bsdf as usize].has_null());
    if object.plugin == "path" && limited && nulls {
        let text = "passing through a null surface, a mask or a thin pane does not count as a bounce here, as in volpath; Mitsuba's path integrator counts it in max_depth";
        library.warn(&object.location, text);
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
    emitters: Vec<Placed<'a>>,
    /// BSDF of shapes that name none: diffuse 0.5, and black on emitters.
    default_bsdf: [Option<u32>; 2],
    before: Option<&'a Before<'a>>,
    /// True if all shapes so far are those of before.
    has_old_shapes: bool,
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
            emitters: Vec::new(),
            default_bsdf: [None; 2],
            before,
            has_old_shapes: before.is_some(),
            parts: Parts::default(),
        }
    }

    fn shape(&mut self, child: &Child<'a>) -> Result<()> {
        let (params, build) = shape::ROWS.read(child.object, self.library)?;
        let old = self.before.and_then(|before| before.shape(child.object, self.recentre));
        let shape = old.cloned().map_or_else(|| build(&params, self.recentre), Ok)?;
        let interior = self.side(&params, "interior")?;
        let exterior = self.side(&params, "exterior")?;
        let index = self.shapes.len() as u32;
        let emitter = self.shape_emitter(&params, index)?;
        let bsdfs = params.children("bsdf", |child| bsdf::ROWS.has(child.object))?;
        let bsdf = match bsdfs.as_slice() {
            [] => self.default_bsdf(emitter.is_some())?,
            [one] => self.bsdf(one.object)?,
            [_, second, ..] => return Err(only_one(second, "bsdf")),
        };
        // One that was built before has been read then.
        if old.is_none() {
            params.finish()?;
        }
        self.has_old_shapes &= old.is_some();
        self.parts.shapes.insert(child.object.location.clone(), self.shapes.len());
        self.shapes.push(shape);
        self.shape_names.push(name_of(child.object));
        self.shape_locations.push(child.location.clone());
        let model = &self.bsdfs[bsdf as usize];
        let nature = nature(model, bsdf, emitter.is_some());
        let (connectible, transmits) = (model.is_connectible(), model.transmits());
        let boundary = Boundary::stated(interior, exterior, transmits);
        if transmits && boundary.is_known() {
            self.mend_container(exterior.is_some(), child.location);
        }
        self.natures.push(nature);
        self.surfaces.push(Surface { bsdf, emitter, boundary, transmits, connectible });
        Ok(())
    }

    /// The last shape bounds a medium: if it is a mesh, each of its triangles has to say alike which side is which.
    fn mend_container(&mut self, is_exterior_stated: bool, location: &Location) {
        let (Some(Shape::Mesh(mesh)), Some(name)) = (self.shapes.last_mut(), self.shape_names.last()) else {
            return;
        };
        if let Some((mended, turned)) = mesh.oriented() {
            let text = format!(
                "{turned} of the {} triangles of \"{name}\" face the other way than their neighbours. They are turned \
                 over, because the boundary of a medium has one inside. Recalculate the normals in the program that \
                 made the mesh",
                mesh.primitive_count()
            );
            self.library.warn(location, &text);
            *mesh = mended;
        }
        if !is_exterior_stated && mesh.is_inside_out() {
            let text = format!(
                "\"{name}\" is inside out: its normals point into the mesh, so that its interior medium fills all the \
                 space around it. Change \"flip_normals\", or turn the mesh over in the program that made it"
            );
            self.library.warn(location, &text);
        }
    }

    /// The medium that the file states on one side of a shape.
    fn side(&mut self, params: &Params<'a>, name: &'static str) -> Result<Option<MediumIndex>> {
        params.child(name)?.map(|child| self.medium(child.object)).transpose()
    }

    fn shape_emitter(&mut self, params: &Params<'a>, shape: u32) -> Result<Option<u32>> {
        let emitters = params.children("emitter", |child| emitter::ROWS.has(child.object))?;
        let child = match emitters.as_slice() {
            [] => return Ok(None),
            [one] => one,
            [_, second, ..] => return Err(only_one(second, "emitter")),
        };
        let emitter = self.built_emitter(child.object)?;
        if !emitter.needs_shape() {
            let found = format!("\"{}\"", child.object.plugin);
            let remedy = "put it beside the shapes, in the scene itself";
            return Err(Error::new(child.location, "an area emitter on a shape", found, remedy));
        }
        let stated = self.stated_medium(&emitter::ROWS.read(child.object, self.library)?.0)?;
        self.emitters.push(Placed { emitter, shape: Some(shape), stated, location: child.location });
        Ok(Some(self.emitters.len() as u32 - 1))
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
        let old = self.before.and_then(|before| before.emitter(object, self.library));
        old.cloned().map_or_else(|| emitter::build(object, self.library), Ok)
    }

    /// The one object behind all references to it, the place among them where it is written.
    fn original(&self, object: &'a Object) -> Result<&'a Object> {
        object.id.as_ref().map_or(Ok(object), |id| self.library.resolve(id, &object.location))
    }

    fn bsdf(&mut self, object: &'a Object) -> Result<u32> {
        let object = self.original(object)?;
        if let Some(index) = self.bsdf_index.get(&std::ptr::from_ref(object)) {
            return Ok(*index);
        }
        let old = self.before.and_then(|before| before.bsdf(object, self.library));
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
        // One that is written twice is one, too: boundaries on both sides of which it lies do not contradict each other.
        if let Some(index) = self.medium_objects.iter().position(|known| known.says_what(object)) {
            if let (None, Some(id)) = (&self.medium_ids[index], &object.id) {
                (self.medium_ids[index], self.medium_names[index]) = (Some(id.clone()), id.clone());
            }
            return Ok(MediumIndex(index as u32 + 1));
        }
        let index = MediumIndex(self.media.len() as u32);
        let old = self.before.and_then(|before| before.medium(object, self.library, self.recentre));
        let medium = old.cloned().map_or_else(|| medium::build(object, self.library, &self.place), Ok)?;
        self.parts.media.insert(object.location.clone(), medium.clone());
        self.media.push(medium);
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

/// What contact needs to know of a shape with this BSDF.
fn nature(model: &Bsdf, bsdf: u32, emits: bool) -> Nature {
    let rank = match model {
        Bsdf::Null(_) => Rank::Null,
        model if model.transmits() => Rank::Transmitting,
        _ if emits => Rank::Emitting,
        _ => Rank::Opaque,
    };
    Nature { rank, bsdf, one_sided: !matches!(model, Bsdf::TwoSided(_)), is_lid: false }
}
