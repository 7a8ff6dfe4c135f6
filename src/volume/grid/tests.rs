//! Grids against Mitsuba's values, against quadrature of an interpolation written again, and against themselves.

mod files;

use super::*;
use crate::{
    description::{Library, Value},
    math::{DMat4, vec3},
    sampling::{Stream, stream::Purpose},
    testing::object,
    volume::Samples,
};

/// Samples in memory, x fastest.
#[derive(Clone)]
pub(super) struct Table<V> {
    pub size: [usize; 3],
    pub values: Vec<V>,
}

impl<V: Voxel> Samples<V> for Table<V> {
    fn size(&self) -> [usize; 3] {
        self.size
    }
    fn at(&self, [x, y, z]: [usize; 3]) -> V {
        self.values[x + self.size[0] * (y + self.size[1] * z)]
    }
    fn uniform(&self, _: [usize; 3], _: [usize; 3]) -> Option<V> {
        None
    }
}

fn colours(size: [usize; 3], index: u64) -> Table<Spectrum> {
    let mut stream = Stream::new(11, index, 0, Purpose::Study);
    let count = size.iter().product::<usize>();
    let values = (0..count).map(|_| vec3(stream.uniform(), stream.uniform(), stream.uniform())).collect();
    Table { size, values }
}

fn numbers(size: [usize; 3], index: u64) -> Table<f32> {
    let Table { size, values } = colours(size, index);
    Table { size, values: values.iter().map(|color| color.x).collect() }
}

fn grey(table: Table<f32>, filter: Filter, wrap: Wrap, to_world: DAffine3) -> Grid {
    Grid::new(Path::new("test"), Values::Grey(Box::new(table)), filter, wrap, to_world).unwrap()
}

fn chromatic(table: Table<Spectrum>, filter: Filter, wrap: Wrap, to_world: DAffine3) -> Grid {
    Grid::new(Path::new("test"), Values::Chromatic(Box::new(table)), filter, wrap, to_world).unwrap()
}

/// Turned, stretched, mirrored.
fn askew() -> DAffine3 {
    let turn = DMat4::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let matrix = DMat4::from_translation(DVec3::new(0.3, -0.4, 0.2))
        * turn
        * DMat4::from_scale(DVec3::new(1.5, 0.7, -2.0));
    DAffine3::from_mat4(matrix)
}

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

pub(super) fn examples() -> Vec<Grid> {
    let mut all = Vec::new();
    for (index, wrap) in (0..).zip(WRAPS) {
        for to_world in [DAffine3::IDENTITY, moved(), askew()] {
            all.push(grey(numbers([4, 3, 2], index), Filter::Trilinear, wrap, to_world));
            all.push(chromatic(colours([10, 1, 9], index), Filter::Trilinear, wrap, to_world));
            all.push(chromatic(colours([2, 1, 3], index), Filter::Nearest, wrap, to_world));
        }
    }
    all
}

fn moved() -> DAffine3 {
    let (scale, shift) = (DVec3::new(2.0, -1.0, 3.0), DVec3::new(-1.0, 1.5, -1.0));
    DAffine3::from_scale_rotation_translation(scale, glam::DQuat::IDENTITY, shift)
}

fn between(a: Vec3, b: Vec3) -> RaySegment {
    RaySegment { origin: a, direction: (b - a).normalize_or_zero(), length: a.distance(b) }
}

fn reversed(segment: &RaySegment) -> RaySegment {
    RaySegment { origin: segment.at(segment.length), direction: -segment.direction, length: segment.length }
}

/// Voxels over six decades.
fn contrasts(size: [usize; 3], index: u64) -> Table<f32> {
    let Table { size, values } = numbers(size, index);
    Table { size, values: values.iter().map(|u| 10f32.powf(6.0 * u - 3.0)).collect() }
}

/// The value by its definition: from the wrapped samples around a point of the unit cube's coordinates.
fn value(table: &Table<f32>, filter: Filter, wrap: Wrap, at: DVec3) -> f64 {
    let sample = |index: [f64; 3]| {
        let index = std::array::from_fn(|i| {
            let (n, k) = (table.size[i] as f64, index[i]);
            let k = match wrap {
                Wrap::Clamp => k.max(0.0).min(n - 1.0),
                Wrap::Repeat => k - n * (k / n).floor(),
                Wrap::Mirror => {
                    let k = k - 2.0 * n * (k / (2.0 * n)).floor();
                    if k < n { k } else { 2.0 * n - 1.0 - k }
                }
            };
            k as usize
        });
        f64::from(table.at(index))
    };
    let scaled = at * DVec3::from(table.size.map(|n| n as f64));
    if filter == Filter::Nearest {
        return sample(scaled.floor().to_array());
    }
    let low = (scaled - 0.5).floor();
    let part = scaled - 0.5 - low;
    let mut sum = 0.0;
    for corner in 0..8 {
        let offset = DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2));
        let weight = offset * part + (1.0 - offset) * (1.0 - part);
        sum += weight.x * weight.y * weight.z * sample((low + offset).to_array());
    }
    sum
}

