//! `polynomial`: polynomials of the coordinates on a box, repeated in space or 0 outside (BMA02 3.2.2).
//!
//! `x`, `y` and `z` are lists of coefficients in a string, constant first: "0.8, -1, 0, 0, 1" is 0.8 - x + x^4. Every
//! nested `term` adds `coefficient` (1 where not given) times powers of the three coordinates, `powers` (three whole
//! numbers, which must be given). The value is the sum of all. The degree of each, a term's being that of its powers
//! together, is at most 31.
//!
//! The box is [-C, C] along every axis, C being `half_width` (> 0, 1 where not given). With the `wrap` `repeat` (where
//! not given) the same is in every such box, side by side without end; with `zero` it is 0 beyond C along the
//! axes that the function depends on.
//!
//! Along a line, terms of one axis cost no more over many boxes than over two. Mixed terms are integrated box by box.
//! If a line crosses more than 8192 boxes, only as many at its two ends are integrated, and those between are taken to
//! be like them.

use super::{
    placed::{COMMON, Function, Line, Placed, parts},
    quadrature::gauss,
};
use crate::{
    description::{Params, Table, table},
    error::{Error, Result},
    math::{DVec3, axes},
};
use std::sync::Arc;

/// Polynomials on boxes.
pub type Polynomial = Placed<Tile>;

/// The function itself.
#[derive(Clone, Debug)]
pub struct Tile(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    /// What depends on one axis.
    axes: [Axis; 3],
    /// What depends on more.
    mixed: Vec<Term>,
    half: f64,
    repeats: bool,
    /// Exact for every axis, and for the mixed terms along any line.
    rules: [Vec<[f64; 2]>; 4],
}

#[derive(Clone, Copy, Debug)]
struct Term {
    coefficient: f64,
    powers: [u32; 3],
}

const DEGREE: usize = 31;
/// So many boxes are crossed one by one.
const CROSSED: f64 = 8192.0;

pub(super) const TERM: Table = table! {
    "A term of a `polynomial`: a coefficient times powers of the coordinates.";
    number("coefficient", "", ANY, Is(1.0), "The coefficient."),
    vector("powers", "", Required, "Powers of x, y and z: three integers >= 0."),
};

const NUMBERS: &str = "numbers in a string";

fn term(params: &Params<'_>) -> Result<Term> {
    let given = params.vector("powers")?;
    let is_power = |p: &f64| p.fract() == 0.0 && *p >= 0.0;
    if !given.to_array().iter().all(is_power) || given.element_sum() > DEGREE as f64 {
        let expected = format!("three whole numbers >= 0 with a sum of at most {DEGREE}");
        return Err(params.complain("powers", expected, given.to_string()));
    }
    Ok(Term { coefficient: params.float("coefficient")?, powers: given.to_array().map(|p| p as u32) })
}

/// The numbers in the string `name`; none where not given.
fn coefficients(params: &Params<'_>, name: &'static str) -> Result<Vec<f64>> {
    let text = params.optional_string(name)?.unwrap_or_default();
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let numbers = words.map(|word| match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(params.complain(name, "finite numbers in a string, constant first", format!("\"{word}\""))),
    });
    let numbers: Vec<f64> = numbers.collect::<Result<_>>()?;
    if numbers.len() > DEGREE + 1 {
        let expected = format!("at most {} coefficients", DEGREE + 1);
        return Err(params.complain(name, expected, numbers.len().to_string()));
    }
    Ok(numbers)
}

