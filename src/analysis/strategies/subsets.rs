//! Sets of strategies that the scene could do with.

use crate::{
    analysis::study::outcome::Interval,
    math::Spectrum,
    render::{Settings, instrument::Instrument},
    scene::build::Setup,
    transport::{Options, Strategies, strategy::StrategyKind},
};

use super::{pilot, report::SubsetReport, table};

/// The sets worth comparing with `full`: without one kind each, the path tracer's and the light tracer's.
pub(super) fn subsets(full: Strategies) -> Vec<Strategies> {
    let without = StrategyKind::ALL.into_iter().filter(|kind| full.has(*kind)).map(|kind| full.without(kind));
    let mut sets = Vec::new();
    for set in without.chain([both(full, Strategies::PT), both(full, Strategies::LT)]) {
        if set != Strategies::NONE && set != full && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

pub(super) fn both(a: Strategies, b: Strategies) -> Strategies {
    StrategyKind::ALL.into_iter().filter(|kind| !b.has(*kind)).fold(a, Strategies::without)
}

pub(super) fn subset(full: Strategies, set: Strategies, gain: Option<Interval>) -> SubsetReport {
    let left_out = StrategyKind::ALL.into_iter().filter(|kind| full.has(*kind) && !set.has(*kind));
    let without = left_out.map(StrategyKind::name).collect::<Vec<_>>().join(",");
    SubsetReport { strategies: set.names().join(","), without, lacks: None, gain }
}

/// Renders with all strategies and with each of `sets`, in turns.
pub(super) fn compare(
    setup: &Setup,
    settings: &Settings,
    sets: &[Strategies],
    reference: &[Spectrum],
    passes: usize,
    progress: &mut dyn FnMut(usize),
) -> Vec<SubsetReport> {
    let full = settings.options.strategies;
    let instrument = |strategies: Strategies| {
        let options = Options { strategies, ..settings.options };
        Instrument::new(&setup.scene, &setup.film, &Settings { options, ..*settings })
    };
    let contenders: Vec<Instrument<'_>> =
        std::iter::once(full).chain(sets.iter().copied()).map(instrument).collect();
    let mut done = 0;
    let turns = pilot::take_turns(&contenders, reference, passes, &mut |more| {
        done += more;
        progress(done);
    });
    let gains = turns[1..].iter().map(|turns_of_one| pilot::gain(&turns[0], turns_of_one));
    sets.iter().zip(gains).map(|(set, gain)| subset(full, *set, gain)).collect()
}

/// What the comparison comes to.
pub(super) fn advice(subsets: &[SubsetReport]) -> String {
    let gains = subsets.iter().filter_map(|subset| Some((subset, subset.gain?)));
    let best = gains.filter(|(_, gain)| gain.low > 1.0).max_by(|(_, a), (_, b)| a.mean.total_cmp(&b.mean));
    match best {
        Some((subset, gain)) => format!(
            "leave out {}: {} less error x time; --strategies {}",
            subset.without,
            table::times(gain),
            subset.strategies
        ),
        None if subsets.is_empty() => {
            "keep all strategies: without any of them paths would be missing".to_owned()
        }
        None => "keep all strategies: no set without one of them has a significantly lower error x time"
            .to_owned(),
    }
}
