//! Which images are shown side by side: for every level of time, each contender's image nearest to it.

use crate::analysis::study::outcome::{ContenderOutcome, Outcome, SceneOutcome};

/// All images of a page together have at most this many pixels, about 40 MB of file.
const MOST_PIXELS: usize = 16_000_000;

/// More levels than this show the eye nothing more.
const MOST_LEVELS: usize = 5;

/// A time, and each contender's point nearest to it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    /// What all have about (s).
    pub seconds: f64,
    /// An index into the points of each contender.
    pub picks: Vec<usize>,
}

/// What is shown of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plan {
    /// In growing order, at least one.
    pub levels: Vec<Level>,
    /// Levels there are, shown or not.
    pub available: usize,
    /// Blocks of this many pixels a side are averaged to one.
    pub shrink: usize,
}

/// As many levels as fit into the scene's share of a page; first the levels give way to it, down to two, then the size.
pub(super) fn plan(outcome: &Outcome, scene: &SceneOutcome) -> Plan {
    let all = levels(&scene.contenders);
    let share = MOST_PIXELS / outcome.scenes.len();
    // A reference; of every contender its variance, and at each level its image and its error.
    let pictures = |levels: usize| 1 + scene.contenders.len() * (1 + 2 * levels);
    let pixels = |shrink: usize| scene.width.div_ceil(shrink).saturating_mul(scene.height.div_ceil(shrink));
    let fits = |levels: usize, shrink: usize| pictures(levels).saturating_mul(pixels(shrink)) <= share;
    let (most, least) = (all.len().min(MOST_LEVELS), all.len().min(2));
    let longest = scene.width.max(scene.height);
    let shrink = (1..longest).find(|shrink| fits(least, *shrink)).unwrap_or(longest);
    let kept = (least..=most).rev().find(|levels| fits(*levels, shrink)).unwrap_or(least);
    Plan { levels: thinned(&all, kept), available: all.len(), shrink }
}

/// The times of the first contender that all others reach too, or a time between where there are none.
fn levels(contenders: &[ContenderOutcome]) -> Vec<Level> {
    let Some(first) = contenders.first() else { return Vec::new() };
    let [start, end] = common_time(contenders);
    // Times of one budget differ a little among contenders.
    let slack = 1.25;
    let times = first.points.iter().map(|point| time(point.seconds.mean));
    let mut wanted: Vec<f64> = times.filter(|time| (start / slack..=end * slack).contains(time)).collect();
    if wanted.is_empty() {
        wanted.push(start.sqrt() * end.sqrt());
    }
    let mut levels: Vec<Level> = Vec::new();
    for seconds in wanted {
        let picks: Vec<usize> = contenders.iter().map(|contender| nearest(contender, seconds)).collect();
        if levels.last().is_none_or(|last| last.picks != picks) {
            levels.push(Level { seconds, picks });
        }
    }
    levels
}

/// From when all have an image, until the first has its last.
fn common_time(contenders: &[ContenderOutcome]) -> [f64; 2] {
    let times = |contender: &ContenderOutcome| {
        let mut times: Vec<f64> = contender.points.iter().map(|point| time(point.seconds.mean)).collect();
        times.sort_by(f64::total_cmp);
        [times.first().copied().unwrap_or(TICK), times.last().copied().unwrap_or(TICK)]
    };
    let spans: Vec<[f64; 2]> = contenders.iter().map(times).collect();
    let start = spans.iter().map(|span| span[0]).fold(TICK, f64::max);
    let end = spans.iter().map(|span| span[1]).fold(f64::MAX, f64::min);
    [start, end]
}

/// Shorter than what clocks resolve (s); a logarithm needs more than 0.
const TICK: f64 = 1e-9;

/// A time that has a logarithm (s).
pub(super) fn time(seconds: f64) -> f64 {
    seconds.max(TICK)
}

/// The point of `contender` whose time has the ratio to `seconds` that is nearest to 1.
fn nearest(contender: &ContenderOutcome, seconds: f64) -> usize {
    let away = |index: usize| (time(contender.points[index].seconds.mean).ln() - seconds.ln()).abs();
    (0..contender.points.len()).min_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or(0)
}

