//! Comparison of the fast weights with the slow ones, and what came out for a scene.

use super::{cases::Case, path::Path, reference::Reference, replay};
use crate::{
    math::Channels,
    transport::{Estimator, profile::Profile},
};

/// Largest relative difference between the two: f32 rounding over some hundred operations.
const TOLERANCE: f64 = 1e-4;
/// Weights below this are compared absolutely, to `TOLERANCE` of it: they share a sum of one with the others, and
/// 1e-7 is how exactly f32 holds that.
const SMALL: f64 = 1e-3;
/// Where positions in f32 leave more uncertain than `TOLERANCE` (see [`Path::rounding`]: real walks know the
/// directions they sampled, the reference those between rounded positions), this many times that.
const PER_ROUNDING: f64 = 20.0;
/// Sum over strategies of less than this: walks by such a hero channel never come along the path.
const NEVER: f64 = 1e-12;

/// How far off f32 may leave the densities of `path`, relative.
fn allowed(path: &Path) -> f64 {
    (PER_ROUNDING * path.rounding).max(TOLERANCE)
}

/// The largest deviation and where.
#[derive(Default)]
struct Worst {
    /// Of paths held to `TOLERANCE`.
    deviation: f64,
    /// Of all, over what is allowed.
    excess: f64,
    reported: String,
}

impl Worst {
    fn add(&mut self, path: &Path, allowed: f64, deviation: f64, tell: impl Fn() -> String) {
        if allowed <= TOLERANCE {
            self.deviation = self.deviation.max(deviation);
        }
        let excess = deviation / allowed;
        // Not a number is as bad as can be.
        let excess = if excess.is_nan() { f64::INFINITY } else { excess };
        if excess > self.excess {
            (self.excess, self.reported) =
                (excess, format!("{deviation:.2e} off: {}, {}", tell(), describe(path)));
        }
    }

    fn check(&self, name: &str, what: &str) {
        assert!(self.excess <= 1.0, "{name}, {what}: {}", self.reported);
    }
}

/// Relative to the slow weight, absolute where that is small.
fn deviation(fast: f64, slow: f64) -> f64 {
    (fast - slow).abs() / slow.max(SMALL)
}

fn describe(path: &Path) -> String {
    let nodes: String = path.nodes.iter().map(|node| if node.dirac { 'D' } else { '-' }).collect();
    format!("{nodes} rounding {:.1e}", path.rounding)
}

/// What came out for one scene.
#[derive(Default)]
pub(super) struct Report {
    name: &'static str,
    pub paths: usize,
    /// By strategy: emitter hit, next-event estimation, connection, lens.
    pub strategies: [usize; 4],
    /// By equiangular sampling.
    pub equiangular: usize,
    vertices: usize,
    /// The longest path, in segments.
    pub longest: usize,
    /// The greatest optical depth that a connection crossed.
    pub deepest: f64,
    /// Paths held to `TOLERANCE` itself.
    exact: usize,
    /// Paths that are free one way but blocked, by a hair, as the fast code connects them.
    blocked: usize,
    /// Paths along which the reference could not determine what lies there.
    unclear: usize,
    /// Paths with strategies that lie, within the precision of f32, where the heuristic jumps: not compared.
    close: usize,
    /// Paths compared.
    pub compared: usize,
    /// Those that no strategy has more than half of.
    pub divided: usize,
    /// Weights of real walks.
    real: Worst,
    /// Weights of walks led along paths.
    led: Worst,
    /// Their sums over all strategies.
    fast_sum: Worst,
    /// The sums of the slow weights.
    slow_sum: f64,
}

