//! Faces that touch, set apart before anything is traced.
//!
//! The right image of two faces in one place is the limit of a gap between them. Common sense gives the order along a
//! ray: faces of solids it leaves, the innermost first; faces that belong to no solid; faces of solids it enters, the
//! outermost first. Rays cannot find that order, as they step over whatever lies within the rounding of a hit. So the
//! gap is made. Solids shrink where they touch something, by a few hundred roundings of positions. Of two open faces,
//! the one to be met first moves. Everything else then sees an ordinary scene.
//!
//! Where that order does not decide, index-matched faces come first, then those that scatter and transmit, then
//! emitting, then opaque ones. Of two alike, the first in the file is nearer to the camera, with a warning.

mod pairs;

use crate::{
    math::{Bounds, DVec3, Vec3, offset::gamma},
    sampling::{Stream, stream::Purpose},
    shape::{Hit, Patch, Ray, Shape, ShapeModel as _},
};
use pairs::{Pair, pairs};
use std::{cell::OnceCell, collections::BTreeMap};

/// Moves put solids in new places; shapes nested deeper than this are not set apart.
const ROUNDS: usize = 16;

/// Order of faces in the same place: the lesser rank comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// Index-matched.
    Null,
    /// Scatters and lets light through.
    Transmitting,
    /// Emits, opaque.
    Emitting,
    /// Opaque.
    Opaque,
}

/// What contact needs to know of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Nature {
    /// Its place in the order.
    pub rank: Rank,
    /// Its BSDF: the order of two faces with the same one does not matter.
    pub bsdf: u32,
    /// It is seen from its front alone.
    pub one_sided: bool,
    /// It is a part of what bounds a solid, though not closed by itself.
    pub is_lid: bool,
}

impl Nature {
    fn is_opaque(self) -> bool {
        self.rank >= Rank::Emitting
    }
}

/// Two shapes whose faces touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The one that was moved, and the other.
    pub shapes: [u32; 2],
    /// The farthest that a face was moved (m).
    pub by: f64,
    /// Only the order of the file decides which of them comes first.
    pub is_tie: bool,
}

/// A move of one primitive along its patch's normal (m).
struct Move {
    shape: u32,
    primitive: usize,
    by: f64,
    other: u32,
    is_tie: bool,
}

/// What was set apart.
#[derive(Clone, Debug, Default)]
pub struct Apart {
    /// Pairs of shapes that touched.
    pub contacts: Vec<Contact>,
    /// Shapes that were moved, by number, as they were before.
    pub given: BTreeMap<u32, Shape>,
}

impl Apart {
    /// Sets faces of `shapes` apart that touch; positions are relative to the camera, those of `lamps` too.
    pub fn separate(&mut self, shapes: &mut [Shape], natures: &[Nature], lamps: &[Vec3]) {
        for _ in 0..ROUNDS {
            let moves: Vec<Move> = {
                let faces = Faces::new(shapes, natures);
                let found =
                    pairs(shapes, &faces.bounds, faces.farthest(lamps), &|pair| faces.closeness(pair));
                found.iter().filter_map(|pair| faces.order(pair)).collect()
            };
            if moves.is_empty() {
                return;
            }
            moves.iter().for_each(|made| self.note(made));
            self.apply(shapes, &moves);
        }
    }

    fn note(&mut self, made: &Move) {
        let (shapes, by) = ([made.shape, made.other], made.by.abs());
        match self.contacts.iter_mut().find(|contact| contact.shapes == shapes) {
            Some(contact) => contact.by = contact.by.max(by),
            None => self.contacts.push(Contact { shapes, by, is_tie: made.is_tie }),
        }
    }

    /// The farthest of all moves of a primitive counts.
    fn apply(&mut self, shapes: &mut [Shape], moves: &[Move]) {
        let mut by_shape: BTreeMap<u32, BTreeMap<usize, f64>> = BTreeMap::new();
        for Move { shape, primitive, by, .. } in moves {
            let farthest = by_shape.entry(*shape).or_default().entry(*primitive).or_insert(0.0);
            if by.abs() > farthest.abs() {
                *farthest = *by;
            }
        }
        for (shape, moves) in by_shape {
            let displaced = shapes[shape as usize].displaced(&moves);
            let given = std::mem::replace(&mut shapes[shape as usize], displaced);
            self.given.entry(shape).or_insert(given);
        }
    }
}

/// All faces.
struct Faces<'a> {
    shapes: &'a [Shape],
    natures: &'a [Nature],
    bounds: Vec<Bounds>,
    /// See [`Faces::solid`].
    solids: Vec<OnceCell<Option<f64>>>,
}

