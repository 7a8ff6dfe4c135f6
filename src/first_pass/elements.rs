//! The elements of a scene: points of its surfaces and media, in one hierarchy.

use super::{
    point::Point,
    scattering::{self, BINS, Element},
};
use crate::{
    bsdf::BsdfModel as _,
    emitter::{Kind, SurfaceModel as _},
    guide::{
        distribution::{Bins, Distribution},
        hierarchy::{Hierarchy, Node, Sample},
        links::Aim,
    },
    math::{Bounds, Frame, Spectrum, SpectrumExt, Vec3, vec3},
    medium::MediumIndex,
    sampling::{Stream, stream::Purpose},
    scene::{Scene, media::Boundary},
    shape::SurfacePoint,
    transport::{Interaction, profiles::Everything},
};
use rayon::prelude::*;

/// Seed of the random numbers that choose points.
const SEED: u64 = 0x656c_656d_656e_7473;
/// Points of an element, on average; each has at least half as many.
const PER_ELEMENT: usize = 32;
/// Candidate points in a medium's box per point that is kept; more are kept where the medium is dense.
const CANDIDATES: usize = 2;
/// Extinction assumed for media that emit without any (1/m).
const LEAST_EXTINCTION: f32 = 1e-6;
/// Length of the mean normal from which on an element faces one way.
const FLAT: f32 = 0.98;
/// Least half edge of a box, over its longest edge.
const THICKNESS: f32 = 0.01;
/// Factor by which boxes are larger than those around their points.
const WIDENED: f32 = 1.2;
/// A place in a medium belongs to an element at most this many radii away.
const REACH: f32 = 4.0;

/// All elements, and the points that stand for them.
pub(super) struct Elements {
    pub hierarchy: Hierarchy,
    /// In the order of the hierarchy.
    pub points: Vec<Point>,
    /// Cumulative sums of the measures of points (m^2).
    sums: Vec<f64>,
    pub all: Vec<Element>,
    /// The bins of the light that each node sends.
    pub bins: Vec<Bins>,
}

impl Elements {
    /// About `number` elements of surfaces, and as many of media.
    pub(super) fn of(scene: &Scene, number: usize) -> Self {
        let mut known = on_surfaces(scene, number * PER_ELEMENT);
        known.extend(in_media(scene, number * PER_ELEMENT));
        let samples: Vec<Sample> = known.iter().map(|(_, sample)| *sample).collect();
        let (hierarchy, order) = Hierarchy::of(&samples, PER_ELEMENT as f64);
        let points: Vec<Point> = order.iter().map(|index| known[*index as usize].0).collect();
        let phases = scattering::phases(scene);
        let element = |node: &u32| {
            let own = hierarchy.nodes[*node as usize].points.clone();
            Element::of(scene, &points[own.start as usize..own.end as usize], &phases)
        };
        let all: Vec<Element> = hierarchy.elements.par_iter().map(element).collect();
        let bins = bins(&hierarchy, &all);
        let measures = order.iter().map(|index| samples[*index as usize].measure.luminance());
        let sums = measures.scan(0.0, |sum, measure| {
            *sum += f64::from(measure);
            Some(*sum)
        });
        let sums = sums.collect();
        Self { hierarchy, points, sums, all, bins }
    }

    /// One of the points of a node, for `u` in [0, 1), in proportion to their measures.
    pub(super) fn pick(&self, node: u32, u: f64) -> &Point {
        let own = &self.hierarchy.nodes[node as usize].points;
        let (first, last) = (own.start as usize, own.end as usize - 1);
        let before = if first == 0 { 0.0 } else { self.sums[first - 1] };
        let at = before + u * (self.sums[last] - before);
        let within = self.sums[first..last].partition_point(|sum| *sum <= at);
        &self.points[first + within]
    }

    /// The box around a node, along its surface where it faces one way.
    pub(super) fn aim(&self, node: u32) -> Aim {
        let points = self.points(node);
        let facing: Vec3 =
            points.iter().filter_map(|point| point.interaction.normal()).sum::<Vec3>() / points.len() as f32;
        let frame = Frame::around(if facing.length() > FLAT { facing.normalize() } else { Vec3::Z });
        let local = points.iter().map(|point| Bounds::of(frame.to_local(point.interaction.position())));
        let around = local.fold(Bounds::EMPTY, Bounds::union);
        let size = around.size();
        // Points lie within what they stand for.
        let half = (0.5 * size).max(Vec3::splat(THICKNESS * size.max_element())) * WIDENED;
        let centre = frame.to_world(0.5 * (around.low + around.high));
        Aim { centre, frame, half: half.max(Vec3::splat(f32::MIN_POSITIVE)), probability: 1.0 }
    }

