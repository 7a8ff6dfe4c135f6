//! What measures one number along parallel rays: Mitsuba's `radiancemeter` and `distant`. Their films have one pixel.

use super::{ALL, Orthographic, Projection, SensorRay, Site, place_of};
use crate::{
    description::{Params, Table, params::Child, table},
    error::{Error, Result},
    math::{Bounds, DMat4, DVec3, Vec2, Vec3, warp},
    sampling::Stream,
    shape::{self, Shape, ShapeModel as _},
};
use std::f32::consts::FRAC_1_PI;

/// Parallel rays whose pixel is the image.
#[derive(Clone, Debug)]
pub struct Meter {
    /// The plugin name.
    pub(super) name: &'static str,
    extent: Extent,
    /// Over a rectangle, or with the middle of a disc and two half axes for its first pixel.
    parallel: Orthographic,
}

/// Where the rays start.
#[derive(Clone, Debug)]
enum Extent {
    /// All over a parallelogram.
    Rectangle,
    /// All over a disc or ellipse.
    Disc,
    /// At one point. No light subpath finds the one ray from there.
    Ray,
    /// In front of all points of a shape: as far from each as the one point is from the origin. Many rays may pass a point
    /// of the scene, so no light subpath is connected to them.
    Surface(Shape),
}

/// Parameters of `radiancemeter`.
pub(super) const RADIANCEMETER: Table = table! {
    "The radiance along one ray: along +z, before `to_world`. Its film has one pixel.";
    transform("to_world", "Where the ray starts, and its direction."),
    vector("origin", "m", Optional, "In place of `to_world`: where the ray starts."),
    vector("direction", "", Optional, "Where the ray goes, from `origin`.");
    ALL
};

/// Parameters of `distant`.
pub(super) const DISTANT: Table = table! {
    "The mean radiance along parallel rays from outside of the scene, along +z before `to_world`. Its film has one pixel.";
    transform("to_world", "Turns the direction."),
    vector("direction", "", Optional, "In place of `to_world`: where the rays go."),
    vector("target", "m", Said("all of the scene"), "A point, which one ray goes through, or a shape, which rays cover evenly by area."),
    nested("shape", Optional, "The `target`. It is not part of the scene.");
    ALL
};

/// Reads the parameters of a `radiancemeter`.
pub(super) fn radiancemeter(params: &Params<'_>, site: &Site<'_>) -> Result<Meter> {
    let origin = params.optional_vector("origin")?;
    let direction = direction(params)?;
    let place = params.transform("to_world")?.transform_point3(DVec3::ZERO);
    if params.has("origin") != params.has("direction") {
        let (expected, remedy) =
            ("origin and direction together", "add the other one, or place the ray by to_world");
        return Err(Error::new(params.location(), expected, "one of them", remedy));
    }
    let start = origin.unwrap_or(place) - site.recentre;
    Ok(Meter::new("radiancemeter", start, [DVec3::ZERO; 2], direction, Extent::Ray))
}

/// Reads the parameters of a `distant` sensor.
pub(super) fn distant(params: &Params<'_>, site: &Site<'_>) -> Result<Meter> {
    let direction = direction(params)?;
    let (middle, radius) = sphere_around(site.shapes);
    let ([middle, across, down], extent) =
        match params.children("shape", |child| shape::is_shape(child.object))?.as_slice() {
            [] => match params.optional_vector("target")? {
                Some(point) => ([point - site.recentre, DVec3::ZERO, DVec3::ZERO], Extent::Ray),
                None => {
                    let (x, y) = direction.any_orthonormal_pair();
                    // The disc touches the sphere in front.
                    ([middle + direction * radius, x * radius, y * radius], Extent::Disc)
                }
            },
            [target] => of_shape(target, params, direction, site)?,
            [_, second, ..] => {
                let remedy = "remove one of them";
                return Err(Error::new(second.location, "one target", "a second target", remedy));
            }
        };
    let start = middle - direction * (2.0 * radius);
    Ok(Meter::new("distant", start, [across, down], direction, extent))
}

impl Meter {
    /// Rays in unit `direction` from around `middle`, half `axes` far.
    fn new(name: &'static str, middle: DVec3, axes: [DVec3; 2], direction: DVec3, extent: Extent) -> Self {
        let [x, y] = axes;
        let (corner, steps) = match extent {
            Extent::Rectangle => (middle - x - y, [2.0 * x, 2.0 * y]),
            Extent::Disc => (middle, axes),
            // Any that can be inverted: the ray starts at the corner.
            Extent::Ray | Extent::Surface(_) => (middle, direction.any_orthonormal_pair().into()),
        };
        Self { name, extent, parallel: Orthographic::endless(corner, steps, direction) }
    }