/// A face and the shape that it is a part of.
#[derive(Clone, Copy)]
struct Face<'a> {
    shape: u32,
    primitive: usize,
    patch: &'a Patch,
}

impl<'a> Faces<'a> {
    fn new(shapes: &'a [Shape], natures: &'a [Nature]) -> Self {
        let bounds = shapes.iter().map(Shape::bounds).collect();
        Self { shapes, natures, bounds, solids: vec![OnceCell::new(); shapes.len()] }
    }

    /// 1 where the normals of a solid's primitives point outwards as [`Shape::winding`] says, -1 where the shape is inside
    /// out; none where it bounds no solid.
    fn solid(&self, shape: u32) -> Option<f64> {
        let shape = shape as usize;
        *self.solids[shape].get_or_init(|| {
            let is_solid = self.natures[shape].is_lid || self.shapes[shape].is_solid();
            is_solid.then(|| self.shapes[shape].turn())
        })
    }

    /// The largest coordinate, per axis, that rays start from.
    fn farthest(&self, lamps: &[Vec3]) -> DVec3 {
        let lamps = lamps.iter().map(|lamp| lamp.abs().as_dvec3());
        self.bounds.iter().map(pairs::far).chain(lamps).fold(DVec3::ZERO, DVec3::max)
    }

    /// How near, relative to coordinates, faces of two shapes may come before rays step over one or meet them in the
    /// wrong order. Scattering faces need more: what lies behind one must not be taken for what lies before it. Ends of
    /// connections keep clear of a surface by half of this where the other end is three times as far away as these
    /// shapes.
    fn closeness(&self, shapes: [u32; 2]) -> f64 {
        let is_null = shapes.iter().any(|shape| self.natures[*shape as usize].rank == Rank::Null);
        f64::from(if is_null { gamma(32) } else { gamma(128) })
    }

    /// The move that puts a pair in order; none if it is in order, or if order makes no difference.
    fn order(&self, pair: &Pair) -> Option<Move> {
        let [a, b] = [0, 1].map(|i| Face {
            shape: pair.shapes[i],
            primitive: pair.primitives[i],
            patch: &pair.patches[i],
        });
        if !self.matters(a, b) {
            return None;
        }
        let [outward_a, outward_b] = [a, b].map(|face| self.outward(face));
        let same = facing(a, b);
        match (outward_a, outward_b) {
            (Some(outward), None) => Self::moved(pair, a, b, -outward, false),
            (None, Some(outward)) => Self::moved(pair, b, a, -outward, false),
            (Some(one), Some(other)) if one * other * same < 0.0 => {
                let (mover, still, outward) = if self.goes_first(a, b) { (a, b, one) } else { (b, a, other) };
                Self::moved(pair, mover, still, -outward, false)
            }
            (Some(one), Some(other)) => {
                let (inner, is_tie) = self.inner(a, b, one);
                let (mover, still, outward) = if inner { (a, b, one) } else { (b, a, other) };
                Self::moved(pair, mover, still, -outward, is_tie)
            }
            (None, None) => {
                let (mover, still) = if self.goes_first(a, b) { (a, b) } else { (b, a) };
                Self::moved(pair, mover, still, self.side_of_view(mover, still), self.is_tie(a, b))
            }
        }
    }

    /// `mover` is to lie beyond `still` by the pair's reach, on the side that `sign` times its normal points to.
    fn moved(pair: &Pair, mover: Face<'_>, still: Face<'_>, sign: f64, is_tie: bool) -> Option<Move> {
        // A quarter more, so that rounding does not make it touch again.
        let wanted = 1.25 * pair.reach;
        let height = sign * mover.patch.height_of(still.patch, pair.reach)?;
        let by = sign * (wanted + height);
        Some(Move { shape: mover.shape, primitive: mover.primitive, by, other: still.shape, is_tie })
    }

    fn nature(&self, face: Face<'_>) -> Nature {
        self.natures[face.shape as usize]
    }

    fn rank(&self, face: Face<'_>) -> Rank {
        self.nature(face).rank
    }

    /// Their order matters: light passes one of them, or both show the same side.
    fn matters(&self, a: Face<'_>, b: Face<'_>) -> bool {
        if !(self.nature(a).is_opaque() && self.nature(b).is_opaque()) {
            return true;
        }
        let [one, other] = [a, b].map(|face| self.shown_side(face));
        one.zip(other).is_none_or(|(one, other)| one * other * facing(a, b) > 0.0)
    }