/// The polynomial by Horner's rule.
fn horner(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The axis that all powers but one leave alone; none for mixed terms.
fn only_axis(powers: [u32; 3]) -> Option<usize> {
    match powers.map(|power| power > 0) {
        [_, false, false] => Some(0),
        [false, _, false] => Some(1),
        [false, false, _] => Some(2),
        _ => None,
    }
}

impl Tile {
    fn new(mut axes: [Vec<f64>; 3], terms: &[Term], half: f64, repeats: bool) -> Self {
        let mut mixed = Vec::new();
        for term in terms {
            match only_axis(term.powers) {
                Some(axis) => {
                    let (power, list) = (term.powers[axis] as usize, &mut axes[axis]);
                    list.resize(list.len().max(power + 1), 0.0);
                    list[power] += term.coefficient;
                }
                None => mixed.push(*term),
            }
        }
        let degree = |term: &Term| term.powers.iter().sum::<u32>() as usize;
        let most = mixed.iter().map(degree).max().unwrap_or(0);
        let lengths = [axes[0].len(), axes[1].len(), axes[2].len(), most + 1];
        let rules = lengths.map(|n| gauss(n.div_ceil(2)));
        Self(Arc::new(Inner { axes: axes.map(|list| Axis::new(list, half)), mixed, half, repeats, rules }))
    }

    /// Along `axis` something changes.
    fn depends(&self, axis: usize) -> bool {
        self.0.axes[axis].coefficients.len() > 1 || self.mixes(axis)
    }

    fn mixes(&self, axis: usize) -> bool {
        self.0.mixed.iter().any(|term| term.powers[axis] > 0)
    }

    /// The number of the box that holds the coordinate `x`; 0 is the one around the origin.
    fn cell(&self, x: f64) -> f64 {
        if self.0.repeats { (x / (2.0 * self.0.half)).round() } else { 0.0 }
    }

    /// The coordinate `x` within its box `cell`. Far out, where f64 cannot distinguish boxes, it stays in it.
    fn local(&self, x: f64, cell: f64) -> f64 {
        (x - 2.0 * self.0.half * cell).clamp(-self.0.half, self.0.half)
    }

    fn mixed_value(&self, at: DVec3) -> f64 {
        let power = |term: &Term, axis: usize| at[axis].powi(term.powers[axis] as i32);
        self.0.mixed.iter().map(|t| t.coefficient * power(t, 0) * power(t, 1) * power(t, 2)).sum()
    }

    /// The mean over one box of what depends on `axis`.
    fn mean(&self, axis: usize) -> f64 {
        let half = self.0.half;
        self.0.rules[axis]
            .iter()
            .map(|[x, weight]| weight * horner(&self.0.axes[axis].coefficients, x * half))
            .sum()
    }

    /// The integral of what depends on `axis` from `first` to `last`, all in the box `cell`.
    fn part(&self, axis: usize, line: &Line, [first, last]: [f64; 2], cell: f64) -> f64 {
        let (origin, direction) = (line.origin[axis], line.direction[axis]);
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let value = |x: f64| {
            let at = origin + direction * (middle + half * x);
            horner(&self.0.axes[axis].coefficients, self.local(at, cell))
        };
        let mean: f64 = self.0.rules[axis].iter().map(|[x, weight]| weight * value(*x)).sum();
        mean * (last - first)
    }

    /// The integral of what depends on `axis`: the begun boxes at both ends, and the mean of all whole ones.
    fn along(&self, axis: usize, line: &Line, first: f64, last: f64) -> f64 {
        let (origin, direction) = (line.origin[axis], line.direction[axis]);
        let cells = [first, last].map(|t| self.cell(origin + direction * t));
        if cells[0] == cells[1] {
            return self.part(axis, line, [first, last], cells[0]);
        }
        let towards = 0.5 * direction.signum();
        let border = |cell: f64| (2.0 * self.0.half * cell - origin) / direction;
        let leaves = border(cells[0] + towards).clamp(first, last);
        let enters = border(cells[1] - towards).clamp(leaves, last);
        let ends = self.part(axis, line, [first, leaves], cells[0])
            + self.part(axis, line, [enters, last], cells[1]);
        ends + self.mean(axis) * (enters - leaves)
    }

    /// The integral of the mixed terms.
    fn mixed_integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let rate = |axis: usize| if self.mixes(axis) { line.direction[axis].abs() } else { 0.0 };
        let per_metre =
            if self.0.repeats { (rate(0) + rate(1) + rate(2)) / (2.0 * self.0.half) } else { 0.0 };
        if per_metre * (last - first) <= CROSSED {
            return self.walk(line, first, last);
        }
        let end = 0.5 * CROSSED / per_metre;
        let ends = self.walk(line, first, first + end) + self.walk(line, last - end, last);
        ends * ((last - first) / (2.0 * end))
    }

    /// The same, box by box.
    fn walk(&self, line: &Line, first: f64, last: f64) -> f64 {
        let start = line.at(first);
        let mut cell = axes(|axis| self.cell(start[axis]));
        let step = axes(|axis| line.direction[axis].signum());
        let border = |cell: &[f64; 3], axis: usize| match self.0.repeats && self.mixes(axis) {
            true if line.direction[axis] != 0.0 => {
                let plane = 2.0 * self.0.half * (cell[axis] + 0.5 * step[axis]);
                (plane - line.origin[axis]) / line.direction[axis]
            }
            _ => f64::INFINITY,
        };
        let mut next = axes(|axis| border(&cell, axis));
        let (mut at, mut sum) = (first, 0.0);
        // Far out, where f64 cannot distinguish boxes, borders may stop moving.
        for _ in 0..2 * CROSSED as usize {
            let axis =
                if next[0] <= next[1] && next[0] <= next[2] { 0 } else { usize::from(next[1] > next[2]) + 1 };
            let until = next[axis].clamp(at, last);
            sum += self.mixed_part(line, [at, until], cell);
            at = until;
            if next[axis] >= last {
                return sum;
            }
            cell[axis] += step[axis];
            next[axis] = border(&cell, axis);
        }
        sum + self.mixed_part(line, [at, last], cell)
    }

    fn mixed_part(&self, line: &Line, [first, last]: [f64; 2], cell: [f64; 3]) -> f64 {
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let value = |x: f64| {
            let at = line.at(middle + half * x);
            self.mixed_value(DVec3::from_array(axes(|axis| self.local(at[axis], cell[axis]))))
        };
        let mean: f64 = self.0.rules[3].iter().map(|[x, weight]| weight * value(*x)).sum();
        mean * (last - first)
    }

    /// The intervals within one box that the coordinates from `low` to `high` fold to.
    fn folded(&self, low: f64, high: f64) -> [[f64; 2]; 2] {
        let (half, cells) = (self.0.half, [self.cell(low), self.cell(high)]);
        let (a, b) = (self.local(low, cells[0]), self.local(high, cells[1]));
        match cells[1] - cells[0] {
            0.0 => [[a, b]; 2],
            1.0 => [[a, half], [-half, b]],
            _ => [[-half, half]; 2],
        }
    }
}