    /// True if light subpaths can be connected to it.
    pub fn is_connectible(&self) -> bool {
        matches!(self.extent, Extent::Rectangle | Extent::Disc)
    }

    /// Some point that a ray starts at.
    pub fn position(&self) -> Vec3 {
        self.ray(Vec2::splat(0.5)).position
    }

    /// The ray through a film position in [0, 1).
    pub fn ray(&self, film: Vec2) -> SensorRay {
        let mut start = self.parallel.ray(match self.extent {
            Extent::Rectangle => film,
            Extent::Disc => warp::to_disk(film),
            Extent::Ray | Extent::Surface(_) => Vec2::ZERO,
        });
        if let Extent::Surface(shape) = &self.extent {
            let point = shape.sample_area(&mut Stream::of(film)).position;
            start.position += point;
            start.ray.origin += point;
        }
        SensorRay { pdf: self.pdf(start.pdf), ..start }
    }

    /// How `point` is seen; none where it lies behind or beside where rays start, or nothing can be connected.
    pub fn project(&self, point: Vec3) -> Option<Projection> {
        let seen = self.parallel.project(point)?;
        let film = match self.extent {
            Extent::Rectangle => seen.film,
            Extent::Disc if seen.film.length_squared() <= 1.0 => warp::from_disk(seen.film),
            Extent::Disc | Extent::Ray | Extent::Surface(_) => return None,
        };
        Some(Projection { film, pdf: self.pdf(seen.pdf), ..seen })
    }

    /// Pixels per area, which are `pdf` for the parallelogram of the steps.
    fn pdf(&self, pdf: f32) -> f32 {
        if matches!(self.extent, Extent::Disc) { pdf * FRAC_1_PI } else { pdf }
    }
}

/// Unit direction of sight.
fn direction(params: &Params<'_>) -> Result<DVec3> {
    let to_world = params.transform("to_world")?;
    let Some(direction) = params.optional_vector("direction")? else {
        return Ok(to_world.transform_vector3(DVec3::Z).normalize());
    };
    if params.has("to_world") {
        return Err(Error::new(params.location(), "direction or to_world", "both", "remove one of them"));
    }
    let found = || params.complain("direction", "a direction other than 0 0 0", "0 0 0");
    direction.try_normalize().ok_or_else(found)
}

/// The point that a `distant` sensor aims at, in the file's coordinates; none where that is all of the scene.
pub(super) fn target(params: &Params<'_>) -> Result<Option<DVec3>> {
    match params.children("shape", |child| shape::is_shape(child.object))?.first() {
        None => params.optional_vector("target"),
        Some(shape) => place_of(shape.object, params.library),
    }
}

/// Middle and half axes of a flat `target`, and what lies between them; those of other shapes are 0.
fn of_shape(
    target: &Child<'_>,
    params: &Params<'_>,
    direction: DVec3,
    site: &Site<'_>,
) -> Result<([DVec3; 3], Extent)> {
    if !shape::ROWS.has(target.object) {
        let (found, remedy) =
            (format!("a {}", target.object.plugin), "use one of the shapes in it, or a point");
        return Err(Error::new(target.location, "a target that is one shape", found, remedy));
    }
    let (given, build) = shape::ROWS.read(target.object, params.library)?;
    let to_scene = DMat4::from_translation(-site.recentre);
    // What else one of the scene has is read there.
    let (shape, place) = match site.places.get(&target.object.location) {
        Some(index) => (site.shapes[*index].clone(), to_scene * given.transform("to_world")?),
        None => {
            let shape = build(&given, to_scene)?;
            let place = to_scene * given.transform("to_world")?;
            given.finish()?;
            (shape, place)
        }
    };
    let extent = match target.object.plugin.as_str() {
        "rectangle" => Extent::Rectangle,
        "disk" => Extent::Disc,
        _ => return Ok(([DVec3::ZERO; 3], Extent::Surface(shape))),
    };
    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| place.transform_vector3(axis));
    if x.cross(y).normalize().dot(direction).abs() < EDGE_ON {
        let remedy = "turn it towards the rays";
        return Err(Error::new(target.location, "a target across the rays", "one along them", remedy));
    }
    Ok(([place.transform_point3(DVec3::ZERO), x, y], extent))
}

/// Cosine of the angle between a target and the rays below which it counts as along them.
const EDGE_ON: f64 = 1e-6;

/// Middle and radius of the sphere around the box around all `shapes` (m), as in Mitsuba.
fn sphere_around(shapes: &[Shape]) -> (DVec3, f64) {
    let Bounds { low, high } = shapes.iter().map(Shape::bounds).fold(Bounds::EMPTY, Bounds::union);
    if shapes.is_empty() {
        return (DVec3::ZERO, 1.0);
    }
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    (0.5 * (low + high), 0.5 * (high - low).length())
}
