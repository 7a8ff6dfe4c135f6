//! Tyndall against theory: furnaces, slabs by adding-doubling, single scattering by quadrature (needs Python 3).

mod validation;

#[test]
fn agrees_with_closed_forms() {
    validation::must_hold(&["closed-forms"]);
}
