//! Specular microflakes whose normals are distributed as those of an ellipsoid (Heitz et al. 2015, "The SGGX microflake
//! distribution"): Mitsuba's `sggx`.
//!
//! The flakes show an area of sqrt(w S w) to light that flies in direction w, per unit of extinction: the medium has that
//! factor on its extinction ([`crate::medium::Medium::area`]). With S = B^T B, the linear map B takes the ellipsoid to a
//! sphere. Shares of what is seen of it stay the same, so that its visible normals are those of the sphere taken back.

use super::{Deflection, PhaseModel};
use crate::{
    description::{Location, Params, Table, table},
    error::{Error, Result},
    math::{DMat3, DVec3, Frame, Mat3, Vec3, warp},
    sampling::Stream,
    volume::{Place, Sixfold},
};
use std::{f64::consts::PI, sync::Arc};

/// Flakes, of one distribution everywhere or of one that varies. What does not ask for a position sees the distribution of
/// the mean of all matrices.
#[derive(Clone, Debug)]
pub struct Sggx {
    mean: Arc<Ellipsoid>,
    varying: Option<Arc<Varying>>,
}

#[derive(Clone, Copy, Debug)]
struct Ellipsoid {
    /// Square root of the largest number on the diagonal of S; 0 where there are no flakes.
    size: f32,
    /// B over that: any, where it is 0.
    root: Mat3,
    /// The inverse of its transpose: normals of unit length to where S^-1 is the squared length.
    inverse: Mat3,
    /// A quarter of the density of normals (1/sr) where that is 1.
    quarter: f32,
}

/// A matrix for every position.
#[derive(Debug)]
struct Varying {
    grid: Sixfold,
    /// What instances do to areas.
    turn: DMat3,
    /// Bounds of the area shown anywhere over the mean's in the same direction.
    shares: [f32; 2],
}

/// The largest number on the diagonal of S, from the first to the second; the thinnest flakes, of which single precision
/// can tell normals apart, have the third of that as the square of their thickness.
const RANGE: [f64; 3] = [1e-12, 1e12, 1e-8];

/// The same for means of matrices within the range and of zeros.
const ANY: [f64; 3] = [0.0, f64::INFINITY, 0.0];

impl Sggx {
    pub(super) const TABLE: Table = table! {
        "Specular microflakes (Heitz et al. 2015): mirrors whose normals are distributed as those of an ellipsoid. The area that they show scales the medium's extinction.";
        object("S", "volume", "A `gridvolume` of 6 channels: xx, yy, zz, xy, xz, yz of a positive definite matrix, or 0 where there are no flakes; n S n is the squared area seen along n. `to_world` moves the voxels and leaves the matrices as they are; an `instance` turns them.").required(),
    };

    /// The same everywhere.
    fn even(mean: Ellipsoid) -> Self {
        Self { mean: Arc::new(mean), varying: None }
    }

