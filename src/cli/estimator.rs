//! How paths are made, as the command line asks for it of a scene.

use super::arguments;
use crate::{
    error::{Error, Result},
    render::{Settings, budget::Budget},
    sampling::Sampler,
    scene::{
        build::Setup,
        heuristic::Heuristic,
        integrator::{Method, Restriction},
    },
    transport::{
        Options, Strategies,
        profile::{Needs, ProfileName},
    },
};

/// A render of `setup` with `budget`, its paths made as asked.
pub fn settings(asked: &arguments::Estimator, setup: &Setup, seed: u64, budget: Budget) -> Result<Settings> {
    let options = options(asked, setup, seed)?;
    Ok(Settings { options, budget, seed, profile: profile(asked, setup) })
}

/// The compiled estimator.
fn profile(asked: &arguments::Estimator, setup: &Setup) -> ProfileName {
    let profile = match asked.profile {
        arguments::Profile::Everything => ProfileName::Everything,
        arguments::Profile::Fitted => {
            ProfileName::leanest(Needs::of(&setup.scene, setup.integrator.hide_emitters))
        }
    };
    profile.weighing(heuristic(asked, setup))
}

fn heuristic(asked: &arguments::Estimator, setup: &Setup) -> Heuristic {
    asked.heuristic.unwrap_or(setup.integrator.heuristic)
}

/// What the estimator does; where nothing is asked for, as the scene says.
fn options(asked: &arguments::Estimator, setup: &Setup, seed: u64) -> Result<Options> {
    let strategies = strategies(asked, setup.integrator.method)?;
    if strategies == Strategies::NONE && asked.max_depth.is_some() {
        super::complain("warning: --max-depth has no effect: the integrator fog makes no paths");
    }
    if strategies == Strategies::NONE && asked.heuristic.is_some() {
        super::complain("warning: --heuristic has no effect: the integrator fog makes no paths");
    }
    let (max_depth, hide_emitters) = (max_depth(asked, setup)?, setup.integrator.hide_emitters);
    let heuristic = heuristic(asked, setup);
    if strategies != Strategies::NONE {
        check_depth(asked, heuristic, max_depth)?;
    }
    let (sampler, forced_interaction) = (sampler(asked, setup), forced_interaction(asked, setup, strategies));
    Ok(Options { strategies, heuristic, max_depth, hide_emitters, seed, sampler, forced_interaction })
}

/// Some heuristics need a bound on the length of paths.
fn check_depth(asked: &arguments::Estimator, heuristic: Heuristic, edges: Option<u32>) -> Result<()> {
    let Some(most) = heuristic.most_edges().filter(|most| edges.is_none_or(|edges| edges > *most)) else {
        return Ok(());
    };
    let place = if asked.max_depth.is_some() { "--max-depth" } else { "the scene's max_depth" };
    Err(Error::new(
        place,
        format!("a number from 0 to {most}, for the heuristic {heuristic}"),
        edges.map_or("-1 (no limit)".to_owned(), |edges| edges.to_string()),
        format!("give --max-depth {most}, or choose another --heuristic: balance, power, maximum or uniform"),
    ))
}

fn forced_interaction(asked: &arguments::Estimator, setup: &Setup, strategies: Strategies) -> bool {
    let by_eye = strategies.hit || strategies.next_event || strategies.join;
    if asked.forced_interaction && !(by_eye && Needs::of(&setup.scene, false).media) {
        let why = if by_eye { "the scene has no media" } else { "no strategy in use walks from the eye" };
        super::complain(&format!("warning: --forced-interaction has no effect: {why}"));
    }
    let forced = asked.forced_interaction || setup.integrator.forced_interaction;
    by_eye && forced && !asked.no_forced_interaction
}

fn sampler(asked: &arguments::Estimator, setup: &Setup) -> Sampler {
    match asked.sampler {
        Some(arguments::Sampler::Independent) => Sampler::Independent,
        Some(arguments::Sampler::Sobol) => Sampler::Sobol,
        None => setup.sampler,
    }
}

fn max_depth(asked: &arguments::Estimator, setup: &Setup) -> Result<Option<u32>> {
    let edges = match asked.max_depth {
        Some(arguments::MaxDepth::Edges(edges)) => Some(edges),
        Some(arguments::MaxDepth::Unbounded) => None,
        None => setup.integrator.max_depth,
    };
    let single = matches!(setup.integrator.restriction, Restriction::SingleScattering { .. });
    if single && edges.is_none_or(|edges| edges > Restriction::SINGLE) {
        return Err(Error::new(
            "--max-depth",
            "0, 1 or 2, for the scene's integrator single_scattering",
            edges.map_or("-1".to_owned(), |edges| edges.to_string()),
            "replace the integrator in the scene, by volpath for example",
        ));
    }
    Ok(edges)
}

fn strategies(asked: &arguments::Estimator, scene_method: Method) -> Result<Strategies> {
    let all = match (asked.integrator, scene_method) {
        (Some(arguments::Integrator::Bdpt), _) | (None, Method::Bdpt) => Strategies::BDPT,
        (Some(arguments::Integrator::Pt), _) | (None, Method::Pt) => Strategies::PT,
        (Some(arguments::Integrator::Lt), _) | (None, Method::Lt) => Strategies::LT,
        (Some(arguments::Integrator::Fog), _) | (None, Method::Fog) => Strategies::NONE,
    };
    if asked.strategies.is_empty() {
        return Ok(all);
    }
    let named = |strategy| asked.strategies.contains(&strategy);
    let chosen = Strategies {
        hit: named(arguments::Strategy::Hit),
        next_event: named(arguments::Strategy::NextEvent),
        join: named(arguments::Strategy::Join),
        lens: named(arguments::Strategy::Lens),
    };
    let kept = Strategies {
        hit: chosen.hit && all.hit,
        next_event: chosen.next_event && all.next_event,
        join: chosen.join && all.join,
        lens: chosen.lens && all.lens,
    };
    if kept == chosen {
        return Ok(kept);
    }
    Err(Error::new(
        "--strategies",
        "strategies that the integrator has",
        "one that it leaves out",
        "choose among those of --integrator bdpt: hit, next-event, join, lens",
    ))
}