impl Report {
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, ..Self::default() }
    }

    /// Compares what a real walk gave, and what walks led along its path give for all strategies.
    pub(super) fn take<P: Profile>(
        &mut self,
        estimator: &Estimator<'_, P>,
        reference: &Reference<'_>,
        case: &Case,
    ) {
        let Case { path, strategy, hero, weight } = case;
        let Some(path) = path else {
            self.unclear += 1;
            return;
        };
        self.count(path, *strategy, *hero);
        let slow = self.lead(estimator, reference, path);
        if reference.is_close(path, 2.0 * allowed(path)) {
            return;
        }
        let (fast, slow) = (f64::from(*weight) / P::Channels::COUNT as f64, slow[*strategy][*hero]);
        let tell = || format!("s = {strategy} by {hero}: {fast} not {slow}");
        let off = deviation(fast, slow);
        let mut allowed = allowed(path);
        if off > allowed {
            // Near total reflection, say, weights hang on directions more than by their cosines.
            let moved = |weights: Vec<Vec<f64>>| deviation(weights[*strategy][*hero], slow);
            allowed = reference.shaken(path).map(moved).fold(allowed, f64::max);
        }
        self.real.add(path, allowed, off, tell);
    }

    fn count(&mut self, path: &Path, strategy: usize, hero: usize) {
        let segments = path.nodes.len() - 1;
        self.longest = self.longest.max(segments);
        if strategy > segments {
            self.equiangular += 1;
            return;
        }
        let kind = match strategy {
            0 => 0,
            s if s == segments => 3,
            1 => 1,
            _ => 2,
        };
        self.strategies[kind] += 1;
        if strategy > 0 {
            self.deepest = self.deepest.max(path.depths[strategy - 1][hero]);
        }
    }

    /// Compares the weights of all strategies by walks led along `path`; gives back the slow ones.
    pub(super) fn lead<P: Profile>(
        &mut self,
        estimator: &Estimator<'_, P>,
        reference: &Reference<'_>,
        path: &Path,
    ) -> Vec<Vec<f64>> {
        self.paths += 1;
        self.vertices += path.nodes.len();
        self.exact += usize::from(PER_ROUNDING * path.rounding <= TOLERANCE);
        let slow = reference.weights(path);
        self.slow_sum = self.slow_sum.max((slow.iter().flatten().sum::<f64>() - 1.0).abs());
        if reference.is_close(path, 2.0 * allowed(path)) {
            self.close += 1;
            return slow;
        }
        self.compared += 1;
        self.divided += usize::from(slow.iter().all(|strategy| strategy.iter().sum::<f64>() <= 0.5 + 1e-9));
        let never = reference.never(path);
        let (mut total, mut blocked, mut whole) = (0.0, false, true);
        for hero in 0..P::Channels::COUNT {
            if slow.iter().map(|strategy| strategy[hero]).sum::<f64>() < NEVER {
                continue;
            }
            for (s, fast) in replay::weights(estimator, reference, path, hero).into_iter().enumerate() {
                let slow = slow[s][hero];
                if never[s][hero] && slow > SMALL * TOLERANCE {
                    whole = false;
                    continue;
                }
                // Where no walk comes, ratios of densities may overflow, which no sum of real walks contains.
                if never[s][hero] && fast.is_some_and(f64::is_nan) {
                    continue;
                }
                blocked |= fast.is_none() && slow > SMALL * TOLERANCE;
                let Some(fast) = fast else { continue };
                total += fast;
                let tell = || format!("s = {s} by {hero}: {fast} not {slow}");
                self.led.add(path, allowed(path), deviation(fast, slow), tell);
            }
        }
        self.blocked += usize::from(blocked);
        if whole && !blocked {
            self.fast_sum.add(path, allowed(path), (total - 1.0).abs(), || format!("{total}"));
        }
        slow
    }

    /// Prints the numbers and holds them to what they have to be.
    pub(super) fn check(&self) {
        let Self { name, paths, strategies, exact, blocked, unclear, longest, deepest, .. } = self;
        let Self { real, led, fast_sum, slow_sum, close, .. } = self;
        eprintln!(
            "{name}: {paths} paths ({exact} exact, {blocked} blocked, {unclear} unclear, {close} close) by {strategies:?}, {:.1} \
             vertices, longest {longest}, deepest {deepest:.1}; real {:.1e} ({:.2}), led {:.1e} ({:.2}), sum {:.1e} \
             ({:.2}), slow sum {slow_sum:.1e}",
            self.vertices as f64 / *paths as f64,
            real.deviation,
            real.excess,
            led.deviation,
            led.excess,
            fast_sum.deviation,
            fast_sum.excess,
        );
        real.check(name, "real walks");
        led.check(name, "led walks");
        fast_sum.check(name, "sum of the fast weights");
        assert!(*slow_sum < 1e-12, "{name}: sum of the slow weights {slow_sum:e} off");
        assert!(close * 4 <= *paths, "{name}: {close} of {paths} too close to tell");
        assert!((blocked + unclear) * 500 <= *paths, "{name}: {blocked} blocked, {unclear} unclear");
    }
}