    /// By the matrices of `grid`, each turned by `turn`.
    fn new(grid: Sixfold, turn: DMat3) -> std::result::Result<Self, Unfit> {
        let (mut sum, mut count) = (DMat3::ZERO, 0.0);
        for (voxel, numbers) in grid.voxels() {
            let matrix = turned(numbers, turn);
            if matrix != DMat3::ZERO {
                lower(matrix, RANGE).ok_or_else(|| Unfit::Voxel {
                    voxel,
                    numbers,
                    is_flat: is_flat(matrix),
                })?;
            }
            (sum, count) = (sum + matrix, count + 1.0);
        }
        let mean = sum * (1.0 / count);
        let shares = shares(&grid, turn, lower(mean, ANY).ok_or(Unfit::Empty)?);
        let varying = (shares[0] < 1.0 - EVEN || shares[1] > 1.0 + EVEN)
            .then(|| Arc::new(Varying { grid, turn, shares }));
        Ok(Self { varying, ..Self::even(Ellipsoid::new(mean)) })
    }

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let grid = params.child("S")?.ok_or_else(|| params.missing("S"))?;
        // In an instance, areas turn with what they are of; extinction stays what it is per metre.
        let placed = place.instance.matrix3;
        let turn = placed.inverse().transpose() * placed.determinant().abs().cbrt();
        Self::new(Sixfold::read(grid.object, params.library, place)?, turn)
            .map_err(|unfit| unfit.refuse(&grid.object.location))
    }

    /// Flakes without an order: as isotropic as they are many.
    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [1.0, 0.3].map(|size| Self::even(Ellipsoid::new(DMat3::IDENTITY * size))).into()
    }

    /// True if it differs from one point to another.
    pub fn varies(&self) -> bool {
        self.varying.is_some()
    }

    /// Flakes of the mean matrix everywhere, with `by` times its area in every direction.
    pub fn mean(&self, by: f32) -> Self {
        Self::even(Ellipsoid { size: self.mean.size * by, ..*self.mean })
    }

    /// Bounds of [`Self::area_at`] over [`Self::area`], anywhere and in any direction.
    pub fn shares(&self) -> [f32; 2] {
        self.varying.as_ref().map_or([1.0; 2], |varying| varying.shares)
    }

    /// What no [`Self::area_at`] exceeds: by the row sums of S, which is the greatest area itself where S is diagonal and
    /// the same everywhere.
    pub fn greatest_area(&self) -> f32 {
        let Ellipsoid { size, root, .. } = *self.mean;
        row_sum((root.transpose() * root).as_dmat3()).sqrt() as f32 * size * self.shares()[1]
    }

    /// The area that they show, per unit of extinction, to light that flies in unit `direction` or back.
    #[inline]
    pub fn area(&self, direction: Vec3) -> f32 {
        self.mean.area(direction)
    }

    /// The same at a world position.
    #[inline]
    pub fn area_at(&self, position: Vec3, direction: Vec3) -> f32 {
        self.at(position).area(direction)
    }

    /// [`PhaseModel::pdf_sr`] at a world position.
    #[inline]
    pub(super) fn pdf_sr_at(&self, position: Vec3, turn: Deflection) -> f32 {
        self.at(position).pdf_sr(turn)
    }

    /// [`PhaseModel::sample`] at a world position.
    #[inline]
    pub(super) fn sample_at(&self, position: Vec3, direction: Vec3, stream: &mut Stream) -> Vec3 {
        self.at(position).sample(direction, stream)
    }

    #[inline]
    fn at(&self, position: Vec3) -> Ellipsoid {
        self.varying.as_ref().map_or(*self.mean, |varying| varying.at(position))
    }
}

impl Varying {
    fn at(&self, position: Vec3) -> Ellipsoid {
        Ellipsoid::new(turned(self.grid.at(position), self.turn))
    }
}

/// Why a grid holds no flakes.
#[derive(Debug)]
enum Unfit {
    /// Six numbers of a voxel are out of range, or, turned by an instance, no positive definite matrix.
    Voxel { voxel: [usize; 3], numbers: [f64; 6], is_flat: bool },
    /// All are 0.
    Empty,
}

impl Unfit {
    fn refuse(self, location: &Location) -> Error {
        let Self::Voxel { voxel: [x, y, z], numbers, is_flat } = self else {
            let remedy = "give a voxel a matrix, or remove the medium";
            return Error::new(location, "flakes in some voxel", "zeros in all of them", remedy);
        };
        let (expected, remedy) = Self::expected(numbers, is_flat);
        let found = format!("{:?} in the voxel ({x}, {y}, {z})", numbers.map(|number| number as f32));
        Error::new(location, expected, found, remedy)
    }

    /// In place of `numbers`, and how to get there.
    fn expected(numbers: [f64; 6], is_flat: bool) -> (String, &'static str) {
        let [least, most, _] = RANGE;
        if !numbers.iter().all(|number| number.is_finite()) {
            return ("six numbers".into(), "correct the file");
        }
        if !is_flat {
            let expected = format!("xx, yy and zz of which the largest is between {least:e} and {most:e}");
            return (
                expected,
                "multiply the matrices by a number, and divide the medium's extinction by its square root",
            );
        }
        let remedy = "raise xx, yy and zz: the square of each other number is less than the product of the two \
                      in its row and column, and flakes have some thickness, in instances too";
        ("xx, yy, zz, xy, xz, yz of a positive definite matrix".into(), remedy)
    }
}

/// Matrices count as equal if their areas differ by less.
const EVEN: f32 = 1e-6;

/// L of Cholesky's S = L L^T, whose transpose is B; none if S is no positive definite matrix, or out of range.
fn lower(matrix: DMat3, [least, most, thinnest]: [f64; 3]) -> Option<DMat3> {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let largest = x.x.max(y.y).max(z.z);
    let pivot = |squared: f64| (squared > thinnest * largest).then(|| squared.sqrt());
    let a = pivot(x.x)?;
    let (b, c) = (x.y / a, x.z / a);
    let d = pivot(y.y - b * b)?;
    let e = (y.z - b * c) / d;
    let f = pivot(z.z - c * c - e * e)?;
    let lower = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(0.0, d, e), DVec3::new(0.0, 0.0, f));
    (least..=most).contains(&largest).then_some(lower)
}