    /// The visible side of an opaque face, as a sign of its patch's normal; none where both are.
    fn shown_side(&self, face: Face<'_>) -> Option<f64> {
        self.outward(face).or_else(|| self.nature(face).one_sided.then(|| self.front(face)))
    }

    /// 1 where the front of a face is where its patch's normal points, else -1.
    fn front(&self, face: Face<'_>) -> f64 {
        let shape = &self.shapes[face.shape as usize];
        let Some(normal) = face.patch.plane_normal() else {
            let point = shape.sample_area(&mut Stream::new(0, 0, 0, Purpose::Pilot));
            let Bounds { low, high } = self.bounds[face.shape as usize];
            let from_middle = point.position - 0.5 * (low + high);
            return f64::from(point.shading.normal.dot(from_middle)).signum();
        };
        let nowhere = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: 0.0 };
        let hit = Hit { t: 0.0, shape: 0, primitive: 0, u: 0.25, v: 0.25 };
        let point = shape.surface(face.primitive, &nowhere, &hit);
        point.shading.normal.as_dvec3().dot(normal).signum()
    }

    /// 1 where the patch's normal points out of the solid that a face bounds, -1 where into it; none for a face of no
    /// solid. The walls of a room are solid outside of it: walls that show their front, or that surround the camera.
    fn outward(&self, face: Face<'_>) -> Option<f64> {
        let outward = self.solid(face.shape)? * self.shapes[face.shape as usize].winding(face.primitive);
        if !self.nature(face).is_opaque() {
            return Some(outward);
        }
        if self.nature(face).one_sided {
            return Some(self.front(face));
        }
        let Bounds { low, high } = self.bounds[face.shape as usize];
        let is_room = low.cmplt(Vec3::ZERO).all() && high.cmpgt(Vec3::ZERO).all();
        Some(if is_room { -outward } else { outward })
    }

    /// Nothing but the file says which of two comes first, and they may look different.
    fn is_tie(&self, a: Face<'_>, b: Face<'_>) -> bool {
        let [one, other] = [a, b].map(|face| self.nature(face));
        let differ = one.bsdf != other.bsdf || one.rank == Rank::Emitting;
        one.rank == other.rank && one.rank > Rank::Null && differ
    }

    /// The lower rank, else the one that comes first in the file.
    fn goes_first(&self, a: Face<'_>, b: Face<'_>) -> bool {
        (self.rank(a), a.shape) < (self.rank(b), b.shape)
    }

    /// For faces of two solids that face the same way: whether `a` is the inner one, and whether only the file says so
    /// about faces that the camera may see. The normal of `a` times `outward` points outwards.
    fn inner(&self, a: Face<'_>, b: Face<'_>, outward: f64) -> (bool, bool) {
        let [a_in_b, b_in_a] = [(a, b), (b, a)].map(|(a, b)| self.is_within(a.shape, b.shape));
        if a_in_b != b_in_a {
            return (a_in_b, false);
        }
        let [one, other] = [self.rank(a), self.rank(b)];
        if one == Rank::Null || other == Rank::Null {
            return ((one, b.shape) < (other, a.shape), false);
        }
        let (point, normal) = a.patch.sample();
        let camera_is_outside = outward * normal.dot(-point) > 0.0;
        (self.goes_first(a, b) != camera_is_outside, camera_is_outside && self.is_tie(a, b))
    }

    /// True if the box of shape `a` lies within that of `b`, up to rounding.
    fn is_within(&self, a: u32, b: u32) -> bool {
        let [inner, outer] = [a, b].map(|shape| self.bounds[shape as usize]);
        let far = pairs::far(&self.bounds[a as usize]).max(pairs::far(&self.bounds[b as usize]));
        let slack = (far * f64::from(gamma(512))).as_vec3();
        outer.grown(slack).contains(inner)
    }

    /// Which way, along its normal, an open face `mover` lies before another: in front of an opaque one, else towards the
    /// camera.
    fn side_of_view(&self, mover: Face<'_>, still: Face<'_>) -> f64 {
        let Nature { one_sided, .. } = self.nature(still);
        if one_sided && self.nature(still).is_opaque() {
            return self.front(still) * facing(mover, still);
        }
        let (point, normal) = mover.patch.sample();
        if normal.dot(point) > 0.0 { -1.0 } else { 1.0 }
    }
}

/// 1 where the normals of both point the same way, else -1.
fn facing(a: Face<'_>, b: Face<'_>) -> f64 {
    match (a.patch.plane_normal(), b.patch.plane_normal()) {
        (Some(a), Some(b)) => a.dot(b).signum(),
        _ => 1.0,
    }
}
