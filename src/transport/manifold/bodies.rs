//! Smooth shapes, and the chains over them.

use super::{
    chain::{Chain, Link, Target},
    circle::{Course, Round},
    flats::{self, Plane, Way},
    tube::Tube,
};
use crate::{
    bsdf::{BsdfModel, Smooth},
    math::{DVec3, Vec3, measure},
    scene::Scene,
    shape::{
        Curved, CurvedModel as _, Flat, Hit, Patch, Primitive, Ray, Shape, ShapeModel as _, SurfacePoint,
    },
};

/// A smooth shape.
pub(super) struct Body {
    shape: u32,
    form: Form,
    /// Index of refraction inside over outside, for a single plane behind over before; none for a mirror.
    ratio: Option<f64>,
}

enum Form {
    /// A plane, or several that enclose something, whose normals point outwards.
    Flats(Vec<(Plane, Primitive)>),
    Ball {
        center: DVec3,
        radius: f64,
    },
    Tube(Tube),
}

impl Body {
    /// All smooth shapes of `scene` that are made of planes, balls or tubes.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        (0..scene.surfaces.len() as u32).filter_map(|shape| Self::of(scene, shape)).collect()
    }

    fn of(scene: &Scene, shape: u32) -> Option<Self> {
        let smooth = scene.bsdf(shape).smooth()?;
        let (form, turn) = Form::of(&scene.geometry.shapes()[shape as usize])?;
        let ratio = match smooth {
            Smooth::Mirror => None,
            Smooth::Interface(ratio) => Some(f64::from(ratio).powf(turn)),
        };
        Some(Self { shape, form, ratio })
    }

    /// Every chain of up to [`super::chain::MOST`] points over it `from` a point to a target.
    pub(super) fn chains(&self, from: DVec3, target: Target, found: &mut impl FnMut(&Chain)) {
        match &self.form {
            Form::Flats(flats) => self.over_flats(flats, from, target, found),
            Form::Ball { center, radius } => self.over_ball(*center, *radius, from, target, found),
            Form::Tube(tube) => self.over_tube(tube, from, target, found),
        }
    }

    fn over_flats(
        &self,
        flats: &[(Plane, Primitive)],
        from: DVec3,
        target: Target,
        found: &mut impl FnMut(&Chain),
    ) {
        for (number, (plane, _)) in flats.iter().enumerate() {
            let (here, there) = (plane.height(from), target.height(plane));
            let (index, next) = (self.index(here), self.index(there));
            let links = match (here * there > 0.0, self.ratio) {
                (true, _) => [(number, None)],
                (false, Some(_)) => [(number, Some(next / index))],
                (false, None) => continue,
            };
            let after = if links[0].1.is_some() { next } else { index };
            Self::over(flats, &links, &[index, after], from, target, found);
        }
        if let Some(ratio) = self.ratio.filter(|_| flats.len() > 1) {
            Self::across(flats, ratio, from, target, found);
        }
    }

    /// Chains that enter the body between the planes through one plane and leave it through another.
    fn across(
        flats: &[(Plane, Primitive)],
        ratio: f64,
        from: DVec3,
        target: Target,
        found: &mut impl FnMut(&Chain),
    ) {
        let all = || flats.iter().map(|(plane, _)| *plane).enumerate();
        let entries = all().filter(|(_, plane)| plane.height(from) > 0.0);
        let exits = || all().filter(|(_, plane)| target.height(plane) > 0.0);
        let pairs = entries.flat_map(|entry| exits().map(move |exit| (entry, exit)));
        for ((first, entry), (last, exit)) in pairs.filter(|((first, _), (last, _))| first != last) {
            let links = [(first, Some(ratio)), (last, Some(1.0 / ratio))];
            match target {
                Target::Point(_) => Self::over(flats, &links, &[1.0, ratio, 1.0], from, target, found),
                Target::Direction(direction) => {
                    let points = flats::between(from, [entry, exit], ratio, direction);
                    points.into_iter().for_each(|points| found(&chain_over(flats, &links, points)));
                }
            }
        }
    }

    /// The index of refraction at a `height` above a surface.
    fn index(&self, height: f64) -> f64 {
        if height < 0.0 { self.ratio.unwrap_or(1.0) } else { 1.0 }
    }

    /// The chain over these planes, given by their numbers, if there is one.
    fn over(
        flats: &[(Plane, Primitive)],
        links: &[(usize, Option<f64>)],
        indices: &[f64],
        from: DVec3,
        target: Target,
        found: &mut impl FnMut(&Chain),
    ) {
        let mut planes = [flats[0].0; 2];
        links.iter().zip(&mut planes).for_each(|((number, _), plane)| *plane = flats[*number].0);
        let way = Way { from, planes: &planes[..links.len()], indices, target };
        if let Some(points) = way.solve() {
            found(&chain_over(flats, links, points));
        }
    }

    fn over_ball(
        &self,
        center: DVec3,
        radius: f64,
        from: DVec3,
        target: Target,
        found: &mut impl FnMut(&Chain),
    ) {
        let inside = self.ratio.unwrap_or(1.0);
        let (start, to) = (from - center, target.relative_to(center));
        let sides = [start.length() < radius, to.is_within(radius)].map(|inside| [!inside, inside]);
        for course in Course::all(sides, self.ratio.is_some()) {
            let Some(round) = Round::new(radius, start, to, course) else { continue };
            let flight = |place: f64| round.fly(round.begin(place), inside);
            round.ways(flight, &mut |_, flight| {
                let link = |(number, point): (usize, &DVec3)| Link {
                    position: *point + center,
                    normal: *point / radius,
                    curvature: 1.0 / radius,
                    axis: DVec3::ZERO,
                    ratio: course.refracts(number, inside),
                    primitive: 0,
                };
                let points = round.points(flight);
                let links = points[..course.meetings].iter().enumerate().map(link);
                found(&Chain::new(&links.collect::<Vec<_>>()));
            });
        }
    }

    fn over_tube(&self, tube: &Tube, from: DVec3, target: Target, found: &mut impl FnMut(&Chain)) {
        tube.solve(self.ratio, from, target, &mut |course, points| {
            let link = |(number, position): (usize, &DVec3)| Link {
                position: *position,
                normal: tube.normal(*position),
                curvature: 1.0 / tube.radius,
                axis: tube.axis,
                ratio: course.refracts(number, self.ratio.unwrap_or(1.0)),
                primitive: 0,
            };
            found(&Chain::new(&points.iter().enumerate().map(link).collect::<Vec<_>>()));
        });
    }

    /// The surface where a ray from `origin` comes to a link; none where there is nothing of the plane.
    pub(super) fn surface(&self, scene: &Scene, link: &Link, origin: Vec3) -> Option<SurfacePoint> {
        let (direction, t, _) = measure::between(origin, link.position.as_vec3())?;
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        let [t, u, v] = match &self.form {
            Form::Ball { .. } | Form::Tube(_) => [t, 0.0, 0.0],
            Form::Flats(flats) => match &flats[link.primitive].1 {
                Primitive::Flat(flat) => {
                    let [u, v] = within(flat, link.position)?;
                    [t, u, v]
                }
                Primitive::Curved(curved) => curved.closest(&ray, f32::INFINITY)?,
                Primitive::Ball { .. } => return None,
            },
        };
        let shape = &scene.geometry.shapes()[self.shape as usize];
        let point =
            shape.surface(link.primitive, &ray, &Hit { t, shape: 0, primitive: link.primitive as u32, u, v });
        Some(SurfacePoint { shape: self.shape, ..point })
    }
}

