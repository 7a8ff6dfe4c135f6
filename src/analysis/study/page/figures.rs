//! Numbers as people read them.

use crate::analysis::study::outcome::Interval;

/// Three significant digits: 0.00123, 45.6, 1.23×10⁻⁵. What is no number is a dash, what is beyond all numbers ∞.
pub(in crate::analysis::study) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.is_nan() {
        return "–".into();
    }
    let sign = if value < 0.0 { "−" } else { "" };
    if value.is_infinite() {
        return format!("{sign}∞");
    }
    let rounded = format!("{:.2e}", value.abs());
    match rounded.split_once('e').and_then(|(digits, exponent)| Some((digits, exponent.parse().ok()?))) {
        Some((_, exponent @ -3..=3)) => {
            let decimals = usize::try_from(2 - exponent).unwrap_or(0);
            format!("{sign}{:.decimals$}", value.abs())
        }
        Some((digits, exponent)) => format!("{sign}{digits}×{}", power_of_ten(exponent)),
        None => rounded,
    }
}

/// 10 with its exponent raised.
pub(super) fn power_of_ten(exponent: i32) -> String {
    let raised = |digit| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' | '4'..='9' => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
        other => other,
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// A time with its unit.
pub(in crate::analysis::study) fn seconds(value: f64) -> String {
    format!("{} s", number(value))
}

/// The ends of an interval.
pub(super) fn ends(interval: Interval) -> String {
    format!("[{}, {}]", number(interval.low), number(interval.high))
}

/// A count with its thousands apart.
pub(super) fn count(value: u64) -> String {
    let digits = value.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join("\u{202f}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_at_any_size() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.00"),
            (9.996, "10.0"),
            (0.001_234, "0.00123"),
            (0.000_999_9, "0.00100"),
            (1234.5, "1234"),
            (99_999.0, "1.00×10⁵"),
            (-0.5, "−0.500"),
            (1e-30, "1.00×10⁻³⁰"),
            (1.5e300, "1.50×10³⁰⁰"),
            (f64::MIN_POSITIVE, "2.23×10⁻³⁰⁸"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "–"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text, "{value:e}");
        }
        assert_eq!((count(7), count(1_234_567)), ("7".into(), "1\u{202f}234\u{202f}567".into()));
    }
}
