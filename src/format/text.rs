//! Numbers, colours and spectra written as text, as Mitsuba's XML writes them.

use super::input::bytes;
use crate::{
    description::{Location, Position},
    error::{Error, Result},
    math::srgb::Srgb as _,
};
use std::{path::Path, sync::Arc};

/// Why a text is not what it should be; the caller adds where it is.
#[derive(Debug)]
pub(super) struct Mistake {
    /// What would have been right.
    pub expected: String,
    /// What is there.
    pub found: String,
}

/// Text, read.
pub(super) type Parsed<T> = std::result::Result<T, Mistake>;

/// Text as found, in quotes; of long text the beginning.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("\"{}...\"", &text[..end]),
        None => format!("\"{text}\""),
    }
}

fn mistake<T>(expected: impl Into<String>, found: impl Into<String>) -> Parsed<T> {
    Err(Mistake { expected: expected.into(), found: found.into() })
}

/// The text of a file; it must be UTF-8, or XML that says that it is Latin-1.
pub(super) fn of_file(path: &Path) -> Result<String> {
    let bytes = bytes(path)?;
    if is_latin(&bytes) {
        return Ok(bytes.into_iter().map(char::from).collect());
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let found = match error.as_bytes() {
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "text in UTF-16".into(),
            _ => format!("other bytes at offset {}", error.utf8_error().valid_up_to()),
        };
        Error::new(path.display(), "text in UTF-8", found, "save the file as UTF-8")
    })?;
    // Some editors mark UTF-8 with a byte-order mark, which is no part of the text.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// True for XML whose declaration names Latin-1.
fn is_latin(bytes: &[u8]) -> bool {
    let end = bytes.iter().take(200).position(|byte| *byte == b'>').unwrap_or(0);
    let declaration = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
    declaration.trim_start().starts_with("<?xml")
        && ["iso-8859-1", "latin1"].iter().any(|name| declaration.contains(name))
}

/// A finite number; space around it is allowed.
pub(super) fn float(text: &str) -> Parsed<f64> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => mistake("a finite number", quoted(text)),
    }
}

/// A whole number; space around it is allowed.
pub(super) fn integer(text: &str) -> Parsed<i64> {
    text.trim().parse().or_else(|_| mistake("a whole number between -2^63 and 2^63 - 1", quoted(text)))
}

/// `true` or `false`, in any case.
pub(super) fn boolean(text: &str) -> Parsed<bool> {
    match text.to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => mistake("\"true\" or \"false\"", quoted(text)),
    }
}

/// What commas and space divide.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty())
}

/// Numbers with commas or space between them.
pub(super) fn floats(text: &str) -> Parsed<Vec<f64>> {
    words(text).map(float).collect()
}

fn count_mistake<T>(expected: &str, numbers: &[f64]) -> Parsed<T> {
    let count = numbers.len();
    mistake(expected, format!("{count} number{}", if count == 1 { "" } else { "s" }))
}

/// Three numbers.
pub(super) fn triple(numbers: &[f64]) -> Parsed<[f64; 3]> {
    <[f64; 3]>::try_from(numbers).or_else(|_| count_mistake("three numbers", numbers))
}

/// Three numbers, or one that counts for all three.
pub(super) fn one_or_triple(numbers: &[f64]) -> Parsed<[f64; 3]> {
    match numbers {
        [all] => Ok([*all; 3]),
        [x, y, z] => Ok([*x, *y, *z]),
        _ => count_mistake("one or three numbers", numbers),
    }
}

/// A matrix, row major: all 16 numbers, or the 9 of its linear part.
pub(super) fn matrix(numbers: &[f64]) -> Parsed<[f64; 16]> {
    if let Ok(all) = <[f64; 16]>::try_from(numbers) {
        return Ok(all);
    }
    match numbers {
        [a, b, c, d, e, f, g, h, i] => {
            Ok([*a, *b, *c, 0.0, *d, *e, *f, 0.0, *g, *h, *i, 0.0, 0.0, 0.0, 0.0, 1.0])
        }
        _ => count_mistake("16 or 9 numbers", numbers),
    }
}

/// A linear-sRGB colour: one number, three, or `#rrggbb`, which is sRGB-encoded as colour pickers show it.
/// (Mitsuba 3 refuses `#rrggbb`.)
pub(super) fn rgb(text: &str) -> Parsed<[f64; 3]> {
    match text.trim().strip_prefix('#') {
        Some(digits) => hex(digits),
        None => one_or_triple(&floats(text)?),
    }
}