/// The chain over planes, by their numbers, with what happens there, through these points.
fn chain_over(flats: &[(Plane, Primitive)], links: &[(usize, Option<f64>)], points: [DVec3; 2]) -> Chain {
    let link = |((number, ratio), position): (&(usize, Option<f64>), DVec3)| Link {
        position,
        normal: flats[*number].0.normal,
        curvature: 0.0,
        axis: DVec3::ZERO,
        ratio: *ratio,
        primitive: *number,
    };
    Chain::new(&links.iter().zip(points).map(link).collect::<Vec<_>>())
}

/// The coordinates of a point that lies on a parallelogram.
fn within(flat: &Flat, point: DVec3) -> Option<[f32; 2]> {
    let at = flat.coordinates(point);
    at.iter()
        .all(|coordinate| (0.0..=1.0).contains(coordinate))
        .then(|| at.map(|coordinate| coordinate as f32))
}

impl Form {
    /// The form of a shape, and 1 where its shading normals point outwards, else -1; none for other shapes.
    fn of(shape: &Shape) -> Option<(Self, f64)> {
        match shape {
            Shape::Parallelograms(_) | Shape::Disk(_) => {
                let flats = (0..shape.primitive_count()).map(|number| plane(shape, number));
                flats.collect::<Option<_>>().map(Self::of_flats)
            }
            Shape::Sphere(sphere) => {
                let Primitive::Ball { center, radius } = shape.primitive(0) else { return None };
                let above = center + Vec3::Z * radius;
                let turn = f64::from(sphere.point_near(above).shading.normal.z.signum());
                Some((Self::Ball { center: center.as_dvec3(), radius: f64::from(radius) }, turn))
            }
            Shape::Cylinder(cylinder) => {
                let Patch::Tube { ends: [base, end], radius } = cylinder.patch() else { return None };
                let (axis, length) = ((end - base).try_normalize()?, end.distance(base));
                let tube = Tube { base, axis, length, radius };
                let beside = base + axis.any_orthonormal_vector() * radius;
                let shading = cylinder.point_near(beside).shading.normal.as_dvec3();
                Some((Self::Tube(tube), shading.dot(tube.normal(beside)).signum()))
            }
            Shape::Mesh(_) | Shape::Instance(_) => None,
        }
    }

