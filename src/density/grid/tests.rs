//! Grids against Mitsuba's values, against quadrature of an interpolation written anew, and against themselves.

use super::*;
use crate::{
    density::Samples,
    math::{DMat4, vec3},
    sampling::{Stream, stream::Purpose},
};

/// Samples in memory, x fastest.
#[derive(Clone)]
pub struct Table<V> {
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

pub fn examples() -> Vec<Grid> {
    let moved = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, -1.0, 3.0),
        glam::DQuat::IDENTITY,
        DVec3::new(-1.0, 1.5, -1.0),
    );
    let mut all = Vec::new();
    for (index, wrap) in (0..).zip(WRAPS) {
        for to_world in [DAffine3::IDENTITY, moved, askew()] {
            all.push(grey(numbers([4, 3, 2], index), Filter::Trilinear, wrap, to_world));
            all.push(chromatic(colours([10, 1, 9], index), Filter::Trilinear, wrap, to_world));
            all.push(chromatic(colours([2, 1, 3], index), Filter::Nearest, wrap, to_world));
        }
    }
    all
}
