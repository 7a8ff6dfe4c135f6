//! Extremes of every number that a scene gives, against theory: some lines of the stability table (needs Python 3). The
//! whole of it takes minutes: `python3 -m validation stability`.

mod validation;

#[test]
fn extremes_are_as_theory_says() {
    for lines in
        ["glowing slab, b", "albedo 0.9, b 1e", "camera on a boundary", "radiance 1e", "touching media"]
    {
        validation::must_hold(&["stability", "--quick", "--batches", "8", "--only", lines]);
    }
}