/// The integral over what lies in the box around the cube, in pieces between the planes where cells meet.
fn quadrature(
    table: &Table<f32>,
    filter: Filter,
    wrap: Wrap,
    to_world: &DAffine3,
    segment: &RaySegment,
) -> f64 {
    let corners = (0..8).map(|i| {
        let corner = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        to_world.transform_point3(corner)
    });
    let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), c| (l.min(c), h.max(c)));
    let (origin, direction) = (segment.origin.as_dvec3(), segment.direction.as_dvec3());
    let mut ends = [0.0, f64::from(segment.length)];
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if !(low[axis]..=high[axis]).contains(&origin[axis]) {
                return 0.0;
            }
            continue;
        }
        let t = [low, high].map(|end| (end[axis] - origin[axis]) / direction[axis]);
        ends = [ends[0].max(t[0].min(t[1])), ends[1].min(t[0].max(t[1]))];
    }
    if ends[0] >= ends[1] {
        return 0.0;
    }
    let to_local = to_world.inverse();
    let (o, d) = (to_local.transform_point3(origin), to_local.transform_vector3(direction));
    let mut cuts = ends.to_vec();
    for axis in 0..3 {
        let n = table.size[axis] as f64;
        let offset = if filter == Filter::Trilinear { 0.5 } else { 0.0 };
        let [a, b] = ends.map(|t| (o[axis] + d[axis] * t) * n - offset);
        let planes = a.min(b).floor() as i64..=a.max(b).ceil() as i64;
        let at = |plane: i64| ((plane as f64 + offset) / n - o[axis]) / d[axis];
        cuts.extend(planes.map(at).filter(|t| *t > ends[0] && *t < ends[1]));
    }
    cuts.sort_by(f64::total_cmp);
    let piece = |ab: &[f64]| {
        let (half, middle) = (0.5 * (ab[1] - ab[0]), 0.5 * (ab[1] + ab[0]));
        let rule = [(-0.6f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6f64.sqrt(), 5.0 / 9.0)];
        rule.map(|(x, w)| w * value(table, filter, wrap, o + d * (middle + half * x))).iter().sum::<f64>()
            * half
    };
    cuts.windows(2).map(piece).sum()
}

/// Lines of all kinds around the unit cube of `to_world`: through it, inside it, along faces, edges and diagonals of
/// voxels, from the border and past it.
fn sections(to_world: &DAffine3, size: [usize; 3]) -> Vec<RaySegment> {
    let mut all = Vec::new();
    let voxel = 1.0 / DVec3::from(size.map(|n| n as f64));
    for index in 0..200 {
        let mut stream = Stream::new(12, index, 0, Purpose::Study);
        let mut point =
            || DVec3::new(stream.uniform_precisely(), stream.uniform_precisely(), stream.uniform_precisely());
        let (mut a, mut b) = (point() * 3.0 - 1.0, point() * 3.0 - 1.0);
        let snap = |p: DVec3| (p / (0.5 * voxel)).round() * (0.5 * voxel);
        match index % 8 {
            1 => (a, b) = (a.fract().abs(), b.fract().abs()),
            2 => a = snap(a),
            3 => (a, b) = (snap(a), snap(b)),
            4 => b = DVec3::new(b.x, a.y, a.z),
            5 => {
                a = snap(a);
                b = DVec3::new(a.x, a.y, b.z);
            }
            6 => {
                a = snap(a.clamp(DVec3::ZERO, DVec3::ONE));
                b = a + voxel * 3.0;
            }
            7 => a.y = 0.0,
            _ => {}
        }
        let [a, b] = [a, b].map(|p| to_world.transform_point3(p).as_vec3());
        all.push(between(a, b));
    }
    all
}

