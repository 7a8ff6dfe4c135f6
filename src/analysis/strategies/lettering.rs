//! Short captions in pixels: the letters that sheets of strategies need, five pixels wide and seven high.

/// Height of a line [pixels of the font].
pub const HEIGHT: usize = 7;
/// From one letter to the next [pixels of the font].
const ADVANCE: usize = 6;

/// Pixels of the font that `text` takes across.
pub fn width(text: &str) -> usize {
    (text.chars().count() * ADVANCE).saturating_sub(1)
}

/// The pixels of the font that `text` inks, from its left and top.
pub fn ink(text: &str) -> impl Iterator<Item = [usize; 2]> {
    let letters = text.chars().enumerate().flat_map(|(index, letter)| {
        let lines = glyph(letter).into_iter().enumerate();
        lines.map(move |(y, bits)| (index * ADVANCE, y, bits))
    });
    letters.flat_map(|(left, y, bits)| {
        (0..5).filter(move |x| bits >> (4 - x) & 1 == 1).map(move |x| [left + x, y])
    })
}

/// The lines of a letter from its top, the highest of five bits at the left; a block for one that there is none of.
fn glyph(letter: char) -> [u8; HEIGHT] {
    match letter {
        ' ' => [0; HEIGHT],
        '(' => [0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0b00100, 0b00010],
        ')' => [0b01000, 0b00100, 0b00010, 0b00010, 0b00010, 0b00100, 0b01000],
        ',' => [0, 0, 0, 0, 0b00110, 0b00100, 0b01000],
        '-' => [0, 0, 0, 0b01110, 0, 0, 0],
        '>' => [0, 0b01000, 0b00100, 0b00010, 0b00100, 0b01000, 0],
        '0' => [0b01110, 0b10001, 0b10001, 0b10101, 0b10001, 0b10001, 0b01110],
        '1' => [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        '2' => [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111],
        '3' => [0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110],
        '4' => [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010],
        '5' => [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110],
        '6' => [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110],
        '7' => [0b11111, 0b00001, 0b00010, 0b00100, 0b00100, 0b01000, 0b01000],
        '8' => [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110],
        '9' => [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100],
        _ => small(letter),
    }
}

fn small(letter: char) -> [u8; HEIGHT] {
    match letter {
        'a' => [0, 0, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111],
        'e' => [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110],
        'g' => [0, 0, 0b01111, 0b10001, 0b01111, 0b00001, 0b01110],
        'h' => [0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001],
        'i' => [0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110],
        'j' => [0b00010, 0, 0b00110, 0b00010, 0b00010, 0b10010, 0b01100],
        'l' => [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110],
        'm' => [0, 0, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101],
        'n' => [0, 0, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001],
        'o' => [0, 0, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110],
        'q' => [0, 0, 0b01111, 0b10001, 0b01111, 0b00001, 0b00001],
        'r' => [0, 0, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000],
        's' => [0, 0, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110],
        't' => [0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110],
        'u' => [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101],
        'v' => [0, 0, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100],
        'x' => [0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001],
        _ => [0b11111; HEIGHT],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::observer::StrategyKind;

    #[test]
    fn all_that_captions_are_made_of_has_letters() {
        let names = StrategyKind::ALL.map(StrategyKind::name).concat();
        let used = format!("{names} (0123456789,) segments >");
        for letter in used.chars() {
            assert_ne!(glyph(letter), [0b11111; HEIGHT], "{letter}");
        }
    }

    #[test]
    fn letters_stand_side_by_side() {
        assert_eq!((width(""), width("1"), width("11")), (0, 5, 11));
        let row = |y| ink("7-").filter(|at| at[1] == y).map(|at| at[0]).collect::<Vec<_>>();
        assert_eq!(row(0), [0, 1, 2, 3, 4]);
        assert_eq!(row(3), [2, 7, 8, 9]);
    }
}
