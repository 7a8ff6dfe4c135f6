//! From description to scene: the tree is walked once, every object is built by its registry row, and what
//! belongs together is tied up by index.

use super::{
    Boundary, Scene, Surface,
    accel::Geometry,
    boundary::{self, Found},
    film,
    integrator::{self, Integrator},
    lights::{Light, Lights},
    plugins, references, tags,
};
use crate::{
    bsdf::{self, Bsdf, BsdfModel},
    description::{Library, Location, Object, Params, Position, Property, Value, params::Child},
    emitter::{self, Emitter},
    error::{Error, Result},
    film::Film,
    math::{DVec3, Spectrum, Vec3, offset},
    medium::{self, Homogeneous, MediumIndex},
    sensor::{self, Crop, Sensor},
    shape::{self, Shape},
};
use std::collections::HashMap;

/// A scene with what its file says about rendering it.
pub struct Setup {
    /// What transport needs.
    pub scene: Scene,
    /// Image size and filter.
    pub film: Film,
    /// Which integrator, how deep.
    pub integrator: Integrator,
    /// Samples per pixel asked for by the sampler.
    pub samples_per_pixel: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Id (or plugin name) of each medium after vacuum, for listings.
    pub medium_names: Vec<String>,
}

/// What the caller asks of the film instead of the file's word.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Width and height [pixels].
    pub size: Option<(u32, u32)>,
}

/// Builds the scene that `root` describes.
pub fn build(root: &Object, overrides: Overrides) -> Result<Setup> {
    plugins::check(root)?;
    let library = Library::new(root)?;
    let sections = Sections::sort(root, &library)?;
    let recentre = sections.viewpoint(&library)?;
    let mut builder = Builder::new(&library, recentre);
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
    };
    let medium_names = builder.medium_names.clone();
    let scene = builder.finish(view.sensor, view.medium, &sections.sensor.location)?;
    if let Some(object) = sections.integrator {
        warn_of_counted_nulls(object, &integrator, &scene, &library);
    }
    Ok(Setup {
        scene,
        film: view.film,
        integrator,
        samples_per_pixel: view.samples_per_pixel,
        warnings: library.take_warnings(),
        medium_names,
    })
}

/// Mitsuba's `path` counts the passage through a null surface, a mask or a thin pane as a bounce; its volumetric
/// integrators do not, and neither does anything here.
fn warn_of_counted_nulls(object: &Object, integrator: &Integrator, scene: &Scene, library: &Library) {
    let limited = integrator.max_depth.is_some() || integrator.hide_emitters;
    let nulls = scene.surfaces.iter().any(|surface| scene.bsdfs[surface.bsdf as usize].has_null());
    if object.plugin == "path" && limited && nulls {
        let text = "a passage through a null surface, a mask or a thin pane is no bounce here, as in volpath; \
                    Mitsuba's path counts it in max_depth";
        library.warn(&object.location, text);
    }
}

/// The scene's children by kind.
struct Sections<'a> {
    integrator: Option<&'a Object>,
    sensor: &'a Object,
    shapes: Vec<Child<'a>>,
    emitters: Vec<Child<'a>>,
}

/// True if `object` only waits to be referred to.
fn is_definition(object: &Object) -> bool {
    bsdf::ROWS.iter().any(|row| row.name == object.plugin)
        || medium::is_medium(object)
        || crate::phase::is_phase(object)
        || crate::texture::ROWS.iter().any(|row| row.name == object.plugin)
}

fn is_shape(object: &Object) -> bool {
    shape::ROWS.iter().any(|row| row.name == object.plugin)
}