/// To all sides, corners included, and to none. One axis alone, too: a line along a face of the domain that also moves
/// along itself has another integral.
fn shifts() -> impl Iterator<Item = Vec3> {
    let steps = [-1e-5f32, 0.0, 1e-5];
    steps
        .into_iter()
        .flat_map(move |x| steps.into_iter().flat_map(move |y| steps.map(move |z| vec3(x, y, z))))
}

#[test]
fn integrals_are_exact_whatever_the_map_the_line_and_the_contrast() {
    let mut crossed = 0;
    for (index, size) in [[5, 4, 3], [1, 1, 1], [17, 9, 20], [8, 8, 8]].into_iter().enumerate() {
        for wrap in WRAPS {
            for filter in [Filter::Trilinear, Filter::Nearest] {
                for to_world in [DAffine3::IDENTITY, moved(), askew()] {
                    let table = contrasts(size, index as u64);
                    let grid = grey(table.clone(), filter, wrap, to_world);
                    for segment in sections(&to_world, size) {
                        let expected = quadrature(&table, filter, wrap, &to_world, &segment);
                        let found: f32 = grid.integral(&segment);
                        // Along a face between two voxels of the nearest kind, or touching a corner of the domain,
                        // either is right.
                        let moved =
                            shifts().map(|shift| RaySegment { origin: segment.origin + shift, ..segment });
                        let beside: Vec<f64> =
                            moved.map(|line| quadrature(&table, filter, wrap, &to_world, &line)).collect();
                        let is_near = |truth: f64| (f64::from(found) - truth).abs() <= 2e-6 * truth + 1e-30;
                        let is_between = beside.iter().any(|truth| *truth <= f64::from(found))
                            && beside.iter().any(|truth| *truth >= f64::from(found));
                        assert!(
                            is_near(expected) || (filter == Filter::Nearest || expected == 0.0) && is_between,
                            "{found} {expected} {beside:?} {size:?} {wrap:?} {filter:?} {segment:?}"
                        );
                        crossed += usize::from(expected > 0.0);
                    }
                }
            }
        }
    }
    assert!(crossed > 5_000, "{crossed}");
}

#[test]
fn integrals_are_symmetric_and_add_up() {
    let table = numbers([33, 12, 20], 3);
    let to_world = askew();
    let grid = grey(table, Filter::Trilinear, Wrap::Clamp, to_world);
    for segment in sections(&to_world, [33, 12, 20]) {
        let whole: f32 = grid.integral(&segment);
        // The far end is rounded: the way back is another line, by an ulp of its origin.
        let back: f32 = grid.integral(&reversed(&segment));
        assert!((whole - back).abs() <= 1e-5 * whole + 1e-6, "{whole} {back}");
        let half = RaySegment { length: 0.5 * segment.length, ..segment };
        let rest = RaySegment { origin: segment.at(half.length), ..half };
        let parts = grid.integral::<f32>(&half) + grid.integral::<f32>(&rest);
        assert!((whole - parts).abs() <= 1e-5 * whole + 1e-6, "{whole} {parts}");
    }
}

