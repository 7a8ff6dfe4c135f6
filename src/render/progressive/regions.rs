//! The *regions method* (P03T sec. 6.5): the image is cut into regions where conductance is low. Their outlines are
//! shaded first and become permanent edges.

use super::conductance::Maps;
use std::collections::VecDeque;

/// Neighbours of a higher resistance are of different regions: a conductance of one half.
const BREAK: f32 = std::f32::consts::LN_2;
/// Regions of fewer pixels are left to the edges: they would be nothing but outline.
const LEAST_AREA: usize = 24;
/// Most pixels that one piece of an outline replaces.
const LONGEST_PIECE: usize = 64;
/// How far a piece may be from the pixels that it replaces (pixels).
const TOLERANCE: f64 = 0.75;

/// Steps to the right, down, left, up.
const STEPS: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// The outlines of regions.
#[derive(Default)]
pub(super) struct Outlines {
    /// Their corners, those that stand for most of the picture first.
    pub corners: Vec<usize>,
    /// Their pieces, each from a corner to the next.
    pub pieces: Vec<[u32; 2]>,
}

impl Outlines {
    /// Those of the regions of an image.
    pub(super) fn of(maps: &Maps) -> Self {
        let regions = Regions::of(maps);
        let mut polygons: Vec<(usize, Vec<usize>)> = Vec::new();
        let mut lengths = vec![0; regions.areas.len()];
        for (region, pixels) in regions.loops() {
            let polygon = regions.polygon(maps, &pixels);
            lengths[region] += polygon.len();
            polygons.push((region, polygon));
        }
        // P03T sec. 6.5: by the area that a vertex has.
        let share = |region: usize| regions.areas[region] as f64 / lengths[region] as f64;
        polygons.sort_by(|(a, _), (b, _)| share(*b).total_cmp(&share(*a)));
        let pieces = polygons.iter().flat_map(|(_, polygon)| {
            let next = polygon.iter().cycle().skip(1);
            polygon.iter().zip(next).map(|(a, b)| [*a as u32, *b as u32]).filter(|[a, b]| a != b)
        });
        let pieces = pieces.collect();
        Self { corners: polygons.into_iter().flat_map(|(_, polygon)| polygon).collect(), pieces }
    }
}

/// Sets of pixels that are connected by steps of little resistance.
struct Regions {
    width: usize,
    /// Of every pixel, the number of its region.
    labels: Vec<usize>,
    /// Pixels of every region.
    areas: Vec<usize>,
}

impl Regions {
    fn of(maps: &Maps) -> Self {
        let mut regions =
            Self { width: maps.width(), labels: vec![usize::MAX; maps.len()], areas: Vec::new() };
        for pixel in 0..maps.len() {
            if regions.labels[pixel] == usize::MAX {
                regions.flood(maps, pixel);
            }
        }
        regions
    }

    /// Gives a new region all pixels that are connected with `first`.
    fn flood(&mut self, maps: &Maps, first: usize) {
        let (label, mut area) = (self.areas.len(), 0);
        let mut open = VecDeque::from([first]);
        self.labels[first] = label;
        while let Some(pixel) = open.pop_front() {
            area += 1;
            for step in STEPS {
                let Some(next) = self.neighbour(pixel, step) else { continue };
                if self.labels[next] == usize::MAX && maps.step(pixel, next) < BREAK {
                    self.labels[next] = label;
                    open.push_back(next);
                }
            }
        }
        self.areas.push(area);
    }

    fn neighbour(&self, pixel: usize, [right, down]: [i64; 2]) -> Option<usize> {
        let height = self.labels.len() / self.width;
        let x = (pixel % self.width).checked_add_signed(right as isize).filter(|x| *x < self.width)?;
        let y = (pixel / self.width).checked_add_signed(down as isize).filter(|y| *y < height)?;
        Some(y * self.width + x)
    }

    /// The neighbour, if it is of region `label`.
    fn within(&self, pixel: usize, direction: usize, label: usize) -> Option<usize> {
        self.neighbour(pixel, STEPS[direction % 4]).filter(|next| self.labels[*next] == label)
    }

    /// All closed outlines, around regions and around holes in them: the region and its pixels along the outline.
    fn loops(&self) -> Vec<(usize, Vec<usize>)> {
        let mut passed = vec![[false; 4]; self.labels.len()];
        let mut loops = Vec::new();
        for pixel in 0..self.labels.len() {
            let label = self.labels[pixel];
            for direction in 0..4 {
                let is_side = self.within(pixel, direction + 3, label).is_none();
                if is_side && !passed[pixel][direction] && self.areas[label] >= LEAST_AREA {
                    loops.push((label, self.follow(pixel, direction, &mut passed)));
                }
            }
        }
        loops
    }

    /// Follows the sides of pixels with the region on the right, from the side on the left of `pixel` in this
    /// `direction` until back at it.
    fn follow(&self, pixel: usize, direction: usize, passed: &mut [[bool; 4]]) -> Vec<usize> {
        let label = self.labels[pixel];
        let (mut at, mut pixels) = ((pixel, direction), vec![pixel]);
        while !passed[at.0][at.1] {
            passed[at.0][at.1] = true;
            let (pixel, ahead) = at;
            at = match self.within(pixel, ahead, label) {
                None => (pixel, (ahead + 1) % 4),
                Some(next) => match self.within(next, ahead + 3, label) {
                    None => (next, ahead),
                    Some(beside) => (beside, (ahead + 3) % 4),
                },
            };
            if pixels.last() != Some(&at.0) {
                pixels.push(at.0);
            }
        }
        pixels.pop();
        pixels
    }

    /// The corners of a polygon that replaces a closed outline: pieces that stay within the region, as long as they may be.
    fn polygon(&self, maps: &Maps, pixels: &[usize]) -> Vec<usize> {
        let mut corners = Vec::new();
        let mut first = 0;
        while first < pixels.len() {
            corners.push(pixels[first]);
            let most = (pixels.len() - first).min(LONGEST_PIECE);
            let at = |index: usize| pixels[(first + index) % pixels.len()];
            let mut length = 1;
            while length < most && self.replaces(maps, length + 1, &at) {
                length += 1;
            }
            first += length;
        }
        corners
    }

    /// True if the line from pixel 0 to pixel `length` of an outline stays in the region, and near those between.
    fn replaces(&self, maps: &Maps, length: usize, at: &dyn Fn(usize) -> usize) -> bool {
        let (first, last) = (at(0), at(length));
        let place = |pixel: usize| [pixel % self.width, pixel / self.width].map(|x| x as f64);
        let ([x, y], [to_x, to_y]) = (place(first), place(last));
        let long = (to_x - x).hypot(to_y - y);
        let off = |pixel| {
            let [at_x, at_y] = place(pixel);
            ((at_x - x) * (to_y - y) - (at_y - y) * (to_x - x)).abs() / long
        };
        let mut stays = long > 0.0 && (1..length).all(|index| off(at(index)) <= TOLERANCE);
        maps.walk(first, last, |pixel, _| stays &= self.labels[pixel] == self.labels[first]);
        stays
    }
}
