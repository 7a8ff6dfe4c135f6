//! The roots of a function of one unknown that is not defined everywhere.

use std::f64::consts::PI;

/// Parts of [-1, 1] at whose ends the function is evaluated first.
const STEPS: i32 = 32;
/// The same for each stretch where it is defined, if not everywhere.
const STRETCH_STEPS: usize = 24;
/// Parts of an interval in which it may have three roots.
const CLOSER: i32 = 8;
/// Most steps to a root, or to an end of a stretch; 12 are common for a root.
const HALVINGS: usize = 50;
/// Values up to this count as 0.
const EXACT: f64 = 1e-12;
/// Cuts of an interval that may hold two roots.
const CUTS: usize = 24;
/// Part of an interval that such a cut leaves.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Looks for the places in [-1, 1] where a function changes its sign.
pub(super) struct Search<F> {
    pub(super) function: F,
    /// It goes on beyond 1 as beyond -1.
    pub(super) is_periodic: bool,
}

/// A place, and the value there.
type Place = (f64, f64);

/// True if a function of these values, one after the other, comes closest to 0 between the first and the last without a
/// change of sign.
fn turns_back([a, b, c]: [f64; 3]) -> bool {
    a * b > 0.0 && b * c > 0.0 && b.abs() <= a.abs().min(c.abs())
}

/// True if a function of these values may have three roots around the middle: it is flatter there than before and after.
fn flattens([a, b, c, d]: [f64; 4]) -> bool {
    let [before, here, after] = [b - a, c - b, d - c];
    let is_near = b.abs().min(c.abs()) < before.abs().max(after.abs());
    is_near && before * after > 0.0 && here.abs() < before.abs().min(after.abs())
}

impl<F: Fn(f64) -> Option<f64>> Search<F> {
    /// All roots.
    pub(super) fn roots(&self, found: &mut impl FnMut(f64)) {
        for mut places in self.stretches() {
            self.refine(&mut places);
            for pair in places.windows(2) {
                if (pair[0].1 < 0.0) == (pair[1].1 < 0.0) {
                    continue;
                }
                let root = self.root(pair[0], pair[1]);
                // Beyond, a periodic function has roots that it has within.
                if (-1.0..1.0).contains(&root) {
                    found(root);
                }
            }
        }
    }

    /// Places where the function is defined, stretch by stretch.
    fn stretches(&self) -> Vec<Vec<Place>> {
        let beyond = i32::from(self.is_periodic);
        let place = |step: i32| f64::from(2 * step) / f64::from(STEPS) - 1.0;
        let places = (-beyond..=STEPS + beyond).map(|step| (place(step), (self.function)(place(step))));
        let places: Vec<(f64, Option<f64>)> = places.collect();
        let whole: Option<Vec<Place>> =
            places.iter().map(|(place, value)| Some((*place, (*value)?))).collect();
        whole.map_or_else(|| self.parts(&places), |whole| vec![whole])
    }

    /// The stretches between ends of where the function is, at each of which it may change as a root does.
    fn parts(&self, places: &[(f64, Option<f64>)]) -> Vec<Vec<Place>> {
        let groups: Vec<_> = places.chunk_by(|a, b| a.1.is_some() == b.1.is_some()).collect();
        let there = (0..groups.len()).filter(|number| groups[*number][0].1.is_some());
        let part = |number: usize| {
            let [first, last] = [groups[number][0].0, groups[number][groups[number].len() - 1].0];
            let before = number.checked_sub(1).and_then(|number| groups[number].last());
            let after = groups.get(number + 1).map(|group| &group[0]);
            let low = before.map_or(first, |outside| self.end(first, outside.0));
            let high = after.map_or(last, |outside| self.end(last, outside.0));
            self.places(STRETCH_STEPS, |part| low + (high - low) * (0.5 - 0.5 * (PI * part).cos()))
        };
        there.map(part).collect()
    }

    /// The function at `count` + 1 places; `place` maps the part of the stretch before one to the place.
    fn places(&self, count: usize, place: impl Fn(f64) -> f64) -> Vec<Place> {
        let places = (0..=count).map(|step| place(step as f64 / count as f64));
        places.filter_map(|place| self.at(place)).collect()
    }

    fn at(&self, place: f64) -> Option<Place> {
        Some((place, (self.function)(place)?))
    }

    /// Adds places between three roots, then between two.
    fn refine(&self, places: &mut Vec<Place>) {
        let flat = places.windows(4).filter(|four| flattens([0, 1, 2, 3].map(|i| four[i].1)));
        let within = |[low, high]: [f64; 2]| {
            (1..CLOSER).map(move |part| low + (high - low) * f64::from(part) / f64::from(CLOSER))
        };
        let closer = flat.flat_map(|four| within([four[1].0, four[2].0]));
        Self::add(places, closer.filter_map(|place| self.at(place)).collect());
        let between = places.windows(3).filter(|three| turns_back([0, 1, 2].map(|i| three[i].1)));
        Self::add(places, between.filter_map(|three| self.nearest(three[0], three[2])).collect());
    }

    fn add(places: &mut Vec<Place>, more: Vec<Place>) {
        places.extend(more);
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// The last place between `inside` and `outside` where the function is defined, as it is at `inside`.
    fn end(&self, mut inside: f64, mut outside: f64) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            *if (self.function)(middle).is_some() { &mut inside } else { &mut outside } = middle;
        }
        inside
    }

    /// A place between two of equal sign where the function has the other sign, by golden sections; none where it is
    /// not found.
    fn nearest(&self, low: Place, high: Place) -> Option<Place> {
        let sign = low.1.signum();
        let value = |place: f64| (place, (self.function)(place).map_or(f64::INFINITY, |value| value * sign));
        let cut = |low: f64, high: f64| high - GOLDEN * (high - low);
        let [mut low, mut high] = [(low.0, low.1 * sign), (high.0, high.1 * sign)];
        let [mut left, mut right] = [value(cut(low.0, high.0)), value(cut(high.0, low.0))];
        for _ in 0..CUTS {
            let least = if left.1 < right.1 { left } else { right };
            if least.1 < 0.0 {
                return Some((least.0, least.1 * sign));
            }
            // It changes by too little.
            if low.1.max(high.1) < 2.0 * least.1 {
                return None;
            }
            if left.1 < right.1 {
                (high, right) = (right, left);
                left = value(cut(low.0, high.0));
            } else {
                (low, left) = (left, right);
                right = value(cut(high.0, low.0));
            }
        }
        None
    }

    /// The root between two places: regula falsi, which halves the weight of an end that stays (Illinois).
    fn root(&self, mut low: Place, mut high: Place) -> f64 {
        let mut place = low.0;
        for _ in 0..HALVINGS {
            place = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let Some((_, value)) = self.at(place).filter(|(_, value)| value.abs() > EXACT) else { break };
            if (value < 0.0) == (low.1 < 0.0) {
                (low, high.1) = ((place, value), 0.5 * high.1);
            } else {
                (high, low.1) = ((place, value), 0.5 * low.1);
            }
        }
        place
    }
}