impl<'a> Sections<'a> {
    fn sort(root: &'a Object, library: &'a Library) -> Result<Self> {
        let params = Params::new(root, library);
        let shapes = params.children(|child| is_shape(child.object))?;
        let emitters = params.children(|child| emitter::is_emitter(child.object))?;
        let sensors = params.children(|child| sensor::is_sensor(child.object))?;
        let integrators = params.children(|child| integrator::is_integrator(child.object))?;
        let definitions = params.children(|child| is_definition(child.object))?;
        for child in &definitions {
            check_definition(child.object, library)?;
        }
        warn_of_idle(&definitions, root, library);
        if let Some(unknown) = params.children(|_| true)?.iter().find(|child| {
            !(is_shape(child.object)
                || emitter::is_emitter(child.object)
                || sensor::is_sensor(child.object)
                || integrator::is_integrator(child.object)
                || is_definition(child.object))
        }) {
            return Err(misplaced(unknown));
        }
        params.finish()?;
        let sensor = match sensors.as_slice() {
            [] => return Err(without_sensor(root)),
            [sensor] => sensor.object,
            [_, second, ..] => return Err(only_one(second, "sensor")),
        };
        if let [_, second, ..] = integrators.as_slice() {
            return Err(only_one(second, "integrator"));
        }
        let integrator = integrators.first().map(|child| child.object);
        Ok(Self { integrator, sensor, shapes, emitters })
    }

    /// Where the camera stands, in the file's coordinates: it becomes the origin, so that f32 geometry is most
    /// precise where it is seen from nearest, however far from the file's origin that is.
    fn viewpoint(&self, library: &Library) -> Result<DVec3> {
        sensor::viewpoint(self.sensor, library)
    }
}

/// Definitions are built even if nothing refers to them, so that a mistake in one is told.
fn check_definition(object: &Object, library: &Library) -> Result<()> {
    if bsdf::ROWS.iter().any(|row| row.name == object.plugin) {
        bsdf::build(object, library).map(drop)
    } else if medium::is_medium(object) {
        medium::build(object, library).map(drop)
    } else if crate::phase::is_phase(object) {
        crate::phase::build(object, library).map(drop)
    } else {
        crate::texture::build(object, library).map(drop)
    }
}

/// A plugin that nobody knows, that a scene does not hold, or a sensor that only Mitsuba has.
fn misplaced(child: &Child<'_>) -> Error {
    let plugin = &child.object.plugin;
    let tags = tags::of_plugin(plugin);
    if tags.is_empty() {
        return plugins::unknown_in(child.object, "scene");
    }
    if tags.contains(&"sensor") {
        let found = format!("\"{plugin}\", which only Mitsuba has");
        return Error::new(
            child.location,
            "a sensor of Tyndall",
            found,
            format!("replace it by one of {}", sensor::names().collect::<Vec<_>>().join(", ")),
        );
    }
    let remedy = "move it into the object that it belongs to (films and samplers into the sensor)";
    Error::new(child.location, "a plugin that stands in the scene itself", format!("\"{plugin}\""), remedy)
}

/// Says which definitions have no effect.
fn warn_of_idle(definitions: &[Child<'_>], root: &Object, library: &Library) {
    let referred = references::referred(root);
    for Child { object, location, .. } in definitions {
        if object.id.as_deref().is_none_or(|id| !referred.contains(id)) {
            let name = object.id.as_deref().unwrap_or(&object.plugin);
            library.warn(location, &format!("\"{name}\" is not used: nothing refers to it"));
        }
    }
}

fn without_sensor(root: &Object) -> Error {
    let remedy = match root.location.position {
        Position::Text { .. } => "add <sensor type=\"perspective\">...</sensor>",
        Position::Path(_) => "add \"camera\": {\"type\": \"perspective\", ...}",
    };
    Error::new(&root.location, "a sensor in the scene", "none", remedy)
}

pub(super) fn only_one(second: &Child<'_>, what: &str) -> Error {
    Error::new(second.location, format!("one {what}"), format!("a second {what}"), "remove one of them")
}

/// The camera with its film.
struct View {
    sensor: Sensor,
    film: Film,
    samples_per_pixel: u64,
    medium: Option<MediumIndex>,
}

/// An emitter as the file places it.
struct Placed<'a> {
    emitter: Emitter,
    shape: Option<u32>,
    /// The medium that the file says it stands in.
    stated: Option<MediumIndex>,
    location: &'a Location,
}

