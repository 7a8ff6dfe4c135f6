//! Named arrays of numbers, as files hold them.

use crate::{
    math::{DVec3, Spectrum},
    passes::pass::Pass,
};
use safetensors::SafeTensors;

/// A named array.
pub(super) struct Array {
    pub(super) name: String,
    /// The type of its numbers, as safetensors calls it.
    pub(super) kind: &'static str,
    pub(super) shape: Vec<usize>,
    /// The numbers, little-endian.
    pub(super) bytes: Vec<u8>,
}

/// The array of [`Array::of_known`].
const KNOWN: &str = "known";

impl Array {
    /// Numbers in a row.
    pub(super) fn row<const N: usize>(
        name: &str,
        kind: &'static str,
        numbers: impl Iterator<Item = [u8; N]>,
    ) -> Self {
        let bytes: Vec<u8> = numbers.flatten().collect();
        Self { name: name.to_owned(), kind, shape: vec![bytes.len() / N], bytes }
    }

    /// The same, of which each `columns` belong together.
    pub(super) fn in_columns(mut self, columns: usize) -> Self {
        self.shape = vec![self.shape[0] / columns, columns];
        self
    }

    /// Vectors.
    pub(super) fn vectors<'a>(name: &str, vectors: impl IntoIterator<Item = &'a DVec3>) -> Self {
        let numbers = vectors.into_iter().flat_map(|vector| vector.to_array());
        Self::row(name, "F64", numbers.map(f64::to_le_bytes)).in_columns(3)
    }

    /// Which pixels of the unfinished `pass` are known, unless it has not begun.
    pub(super) fn of_known(pass: &Pass, has_begun: bool) -> Self {
        let known = if has_begun { pass.known() } else { &[] };
        Self::row(KNOWN, "U8", known.iter().map(|known| [u8::from(*known)]))
    }

    /// The unfinished `pass`, unless it has not begun.
    pub(super) fn of_pass(pass: &Pass, has_begun: bool) -> [Self; 2] {
        let (camera, light) = if has_begun { pass.parts() } else { (&[][..], &[][..]) };
        [("camera", camera), ("light", light)].map(|(name, spectra)| {
            let numbers = spectra.iter().flat_map(|spectrum| spectrum.to_array());
            Self::row(name, "F32", numbers.map(f32::to_le_bytes)).in_columns(3)
        })
    }
}

/// All arrays of a file.
pub(super) struct Arrays<'a>(SafeTensors<'a>);

impl<'a> Arrays<'a> {
    pub(super) fn of(all: SafeTensors<'a>) -> Self {
        Self(all)
    }

    /// Their bytes as they stand in the file.
    pub(super) fn in_order(&self) -> impl Iterator<Item = &'a [u8]> {
        let mut all: Vec<&'a [u8]> = self.0.iter().map(|(_, array)| array.data()).collect();
        all.sort_by_key(|bytes| bytes.as_ptr());
        all.into_iter()
    }

    /// The numbers of an array.
    pub(super) fn row<T, const N: usize>(&self, name: &str, number: fn([u8; N]) -> T) -> Option<Vec<T>> {
        let bytes = self.0.tensor(name).ok()?.data();
        Some(bytes.as_chunks().0.iter().map(|bytes| number(*bytes)).collect())
    }

    /// As many vectors as there are `pixels`.
    pub(super) fn vectors(&self, name: &str, pixels: usize) -> Option<Vec<DVec3>> {
        let numbers = self.row(name, f64::from_le_bytes)?;
        let vectors = numbers.as_chunks().0.iter().map(|vector| DVec3::from_array(*vector));
        Some(vectors.collect()).filter(|vectors: &Vec<_>| vectors.len() == pixels)
    }

    /// Blocks done of an unfinished pass, of which the file says that they are so many: none where it does not tell which
    /// pixels are known, as those of version 0.2.0.
    pub(super) fn blocks(&self, done: usize) -> usize {
        if self.0.tensor(KNOWN).is_ok() { done } else { 0 }
    }

    /// An unfinished pass over so many `pixels`.
    pub(super) fn pass(&self, pixels: usize, has_begun: bool) -> Option<Pass> {
        if !has_begun {
            return Some(Pass::new(pixels));
        }
        let spectra = |name: &str| {
            let numbers = self.row(name, f32::from_le_bytes)?;
            let spectra = numbers.as_chunks().0.iter().map(|spectrum| Spectrum::from_array(*spectrum));
            Some(spectra.collect()).filter(|spectra: &Vec<_>| spectra.len() == pixels)
        };
        let known: Vec<_> = self.row(KNOWN, u8::from_le_bytes)?.into_iter().map(|known| known != 0).collect();
        if known.len() != pixels {
            return None;
        }
        Some(Pass::of(spectra("camera")?, spectra("light")?, known))
    }
}