fn hex(digits: &str) -> Parsed<[f64; 3]> {
    let number = u32::from_str_radix(digits, 16).ok();
    match number.filter(|_| digits.len() == 6 && digits.is_ascii() && !digits.starts_with('+')) {
        Some(rgb) => Ok([rgb >> 16, rgb >> 8, rgb].map(|c| (f64::from(c & 0xff) / 255.0).srgb_decoded())),
        None => mistake("six hexadecimal digits after #", quoted(&format!("#{digits}"))),
    }
}

/// A spectrum: one value at all wavelengths, or values at wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Spectrum {
    /// The same at all wavelengths.
    Constant(f64),
    /// Wavelength (nm) and value, in increasing order of wavelength.
    Sampled(Vec<(f64, f64)>),
}

/// A number, or `wavelength:value` pairs with commas or space between them.
pub(super) fn spectrum(text: &str) -> Parsed<Spectrum> {
    if let (Ok(constant), false) = (float(text), text.contains(':')) {
        return Ok(Spectrum::Constant(constant));
    }
    let pair = |word: &str| match word.split_once(':') {
        Some((wavelength, value)) => Ok((float(wavelength)?, float(value)?)),
        None => mistake("one number, or wavelength:value pairs", quoted(word)),
    };
    samples(words(text).map(pair).collect::<Parsed<_>>()?)
}

/// Checks the order of wavelengths.
pub(super) fn samples(pairs: Vec<(f64, f64)>) -> Parsed<Spectrum> {
    if pairs.len() < 2 {
        let found = format!("{} pairs", pairs.len());
        return mistake("a spectrum: one number, or two or more wavelength:value pairs", found);
    }
    match pairs.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
        None => Ok(Spectrum::Sampled(pairs)),
        Some(pair) => {
            mistake("wavelengths in increasing order", format!("{} after {}", pair[1].0, pair[0].0))
        }
    }
}

/// A spectrum file: a wavelength and a value on each line; `#` starts a comment.
pub(super) fn spectrum_file(path: &Path) -> Result<Spectrum> {
    let file = Arc::new(path.to_owned());
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for (line, text) in (1u32..).zip(of_file(path)?.lines()) {
        let numbers = text.split('#').next().unwrap_or_default();
        let pair = match floats(numbers).as_deref() {
            Ok([]) => continue,
            Ok([nm, value]) if pairs.last().is_none_or(|last| last.0 < *nm) => (*nm, *value),
            _ => {
                let position = Position::Text { line, column: 1 };
                let expected = "a wavelength above the last one, and a value";
                let place = Location { file, position };
                return Err(Error::new(place, expected, quoted(text), "correct the line"));
            }
        };
        pairs.push(pair);
    }
    samples(pairs).map_err(|m| Error::new(path.display(), m.expected, m.found, "fill the file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_mitsuba_reads_them() {
        for (text, number) in [("1.5 ", 1.5), ("+1.5", 1.5), ("1.", 1.0), (".5", 0.5), ("1e1", 10.0)] {
            assert_eq!(float(text).unwrap(), number);
        }
        for text in ["1.5f", "", "1 2", "nan", "inf", "1e999", "0x1"] {
            assert!(float(text).is_err(), "{text}");
        }
        assert_eq!(integer(" 2 ").unwrap(), 2);
        assert!(integer("2.0").is_err());
        assert!(boolean("TRUE").unwrap());
        assert!(boolean(" true").is_err());
        assert_eq!(floats("1,  2\t3\n4").unwrap(), [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn colours_in_three_spellings() {
        assert_eq!(rgb("0.5").unwrap(), [0.5; 3]);
        assert_eq!(rgb("0.1 0.2, 0.3").unwrap(), [0.1, 0.2, 0.3]);
        let [r, g, b] = rgb("#ff8000").unwrap();
        assert_eq!((r, b), (1.0, 0.0));
        assert!((g - 0.215_860_5).abs() < 1e-6);
        for text in ["#ff80", "#gg0000", "#+12345", "1 2", "red", ""] {
            assert!(rgb(text).is_err(), "{text}");
        }
    }

    #[test]
    fn spectra_are_constant_or_sampled_in_order() {
        assert_eq!(spectrum(" 0.4").unwrap(), Spectrum::Constant(0.4));
        let sampled = Spectrum::Sampled(vec![(400.0, 0.1), (700.0, 0.4)]);
        assert_eq!(spectrum("400:0.1, 700:0.4").unwrap(), sampled);
        for text in ["400:0.1", "700:0.1 400:0.4", "0.1 0.4", "", "400:", "400:1:2"] {
            assert!(spectrum(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_matrix_has_16_numbers_or_9() {
        let linear: Vec<f64> = (1..10).map(f64::from).collect();
        assert_eq!(matrix(&linear).unwrap()[4..8], [4.0, 5.0, 6.0, 0.0]);
        assert!(matrix(&[1.0; 12]).is_err());
    }
}