struct Builder<'a> {
    library: &'a Library,
    recentre: DVec3,
    shapes: Vec<Shape>,
    surfaces: Vec<Surface>,
    bsdfs: Vec<Bsdf>,
    bsdf_index: HashMap<*const Object, u32>,
    media: Vec<Homogeneous>,
    medium_names: Vec<String>,
    medium_index: HashMap<*const Object, MediumIndex>,
    emitters: Vec<Placed<'a>>,
    /// BSDF of shapes that name none: diffuse 0.5, and black on emitters.
    default_bsdf: [Option<u32>; 2],
}

impl<'a> Builder<'a> {
    fn new(library: &'a Library, recentre: DVec3) -> Self {
        Self {
            library,
            recentre,
            shapes: Vec::new(),
            surfaces: Vec::new(),
            bsdfs: Vec::new(),
            bsdf_index: HashMap::new(),
            media: vec![Homogeneous::vacuum()],
            medium_names: Vec::new(),
            medium_index: HashMap::new(),
            emitters: Vec::new(),
            default_bsdf: [None; 2],
        }
    }

    fn shape(&mut self, child: &Child<'a>) -> Result<()> {
        let params = Params::new(child.object, self.library);
        let shape = shape::build(&params, self.recentre)?;
        let boundary = self.boundary(&params)?;
        let index = self.shapes.len() as u32;
        let emitter = self.shape_emitter(&params, index)?;
        let bsdfs = params.children(|child| bsdf::ROWS.iter().any(|row| row.name == child.object.plugin))?;
        let bsdf = match bsdfs.as_slice() {
            [] => self.default_bsdf(emitter.is_some())?,
            [one] => self.bsdf(one.object)?,
            [_, second, ..] => return Err(only_one(second, "bsdf")),
        };
        params.finish()?;
        self.shapes.push(shape);
        self.surfaces.push(Surface { bsdf, emitter, boundary, touching: false });
        Ok(())
    }

    fn boundary(&mut self, params: &Params<'a>) -> Result<Option<Boundary>> {
        let interior = params.child("interior")?.map(|child| self.medium(child.object)).transpose()?;
        let exterior = params.child("exterior")?.map(|child| self.medium(child.object)).transpose()?;
        if interior.is_none() && exterior.is_none() {
            return Ok(None);
        }
        let side = |medium: Option<MediumIndex>| medium.unwrap_or(MediumIndex::VACUUM);
        Ok(Some(Boundary { interior: side(interior), exterior: side(exterior) }))
    }

    fn shape_emitter(&mut self, params: &Params<'a>, shape: u32) -> Result<Option<u32>> {
        let emitters = params.children(|child| emitter::is_emitter(child.object))?;
        let child = match emitters.as_slice() {
            [] => return Ok(None),
            [one] => one,
            [_, second, ..] => return Err(only_one(second, "emitter")),
        };
        let emitter = emitter::build(child.object, self.library)?;
        if !emitter.needs_shape() {
            let found = format!("\"{}\"", child.object.plugin);
            let remedy = "put it beside the shapes, in the scene itself";
            return Err(Error::new(child.location, "an area emitter on a shape", found, remedy));
        }
        let stated = self.stated_medium(&Params::new(child.object, self.library))?;
        self.emitters.push(Placed { emitter, shape: Some(shape), stated, location: child.location });
        Ok(Some(self.emitters.len() as u32 - 1))
    }

    fn emitter(&mut self, child: &Child<'a>) -> Result<()> {
        let emitter = emitter::build(child.object, self.library)?;
        if emitter.needs_shape() {
            let expected = format!("the {} emitter on a shape", emitter.name);
            let remedy = "put it inside the shape that emits";
            return Err(Error::new(child.location, expected, "one in the scene", remedy));
        }
        if emitter.is_environment() && self.emitters.iter().any(|other| other.emitter.is_environment()) {
            return Err(only_one(child, "environment"));
        }
        let stated = self.stated_medium(&Params::new(child.object, self.library))?;
        self.emitters.push(Placed { emitter, shape: None, stated, location: child.location });
        Ok(())
    }

