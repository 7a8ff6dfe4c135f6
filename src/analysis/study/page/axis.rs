//! A logarithmic scale: what it holds, and its ticks.

use super::figures::power_of_ten;
use plotters::{
    coord::combinators::{LogCoord, WithKeyPoints},
    prelude::{BindKeyPoints, IntoLogRange},
};

/// Room beyond the least and the greatest value, as a factor.
const PADDING: f64 = 1.4;
/// Values further from the core of a scale than this factor are drawn at its end.
const NEAR: f64 = 30.0;
/// More numbers than this do not fit beside a scale.
const MOST_LABELS: i32 = 8;
/// More guiding lines than this hide the curves.
const MOST_LINES: f64 = 12.0;

/// From `low` to `high`, 0 < low < high, both finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Span {
    /// Around all `values` above 0; without any, from 0.1 to 1.
    pub(super) fn around(values: impl Iterator<Item = f64>) -> Self {
        let shown = values.filter(|value| *value > 0.0 && value.is_finite());
        let ends = |span: Option<Self>, value: f64| {
            let span = span.unwrap_or(Self { low: value, high: value });
            Some(Self { low: span.low.min(value), high: span.high.max(value) })
        };
        let Some(Self { low, high }) = shown.fold(None, ends) else { return Self { low: 0.1, high: 1.0 } };
        // Not narrower than half a decade, so that noise does not look like change.
        let padding = if high / low < 2.0 { 2.0 } else { PADDING };
        Self { low: (low / padding).clamp(1e-300, 1e299), high: (high * padding).clamp(1e-299, 1e300) }
    }

    /// True for what the scale may be stretched to hold.
    pub(super) fn is_near(&self, value: f64) -> bool {
        value > self.low / NEAR && value < self.high * NEAR
    }

    /// `value` on the scale; what is off it is put at its end, and what is no number at the high one: of errors and
    /// times that is the worst.
    pub(super) fn clamped(&self, value: f64) -> f64 {
        if value.is_nan() { self.high } else { value.clamp(self.low, self.high) }
    }

    /// For plotters.
    pub(super) fn coordinate(&self) -> WithKeyPoints<LogCoord<f64>> {
        (self.low..self.high).log_scale().with_key_points(self.ticks())
    }

    /// Where lines and numbers are.
    fn ticks(&self) -> Vec<f64> {
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        let of = |digits: &[f64], step: i32| -> Vec<f64> {
            let decades = (first..=last).filter(|k| k.rem_euclid(step) == 0);
            let values = decades.flat_map(|k| digits.iter().map(move |d| d * 10f64.powi(k)));
            values.filter(|value| (self.low..=self.high).contains(value)).collect()
        };
        let decades = of(&[1.0], 1).len() as i32;
        // Short numbers leave room for more.
        let few = if self.is_plain() { 2 } else { 1 };
        if decades <= few {
            return of(&[1.0, 2.0, 5.0], 1);
        }
        of(&[1.0], (decades + MOST_LABELS - 1) / MOST_LABELS)
    }

    /// True where numbers need no powers of ten.
    fn is_plain(&self) -> bool {
        self.low >= 1e-3 && self.high <= 1e5
    }

    /// A tick's number. Far from 1 the whole scale has powers of ten.
    pub(super) fn label(&self, value: f64) -> String {
        if self.is_plain() {
            return format!("{}", (value * 1e6).round() / 1e6);
        }
        let exponent = value.log10().floor() as i32;
        let exponent = if 10f64.powi(exponent + 1) <= value * 1.000_001 { exponent + 1 } else { exponent };
        match (value / 10f64.powi(exponent)).round() as i64 {
            1 => power_of_ten(exponent),
            digit => format!("{digit}·{}", power_of_ten(exponent)),
        }
    }

    /// Lines y = c x^slope across both scales, each for ten times (or a power of it, where they are many) as much x as
    /// the one before; slope < 0.
    pub(super) fn parallels(&self, up: &Self, slope: f64) -> Vec<[(f64, f64); 2]> {
        let crossing = |x: f64, y: f64| x.log10() - y.log10() / slope;
        let (first, last) = (crossing(self.low, up.low).ceil(), crossing(self.high, up.high).floor());
        let step = ((last - first) / MOST_LINES).ceil().max(1.0);
        let count = ((last - first) / step).floor().max(-1.0) as usize + 1;
        let lines = (0..count).map(|k| first + step * k as f64);
        lines.filter_map(|k| self.line_through(up, k, slope)).collect()
    }

    /// The part that both scales hold of the line with `slope` that crosses y = 1 at x = 10^k.
    fn line_through(&self, up: &Self, k: f64, slope: f64) -> Option<[(f64, f64); 2]> {
        let along = |y: f64| 10f64.powf(k + y.log10() / slope);
        let height = |x: f64| up.clamped(10f64.powf(slope * (x.log10() - k)));
        let (start, end) = (along(up.high).max(self.low), along(up.low).min(self.high));
        (start < end).then(|| [start, end].map(|x| (x, height(x))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_span_is_a_scale() {
        let cases: &[&[f64]] = &[
            &[],
            &[0.0],
            &[1.0],
            &[1e-320],
            &[1e308],
            &[f64::MAX],
            &[1e-300, 1e300],
            &[f64::INFINITY],
            &[0.3, 0.30001],
        ];
        for values in cases {
            let span = Span::around(values.iter().copied());
            assert!(0.0 < span.low && span.low < span.high && span.high.is_finite(), "{values:?}: {span:?}");
            let ticks = span.ticks();
            assert!(ticks.len() <= 9 && !ticks.is_empty(), "{values:?}: {ticks:?}");
            assert!(ticks.iter().all(|tick| !span.label(*tick).is_empty()));
        }
    }

    #[test]
    fn what_is_off_a_scale_stands_at_its_end_and_nan_at_the_worst() {
        let span = Span { low: 0.1, high: 10.0 };
        let shown = [0.0, 1.0, f64::INFINITY, f64::NAN].map(|value| span.clamped(value));
        assert_eq!(shown, [0.1, 1.0, 10.0, 10.0]);
    }

    #[test]
    fn labels_are_short() {
        let seconds = Span { low: 0.05, high: 300.0 };
        let labels: Vec<String> = seconds.ticks().iter().map(|tick| seconds.label(*tick)).collect();
        assert_eq!(labels, ["0.1", "1", "10", "100"]);
        let errors = Span { low: 2e-6, high: 3e-4 };
        let labels: Vec<String> = errors.ticks().iter().map(|tick| errors.label(*tick)).collect();
        assert_eq!(labels, ["10⁻⁵", "10⁻⁴"]);
        let narrow = Span { low: 2e-6, high: 8e-6 };
        let labels: Vec<String> = narrow.ticks().iter().map(|tick| narrow.label(*tick)).collect();
        assert_eq!(labels, ["2·10⁻⁶", "5·10⁻⁶"]);
    }

    #[test]
    fn guides_fall_as_their_slope_says() {
        let (across, up) = (Span { low: 1.0, high: 100.0 }, Span { low: 1e-3, high: 10.0 });
        for slope in [-1.0, -0.5] {
            let lines = across.parallels(&up, slope);
            assert!(lines.len() >= 5, "{lines:?}");
            for [(x0, y0), (x1, y1)] in &lines {
                let found = (y1 / y0).ln() / (x1 / x0).ln();
                assert!((found - slope).abs() < 1e-9 && *x0 >= 1.0 && *x1 <= 100.0, "{lines:?}");
            }
            let at_one = |[(x, y), _]: &[(f64, f64); 2]| x.log10() - y.log10() / slope;
            assert!(lines.windows(2).all(|pair| (at_one(&pair[1]) - at_one(&pair[0]) - 1.0).abs() < 1e-9));
        }
        let (far, deep) = (Span { low: 1e-300, high: 1e300 }, Span { low: 1e-300, high: 1e300 });
        assert!(far.parallels(&deep, -1.0).len() <= 1 + MOST_LINES as usize);
    }
}