/// True of what is no positive definite matrix, or flakes without thickness.
fn is_flat(matrix: DMat3) -> bool {
    lower(matrix, [0.0, f64::INFINITY, RANGE[2]]).is_none()
}

/// The matrix of six numbers, in an instance.
fn turned(numbers: [f64; 6], turn: DMat3) -> DMat3 {
    turn * symmetric(numbers) * turn.transpose()
}

/// Bounds of the area that any voxel shows over the mean's, whose L is `mean`. Seen with the mean as a sphere, the squares
/// are bounded by the row sums of a matrix and of its inverse; between voxels S lies between theirs.
fn shares(grid: &Sixfold, turn: DMat3, mean: DMat3) -> [f32; 2] {
    let to_sphere = mean.inverse();
    let bounds = grid.voxels().map(|(_, numbers)| {
        let seen = to_sphere * turned(numbers, turn) * to_sphere.transpose();
        let least = if seen == DMat3::ZERO { 0.0 } else { 1.0 / row_sum(seen.inverse()) };
        [least, row_sum(seen)]
    });
    let wider = |[a, b]: [f64; 2], [least, most]: [f64; 2]| [a.min(least), b.max(most)];
    bounds.fold([1.0; 2], wider).map(|square| square.sqrt() as f32)
}

/// The greatest sum of the magnitudes in a row: no eigenvalue of a symmetric matrix is greater.
fn row_sum(matrix: DMat3) -> f64 {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis]
        .into_iter()
        .map(|row| row.abs().element_sum())
        .fold(0.0, f64::max)
}

/// The matrix of the numbers xx, yy, zz, xy, xz and yz.
fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}

impl Ellipsoid {
    /// Of S, which is positive definite or 0.
    fn new(matrix: DMat3) -> Self {
        let squared = matrix.x_axis.x.max(matrix.y_axis.y).max(matrix.z_axis.z);
        let size = squared.sqrt();
        let (size, lower) = match lower(matrix, ANY) {
            Some(lower) => (size as f32, lower * size.recip()),
            None => (0.0, DMat3::IDENTITY),
        };
        Self {
            size,
            root: lower.transpose().as_mat3(),
            inverse: lower.inverse().as_mat3(),
            quarter: (0.25 / (PI * lower.determinant())) as f32,
        }
    }

    #[inline]
    fn area(&self, direction: Vec3) -> f32 {
        (self.root * direction).length() * self.size
    }

    /// A quarter of the density of normals at the one that mirrors so, over the area seen.
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        let normal = turn.normal();
        let squared = (self.inverse * normal).length_squared() / normal.length_squared();
        self.quarter / (squared * squared * (self.root * turn.before()).length())
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let facing = Frame::around((self.root * -direction).normalize());
        let on_sphere = facing.to_world(warp::to_cosine_hemisphere(stream.square()));
        let normal = (self.root.transpose() * on_sphere).normalize();
        (direction - 2.0 * direction.dot(normal) * normal).normalize()
    }
}