    fn bsdf(&mut self, object: &'a Object) -> Result<u32> {
        if let Some(index) = self.bsdf_index.get(&std::ptr::from_ref(object)) {
            return Ok(*index);
        }
        let index = self.add_bsdf(bsdf::build(object, self.library)?);
        self.bsdf_index.insert(std::ptr::from_ref(object), index);
        Ok(index)
    }

    fn add_bsdf(&mut self, bsdf: Bsdf) -> u32 {
        self.bsdfs.push(bsdf);
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
        let index = self.add_bsdf(bsdf::build(&object, self.library)?);
        self.default_bsdf[usize::from(emits)] = Some(index);
        Ok(index)
    }

    fn medium(&mut self, object: &'a Object) -> Result<MediumIndex> {
        if let Some(index) = self.medium_index.get(&std::ptr::from_ref(object)) {
            return Ok(*index);
        }
        let index = MediumIndex(self.media.len() as u32);
        self.media.push(medium::build(object, self.library)?);
        self.medium_names.push(object.id.clone().unwrap_or_else(|| object.plugin.clone()));
        self.medium_index.insert(std::ptr::from_ref(object), index);
        Ok(index)
    }

    /// The medium that a camera or emitter says it stands in.
    fn stated_medium(&mut self, params: &Params<'a>) -> Result<Option<MediumIndex>> {
        match params.children(|child| medium::is_medium(child.object))?.as_slice() {
            [] => Ok(None),
            [one] => self.medium(one.object).map(Some),
            [_, second, ..] => Err(only_one(second, "medium")),
        }
    }

    fn view(&mut self, object: &'a Object, overrides: Overrides) -> Result<View> {
        let params = Params::new(object, self.library);
        let film = match params.children(film::is_film)?.as_slice() {
            [] => film::default(overrides),
            [one] => film::build(one.object, self.library, overrides)?,
            [_, second, ..] => return Err(only_one(second, "film")),
        };
        let samples_per_pixel = match params.children(|child| is_sampler(child.object))?.as_slice() {
            [] => 4,
            [one] => sampler(one.object, self.library)?,
            [_, second, ..] => return Err(only_one(second, "sampler")),
        };
        let medium = self.stated_medium(&params)?;
        let crop = Crop { film: film.window.full_size, offset: film.window.offset };
        let sensor = sensor::build(&params, self.recentre, crop)?;
        params.finish()?;
        Ok(View { sensor, film, samples_per_pixel, medium })
    }

    /// Indexes the geometry and finds out which medium the camera and every emitter lie in.
    fn finish(
        mut self,
        sensor: Sensor,
        stated: Option<MediumIndex>,
        sensor_location: &Location,
    ) -> Result<Scene> {
        let geometry = Geometry::build(self.shapes);
        let touching = boundary::touching(&geometry, &self.surfaces);
        self.surfaces.iter_mut().zip(touching).for_each(|(surface, touching)| surface.touching = touching);
        let finder = Finder { geometry: &geometry, surfaces: &self.surfaces, library: self.library };
        let ambient = stated.unwrap_or(MediumIndex::VACUUM);
        let sensor_medium = match stated {
            Some(medium) => medium,
            None => finder.around(sensor.position(), ambient, sensor_location, "the camera"),
        };
        let recentre = self.recentre;
        let lights = self.emitters.into_iter().map(|Placed { emitter, shape, stated, location }| {
            let position = emitter.position().map(|position| (position - recentre).as_vec3());
            let straddles = stated.is_none() && shape.is_some_and(|shape| finder.straddles(shape));
            let medium = match (stated, shape, position) {
                (Some(medium), ..) => medium,
                (None, Some(shape), _) if !straddles => finder.in_front_of(shape, sensor_medium, location),
                (None, None, Some(position)) => {
                    finder.around(position, sensor_medium, location, "an emitter")
                }
                _ => finder.far_outside(sensor_medium),
            };
            Light { emitter, position: position.unwrap_or(Vec3::ZERO), shape, medium, straddles }
        });
        let lights: Vec<Light> = lights.collect();
        let outside = self.media[finder.far_outside(sensor_medium).0 as usize].sigma_t;
        let lane = |sigma_t: f32| if sigma_t > 0.0 { 0.0 } else { 1.0 };
        let from_infinity = Spectrum::new(lane(outside.x), lane(outside.y), lane(outside.z));
        let lights = Lights::new(lights, &geometry, from_infinity);
        Ok(Scene {
            lights,
            geometry,
            surfaces: self.surfaces,
            bsdfs: self.bsdfs,
            media: self.media,
            sensor,
            sensor_medium,
            recentre,
        })
    }
}

