//! Values that change in time (BMA02 sec. 5): keys at a few times, and the interpolation between them.

mod matrices;

use super::{
    object::{Location, Property, Value},
    transform::TransformStep,
};
use crate::error::{Error, Result};
use matrices::Parts;

/// A value at several times; constant before the first and after the last of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    interpolation: Interpolation,
    keys: Vec<Key>,
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// When (s).
    pub time: f64,
    /// The value, and where it is.
    pub value: Property,
}

/// How numbers are interpolated between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// On a straight line.
    #[default]
    Linear,
    /// With a continuous slope, and never beyond the two keys: values ease in and out where they rest or turn (Fritsch
    /// and Butland, "A Method for Constructing Local Monotone Piecewise Cubic Interpolants", 1984).
    Smooth,
}

impl Interpolation {
    /// As users write them.
    pub const NAMES: [&'static str; 2] = ["linear", "smooth"];

    /// What `name` refers to.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Linear, Self::Smooth].into_iter().find(|known| known.name() == name)
    }

    /// As users write it.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

impl Keyframes {
    /// `keys` at growing times, each of numbers in the same form; `location` is that of all.
    pub fn new(interpolation: Interpolation, keys: Vec<Key>, location: &Location) -> Result<Self> {
        let Some(Key { value: first, .. }) = keys.first() else {
            return Err(Error::new(location, "one or more keys", "none", "add a time and a value"));
        };
        if numbers(&first.value).is_empty() && matrices::of(&first.value).next().is_none() {
            let expected = "a value of numbers, which can change in time";
            let remedy = "give a number, a colour, a vector, a transform, or numbers in a string";
            return Err(Error::new(&first.location, expected, first.value.describe(), remedy));
        }
        for pair in keys.windows(2) {
            check(&pair[0], &pair[1])?;
        }
        if keys.len() > 1 {
            keys.iter().try_for_each(|key| matrices::check(&key.value, first))?;
        }
        Ok(Self { interpolation, keys })
    }

    /// All keys, by time.
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// The interpolation between keys.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The value at `time` (s).
    pub fn at(&self, time: f64) -> Value {
        self.value(|curve| curve.at(time))
    }

    /// The mean of the value from the time 0 to `time` (s).
    pub fn mean(&self, time: f64) -> Value {
        self.value(|curve| match time == 0.0 {
            true => curve.at(0.0),
            false => (curve.integral(time) - curve.integral(0.0)) / time,
        })
    }

    /// When each of its numbers is least and greatest (s) at the keys from `begin` to `end`. None of a transform: it has
    /// no range.
    pub fn extremes(&self, [begin, end]: [f64; 2]) -> Vec<f64> {
        let is_meant =
            |key: &&Key| (begin..=end).contains(&key.time) && !matches!(key.value.value, Value::Transform(_));
        let keys: Vec<(f64, Vec<f64>)> =
            self.keys.iter().filter(is_meant).map(|key| (key.time, numbers(&key.value.value))).collect();
        let count = keys.first().map_or(0, |(_, numbers)| numbers.len());
        let of_number = |index: usize| {
            let order = |a: &&(f64, Vec<f64>), b: &&(f64, Vec<f64>)| a.1[index].total_cmp(&b.1[index]);
            let [least, greatest] = [keys.iter().min_by(order), keys.iter().max_by(order)];
            let differ = least.zip(greatest).filter(|(least, greatest)| least.1[index] != greatest.1[index]);
            differ.map_or([None; 2], |(least, greatest)| [Some(least.0), Some(greatest.0)])
        };
        (0..count).flat_map(of_number).flatten().collect()
    }

    /// The value with each number as `of` makes it from its curve.
    fn value(&self, of: impl Fn(&Curve) -> f64) -> Value {
        let times: Vec<f64> = self.keys.iter().map(|key| key.time).collect();
        let all: Vec<Vec<f64>> = self.keys.iter().map(|key| numbers(&key.value.value)).collect();
        let mut value = floating(&self.keys[0].value.value);
        let mut index = 0;
        visit(&mut value, &mut |number| {
            let values = all.iter().map(|numbers| numbers[index]).collect();
            *number = of(&Curve { interpolation: self.interpolation, times: &times, values });
            index += 1;
        });
        for (index, rows) in matrices::of_mut(&mut value).enumerate() {
            *rows = self.matrix(&times, index, &of);
        }
        value
    }

