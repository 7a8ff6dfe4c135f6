//! Sets of strategies against each other: short renders that take turns, so that whatever else the machine
//! does affects all of them, and what their passes say about error and time.

use crate::{
    analysis::{interval, study::outcome::Interval},
    math::{Spectrum, relative::Relative},
    render::instrument::Instrument,
};

/// Confidence of every interval.
pub const CONFIDENCE: f64 = 0.95;
/// Turns of every contender: enough for an interval.
const ROUNDS: usize = 10;
/// Passes of a turn, at least: below, there is no variance between them.
const PASSES: usize = 2;

/// What one turn of one contender measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// relMSE of one pass: mean over pixels and channels of the variance between passes over (r^2 + 0.01 m^2), as
    /// [`crate::analysis::study::outcome::Point::relmse`].
    pub relmse: f64,
    /// Time of one pass (s).
    pub seconds: f64,
}

/// Passes that every contender makes if `wanted` are requested.
pub fn passes(wanted: usize) -> usize {
    turn(wanted) * ROUNDS
}

fn turn(wanted: usize) -> usize {
    wanted.div_ceil(ROUNDS).max(PASSES)
}

/// Lets all of `contenders` make `wanted` passes or a few more, in turns; what each turn measured, by
/// contender. Errors are relative to `reference`. Reports every turn.
pub fn take_turns(
    contenders: &[Instrument<'_>],
    reference: &[Spectrum],
    wanted: usize,
    progress: &mut dyn FnMut(usize),
) -> Vec<Vec<Turn>> {
    let mut turns = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    let count = turn(wanted);
    for round in 0..ROUNDS {
        for (contender, turns) in contenders.iter().zip(&mut turns) {
            turns.push(take_turn(contender, reference, round * count..(round + 1) * count));
            progress(count);
        }
    }
    turns
}

fn take_turn(contender: &Instrument<'_>, reference: &[Spectrum], passes: std::ops::Range<usize>) -> Turn {
    let count = passes.len() as f64;
    let mut moments = vec![[[0.0; 2]; 3]; reference.len()];
    let time = contender.passes(passes, &mut |image| {
        for (moments, value) in moments.iter_mut().zip(image) {
            for (channel, v) in moments.iter_mut().zip(value.to_array().map(f64::from)) {
                channel[0] += v;
                channel[1] += v * v;
            }
        }
    });
    let to = Relative::to(reference, 3);
    let relative = moments.iter().zip(reference).flat_map(|(moments, r)| {
        moments.iter().zip(r.to_array()).map(move |([sum, square], r)| {
            let variance = ((square - sum * sum / count) / (count - 1.0)).max(0.0);
            to.square(variance, f64::from(r))
        })
    });
    let relmse = relative.sum::<f64>() / (3 * reference.len()) as f64;
    Turn { relmse, seconds: time.as_secs_f64() / count }
}

/// relMSE x seconds of `full` over that of `other`: how many times less error `other` makes in the same time. None where
/// nothing is noisy or nothing took any time.
pub fn gain(full: &[Turn], other: &[Turn]) -> Option<Interval> {
    let product = |turns: &[Turn], picks: &[usize]| {
        let sum = |of: fn(&Turn) -> f64| picks.iter().map(|pick| of(&turns[*pick])).sum::<f64>();
        sum(|turn| turn.relmse) * sum(|turn| turn.seconds)
    };
    let found =
        interval::bootstrap(full.len(), CONFIDENCE, |picks| product(full, picks) / product(other, picks));
    (found.low > 0.0 && found.high.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    fn turns(error: f64, time: f64, seed: u64) -> Vec<Turn> {
        let mut stream = Stream::new(9, seed, 0, Purpose::Study);
        let mut noisy = |mean: f64| mean * f64::from(1.0 + 0.1 * stream.normal());
        (0..ROUNDS).map(|_| Turn { relmse: noisy(error), seconds: noisy(time) }).collect()
    }

    /// Of many intervals about as many hold the truth as they say.
    #[test]
    fn the_interval_holds_the_ratio() {
        let trials = 400;
        let held = (0..trials).filter(|trial| {
            let gain = gain(&turns(3.0, 2.0, 2 * trial), &turns(1.0, 4.0, 2 * trial + 1)).unwrap();
            gain.low < 1.5 && 1.5 < gain.high
        });
        let held = held.count() as f64 / trials as f64;
        assert!((held - CONFIDENCE).abs() < 4.0 * (0.95 * 0.05 / trials as f64).sqrt(), "{held}");
    }

    #[test]
    fn without_noise_nothing_is_gained() {
        let still = vec![Turn { relmse: 0.0, seconds: 1.0 }; ROUNDS];
        assert_eq!(gain(&still, &still), None);
        assert!(passes(1) == 20 && passes(64) == 70);
    }
}
