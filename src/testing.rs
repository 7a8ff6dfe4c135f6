//! What the tests of several rooms share: descriptions by hand and the chi-square test.

use crate::{
    analysis::chi_square,
    description::{Location, Object, Position, Property, Value},
};
use std::sync::Arc;

/// A place for objects that come from no file.
pub(crate) fn nowhere() -> Location {
    Location { file: Arc::new("test.json".into()), position: Position::Path("$".into()) }
}

/// An object of `plugin` with the given properties.
pub(crate) fn object(plugin: &str, properties: &[(&str, Value)]) -> Object {
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

/// The p-value of Pearson's chi-square test, see [`chi_square::chi_square`].
pub(crate) fn chi_square(observed: &[u64], expected: &[f64]) -> f64 {
    chi_square::chi_square(observed, expected).p_value
}

/// The significance level of each of `tests` tests that makes 0.01 for all of them together (Sidak).
pub(crate) fn significance(tests: usize) -> f64 {
    1.0 - 0.99f64.powf(1.0 / tests as f64)
}

#[test]
fn chi_square_tells_a_fair_die_from_a_loaded_one() {
    let expected = [100.0; 6];
    assert!(chi_square(&[105, 94, 101, 97, 110, 93], &expected) > 0.5);
    assert!(chi_square(&[140, 94, 101, 97, 85, 83], &expected) < 0.01);
    assert_eq!(chi_square(&[100, 4], &[104.0, 0.0]), 0.0);
}