    /// The power that each element sends by its radiance (W), as luminance.
    pub(super) fn powers(&self, sent: &[Distribution]) -> Vec<f32> {
        let nodes = self.hierarchy.elements.iter().map(|node| &self.hierarchy.nodes[*node as usize]);
        let power = |(node, sent): (&Node, &Distribution)| {
            (sent.sum() * node.measure).luminance() * sent.bins.angle()
        };
        nodes.zip(sent).map(power).collect()
    }

    /// The power of all elements together (W).
    pub(super) fn power(&self, sent: &[Distribution]) -> f32 {
        self.powers(sent).iter().sum()
    }

    /// The element of a place; none beyond all elements: endless fog has elements near the scene alone.
    pub(super) fn at(&self, place: &Interaction) -> Option<u32> {
        let element = self.hierarchy.element(place.position(), place.normal())?;
        let node = self.hierarchy.node(element);
        let within = place.position().distance(node.centre()) <= REACH * node.radius();
        (within || place.normal().is_some()).then_some(element)
    }

    /// True if an element receives light that comes to a place from unit `towards`.
    pub(super) fn receives(&self, scene: &Scene, place: &Interaction, towards: Vec3) -> bool {
        let is_dark = match place {
            Interaction::Surface(point) => brightness(scene, point, towards) == 0.0,
            Interaction::Medium(..) => false,
        };
        !is_dark && place.is_connectible(scene) && self.at(place).is_some()
    }

    /// The points that stand for a node.
    pub(super) fn points(&self, node: u32) -> &[Point] {
        let own = &self.hierarchy.nodes[node as usize].points;
        &self.points[own.start as usize..own.end as usize]
    }
}

/// The bins of all nodes. A cluster has the bins of its parts if these are alike; surfaces that face one way count as
/// one.
fn bins(hierarchy: &Hierarchy, all: &[Element]) -> Vec<Bins> {
    let mut found = vec![Bins::Equal(BINS); hierarchy.nodes.len()];
    for (index, node) in hierarchy.nodes.iter().enumerate().rev() {
        let Some(parts) = node.parts else {
            found[index] = all[node.elements.start as usize].source.bins;
            continue;
        };
        found[index] = match parts.map(|part| found[part as usize]) {
            [Bins::Sides(a), Bins::Sides(b)] => {
                let [whole, other] = parts.map(|part| hierarchy.nodes[part as usize].measure.x);
                let mean = (a * whole + b * other) / (whole + other);
                if mean.length() > FLAT { Bins::Sides(mean.normalize()) } else { Bins::Equal(BINS) }
            }
            [Bins::Equal(1), Bins::Equal(1)] => Bins::Equal(1),
            _ => Bins::Equal(BINS),
        };
    }
    found
}

/// About `number` points of all surfaces that reflect or emit: half of them by area, half as many of each shape.
fn on_surfaces(scene: &Scene, number: usize) -> Vec<(Point, Sample)> {
    let is_seen = |shape: &u32| {
        let surface = scene.surface(*shape);
        (surface.connectible || surface.emitter.is_some()) && scene.geometry.area(*shape) > 0.0
    };
    let shapes: Vec<u32> = (0..scene.surfaces.len() as u32).filter(is_seen).collect();
    let all: f32 = shapes.iter().map(|shape| scene.geometry.area(*shape)).sum();
    let of_shape = |shape: &u32| {
        let area = scene.geometry.area(*shape);
        let share = 0.5 / shapes.len() as f32 + 0.5 * area / all;
        let count = ((number as f32 * share) as u64).max(PER_ELEMENT as u64);
        let shape = *shape;
        (0..count).into_par_iter().map(move |index| {
            let mut stream = Stream::sobol(SEED, u64::from(shape), index, Purpose::Study);
            on_surface(scene, scene.geometry.sample_area(shape, &mut stream), area / count as f32)
        })
    };
    shapes.par_iter().flat_map(of_shape).collect()
}

/// Luminance that a point of a shape sends in unit `direction`: reflected from uniform unit radiance, and emitted.
fn brightness(scene: &Scene, point: &SurfacePoint, direction: Vec3) -> f32 {
    let wi = point.shading.to_local(direction);
    let albedo = scene.at(point, |bsdf, uv| bsdf.albedo(uv, wi));
    (albedo + emitted(scene, point, direction)).luminance()
}