    /// Of planes that enclose something, about a point of it; of a single plane, outwards is where it faces.
    fn of_flats(flats: Vec<(Plane, Primitive)>) -> (Self, f64) {
        let middle = flats.iter().map(|(plane, _)| plane.origin).sum::<DVec3>() / flats.len() as f64;
        let is_inside_out = flats.len() > 1 && flats[0].0.height(middle) > 0.0;
        let turn = if is_inside_out { -1.0 } else { 1.0 };
        let outwards = |(plane, primitive): (Plane, Primitive)| {
            (Plane::new(plane.origin, plane.normal * turn), primitive)
        };
        (Self::Flats(flats.into_iter().map(outwards).collect()), turn)
    }
}

/// The plane of a primitive through the middle of that, on the side of the shading normal, and the primitive itself.
fn plane(shape: &Shape, number: usize) -> Option<(Plane, Primitive)> {
    let primitive = shape.primitive(number);
    let flat = match &primitive {
        Primitive::Flat(flat) => *flat,
        Primitive::Curved(Curved::Disk(disk)) => disk.square(),
        _ => return None,
    };
    let ray = Ray { origin: flat.corner, direction: flat.normal, t_max: f32::INFINITY };
    let shading =
        shape.surface(number, &ray, &Hit { t: 0.0, shape: 0, primitive: 0, u: 0.0, v: 0.0 }).shading.normal;
    let [u, v] = [flat.edge_u, flat.edge_v].map(|edge| edge.as_dvec3());
    let normal = u.cross(v).normalize();
    let normal = normal * normal.dot(shading.as_dvec3()).signum();
    Some((Plane::new(flat.corner.as_dvec3() + (u + v) * 0.5, normal), primitive))
}

impl Target {
    /// The signed distance above a plane; of a direction, its rise.
    fn height(self, plane: &Plane) -> f64 {
        match self {
            Self::Point(point) => plane.height(point),
            Self::Direction(direction) => direction.dot(plane.normal),
        }
    }

    fn is_within(self, radius: f64) -> bool {
        matches!(self, Self::Point(point) if point.length() < radius)
    }
}