#[test]
fn a_thick_constant_keeps_its_depth() {
    let ones = Table { size: [1000, 3, 2], values: vec![1.0; 6000] };
    let mut noisy = numbers([1000, 3, 2], 5);
    noisy.values.iter_mut().for_each(|value| *value = 1e4 * (0.5 + *value));
    let wide = DAffine3::from_scale(DVec3::new(1e4, 1.0, 1.0));
    let segment = between(vec3(-1.0, 0.3, 0.4), vec3(2e4, 0.7, 0.6));
    let expected = quadrature(&ones, Filter::Trilinear, Wrap::Clamp, &wide, &segment);
    let found: f32 = grey(ones, Filter::Trilinear, Wrap::Clamp, wide).integral(&segment);
    assert!((f64::from(found) / expected - 1.0).abs() < 1e-7, "{found} {expected}");
    let expected = quadrature(&noisy, Filter::Trilinear, Wrap::Clamp, &DAffine3::IDENTITY, &segment);
    let found: f32 = grey(noisy, Filter::Trilinear, Wrap::Clamp, DAffine3::IDENTITY).integral(&segment);
    assert!((f64::from(found) / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn inversions_find_where_the_integral_is_reached() {
    let mut within = 0;
    for filter in [Filter::Trilinear, Filter::Nearest] {
        for (index, to_world) in [DAffine3::IDENTITY, moved(), askew()].into_iter().enumerate() {
            let size = [9, 20, 5];
            let table = contrasts(size, index as u64);
            let grid = grey(table.clone(), filter, Wrap::Mirror, to_world);
            for (segment, share) in
                sections(&to_world, size).into_iter().zip((0..).map(|i| (i % 12) as f32 / 10.0))
            {
                let whole: f32 = grid.integral(&segment);
                let remaining = 2.0 * whole * share;
                match grid.invert::<f32>(&segment, 2.0, 0, remaining) {
                    Reached::Beyond { depth } => {
                        assert_eq!(depth, 2.0 * whole);
                        assert!(remaining >= depth * (1.0 - 1e-6), "{remaining} {depth}");
                    }
                    Reached::Within { t, depth, value } => {
                        within += 1;
                        assert!(share <= 1.0 && (0.0..=segment.length).contains(&t));
                        assert!(
                            (depth - remaining).abs() <= 1e-6 * remaining + 1e-9 * whole,
                            "{depth} {remaining}"
                        );
                        assert!(value > 0.0);
                        // As exact as an f32 can represent the place.
                        let ulp = t.next_up() - t;
                        let most = 2.0 * 1e3 * f64::from(ulp);
                        let up_to = RaySegment { length: t, ..segment };
                        let reached = 2.0 * quadrature(&table, filter, Wrap::Mirror, &to_world, &up_to);
                        let off = (reached - f64::from(remaining)).abs();
                        assert!(
                            off <= most + 1e-5 * f64::from(remaining) + 1e-8 * f64::from(whole),
                            "{reached} {remaining} {most}"
                        );
                    }
                }
            }
        }
    }
    assert!(within > 400, "{within}");
}

#[test]
fn the_hero_decides_and_every_lane_tells_its_depth() {
    let table = colours([6, 11, 7], 1);
    let grid = chromatic(table, Filter::Trilinear, Wrap::Clamp, askew());
    let scale = vec3(3.0, 0.5, 20.0);
    for segment in sections(&askew(), [6, 11, 7]) {
        for hero in 0..3 {
            if let Reached::Within { t, depth, value } = grid.invert(&segment, scale, hero, 0.2) {
                let up_to = RaySegment { length: t, ..segment };
                let expected = grid.integral::<Spectrum>(&up_to) * scale;
                assert!((depth - expected).abs().max_element() < 1e-5, "{depth} {expected}");
                assert!((depth[hero] - 0.2).abs() < 1e-6, "{depth} {hero}");
                let at = grid.eval::<Spectrum>(segment.at(t)) * scale;
                assert!((value - at).abs().cmple(1e-3 * scale).all(), "{value} {at}");
            }
        }
    }
    // What does not scatter is never hit.
    let segment = between(vec3(-3.0, -0.4, 0.2), vec3(3.0, -0.3, 0.1));
    let blind = grid.invert(&segment, vec3(0.0, 1.0, 1.0), 0, 0.0);
    assert!(matches!(blind, Reached::Beyond { depth } if depth.x == 0.0 && depth.y > 0.1), "{blind:?}");
}

#[test]
fn a_collision_at_depth_zero_is_where_something_is() {
    let mut table = Table { size: [30, 3, 3], values: vec![0.0; 270] };
    table.values.iter_mut().enumerate().filter(|(i, _)| i % 30 >= 20).for_each(|(_, value)| *value = 1.0);
    for filter in [Filter::Trilinear, Filter::Nearest] {
        let grid = grey(table.clone(), filter, Wrap::Clamp, DAffine3::IDENTITY);
        for segment in [
            between(vec3(-1.0, 0.5, 0.5), vec3(2.0, 0.5, 0.5)),
            between(vec3(2.0, 0.1, 0.5), vec3(-1.0, 0.9, 0.5)),
        ] {
            let reached = grid.invert::<f32>(&segment, 1.0, 0, 0.0);
            assert!(matches!(reached, Reached::Within { value, .. } if value > 0.0), "{reached:?}");
        }
    }
}

#[test]
fn odd_sections_are_harmless() {
    let grid = grey(numbers([9, 9, 9], 2), Filter::Trilinear, Wrap::Clamp, askew());
    let centre = askew().transform_point3(DVec3::splat(0.5)).as_vec3();
    let segment = |origin, direction, length| RaySegment { origin, direction, length };
    for (segment, is_seen) in [
        (segment(centre, Vec3::X, f32::INFINITY), true),
        (segment(centre, Vec3::X, 0.0), false),
        (segment(centre - 1e4 * Vec3::X, Vec3::X, f32::INFINITY), true),
        (segment(centre, Vec3::ZERO, 1.0), true),
        (segment(centre, vec3(1.0, 1e-30, -1e-38), 1.0), true),
        (segment(centre + 9.0 * Vec3::X, Vec3::X, f32::INFINITY), false),
        (segment(centre + 9.0 * Vec3::Y, Vec3::X, f32::INFINITY), false),
        (segment(Vec3::splat(1e30), Vec3::X, f32::INFINITY), false),
    ] {
        let found: f32 = grid.integral(&segment);
        assert!(found.is_finite() && (found > 0.0) == is_seen, "{found} {segment:?}");
    }
    for far in [1e9, -1e30, f32::MAX] {
        for wrap in WRAPS {
            let grid = grey(numbers([9, 9, 9], 2), Filter::Trilinear, wrap, askew());
            let value: f32 = grid.eval(vec3(far, -far, 0.0));
            assert!((0.0..=1.0).contains(&value), "{value} {far} {wrap:?}");
        }
    }
}

/// Reports which parts of a table are uniform.
struct Sparse(Table<f32>);

impl Samples<f32> for Sparse {
    fn size(&self) -> [usize; 3] {
        self.0.size
    }
    fn at(&self, index: [usize; 3]) -> f32 {
        self.0.at(index)
    }
    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<f32> {
        let first = self.0.at(low);
        let same = |x, y, z| self.0.at([x, y, z]) == first;
        let rows = |y, z| (low[0]..=high[0]).all(|x| same(x, y, z));
        (low[2]..=high[2]).all(|z| (low[1]..=high[1]).all(|y| rows(y, z))).then_some(first)
    }
}

#[test]
fn what_a_sparse_file_knows_changes_nothing() {
    let size = [40, 30, 35];
    let mut table = numbers(size, 4);
    for (index, value) in table.values.iter_mut().enumerate() {
        let [x, y, z] = [index % 40, index / 40 % 30, index / 1200];
        match (x / 13, y / 10, z / 20) {
            (1, 1, _) => {}
            (2, _, 0) => *value = 0.5,
            _ => *value = 0.0,
        }
    }
    for wrap in WRAPS {
        for filter in [Filter::Trilinear, Filter::Nearest] {
            for to_world in [DAffine3::IDENTITY, askew()] {
                let dense = grey(table.clone(), filter, wrap, to_world);
                let values = Values::Grey(Box::new(Sparse(table.clone())));
                let sparse = Grid::new(Path::new("test"), values, filter, wrap, to_world).unwrap();
                assert_eq!(dense.counts(), sparse.counts());
                let [full, all] = sparse.counts();
                assert!(3 * full < 2 * all, "{full} of {all}");
                for segment in sections(&to_world, size) {
                    assert_eq!(dense.integral::<f32>(&segment), sparse.integral::<f32>(&segment));
                    let expected = quadrature(&table, filter, wrap, &to_world, &segment);
                    let found = f64::from(sparse.integral::<f32>(&segment));
                    let is_fair =
                        filter == Filter::Nearest || (found - expected).abs() <= 2e-6 * expected + 1e-12;
                    assert!(is_fair, "{found} {expected} {segment:?}");
                }
            }
        }
    }
}

#[test]
fn bricks_know_their_mean_and_bound() {
    let size = [20, 9, 3];
    let table = numbers(size, 6);
    for filter in [Filter::Trilinear, Filter::Nearest] {
        let grid = grey(table.clone(), filter, Wrap::Clamp, moved());
        let (to_bricks, [nx, ny, nz]) = (grid.to_bricks(), grid.bricks());
        let count = (nx * ny * nz) as usize;
        let (mut sums, mut hits) = (vec![0.0; count], vec![0u32; count]);
        let mut stream = Stream::new(13, 0, 0, Purpose::Study);
        for _ in 0..400_000 {
            let local = vec3(stream.uniform(), stream.uniform(), stream.uniform());
            let position = moved().transform_point3(local.as_dvec3()).as_vec3();
            let brick = to_bricks.transform_point3(position).max(Vec3::ZERO).as_uvec3();
            let index = (brick.x + nx * (brick.y + ny * brick.z)) as usize;
            let value: f32 = grid.eval(position);
            assert!(value <= grid.brick_max::<f32>(brick.to_array()) + 1e-6);
            sums[index] += f64::from(value);
            hits[index] += 1;
        }
        let coarse = grid.coarse();
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let index = x + nx * (y + ny * z);
                    let mean: f32 = grid.brick_mean([x, y, z]);
                    assert_eq!(
                        (coarse.cell(index).mean.x, coarse.cell(index).most),
                        (mean, grid.brick_max([x, y, z]))
                    );
                    let hits = f64::from(hits[index as usize]);
                    let found = sums[index as usize] / hits;
                    // The values spread by less than 0.3.
                    assert!((found - f64::from(mean)).abs() < 5.0 * 0.3 / hits.sqrt(), "{found} {mean}");
                }
            }
        }
    }
}

