//! What of an image is written, and in which numbers: Mitsuba's `pixel_format`, `component_format` and
//! `file_format`.

use super::Channel;
use crate::math::{Spectrum, SpectrumExt, Vec3, vec3};

/// Which colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    /// Y alone, Rec. 709 luminance.
    Luminance,
    /// Linear sRGB.
    Rgb,
    /// CIE 1931 X, Y, Z.
    Xyz,
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// Half precision: three digits, at most 65504.
    Float16,
    /// Single precision.
    Float32,
    /// 0 to 1 as 0 to 2^32 - 1, as Mitsuba does; what lies outside is cut off.
    Uint32,
}

/// The kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// OpenEXR: everything.
    OpenExr,
    /// Portable float map: luminance or RGB, single precision.
    Pfm,
    /// Radiance: RGB with a common exponent, two digits.
    Rgbe,
}

/// What is written of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Which colours.
    pub colours: Colours,
    /// Also the part of a pixel that the scene covers.
    pub alpha: bool,
    /// How numbers are stored.
    pub component: Component,
    /// The kind of file.
    pub file: FileKind,
}

impl Default for Format {
    /// Loses nothing: Mitsuba would store half precision.
    fn default() -> Self {
        Self { colours: Colours::Rgb, alpha: false, component: Component::Float32, file: FileKind::OpenExr }
    }
}

/// Mitsuba's names of pixel formats: colours, and whether alpha comes with them.
pub const PIXEL_FORMATS: &[(&str, (Colours, bool))] = &[
    ("luminance", (Colours::Luminance, false)),
    ("luminance_alpha", (Colours::Luminance, true)),
    ("rgb", (Colours::Rgb, false)),
    ("rgba", (Colours::Rgb, true)),
    ("xyz", (Colours::Xyz, false)),
    ("xyza", (Colours::Xyz, true)),
];

/// Mitsuba's names of component formats.
pub const COMPONENT_FORMATS: &[(&str, Component)] =
    &[("float16", Component::Float16), ("float32", Component::Float32), ("uint32", Component::Uint32)];

/// Mitsuba's names of file formats.
pub const FILE_FORMATS: &[(&str, FileKind)] = &[
    ("openexr", FileKind::OpenExr),
    ("exr", FileKind::OpenExr),
    ("pfm", FileKind::Pfm),
    ("rgbe", FileKind::Rgbe),
];

impl FileKind {
    /// The ending of its files' names.
    pub fn extension(self) -> &'static str {
        match self {
            Self::OpenExr => "exr",
            Self::Pfm => "pfm",
            Self::Rgbe => "rgbe",
        }
    }

    /// What its files can hold.
    pub fn holds(self) -> &'static str {
        match self {
            Self::OpenExr => "any channels",
            Self::Pfm => "luminance or RGB in single precision",
            Self::Rgbe => "RGB with a common exponent",
        }
    }

    /// The kind of file with this extension.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_lowercase().as_str() {
            "exr" => Some(Self::OpenExr),
            "pfm" => Some(Self::Pfm),
            "rgbe" | "hdr" => Some(Self::Rgbe),
            _ => None,
        }
    }
}

impl Format {
    /// The same as far as a file of `kind` can hold it.
    pub fn in_file(self, file: FileKind) -> Self {
        let colours = match file {
            FileKind::OpenExr => return Self { file, ..self },
            FileKind::Pfm if self.colours == Colours::Luminance && !self.alpha => Colours::Luminance,
            FileKind::Pfm | FileKind::Rgbe => Colours::Rgb,
        };
        Self { colours, alpha: false, component: Component::Float32, file }
    }

    /// Names of its channels.
    pub fn names(&self) -> Vec<&'static str> {
        let colours: &[&str] = match self.colours {
            Colours::Luminance => &["Y"],
            Colours::Rgb => &["R", "G", "B"],
            Colours::Xyz => &["X", "Y", "Z"],
        };
        colours.iter().copied().chain(self.alpha.then_some("A")).collect()
    }

    /// The channels of an image; `alpha` is left out where the format has none.
    pub fn channels(&self, pixels: &[Spectrum], alpha: &[f32]) -> Vec<Channel> {
        let colours: Vec<Vec<f32>> = match self.colours {
            Colours::Luminance => vec![pixels.iter().map(|pixel| pixel.luminance()).collect()],
            Colours::Rgb => planes(pixels.iter().copied()),
            Colours::Xyz => planes(pixels.iter().map(|pixel| to_xyz(*pixel))),
        };
        let alpha = self.alpha.then(|| alpha.to_vec());
        let names = self.names().into_iter().map(str::to_owned);
        names.zip(colours.into_iter().chain(alpha)).map(|(name, values)| Channel { name, values }).collect()
    }
}

/// The three components of every item, each as a plane of its own.
pub fn planes(items: impl Iterator<Item = Vec3> + Clone) -> Vec<Vec<f32>> {
    (0..3).map(|i| items.clone().map(|item| item[i]).collect()).collect()
}

/// Rows of the matrix from linear sRGB to CIE XYZ (ITU-R BT.709 primaries, D65), with Mitsuba's digits.
pub const XYZ_ROWS: [Vec3; 3] = [
    vec3(0.412_453, 0.357_580, 0.180_423),
    vec3(0.212_671, 0.715_160, 0.072_169),
    vec3(0.019_334, 0.119_193, 0.950_227),
];

/// CIE XYZ of a linear sRGB colour.
pub fn to_xyz(rgb: Spectrum) -> Vec3 {
    Vec3::from_array(XYZ_ROWS.map(|row| row.dot(rgb)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mitsuba 3.9.1 writes these channels, and for a diffuse sRGB grey these values.
    #[test]
    fn every_pixel_format_has_mitsubas_channels() {
        let grey = [Spectrum::splat(0.5)];
        for (name, channels, values) in [
            ("luminance", "Y", &[0.5][..]),
            ("luminance_alpha", "YA", &[0.5, 0.25]),
            ("rgb", "RGB", &[0.5, 0.5, 0.5]),
            ("rgba", "RGBA", &[0.5, 0.5, 0.5, 0.25]),
            ("xyz", "XYZ", &[0.475_228, 0.5, 0.544_377]),
            ("xyza", "XYZA", &[0.475_228, 0.5, 0.544_377, 0.25]),
        ] {
            let (_, (colours, alpha)) = PIXEL_FORMATS.iter().find(|(known, _)| *known == name).unwrap();
            let format = Format { colours: *colours, alpha: *alpha, ..Format::default() };
            let made = format.channels(&grey, &[0.25]);
            let names: String = made.iter().map(|channel| channel.name.as_str()).collect();
            assert_eq!(names, channels, "{name}");
            for (channel, value) in made.iter().zip(values) {
                assert!((channel.values[0] - value).abs() < 1e-6, "{name}: {channel:?}");
            }
        }
    }

    #[test]
    fn older_files_hold_less() {
        let all =
            Format { colours: Colours::Xyz, alpha: true, component: Component::Float16, ..Format::default() };
        assert_eq!(all.in_file(FileKind::OpenExr), all);
        let rgb = Format { file: FileKind::Pfm, ..Format::default() };
        assert_eq!(all.in_file(FileKind::Pfm), rgb);
        assert_eq!(all.in_file(FileKind::Rgbe), Format { file: FileKind::Rgbe, ..rgb });
        let grey = Format { colours: Colours::Luminance, ..rgb };
        assert_eq!(grey.in_file(FileKind::Pfm), grey);
        assert_eq!(grey.in_file(FileKind::Rgbe).colours, Colours::Rgb);
    }
}