/// `kept` of `all`, evenly, the last always among them, the first too where more than one is kept.
fn thinned(all: &[Level], kept: usize) -> Vec<Level> {
    let last = all.len().saturating_sub(1);
    let steps = kept.saturating_sub(1).max(1);
    let chosen = (0..kept).map(|k| if kept == 1 { last } else { (k * last + steps / 2) / steps });
    chosen.map(|index| all[index].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::study::outcome::{Interval, Point, Reference};

    fn contender(times: &[f64]) -> ContenderOutcome {
        let flat = |mean| Interval { mean, low: mean, high: mean };
        let point = |seconds: &f64| Point {
            samples: 1,
            seconds: flat(*seconds),
            cpu_seconds: None,
            mse: flat(1.0),
            relmse: flat(1.0),
            trimmed_relmse: flat(1.0),
            mape: flat(1.0),
            smape: flat(1.0),
            difference: flat(0.0),
            image: "image.exr".into(),
        };
        ContenderOutcome {
            name: "one".into(),
            load_seconds: None,
            points: times.iter().map(point).collect(),
            slope: None,
            efficiency: flat(1.0),
            chosen: None,
            apart: None,
            variance: "variance.exr".into(),
            ratio: None,
            notes: Vec::new(),
        }
    }

    fn picks(contenders: &[ContenderOutcome]) -> Vec<Vec<usize>> {
        levels(contenders).into_iter().map(|level| level.picks).collect()
    }

    fn study(width: usize, height: usize, contenders: usize, times: &[f64]) -> Outcome {
        let reference = Reference {
            image: "r.exr".into(),
            how: String::new(),
            own_relmse: None,
            known_by: None,
            apart: None,
            like: Vec::new(),
        };
        let contenders = vec![contender(times); contenders];
        let scene =
            SceneOutcome { name: "s".into(), width, height, reference, contenders, notes: Vec::new() };
        Outcome {
            made_by: String::new(),
            command: String::new(),
            machine: String::new(),
            conditions: None,
            confidence: 0.95,
            scenes: vec![scene],
        }
    }

    #[test]
    fn images_side_by_side_took_about_the_same_time() {
        let (a, b) = (contender(&[1.0, 2.0, 4.0, 8.0]), contender(&[3.8, 8.1, 16.0]));
        assert_eq!(picks(&[a.clone(), b.clone()]), [[2, 0], [3, 1]]);
        assert_eq!(picks(&[b, a]), [[0, 2], [1, 3]]);
        let alike = contender(&[1.0, 2.0]);
        assert_eq!(picks(&[alike.clone(), alike]), [[0, 0], [1, 1]]);
    }

    #[test]
    fn without_a_common_time_the_nearest_stand_together() {
        assert_eq!(picks(&[contender(&[1.0, 2.0]), contender(&[50.0, 100.0])]), [[1, 0]]);
        assert_eq!(picks(&[contender(&[0.0]), contender(&[1e300])]), [[0, 0]]);
        assert_eq!(picks(&[contender(&[0.0, 0.0])]), [[0]]);
    }

    #[test]
    fn a_page_stays_small() {
        let times: Vec<f64> = (0..8).map(|k| f64::from(1 << k)).collect();
        let outcome = study(256, 256, 4, &times);
        let shown = plan(&outcome, &outcome.scenes[0]);
        assert_eq!((shown.levels.len(), shown.available, shown.shrink), (5, 8, 1));
        assert_eq!((shown.levels[0].picks[0], shown.levels[4].picks[0]), (0, 7));
        let outcome = study(4096, 2160, 6, &times);
        let shown = plan(&outcome, &outcome.scenes[0]);
        let pixels = 4096usize.div_ceil(shown.shrink) * 2160usize.div_ceil(shown.shrink);
        assert!(shown.levels.len() >= 2 && pixels * (1 + 6 * 5) <= MOST_PIXELS, "{shown:?}");
        let outcome = study(1 << 16, 1, 10_000, &times);
        assert_eq!(plan(&outcome, &outcome.scenes[0]).levels.len(), 2);
    }
}