#[test]
fn colours_that_are_all_grey_collapse() {
    let mut table = colours([9, 3, 4], 0);
    table.values.iter_mut().for_each(|value| *value = Spectrum::splat(value.x));
    let twin = Table { size: table.size, values: table.values.iter().map(|color| color.x).collect() };
    let grid = chromatic(table.clone(), Filter::Trilinear, Wrap::Clamp, askew());
    let twin = grey(twin, Filter::Trilinear, Wrap::Clamp, askew());
    assert!(grid.is_grey());
    for segment in sections(&askew(), [9, 3, 4]) {
        assert_eq!(grid.integral::<Spectrum>(&segment), twin.integral::<Spectrum>(&segment));
    }
    table.values[50].z += 0.1;
    assert!(!chromatic(table, Filter::Trilinear, Wrap::Clamp, askew()).is_grey());
}

#[test]
fn a_walk_and_its_reverse_are_one() {
    let size = [33, 12, 20];
    let extent = lattice::Extent {
        first: [-1; 3],
        cells: size.map(|n| n + 1),
        counted: [[0.5; 3], size.map(|n| n as f64)],
    };
    let lattice = Lattice::build(&contrasts(size, 3), Wrap::Clamp, Filter::Trilinear, &extent, |_| true);
    for index in 0..300 {
        let mut stream = Stream::new(14, index, 0, Purpose::Study);
        let mut point = || extent.cells.map(|n| (stream.uniform() * n as f32 * 2.0).round() as f64 * 0.5);
        let (a, b) = (point(), point());
        let towards = |a: [f64; 3], b: [f64; 3]| {
            let direction = std::array::from_fn(|i| b[i] - a[i]);
            lattice.integral(&Line { origin: a, direction }, 0.0, 1.0)
        };
        let (there, back) = (towards(a, b), towards(b, a));
        assert!((there - back).abs() <= 1e-6 * there, "{there} {back} {a:?} {b:?}");
    }
}