/// What depends on one axis: a polynomial, and where it turns.
#[derive(Debug)]
struct Axis {
    /// Constant first.
    coefficients: Vec<f64>,
    /// Where within the box it may turn, and its value there: between neighbours it rises or falls.
    turns: Vec<[f64; 2]>,
}

impl Axis {
    fn new(coefficients: Vec<f64>, half: f64) -> Self {
        let turns = zeros(&derivative(&coefficients), half);
        let turns = turns.into_iter().map(|x| [x, horner(&coefficients, x)]).collect();
        Self { coefficients, turns }
    }

    /// Bounds on an interval, as narrow as rounding allows: by its ends and what turns between them.
    fn bounds(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let between = self.turns.iter().filter(|[x, _]| (low..high).contains(x)).map(|[_, value]| *value);
        let ends = [low, high].map(|x| horner(&self.coefficients, x));
        let [least, most] =
            between.fold([ends[0].min(ends[1]), ends[0].max(ends[1])], |[a, b], v| [a.min(v), b.max(v)]);
        let slack = 1e-13 * magnitude(&self.coefficients, low.abs().max(high.abs()));
        [least - slack, most + slack]
    }
}

fn derivative(coefficients: &[f64]) -> Vec<f64> {
    (1..).zip(coefficients.iter().skip(1)).map(|(power, c)| f64::from(power) * c).collect()
}

