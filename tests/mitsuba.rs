//! Tyndall against Mitsuba 3: every scene of `scenes/crosscheck/` and a sample of generated ones through both, pixel by
//! pixel, and no plugin that both have without a scene (needs Python 3).

mod validation;

#[test]
fn agrees_with_mitsuba_on_every_crosscheck_scene() {
    validation::must_hold(&["matrix", "--quick"]);
}

#[test]
fn every_plugin_shared_with_mitsuba_is_in_a_crosscheck_scene() {
    validation::must_hold(&["coverage"]);
}
