//! Short captions in pixels, by a font of eight by eight.

use font8x8::{BASIC_FONTS, UnicodeFonts};

/// Height of a line (pixels of the font).
pub(super) const HEIGHT: usize = 8;
/// From one letter to the next (pixels of the font).
const ADVANCE: usize = 8;

/// Pixels of the font that `text` takes across.
pub(super) fn width(text: &str) -> usize {
    text.chars().count() * ADVANCE
}

/// The pixels of the font that `text` inks, from its left and top.
pub(super) fn ink(text: &str) -> impl Iterator<Item = [usize; 2]> {
    let letters = text.chars().enumerate().flat_map(|(index, letter)| {
        let lines = glyph(letter).into_iter().enumerate();
        lines.map(move |(y, bits)| (index * ADVANCE, y, bits))
    });
    letters.flat_map(|(left, y, bits)| {
        (0..ADVANCE).filter(move |x| bits >> x & 1 == 1).map(move |x| [left + x, y])
    })
}

/// The lines of a letter from its top, the lowest bit at the left; a block for one that there is none of.
fn glyph(letter: char) -> [u8; HEIGHT] {
    BASIC_FONTS.get(letter).unwrap_or([0xff; HEIGHT])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::strategy::StrategyKind;

    #[test]
    fn all_that_captions_are_made_of_has_letters() {
        let names = StrategyKind::ALL.map(StrategyKind::name).concat();
        let used = format!("{names} (0123456789,) segments > cells guided, camera light: 1.5 %");
        for letter in used.chars() {
            assert_ne!(glyph(letter), [0xff; HEIGHT], "{letter}");
        }
    }

    #[test]
    fn letters_stand_side_by_side() {
        assert_eq!((width(""), width("1"), width("11")), (0, 8, 16));
        let columns = |text| {
            let all: Vec<usize> = ink(text).map(|at| at[0]).collect();
            (all.iter().min().copied(), all.iter().max().copied())
        };
        let (first, last) = columns("-");
        assert_eq!(columns(" -"), (first.map(|x| x + 8), last.map(|x| x + 8)));
        assert!(ink("L").filter(|at| at[1] == 0).all(|at| at[0] < 4) && ink("L").all(|at| at[1] < HEIGHT));
        assert_eq!(ink("\u{2603}").count(), 64);
    }
}
