//! Images of parts of a film, side by side.

use crate::{
    film::{Channel, Window, noise::Noise},
    math::Spectrum,
    passes::faults::{Fault, Faults},
    render::image::{Image, Reached},
};
use std::time::Duration;

/// The image of a part.
pub struct Tile {
    /// Where in the whole film.
    pub window: Window,
    /// Its pixels.
    pub image: Image,
}

/// True if a pixel is in both.
pub fn overlap(a: &Window, b: &Window) -> bool {
    (0..2).all(|axis| {
        a.offset[axis] < b.offset[axis] + b.size[axis] && b.offset[axis] < a.offset[axis] + a.size[axis]
    })
}

/// The first part of `whole` that is in none of `parts`; these do not overlap.
pub fn missing(whole: &Window, parts: &[Window]) -> Option<Window> {
    let ends = |axis: usize| {
        let ends = parts.iter().map(move |part| part.offset[axis] + part.size[axis]);
        let mut ends: Vec<u32> = ends.chain([whole.offset[axis]]).collect();
        ends.sort_unstable();
        ends
    };
    let (columns, rows) = (ends(0), ends(1));
    let within = |window: &Window| {
        (0..2).all(|axis| window.offset[axis] < whole.offset[axis] + whole.size[axis])
            && !parts.iter().any(|part| overlap(part, window))
    };
    let at = |x: u32, y: u32| Window { offset: [x, y], size: [1, 1], ..*whole };
    let corners = rows.iter().flat_map(|y| columns.iter().map(move |x| at(*x, *y)));
    let mut found = corners.into_iter().find(within)?;
    // As wide, then as high, as the next part allows.
    for axis in 0..2 {
        let all = whole.offset[axis] + whole.size[axis] - found.offset[axis];
        let reaching = |part: &&Window| {
            let mut long = found;
            long.size[axis] = all;
            overlap(part, &long)
        };
        let next = parts.iter().filter(reaching).map(|part| part.offset[axis] - found.offset[axis]).min();
        found.size[axis] = next.unwrap_or(all);
    }
    Some(found)
}

impl Image {
    /// The image of `whole` from tiles that cover it. Numbers of samples and errors are means over the pixels; errors are
    /// relative to each tile's own mean.
    pub fn of_tiles(whole: &Window, tiles: &[Tile]) -> Self {
        let pixels = whole.size.iter().map(|size| *size as usize).product::<usize>();
        let mean = |value: &dyn Fn(&Self) -> f64| {
            let sums = tiles.iter().map(|Tile { image, .. }| value(image) * image.pixels.len() as f64);
            sums.sum::<f64>() / pixels as f64
        };
        let samples = mean(&|image| image.samples());
        let part = |image: &Self| Some((image.pixels.len() as f64 / pixels as f64, image.noise?));
        let noises: Option<Vec<_>> = tiles.iter().map(|tile| part(&tile.image)).collect();
        let share = mean(&|image| image.reached.as_ref().map_or(0.0, |reached| reached.share));
        let has_reached = tiles.iter().all(|tile| tile.image.reached.is_some());
        let counts = |image: &Self| image.reached.as_ref().map(|reached| reached.samples.clone());
        Self {
            pixels: placed(whole, tiles, Spectrum::ZERO, |image| Some(image.pixels.clone())),
            samples_per_pixel: samples as u64,
            unfinished: samples.fract(),
            elapsed: tiles.iter().map(|tile| tile.image.elapsed).sum::<Duration>(),
            noise: noises.map(|noises| Noise::sum(noises.into_iter())),
            alpha: match tiles.iter().any(|tile| tile.image.alpha.is_empty()) {
                true => Vec::new(),
                false => placed(whole, tiles, 0.0, |image| Some(image.alpha.clone())),
            },
            layers: layers(whole, tiles),
            reached: has_reached.then(|| Reached { share, samples: placed(whole, tiles, 0, counts) }),
            faults: faults(whole, tiles),
        }
    }
}

/// Channels that all tiles have.
fn layers(whole: &Window, tiles: &[Tile]) -> Vec<Channel> {
    let find = |image: &Image, name: &str| {
        image.layers.iter().find(|layer| layer.name == name).map(|layer| layer.values.clone())
    };
    let names = tiles.first().into_iter().flat_map(|tile| &tile.image.layers).map(|layer| layer.name.clone());
    let shared = names.filter(|name| tiles.iter().all(|tile| find(&tile.image, name).is_some()));
    let layer = |name: String| {
        let values = placed(whole, tiles, 0.0, |image| find(image, &name));
        Channel { name, values }
    };
    shared.map(layer).collect()
}

/// Values of the tiles' pixels where these lie in `whole`.
fn placed<T: Copy>(
    whole: &Window,
    tiles: &[Tile],
    zero: T,
    values: impl Fn(&Image) -> Option<Vec<T>>,
) -> Vec<T> {
    let mut all = vec![zero; whole.size.iter().map(|size| *size as usize).product()];
    for Tile { window, image } in tiles {
        for (pixel, value) in values(image).into_iter().flatten().enumerate() {
            all[place(whole, window, pixel)] = value;
        }
    }
    all
}

/// Which pixel of `whole` a pixel of the part `window` is.
fn place(whole: &Window, window: &Window, pixel: usize) -> usize {
    let [left, top] = [0, 1].map(|axis| (window.offset[axis] - whole.offset[axis]) as usize);
    let width = window.size[0] as usize;
    (top + pixel / width) * whole.size[0] as usize + left + pixel % width
}

fn faults(whole: &Window, tiles: &[Tile]) -> Faults {
    let mut all = Faults::default();
    for Tile { window, image: Image { faults, .. } } in tiles {
        let at = |pixel: u32| place(whole, window, pixel as usize) as u32;
        let first = faults.first.iter().map(|fault| Fault { pixel: fault.pixel.map(at), ..fault.clone() });
        all.merge(&Faults { count: faults.count, first: first.collect() });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Window = Window { full_size: [100, 100], offset: [10, 20], size: [6, 5] };

    fn part(offset: [u32; 2], size: [u32; 2]) -> Window {
        Window { offset: [offset[0] + 10, offset[1] + 20], size, ..WHOLE }
    }

    #[test]
    fn the_first_gap_is_found() {
        let (left, top, bottom) = (part([0, 0], [2, 5]), part([2, 0], [4, 2]), part([3, 3], [3, 2]));
        for (parts, gap) in [
            (vec![], Some(WHOLE)),
            (vec![WHOLE], None),
            (vec![left], Some(part([2, 0], [4, 5]))),
            (vec![top, left], Some(part([2, 2], [4, 3]))),
            (vec![bottom, top, left], Some(part([2, 2], [4, 1]))),
            (vec![bottom, top, left, part([2, 2], [4, 1])], Some(part([2, 3], [1, 2]))),
            (vec![top, bottom], Some(part([0, 0], [2, 5]))),
        ] {
            assert_eq!(missing(&WHOLE, &parts), gap, "{parts:?}");
        }
        assert!(overlap(&left, &part([1, 4], [1, 1])) && !overlap(&left, &top) && !overlap(&top, &bottom));
    }
}