    /// Matrix number `index` of the value, likewise; one that is the same in all keys stays as it is.
    fn matrix(&self, times: &[f64], index: usize, of: &impl Fn(&Curve) -> f64) -> [f64; 16] {
        let rows = |key: &Key| matrices::of(&key.value.value).nth(index).copied();
        let given: Vec<[f64; 16]> = self.keys.iter().filter_map(rows).collect();
        if given.iter().all(|rows| *rows == given[0]) {
            return given[0];
        }
        let all: Vec<Parts> = given.iter().filter_map(Parts::of).collect();
        Parts::mixed(&all, |values| of(&Curve { interpolation: self.interpolation, times, values })).rows()
    }
}

/// Two keys must follow each other, in the same form.
fn check(first: &Key, second: &Key) -> Result<()> {
    let place = &second.value.location;
    let grows = first.time < second.time;
    if !grows {
        let expected = format!("keys at growing times, the next one after {} s", first.time);
        let remedy = "put keys in order of time; for a jump, leave a millionth of a second between two";
        return Err(Error::new(place, expected, format!("one at {} s", second.time), remedy));
    }
    let form = |key: &Key| {
        let mut value = floating(&key.value.value);
        visit(&mut value, &mut |number| *number = 0.0);
        matrices::of_mut(&mut value).for_each(|rows| *rows = [0.0; 16]);
        value
    };
    if form(first) == form(second) {
        return Ok(());
    }
    let count = |key: &Key| match numbers(&key.value.value).len() {
        1 => "1 number".to_owned(),
        count => format!("{count} numbers"),
    };
    let of_form = |key: &Key| format!("{} of {}", key.value.value.describe(), count(key));
    let expected = format!("a value in the form of the key before it, {}", of_form(first));
    let remedy = "give every key the same kind of value: as many numbers, the same steps of a transform in the \
                  same order, the same wavelengths";
    Err(Error::new(place, expected, of_form(second), remedy))
}

/// The value, with a number for a whole number.
fn floating(value: &Value) -> Value {
    match value {
        Value::Integer(i) => Value::Float(*i as f64),
        other => other.clone(),
    }
}

/// All numbers of a value that can change, in order; none of what is no number.
fn numbers(value: &Value) -> Vec<f64> {
    let mut all = Vec::new();
    visit(&mut floating(value), &mut |number| all.push(*number));
    all
}

/// Shows `change` every number of a value that can change by itself, in order: those of a matrix cannot, and wavelengths stay.
fn visit(value: &mut Value, change: &mut dyn FnMut(&mut f64)) {
    match value {
        Value::Float(x) => change(x),
        Value::Rgb(values) | Value::Vector(values) => values.iter_mut().for_each(change),
        Value::Spectrum(pairs) => pairs.iter_mut().for_each(|(_, value)| change(value)),
        Value::Transform(steps) => steps.iter_mut().for_each(|step| visit_step(step, change)),
        Value::String(text) => {
            let separates = |c: char| c == ',' || c.is_whitespace();
            let words = text.split(separates).filter(|word| !word.is_empty()).map(str::parse);
            if let Ok(mut numbers) = words.collect::<std::result::Result<Vec<f64>, _>>() {
                numbers.iter_mut().for_each(change);
                *text = numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
            }
        }
        Value::Boolean(_)
        | Value::Integer(_)
        | Value::Object(_)
        | Value::Reference(_)
        | Value::Note(_)
        | Value::Keyframes(_) => {}
    }
}

fn visit_step(step: &mut TransformStep, change: &mut dyn FnMut(&mut f64)) {
    match step {
        TransformStep::Scale(values) | TransformStep::Translate(values) => {
            values.iter_mut().for_each(change);
        }
        TransformStep::Rotate { axis, angle } => {
            axis.iter_mut().for_each(&mut *change);
            change(angle);
        }
        TransformStep::LookAt { origin, target, up } => {
            [origin, target, up].into_iter().flatten().for_each(change);
        }
        TransformStep::Matrix(_) => {}
    }
}

/// One number over time.
struct Curve<'a> {
    interpolation: Interpolation,
    /// Growing.
    times: &'a [f64],
    values: Vec<f64>,
}

/// What is between two keys: a cubic.
struct Piece {
    start: f64,
    length: f64,
    /// Of the powers of u, which is 0 at the first key and 1 at the second.
    coefficients: [f64; 4],
}

impl Piece {
    fn at(&self, time: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        let u = (time - self.start) / self.length;
        a + u * (b + u * (c + u * d))
    }

    /// From its start to `time`.
    fn integral(&self, time: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        let u = (time - self.start) / self.length;
        self.length * u * (a + u * (b / 2.0 + u * (c / 3.0 + u * d / 4.0)))
    }
}

impl Curve<'_> {
    fn at(&self, time: f64) -> f64 {
        let last = self.times.len() - 1;
        match self.times.partition_point(|key| *key <= time) {
            0 => self.values[0],
            after if after > last => self.values[last],
            after => self.piece(after - 1).at(time),
        }
    }

    /// From the first key to `time`; below 0 for constants above 0 before it.
    fn integral(&self, time: f64) -> f64 {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let outside = self.values[0] * (time - first).min(0.0)
            + self.values[self.times.len() - 1] * (time - last).max(0.0);
        let begun = (1..self.times.len()).filter(|next| self.times[next - 1] < time);
        outside + begun.map(|next| self.piece(next - 1).integral(time.min(self.times[next]))).sum::<f64>()
    }

    /// The piece after key number `first`.
    fn piece(&self, first: usize) -> Piece {
        let (start, length) = (self.times[first], self.times[first + 1] - self.times[first]);
        let (value, rise) = (self.values[first], self.values[first + 1] - self.values[first]);
        let coefficients = match self.interpolation {
            Interpolation::Linear => [value, rise, 0.0, 0.0],
            Interpolation::Smooth => {
                let [start, end] = [first, first + 1].map(|key| length * self.slope(key));
                [value, start, 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise]
            }
        };
        Piece { start, length, coefficients }
    }

    /// The slope at a key of a smooth curve: a mean of those beside it, and 0 where it turns or holds still.
    fn slope(&self, key: usize) -> f64 {
        if key == 0 || key + 1 == self.times.len() {
            return 0.0;
        }
        let length = |first: usize| self.times[first + 1] - self.times[first];
        let slope = |first: usize| (self.values[first + 1] - self.values[first]) / length(first);
        let (before, after) = (slope(key - 1), slope(key));
        if before.signum() != after.signum() || before == 0.0 || after == 0.0 {
            return 0.0;
        }
        let (a, b) = (length(key - 1) + 2.0 * length(key), 2.0 * length(key - 1) + length(key));
        (a + b) / (a / before + b / after)
    }
}

#[cfg(test)]
mod tests;
