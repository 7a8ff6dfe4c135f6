//! Bias over what `--vary` varied: how far the mean of the image is off at each value (LW96 sec. 5 for the step of a march).

use super::chart::{self, Chart};
use crate::{
    analysis::study::outcome::{ContenderOutcome, Interval, SceneOutcome},
    error::Result,
};

/// What the rest of a contender's name says, and its bias at each value.
type Curve = (String, Vec<(f64, Interval)>);

/// A chart of bias over the values of one option.
pub(super) struct BiasView {
    /// The option.
    pub option: String,
    /// Of each curve, the rest of its contenders' names.
    pub names: Vec<String>,
    /// The inside of the SVG element.
    pub svg: String,
}

impl BiasView {
    /// One for each option that has several numbers as its values.
    pub(super) fn all(scene: &SceneOutcome) -> Result<Vec<Self>> {
        let mut options: Vec<&str> = Vec::new();
        for (option, _) in scene.contenders.iter().flat_map(|contender| words(&contender.name)) {
            if !options.contains(&option) {
                options.push(option);
            }
        }
        let views = options.into_iter().map(|option| (option, curves(scene, option)));
        let views = views.filter(|(_, curves)| curves.iter().any(|(_, points)| points.len() > 1));
        views.map(|(option, curves)| Self::new(option, curves)).collect()
    }

    fn new(option: &str, curves: Vec<Curve>) -> Result<Self> {
        let (names, points) = curves.into_iter().unzip();
        let svg = Chart::of(points, None, None).svg()?;
        Ok(Self { option: option.to_owned(), names, svg })
    }

    /// For the template.
    pub(super) fn view_box(&self) -> String {
        format!("0 0 {} {}", chart::WIDTH, chart::HEIGHT)
    }
}

/// The words OPTION=NUMBER of a contender's name, of numbers above 0: others are on no logarithmic scale.
fn words(name: &str) -> impl Iterator<Item = (&str, f64)> {
    name.split(' ').filter_map(|word| {
        let (option, value) = word.split_once('=')?;
        Some((option, value.parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite())?))
    })
}

/// A curve for all contenders that differ by the value of `option` alone.
fn curves(scene: &SceneOutcome, option: &str) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for contender in &scene.contenders {
        let Some((rest, point)) = point(contender, option) else { continue };
        match curves.iter_mut().find(|(name, _)| *name == rest) {
            Some((_, points)) => points.push(point),
            None => curves.push((rest, vec![point])),
        }
    }
    curves.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    curves
}

fn point(contender: &ContenderOutcome, option: &str) -> Option<(String, (f64, Interval))> {
    let (_, value) = words(&contender.name).find(|(found, _)| *found == option)?;
    let is_rest = |word: &&str| word.split_once('=').is_none_or(|(found, _)| found != option);
    let rest = contender.name.split(' ').filter(is_rest).collect::<Vec<_>>().join(" ");
    Some((rest, (value, magnitude(contender.points.last()?.difference))))
}

/// Of a number that may have either sign: an interval around 0 begins there.
fn magnitude(Interval { mean, low, high }: Interval) -> Interval {
    let [a, b] = [low.abs(), high.abs()];
    let low = if low <= 0.0 && high >= 0.0 { 0.0 } else { a.min(b) };
    Interval { mean: mean.abs(), low, high: a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_with_numbers_are_found() {
        let found = |name| words(name).collect::<Vec<_>>();
        assert_eq!(found("pt step=0.5 max-depth=-1"), [("step", 0.5)]);
        assert_eq!(found("pt heuristic=power"), []);
    }

    #[test]
    fn an_interval_around_nothing_begins_there() {
        let of = |low, mean, high| {
            let Interval { mean, low, high } = magnitude(Interval { mean, low, high });
            [low, mean, high]
        };
        assert_eq!(of(-3.0, -2.0, -1.0), [1.0, 2.0, 3.0]);
        assert_eq!(of(-3.0, -1.0, 1.0), [0.0, 1.0, 3.0]);
        assert_eq!(of(1.0, 2.0, 3.0), [1.0, 2.0, 3.0]);
    }
}