/// A `.vdb` file as a volume of a scene: its own place in the world, and one of its grids by name.
#[test]
fn vdb_files_are_placed_by_their_own_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("smoke.vdb");
    let packed = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/src/volume/files/samples/blosc.vdb.gz"));
    let mut unpacked = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&packed.unwrap()[..]), &mut unpacked)
        .unwrap();
    std::fs::write(&path, unpacked).unwrap();
    let name = Value::String(path.to_str().unwrap().into());
    let grid = crate::volume::build(
        &object("gridvolume", &[("filename", name)]),
        &Library::default(),
        &Place::new(DVec3::new(1.0, 0.0, 0.0), 0.0),
    )
    .unwrap_or_else(|error| panic!("{error}"));
    let source = crate::volume::files::open(&path, None).unwrap();
    let crate::volume::files::Field::Grey(samples) = &source.samples else { panic!() };
    let [x, y, z] = samples.size();
    let mut seen = 0;
    for at in (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k]))) {
        let index =
            DVec3::from_array(std::array::from_fn(|axis| (source.low[axis] + at[axis] as i64) as f64));
        let world = source.to_world.transform_point3(index) - DVec3::X;
        let (found, expected): (f32, f32) = (grid.eval(world.as_vec3()), samples.at(at));
        assert!((found - expected).abs() <= 1e-3 * expected.abs() + 1e-4, "{at:?}: {found} {expected}");
        seen += usize::from(expected != 0.0);
    }
    assert!(seen > 10);
}

/// Rounding would spread the box of a far grid over endlessly many cells.
#[test]
fn a_grid_farther_away_than_numbers_tell_apart_is_an_error() {
    let at = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    let place = |x| {
        let table = Values::Grey(Box::new(numbers([2; 3], 0)));
        Grid::new(Path::new("test"), table, Filter::Trilinear, Wrap::Clamp, at(x))
    };
    assert!(place(1e11).is_ok());
    for x in [1e13, -1e30, 1e300, f64::INFINITY] {
        assert!(place(x).unwrap_err().found.contains("times its size"), "{x:e}");
    }
}
