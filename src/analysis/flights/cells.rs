//! Matter that differs from cell to cell of a subdivided medium, and straight ways through it.

use crate::math::DVec3;
use serde::Serialize;

/// Coefficients (1/m), both >= 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Matter {
    /// Absorption.
    pub sigma_a: f64,
    /// Scattering.
    pub sigma_s: f64,
}

impl Matter {
    /// Extinction (1/m).
    pub fn sigma_t(self) -> f64 {
        self.sigma_a + self.sigma_s
    }

    /// Share of the extinction that is scattering; 0 in vacuum.
    pub fn albedo(self) -> f64 {
        if self.sigma_t() > 0.0 { self.sigma_s / self.sigma_t() } else { 0.0 }
    }
}

/// Equal cells of a medium: along x and y, where a slab has one, and in depth.
#[derive(Clone, Debug)]
pub struct Cells {
    counts: [usize; 3],
    /// x fastest, then y, then from the face that light enters.
    matter: Vec<Matter>,
}

/// A part of a way within one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Index of the cell.
    pub cell: usize,
    /// Distance of its start along the way (m).
    pub start: f64,
    /// And of its end.
    pub end: f64,
}

impl Cells {
    /// The same everywhere.
    pub fn one(matter: Matter) -> Self {
        Self::new([1; 3], vec![matter])
    }

    /// `counts` >= 1 of cells along x, y and depth, and as many entries of `matter` as their product.
    pub fn new(counts: [usize; 3], matter: Vec<Matter>) -> Self {
        Self { counts, matter }
    }

    /// What is in each cell.
    pub fn matter(&self) -> &[Matter] {
        &self.matter
    }

    /// How many cells lie along x, y and depth.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// What is everywhere, if that is the same.
    pub fn only(&self) -> Option<Matter> {
        self.matter.iter().all(|matter| *matter == self.matter[0]).then_some(self.matter[0])
    }

    /// The mean extinction over the volume (1/m).
    pub fn mean_extinction(&self) -> f64 {
        self.matter.iter().map(|matter| matter.sigma_t()).sum::<f64>() / self.matter.len() as f64
    }

    /// The way from `position` along the unit `direction` as far as `limit`, in a medium of `size` that reaches from
    /// -size / 2 to size / 2 along x and y and from 0 to size in depth: at least one section, the last of which ends at
    /// `limit`.
    pub fn way(&self, size: f64, position: DVec3, direction: DVec3, limit: f64) -> Way {
        let axes = [
            (position.x + 0.5 * size, direction.x),
            (position.y + 0.5 * size, direction.y),
            (position.z, direction.z),
        ];
        let axis = |i: usize| Axis::new(self.counts[i], size, axes[i].0, axes[i].1);
        Way { axes: [axis(0), axis(1), axis(2)], at: 0.0, limit, is_over: false }
    }
}

/// Where a way is along one axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    count: usize,
    cell: usize,
    is_forward: bool,
    /// Distance along the way of the next border; infinite where none is ahead.
    border: f64,
    /// Distance from border to border.
    width: f64,
}

impl Axis {
    /// At `place` in [0, size], with the component `part` of a direction. On a border it is in the cell ahead.
    fn new(count: usize, size: f64, place: f64, part: f64) -> Self {
        let mut axis = Self { count, cell: 0, is_forward: part >= 0.0, border: f64::INFINITY, width: 0.0 };
        if count == 1 {
            return axis;
        }
        let width = size / count as f64;
        let number = place / width;
        let number = if axis.is_forward { number.floor() } else { number.ceil() - 1.0 };
        axis.cell = (number.max(0.0) as usize).min(count - 1);
        if !axis.is_last() && part != 0.0 {
            let border = (axis.cell + usize::from(axis.is_forward)) as f64 * width;
            axis.border = ((border - place) / part).max(0.0);
            axis.width = width / part.abs();
        }
        axis
    }

    fn is_last(&self) -> bool {
        self.cell == if self.is_forward { self.count - 1 } else { 0 }
    }

    fn cross(&mut self) {
        self.cell = if self.is_forward { self.cell + 1 } else { self.cell - 1 };
        self.border = if self.is_last() { f64::INFINITY } else { self.border + self.width };
    }
}

/// The sections of a straight way.
#[derive(Clone, Debug)]
pub struct Way {
    axes: [Axis; 3],
    at: f64,
    limit: f64,
    is_over: bool,
}

impl Iterator for Way {
    type Item = Section;

    fn next(&mut self) -> Option<Section> {
        if self.is_over {
            return None;
        }
        let [x, y, z] = &mut self.axes;
        let cell = x.cell + x.count * (y.cell + y.count * z.cell);
        let nearer = if y.border < x.border { y } else { x };
        let nearest = if z.border < nearer.border { z } else { nearer };
        let start = self.at;
        self.is_over = nearest.border >= self.limit;
        if self.is_over {
            self.at = self.limit;
        } else {
            self.at = nearest.border.max(start);
            nearest.cross();
        }
        Some(Section { cell, start, end: self.at })
    }
}

/// What `sigma` (1/m) makes over `length` (m); nothing makes nothing however far.
pub fn depth(sigma: f64, length: f64) -> f64 {
    if sigma > 0.0 { sigma * length } else { 0.0 }
}
