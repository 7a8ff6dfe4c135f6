//! What the tests of several rooms share: descriptions by hand and the chi-square test.

use crate::description::{Location, Object, Position, Property, Value};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::sync::Arc;

/// A place for objects that come from no file.
pub fn nowhere() -> Location {
    Location { file: Arc::new("test.json".into()), position: Position::Path("$".into()) }
}

/// An object of `plugin` with the given properties.
pub fn object(plugin: &str, properties: &[(&str, Value)]) -> Object {
    let property = |(name, value): &(&str, Value)| Property {
        name: (*name).into(),
        value: value.clone(),
        location: nowhere(),
    };
    Object {
        tag: None,
        plugin: plugin.into(),
        id: None,
        properties: properties.iter().map(property).collect(),
        location: nowhere(),
    }
}

/// The p-value of Pearson's chi-square test. Cells are pooled, in order, until each expects at least 5
/// counts. More than a few counts where none are expected are a certain failure; a few may come from
/// the corner of a cell that the quadrature of its expectation missed.
pub fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    let impossible: u64 = observed.iter().zip(expected).filter(|(_, e)| **e < 1e-6).map(|(o, _)| o).sum();
    if impossible > 3 {
        return 0.0;
    }
    let mut cells: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    for (o, e) in observed.iter().zip(expected) {
        if cells.last().is_some_and(|cell| cell.1 >= 5.0) {
            cells.push((0.0, 0.0));
        }
        let cell = cells.last_mut().unwrap();
        *cell = (cell.0 + *o as f64, cell.1 + e);
    }
    if cells.len() > 1 && cells.last().is_some_and(|cell| cell.1 < 5.0) {
        let (o, e) = cells.pop().unwrap();
        let cell = cells.last_mut().unwrap();
        *cell = (cell.0 + o, cell.1 + e);
    }
    let statistic: f64 = cells.iter().map(|(o, e)| (o - e).powi(2) / e).sum();
    let freedom = cells.len() - 1;
    if freedom == 0 { 1.0 } else { ChiSquared::new(freedom as f64).unwrap().sf(statistic) }
}

/// The significance level of each of `tests` tests that makes 0.01 for all of them together (Sidak).
pub fn significance(tests: usize) -> f64 {
    1.0 - 0.99f64.powf(1.0 / tests as f64)
}

#[test]
fn chi_square_tells_a_fair_die_from_a_loaded_one() {
    let expected = [100.0; 6];
    assert!(chi_square(&[105, 94, 101, 97, 110, 93], &expected) > 0.5);
    assert!(chi_square(&[140, 94, 101, 97, 85, 83], &expected) < 0.01);
    assert_eq!(chi_square(&[100, 4], &[104.0, 0.0]), 0.0);
}
