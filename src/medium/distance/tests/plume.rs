//! Nanoseconds per transmittance query and per flight on the plume that `python3 -m validation plume` writes and runs
//! this test for: every tracker on the connections that Mitsuba is timed on. The folder of its files is
//! `$TYNDALL_PLUME`, else `target/validation/plume`.
#![expect(clippy::print_stdout, reason = "what is measured is told")]

use super::*;
use std::{hint::black_box, path::PathBuf, time::Instant};

/// Extinction where the plume is densest (1/m).
const SCALE: f32 = 12.0;
/// Of so many connections one is timed: marching is slow.
const EVERY: usize = 16;
/// Of those, so many are compared with one whose true transmittance is sought.
const SOUGHT: usize = 8;
const ROUNDS: u64 = 16;

/// The connections, from end to end.
fn connections(folder: &std::path::Path) -> Vec<RaySegment> {
    let bytes = std::fs::read(folder.join("chords.f32")).expect("python3 -m validation plume writes it");
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let segment = |[a, b, c, x, y, z]: [f32; 6]| {
        let (from, to) = (vec3(a, b, c), vec3(x, y, z));
        let direction = (to - from).try_normalize().unwrap_or(Vec3::Y);
        RaySegment { origin: from, direction, length: from.distance(to) }
    };
    numbers.as_chunks().0.iter().step_by(EVERY).map(|ends| segment(*ends)).collect()
}

fn plume(folder: &std::path::Path) -> Extinction {
    use crate::description::TransformStep::{Scale, Translate};
    let file = folder.join("plume.vol").to_string_lossy().into_owned();
    let place = Value::Transform(vec![Scale([2.0; 3]), Translate([-1.0, 0.0, -1.0])]);
    let grid = volume(&object("gridvolume", &[("filename", Value::String(file)), ("to_world", place)]));
    let [low, high] = grid.domain().expect("a grid ends somewhere");
    Extinction { volume: grid, scale: SCALE, low, high }
}

/// The least and the middle of the rounds' times, in ns for each segment.
fn time(sections: &[RaySegment], mut run: impl FnMut(&RaySegment, &mut Stream) -> f32) -> [f64; 2] {
    let mut round = |seed| {
        let start = Instant::now();
        for (index, segment) in (0u64..).zip(sections) {
            let mut stream = Stream::new(seed, index, 0, Purpose::Study);
            black_box(run(segment, &mut stream));
        }
        start.elapsed().as_secs_f64() * 1e9 / sections.len() as f64
    };
    let mut times: Vec<f64> = (0..ROUNDS).map(&mut round).collect();
    times.sort_by(f64::total_cmp);
    [times[0], times[times.len() / 2]]
}

/// How a tracker's transmittances lie to the truth, relative to the mean of that: the mean's own error and its standard
/// deviation, a single query's standard deviation, and the largest error of any connection's mean (not relative).
fn errors(tracker: &DistanceSampler, medium: &Extinction, sections: &[(RaySegment, f64)]) -> [f64; 4] {
    let (mut sum, mut squares, mut truths, mut worst) = (0.0, 0.0, 0.0, 0.0f64);
    for (index, (segment, truth)) in (0u64..).zip(sections) {
        let one = |round| {
            let mut stream = Stream::new(round, index, 1, Purpose::Study);
            crossed(tracker, medium, segment, &mut stream)
        };
        let values: Vec<f64> = (0..ROUNDS).map(one).collect();
        let mean = values.iter().sum::<f64>() / ROUNDS as f64;
        squares += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (ROUNDS - 1) as f64;
        sum += mean - truth;
        truths += truth;
        worst = worst.max((mean - truth).abs());
    }
    let n = sections.len() as f64;
    let off = (squares / n).sqrt() * n / truths;
    [sum / truths, off / (n * ROUNDS as f64).sqrt(), off, worst]
}

#[test]
#[ignore = "measures, checks nothing: python3 -m validation plume"]
fn nanoseconds_per_query() {
    let in_target = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/validation/plume");
    let folder = std::env::var_os("TYNDALL_PLUME").map_or_else(in_target, PathBuf::from);
    let (medium, sections) = (plume(&folder), connections(&folder));
    let sought = sections.iter().step_by(SOUGHT);
    let sought: Vec<_> = sought.map(|s| (*s, (-depth_by_quadrature(&medium, s, s.length)).exp())).collect();
    let mean = sought.iter().map(|(_, truth)| truth).sum::<f64>() / sought.len() as f64;
    println!("plume {{\"sections\": {}, \"sought\": {}, \"truth\": {mean}}}", sections.len(), sought.len());
    println!("plume {{\"overhead\": {:?}}}", time(&sections, |_, stream| stream.uniform()));
    for tracker in trackers(&medium) {
        let query = time(&sections, |segment, stream| crossed(&tracker, &medium, segment, stream) as f32);
        let flight = time(&sections, |segment, stream| {
            let remaining = stream.exponential();
            tracker.sample_distance::<f32>(&medium, segment, 0, remaining, stream).depth
        });
        let [bias, error, off, worst] = errors(&tracker, &medium, &sought);
        let step = match &tracker {
            DistanceSampler::RayMarching(march) => march.step,
            _ => 0.0,
        };
        println!(
            "plume {{\"tracker\": \"{}\", \"query\": {query:?}, \"flight\": {flight:?}, \"bias\": {bias}, \
             \"error\": {error}, \"off\": {off}, \"worst\": {worst}, \"step\": {step}}}",
            tracker.choice().name()
        );
    }
}