/// Where a polynomial changes its sign from -`half` to `half`. Between the zeros of its derivative it does so once at
/// most. Zeros that rounding hides lie where it is within rounding of 0.
fn zeros(coefficients: &[f64], half: f64) -> Vec<f64> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let mut ends = zeros(&derivative(coefficients), half);
    ends.insert(0, -half);
    ends.push(half);
    ends.windows(2).filter_map(|pair| crossing(coefficients, pair[0], pair[1])).collect()
}

/// Where a polynomial that rises or falls from `low` to `high` changes its sign; none where it does not.
fn crossing(coefficients: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let is_above = |x| horner(coefficients, x) > 0.0;
    let first = is_above(low);
    if first == is_above(high) {
        return None;
    }
    loop {
        let middle = 0.5 * low + 0.5 * high;
        if !(low < middle && middle < high) {
            return Some(high);
        }
        if is_above(middle) == first { low = middle } else { high = middle }
    }
}

/// The sum of all terms' absolute values at `x` >= 0.
fn magnitude(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c.abs())
}

/// Bounds of a power on an interval.
fn power([low, high]: [f64; 2], power: u32) -> [f64; 2] {
    let (a, b) = (low.powi(power as i32), high.powi(power as i32));
    let least =
        if power > 0 && power.is_multiple_of(2) && low <= 0.0 && high >= 0.0 { 0.0 } else { a.min(b) };
    [least, a.max(b)]
}

/// Bounds of a product.
pub(super) fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let ends = [a * c, a * d, b * c, b * d];
    [
        ends.iter().copied().fold(f64::INFINITY, f64::min),
        ends.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    ]
}

impl Function for Tile {
    const TABLE: Table = table! {
        "A polynomial of the coordinates on a box, repeated in space or 0 outside (BMA02 3.2.2).";
        text("x", NUMBERS, Optional, "Coefficients of the powers of x, constant first: \"0.8, -1, 0, 0, 1\" is 0.8 - x + x^4."),
        text("y", NUMBERS, Optional, "Coefficients of the powers of y."),
        text("z", NUMBERS, Optional, "Coefficients of the powers of z."),
        nested("volume", Optional, "Mixed terms, plugins `term`."),
        number("half_width", "", above(0.0, f64::MAX), Is(1.0), "The box spans -half_width to half_width along each axis."),
        choice("wrap", &["repeat", "zero"], "repeat", "Outside the box: repeated, or 0.");
        COMMON
    };

    fn read(params: &Params<'_>) -> Result<Self> {
        let axes = [coefficients(params, "x")?, coefficients(params, "y")?, coefficients(params, "z")?];
        let terms = parts(params, "term", &TERM, term)?;
        if terms.is_empty() && axes.iter().all(Vec::is_empty) {
            return Err(Error::new(
                params.location(),
                "coefficients of a polynomial",
                "none",
                "add \"x\", \"y\" or \"z\", such as \"0.8, -1, 0, 0, 1\", or a nested plugin \"term\"",
            ));
        }
        let repeats = params.choice("wrap", &[("repeat", true), ("zero", false)])?;
        let tile = Self::new(axes, &terms, params.float("half_width")?, repeats);
        let most = tile.greatest();
        match most <= 1e30 {
            true => Ok(tile),
            false => Err(params.complain(
                "half_width",
                "one with values within 1e30",
                format!("values up to {most:e}"),
            )),
        }
    }