fn on_surface(scene: &Scene, point: SurfacePoint, area: f32) -> (Point, Sample) {
    let sides = [1.0, -1.0].map(|side| brightness(scene, &point, side * point.normal));
    let sample = Sample {
        position: point.position,
        normal: Some(point.normal),
        measure: Spectrum::splat(area),
        value: kind(sides[0] + sides[1]),
    };
    (Point::on(scene, point, sides.map(|side| side > 0.0)), sample)
}

/// An amount that elements should not mix, in steps of about a fifth: values that differ by rounding alone are equal.
pub(super) fn kind(amount: f32) -> f32 {
    (4.0 * amount.max(f32::MIN_POSITIVE).log2()).round()
}

/// Radiance that leaves a point of a shape in unit `direction` (W/(m^2 sr)).
pub(super) fn emitted(scene: &Scene, point: &SurfacePoint, direction: Vec3) -> Spectrum {
    let Some(light) = scene.surface(point.shape).emitter else { return Spectrum::ZERO };
    let Kind::Surface(surface) = &scene.lights.all[light as usize].emitter.kind else {
        return Spectrum::ZERO;
    };
    surface.radiance(point.uv, point.front().dot(direction))
}

/// Points of all media, about `number` together.
fn in_media(scene: &Scene, number: usize) -> Vec<(Point, Sample)> {
    let count = scene.media_map.overlaps.as_ref().map_or(scene.media.len(), |overlaps| overlaps.media());
    let media: Vec<(MediumIndex, Bounds)> = (1..count as u32)
        .map(MediumIndex)
        .filter_map(|medium| Some((medium, extent(scene, medium)?)))
        .collect();
    let number = number / media.len().max(1);
    media.into_iter().flat_map(|(medium, within)| in_medium(scene, medium, within, number)).collect()
}

/// The box that `medium` is in; none where that is nothing, or has no end.
fn extent(scene: &Scene, medium: MediumIndex) -> Option<Bounds> {
    let of = |side: fn(&Boundary) -> Option<MediumIndex>| {
        let surfaces = scene.surfaces.iter().zip(scene.geometry.shapes());
        surfaces.filter(move |(surface, _)| side(&surface.boundary) == Some(medium))
    };
    let inside = of(|boundary| boundary.interior).map(|(_, shape)| shape.bounds()).reduce(Bounds::union);
    let is_around = of(|boundary| boundary.exterior).next().is_some() || inside.is_none();
    let shapes = if is_around { scene.bounds() } else { inside? };
    let bounds = match scene.media[medium.0 as usize].extent() {
        Some(own) if shapes.is_finite() => own.common(shapes)?,
        Some(own) => own,
        None => shapes,
    };
    (bounds.is_finite() && bounds.size().min_element() > 0.0).then_some(bounds)
}

/// About `number` points in `medium`, chosen from uniform points of a box: more where it is denser.
fn in_medium(scene: &Scene, medium: MediumIndex, within: Bounds, number: usize) -> Vec<(Point, Sample)> {
    let candidates = CANDIDATES * number;
    let emission = scene.lights.of_medium(medium).map(|(_, emission)| emission);
    let find = |index: u64| {
        let mut stream = Stream::sobol(SEED, u64::from(medium.0), index, Purpose::Pilot);
        let at = vec3(stream.uniform(), stream.uniform(), stream.uniform());
        let position = within.low + within.size() * at;
        let there = scene.medium_at(position)?;
        let mut found = scene.media[medium.0 as usize].properties_at::<Everything>(0, position);
        let emits = emission.is_some_and(|emission| emission.at(position).max_element() > 0.0);
        if emits {
            found.sigma_t = found.sigma_t.max(Spectrum::splat(LEAST_EXTINCTION));
        }
        let holds = scene.components(&there).contains(&medium) && found.sigma_t.max_element() > 0.0;
        holds.then_some((Point::within(position, found, there), found.sigma_t))
    };
    let found: Vec<(Point, Spectrum)> = (0..candidates as u64).into_par_iter().filter_map(find).collect();
    let mean = found.iter().map(|(_, sigma_t)| sigma_t.luminance()).sum::<f32>() / found.len().max(1) as f32;
    let volume = within.size().element_product() / candidates as f32;
    let (mut due, each) = (0.5, number as f32 / found.len().max(1) as f32);
    let mut kept = Vec::new();
    for (point, sigma_t) in found {
        // Half of the points by the mean density, half by their own.
        let chance = (0.5 * each * (1.0 + sigma_t.luminance() / mean)).min(1.0);
        due += chance;
        if due >= 1.0 {
            due -= 1.0;
            kept.push((point, point.sample(sigma_t * (volume / chance), kind(sigma_t.max_element()))));
        }
    }
    kept
}
