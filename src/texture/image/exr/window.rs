//! The display window is the picture: what a file holds beyond it (overscan) is left out, what it lacks of it is black.

use exr::{
    image::{FlatSamples, Layer},
    meta::header::ImageAttributes,
};

/// Where the samples of a layer lie in the picture (pixels).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Columns and rows of the picture.
    pub size: [usize; 2],
    /// Columns and rows of samples.
    data: [usize; 2],
    /// Place of the first sample in the picture.
    start: [i64; 2],
}

impl Window {
    /// That of `layer` in an image with these attributes.
    pub fn new<C>(image: &ImageAttributes, layer: &Layer<C>) -> Self {
        let (shown, first) = (image.display_window, layer.attributes.layer_position);
        let start = [(first.x(), shown.position.x()), (first.y(), shown.position.y())];
        Self {
            size: [shown.size.width(), shown.size.height()],
            data: [layer.size.width(), layer.size.height()],
            start: start.map(|(first, shown)| i64::from(first) - i64::from(shown)),
        }
    }

    /// The samples of one channel, pixel by pixel of the picture.
    pub fn values(&self, samples: &FlatSamples) -> Vec<f32> {
        let values: Vec<f32> = samples.values_as_f32().collect();
        let [width, height] = self.size;
        if self.start == [0; 2] && self.data == self.size {
            return values;
        }
        let mut shown = vec![0.0; width * height];
        let rows = shown.chunks_exact_mut(width.max(1));
        for (y, row) in rows.enumerate() {
            let of_row = self.place(1, y).and_then(|y| values.get(y * self.data[0]..));
            for (x, value) in row.iter_mut().enumerate() {
                *value = of_row.zip(self.place(0, x)).and_then(|(row, x)| row.get(x).copied()).unwrap_or(0.0);
            }
        }
        shown
    }

    /// The row or column of samples at one of the picture.
    fn place(&self, axis: usize, at: usize) -> Option<usize> {
        usize::try_from(at as i64 - self.start[axis]).ok().filter(|place| *place < self.data[axis])
    }
}
