//! Extremes of every number that a scene gives, against theory: some lines of the stability table (needs Python 3). The
//! whole of it takes minutes: `python3 -m validation stability`.

mod validation;

/// One group of each kind, and all that the renderer was once wrong about.
const LINES: &str = "glowing slab, b|albedo 0.9, b 100000|albedo 0.9, b 1e|white ball under the sky, b 1000|\
    ball under the sky, b 15000|camera on a boundary|touching|radiance 1e|a sphere in absorber";

#[test]
fn extremes_are_as_theory_says() {
    validation::must_hold(&["stability", "--quick", "--batches", "8", "--only", LINES]);
}