    #[inline]
    fn eval(&self, position: DVec3) -> f64 {
        let at = DVec3::from_array(axes(|axis| self.local(position[axis], self.cell(position[axis]))));
        let axes: f64 = (0..3).map(|axis| horner(&self.0.axes[axis].coefficients, at[axis])).sum();
        if self.0.mixed.is_empty() { axes } else { axes + self.mixed_value(at) }
    }

    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let folded = axes(|axis| self.folded(low[axis], high[axis]));
        let mut sum = [0.0; 2];
        let mut add = |[least, most]: [f64; 2]| sum = [sum[0] + least, sum[1] + most];
        for (axis, [a, b]) in self.0.axes.iter().zip(folded).filter(|(axis, _)| !axis.coefficients.is_empty())
        {
            let (a, b) = (axis.bounds(a), axis.bounds(b));
            add([a[0].min(b[0]), a[1].max(b[1])]);
        }
        let hull = folded.map(|[a, b]| [a[0].min(b[0]), a[1].max(b[1])]);
        for Term { coefficient, powers } in &self.0.mixed {
            let [x, y, z] = axes(|axis| power(hull[axis], powers[axis]));
            let [a, b] = product(product(x, y), z).map(|bound| bound * coefficient);
            let slack = 1e-13 * a.abs().max(b.abs());
            add([a.min(b) - slack, a.max(b) + slack]);
        }
        sum
    }

    fn extent(&self) -> [DVec3; 2] {
        let half = |axis: usize| match !self.0.repeats && self.depends(axis) {
            true => self.0.half,
            false => f64::INFINITY,
        };
        let corner = DVec3::new(half(0), half(1), half(2));
        [-corner, corner]
    }

    #[inline]
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64 {
        let axes: f64 = (0..3).map(|axis| self.along(axis, line, first, last)).sum();
        if self.0.mixed.is_empty() { axes } else { axes + self.mixed_integral(line, first, last) }
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let none = || [Vec::new(), Vec::new(), Vec::new()];
        let wave = || vec![0.8, -1.0, 0.0, 0.0, 1.0];
        let term = |coefficient, powers| Term { coefficient, powers };
        let saddle = [term(1.0, [2, 0, 0]), term(-2.0, [1, 1, 0]), term(1.0, [0, 2, 0])];
        vec![
            // BMA02 fig. 7.
            Self::new([wave(), Vec::new(), wave()], &[], 1.0, true),
            Self::new([wave(), Vec::new(), wave()], &[], 0.7, false),
            Self::new([Vec::new(), vec![0.2], Vec::new()], &[], 0.1, true),
            Self::new(none(), &saddle, 0.6, true),
            Self::new(
                [vec![1.0, 0.5], vec![], vec![]],
                &[term(-0.3, [1, 2, 3]), term(0.2, [0, 1, 1])],
                1.1,
                false,
            ),
            Self::new([vec![1.0; 32], vec![], vec![]], &[term(0.7, [3, 1, 4])], 0.2, true),
        ]
    }
}

impl Tile {
    /// No value is greater, of either sign.
    fn greatest(&self) -> f64 {
        let half = self.0.half;
        let axes: f64 = self.0.axes.iter().map(|axis| magnitude(&axis.coefficients, half)).sum();
        let degree = |term: &Term| term.powers.iter().sum::<u32>() as i32;
        axes + self.0.mixed.iter().map(|t| t.coefficient.abs() * half.powi(degree(t))).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_and_are_as_narrow_as_rounding_allows() {
        // The last turns twice within a millionth.
        let lists: [&[f64]; 6] = [
            &[],
            &[0.3],
            &[1.0, 0.0, -2.0, 0.0, 1.0],
            &[0.8, -1.0, 0.0, 0.0, 1.0],
            &[1.0; 32],
            &[0.5, 1e-13, 0.0, -1.0 / 3.0, 1.0, 0.2],
        ];
        for list in lists {
            let axis = Axis::new(list.to_vec(), 1.0);
            for i in 0..40 {
                let low = f64::from(i) / 20.0 - 1.0;
                let high = (low + f64::from(i % 7) / 5.0).min(1.0);
                let [least, most] = axis.bounds([low, high]);
                let values = (0..=4000).map(|j| horner(list, low + (high - low) * f64::from(j) / 4000.0));
                let (a, b) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
                assert!(least <= a && most >= b, "{list:?} {low} {high}");
                // Between points that are looked at, a turn may rise by its curvature.
                let slack = 1e-6 * magnitude(&derivative(&derivative(list)), 1.0) + 1e-11;
                assert!(a - least < slack && most - b < slack, "{list:?} {low} {high} {least} {a}");
            }
        }
        assert!(Axis::new(vec![1.0, 0.0, -2.0, 0.0, 1.0], 1.0).bounds([-1.0, 1.0])[0] > -1e-12);
    }
}