impl PhaseModel for Sggx {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        self.mean.pdf_sr(turn)
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        self.mean.sample(direction, stream)
    }

    /// In light from everywhere, flakes reflect as much onwards as back.
    fn mean_cosine(&self) -> f32 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::vec3,
        sampling::stream::Purpose,
        testing::{chi_square, significance},
    };
    use std::f32::consts::{FRAC_PI_4, TAU};

    const SKEWED: [f64; 6] = [0.09, 0.5, 0.25, 0.05, 0.02, 0.01];

    fn flakes(numbers: [f64; 6]) -> Sggx {
        assert!(lower(symmetric(numbers), RANGE).is_some());
        Sggx::even(Ellipsoid::new(symmetric(numbers)))
    }

    fn pdf(flakes: &Sggx, towards: Vec3, outgoing: Vec3) -> f32 {
        flakes.pdf_sr(Deflection::between(-towards, outgoing))
    }

    #[test]
    fn values_are_those_of_mitsuba() {
        let flakes = flakes(SKEWED);
        let outgoing = [Vec3::Z, vec3(0.48, 0.6, 0.64), vec3(-0.8, 0.0, 0.6)];
        for (towards, area, values) in [
            (Vec3::X, 0.3, [0.051_364_4, 0.036_885, 0.139_403]),
            (vec3(0.6, 0.8, 0.0), 0.632_772, [0.086_896_3, 0.068_656_4, 0.087_319_9]),
        ] {
            assert!((flakes.area(towards) / area - 1.0).abs() < 1e-5);
            for (outgoing, value) in outgoing.iter().zip(values) {
                let found = pdf(&flakes, towards, *outgoing);
                assert!((found / value - 1.0).abs() < 1e-5, "{towards} {outgoing}: {found} for {value}");
            }
        }
    }

    #[test]
    fn no_area_exceeds_the_greatest() {
        let (round, skewed) = (flakes([0.25, 4.0, 1.0, 0.0, 0.0, 0.0]), flakes(SKEWED));
        assert_eq!(round.greatest_area(), 2.0);
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let areas = (0..1000).map(|_| skewed.area(warp::to_sphere(stream.square())));
        let greatest = areas.fold(0.0, f32::max);
        assert!((1.0..1.2).contains(&(skewed.greatest_area() / greatest)));
    }

    #[test]
    fn what_collides_and_turns_is_the_same_both_ways() {
        let (flakes, a, b) = (flakes(SKEWED), vec3(0.6, 0.0, 0.8), vec3(-0.48, 0.6, 0.64));
        let (there, back) = (pdf(&flakes, a, b) * flakes.area(a), pdf(&flakes, b, a) * flakes.area(b));
        assert!((there / back - 1.0).abs() < 1e-5 && there > 0.0);
        assert!(pdf(&flakes, a, -a).is_finite(), "straight on, mirrors are grazed");
    }

    /// Cells of the sphere of directions by cosine to z and azimuth.
    const CELLS: [usize; 2] = [24, 16];

    fn cell(direction: Vec3) -> usize {
        let row = ((0.5 * (direction.z + 1.0) * CELLS[0] as f32) as usize).min(CELLS[0] - 1);
        let around = (direction.y.atan2(direction.x) / TAU).rem_euclid(1.0);
        row * CELLS[1] + ((around * CELLS[1] as f32) as usize).min(CELLS[1] - 1)
    }

    #[test]
    fn samples_are_distributed_as_the_density_says() {
        let matrices = [SKEWED, [0.04, 0.05, 0.9, 0.01, -0.1, 0.12], [2.0, 0.1, 3.0, 0.2, -1.0, 0.3]];
        let directions = [-Vec3::Z, Vec3::X, vec3(0.6, -0.48, 0.64)];
        let (samples, fine) = (100_000, 1 << 20);
        for (matrix, towards) in matrices.iter().flat_map(|matrix| directions.map(|w| (matrix, w))) {
            let flakes = flakes(*matrix);
            let mut stream = Stream::new(3, 0, 0, Purpose::Study);
            let (mut counts, mut expected) = (vec![0; CELLS[0] * CELLS[1]], vec![0.0; CELLS[0] * CELLS[1]]);
            (0..samples).for_each(|_| counts[cell(flakes.sample(-towards, &mut stream))] += 1);
            for i in 0..fine {
                let [row, column] = [i / 1024, i % 1024].map(|k| (k as f32 + 0.5) / 1024.0);
                let direction = warp::spherical(2.0 * row - 1.0, TAU * column);
                let share = 16.0 * FRAC_PI_4 * pdf(&flakes, towards, direction) / fine as f32;
                expected[cell(direction)] += f64::from(share) * f64::from(samples);
            }
            let total = expected.iter().sum::<f64>() / f64::from(samples);
            assert!((total - 1.0).abs() < 1e-3, "{matrix:?}, {towards}: {total}");
            let p = chi_square(&counts, &expected);
            assert!(p > significance(9), "{matrix:?}, {towards}: p-value {p}");
        }
    }

    #[test]
    fn thin_flakes_are_mirrors_and_what_is_flat_or_no_number_is_refused() {
        let mirror = flakes([1e-7, 1e-7, 1.0, 0.0, 0.0, 0.0]);
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let turned = mirror.sample(vec3(0.6, 0.0, -0.8), &mut stream);
        assert!(turned.distance(vec3(0.6, 0.0, 0.8)) < 0.01, "{turned}");
        for (numbers, is_fine) in [
            ([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], true),
            ([1.0, 1.0, 0.0, 0.0, 0.0, 0.0], false),
            ([1.0, 1.0, 1.0, 1.0, 0.0, 0.0], false),
            ([1.0, -1.0, 1.0, 0.0, 0.0, 0.0], false),
            ([1.0, 1.0, 1.0, 0.8, 0.8, -0.8], false),
            ([f64::NAN, 1.0, 1.0, 0.0, 0.0, 0.0], false),
            ([1.0, 1.0, 1.0, 0.0, f64::NAN, 0.0], false),
            ([f64::INFINITY, 1.0, 1.0, 0.0, 0.0, 0.0], false),
            ([1e-30, 1e-30, 1e-30, 0.0, 0.0, 0.0], false),
        ] {
            assert_eq!(lower(symmetric(numbers), RANGE).is_some(), is_fine, "{numbers:?}");
        }
    }
}
