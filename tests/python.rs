//! The Python package `validation/` itself: its statistics, its way around this program, its pages and its type hints
//! (needs Python 3).

mod validation;

#[test]
fn the_python_package_passes_its_own_tests() {
    validation::must_hold(&["test"]);
}