/// Points of an emitting shape that are asked whether they lie in one medium.
const POINTS_ASKED: u32 = 256;

/// Finds the media of points, with a warning where the shapes contradict each other.
struct Finder<'a> {
    geometry: &'a Geometry,
    surfaces: &'a [Surface],
    library: &'a Library,
}

impl Finder<'_> {
    fn around(&self, point: Vec3, ambient: MediumIndex, location: &Location, what: &str) -> MediumIndex {
        match boundary::medium_at(self.geometry, self.surfaces, point) {
            Found::Nothing => ambient,
            Found::Medium(medium) => medium,
            Found::Ambiguous(medium) => {
                let text = format!(
                    "rays from {what} meet boundaries of different media; the most frequent one is taken. \
                     Close the shapes that bound media, or name the medium of the camera in its description"
                );
                self.library.warn(location, &text);
                medium
            }
        }
    }

    /// The medium on the emitting side of a shape: the shape's own exterior, else that around points on it.
    fn in_front_of(&self, shape: u32, ambient: MediumIndex, location: &Location) -> MediumIndex {
        if let Some(boundary) = self.surfaces[shape as usize].boundary {
            return boundary.exterior;
        }
        let mut stream =
            crate::sampling::Stream::new(0, u64::from(shape), 0, crate::sampling::stream::Purpose::Pilot);
        let point = self.geometry.sample_area(shape, &mut stream);
        let origin = offset::leave_surface(point.position, point.error, point.normal, point.shading.normal);
        self.around(origin, ambient, location, "an emitting shape")
    }

    /// True if rays from different points of an emitting shape start in different media.
    fn straddles(&self, shape: u32) -> bool {
        if self.surfaces[shape as usize].boundary.is_some() {
            return false;
        }
        let mut stream =
            crate::sampling::Stream::new(1, u64::from(shape), 0, crate::sampling::stream::Purpose::Pilot);
        let mut media = (0..POINTS_ASKED).map(|_| {
            let point = self.geometry.sample_area(shape, &mut stream);
            let towards = point.shading.normal;
            let origin = offset::leave_surface(point.position, point.error, point.normal, towards);
            boundary::ask(self.geometry, self.surfaces, origin, towards)
        });
        let first = media.next();
        media.any(|medium| Some(medium) != first)
    }

    /// The medium far from everything: in front of the first boundary on the way in from outside.
    fn far_outside(&self, ambient: MediumIndex) -> MediumIndex {
        let (low, high) = self.geometry.bounds();
        let (centre, size) = (0.5 * (low + high), (high - low).length().max(f32::MIN_POSITIVE));
        let from = |towards: Vec3| {
            boundary::ask(self.geometry, self.surfaces, centre - towards * (2.0 * size), towards)
        };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (axis + Vec3::splat(0.013)).normalize());
        axes.iter().flat_map(|axis| [*axis, -*axis]).find_map(from).unwrap_or(ambient)
    }
}

const SAMPLERS: [&str; 5] = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"];

fn is_sampler(object: &Object) -> bool {
    SAMPLERS.contains(&object.plugin.as_str())
}

fn sampler(object: &Object, library: &Library) -> Result<u64> {
    let params = Params::new(object, library);
    let count = params.integer("sample_count", 4)?;
    params.accept_unused(&["seed", "jitter", "strength"], "the sequence of random numbers is Tyndall's own");
    params.finish()?;
    if count >= 1 {
        return Ok(count as u64);
    }
    Err(params.complain("sample_count", "an integer >= 1", count.to_string()))
}
