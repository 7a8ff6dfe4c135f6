//! Tyndall against Mitsuba 3: every scene of `scenes/crosscheck/` through both, pixel by pixel (needs Python 3).

mod validation;

#[test]
fn agrees_with_mitsuba_on_every_crosscheck_scene() {
    validation::must_hold(&["matrix", "--quick"]);
}
