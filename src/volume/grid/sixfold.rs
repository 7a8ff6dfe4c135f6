//! `gridvolume` of six channels: a symmetric matrix that varies in space.

use super::{Filter, Given, Grid, Wrap, check_box, check_place, vol};
use crate::{
    description::{Library, Object, Params},
    error::{Error, Result},
    math::{DAffine3, DVec3, Vec3, axes},
    volume::Place,
};

/// Six numbers a voxel: xx, yy, zz, xy, xz and yz. They fill all of space, as `wrap_mode` says: the box of a grid does not
/// bound them, as it does not in Mitsuba.
#[derive(Clone, Debug)]
pub struct Sixfold {
    size: [usize; 3],
    voxels: Vec<[f32; 6]>,
    filter: Filter,
    wrap: Wrap,
    /// From recentred positions to voxels: the centre of a voxel, or its first corner where the nearest counts, has
    /// whole numbers.
    to_voxels: DAffine3,
}

/// Positions are taken for no farther away (voxels).
const FARTHEST: f64 = 1e15;

impl Sixfold {
    /// Reads what `object` describes, which has to be a `gridvolume` of six channels.
    pub fn read(object: &Object, library: &Library, place: &Place) -> Result<Self> {
        if object.plugin != "gridvolume" {
            let (expected, remedy) = ("a gridvolume of six channels", "use a gridvolume, as Mitsuba does");
            return Err(Error::new(&object.location, expected, format!("\"{}\"", object.plugin), remedy));
        }
        let params = Params::new(object, library, &Grid::TABLE);
        let Given { path, filter, wrap, mut to_world, uses_file_box, .. } = Given::read(&params, place)?;
        params.finish()?;
        let vol::Sixfold { size, voxels, to_file } = vol::sixfold(&path)?;
        if uses_file_box {
            check_box(&path, &to_file)?;
            to_world *= to_file;
        }
        let to_local = to_world.inverse();
        check_place(&path, &to_world, &to_local)?;
        let first = if filter == Filter::Trilinear { -0.5 } else { 0.0 };
        let scale = DAffine3::from_scale(DVec3::from(size.map(|n| n as f64)));
        let to_voxels = DAffine3::from_translation(DVec3::splat(first)) * scale * to_local;
        Ok(Self { size, voxels, filter, wrap, to_voxels })
    }

    /// Every voxel, and where it is in the file.
    pub fn voxels(&self) -> impl Iterator<Item = ([usize; 3], [f64; 6])> {
        let [nx, ny, _] = self.size;
        let at = move |i: usize| [i % nx, i / nx % ny, i / nx / ny];
        self.voxels.iter().enumerate().map(move |(i, voxel)| (at(i), voxel.map(f64::from)))
    }

    /// The six numbers at a recentred position.
    pub fn at(&self, position: Vec3) -> [f64; 6] {
        let at = self.to_voxels.transform_point3(position.as_dvec3());
        let at = at.clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST));
        let first = at.floor();
        let indices = axes(|axis| {
            let index = |i: i64| self.wrap.index(first[axis] as i64 + i, self.size[axis]);
            [index(0), index(1)]
        });
        if self.filter == Filter::Nearest {
            return self.voxel(indices.map(|[index, _]| index)).map(f64::from);
        }
        let mut sum = [0.0; 6];
        for corner in 0..8 {
            let far = axes(|axis| corner >> axis & 1);
            let share = |axis: usize| {
                if far[axis] == 1 { at[axis] - first[axis] } else { 1.0 - (at[axis] - first[axis]) }
            };
            let weight = share(0) * share(1) * share(2);
            let voxel = self.voxel(axes(|axis| indices[axis][far[axis]]));
            sum.iter_mut().zip(voxel).for_each(|(sum, number)| *sum += weight * f64::from(number));
        }
        sum
    }

    fn voxel(&self, [x, y, z]: [usize; 3]) -> [f32; 6] {
        self.voxels[x + self.size[0] * (y + self.size[1] * z)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::Value,
        math::vec3,
        testing::object,
        volume::{self, VolumeModel as _},
    };
    use std::path::Path;

    const SIZE: [i32; 3] = [3, 2, 4];

    fn number(voxel: usize, channel: usize) -> f32 {
        ((voxel * 6 + channel) * 37 % 101) as f32
    }

    /// A file of 3 x 2 x 4 voxels that have these of the six numbers.
    fn write(path: &Path, numbers: std::ops::Range<usize>) {
        let integers = [1, SIZE[0], SIZE[1], SIZE[2], numbers.len() as i32];
        let corners = [-1f32, 0.5, 0.0, 2.0, 1.5, 3.0];
        let voxels = (0..24).flat_map(|voxel| numbers.clone().map(move |channel| number(voxel, channel)));
        let head = b"VOL\x03".iter().copied().chain(integers.into_iter().flat_map(i32::to_le_bytes));
        let bytes: Vec<u8> =
            head.chain(corners.into_iter().chain(voxels).flat_map(f32::to_le_bytes)).collect();
        std::fs::write(path, bytes).unwrap();
    }

    #[test]
    fn each_number_is_what_a_grid_of_it_alone_has() {
        let folder = tempfile::tempdir().unwrap();
        let (place, library) = (Place::new(DVec3::new(0.3, -0.2, 0.1), 0.0), Library::default());
        for (filter, wrap, own_box) in
            [("trilinear", "clamp", true), ("trilinear", "repeat", false), ("nearest", "mirror", false)]
        {
            let describe = |channels: std::ops::Range<usize>| {
                let path = folder.path().join(format!("{channels:?}.vol"));
                write(&path, channels);
                let text = |text: &str| Value::String(text.into());
                let properties = [
                    ("filename", text(&path.display().to_string())),
                    ("filter_type", text(filter)),
                    ("wrap_mode", text(wrap)),
                    ("use_grid_bbox", Value::Boolean(own_box)),
                ];
                object("gridvolume", &properties)
            };
            let six = Sixfold::read(&describe(0..6), &library, &place).unwrap();
            for channel in 0..6 {
                let one = volume::build(&describe(channel..channel + 1), &library, &place).unwrap();
                for i in 0..200u8 {
                    let [x, y, z] = [7u8, 11, 13].map(|step| f32::from(i.wrapping_mul(step)) / 255.0);
                    let (low, high) = one.domain().map(|[low, high]| (low, high)).unwrap();
                    let position = low + (high - low) * vec3(x, y, z);
                    let (found, expected) = (six.at(position)[channel], f64::from(one.eval::<f32>(position)));
                    assert!(
                        (found - expected).abs() < 1e-3,
                        "{filter} {wrap} {position}: {found} for {expected}"
                    );
                }
            }
        }
    }
}
