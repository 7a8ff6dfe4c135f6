//! What is mended, what is refused, and what is said.

use super::*;

fn mended(values: &[f32], most: f32, is_strict: bool) -> (Result<Vec<f32>>, Vec<String>) {
    let mut library = Library::default();
    library.is_strict = is_strict;
    let numbers = |visit: &mut dyn FnMut(Number)| {
        let number =
            |(x, value): (usize, &f32)| Number { value: *value, at: [x, 0, 0], channel: 0, count: 1 };
        values.iter().enumerate().map(number).for_each(visit);
    };
    let place = |number: &Number| format!("number {}", number.at[0]);
    let source = Source { path: Path::new("a.vol"), part: "", what: "voxels", place, remedy: "look again" };
    let mend = source.mend(numbers, most, &library);
    let values =
        |mend: Option<Mend>| values.iter().map(|value| mend.map_or(*value, |mend| mend.of(*value))).collect();
    (mend.map(values), library.take_warnings())
}

/// 1000 numbers from 0 to 1, the first of which are `first`.
fn with(first: &[f32]) -> Vec<f32> {
    let ramp = (0..1000).map(|i| i as f32 / 999.0);
    first.iter().copied().chain(ramp.skip(first.len())).collect()
}

#[test]
fn what_is_a_hair_out_of_range_is_brought_into_it_with_one_warning() {
    let (values, warnings) = mended(&with(&[-1e-7, f32::INFINITY, -0.25]), f32::INFINITY, false);
    assert_eq!(values.unwrap()[..3], [0.0, 1.0, 0.0]);
    let text = "a.vol: 3 values are out of range and changed: the worst, inf, becomes 1.0";
    assert_eq!(warnings, [text]);
    let (values, warnings) = mended(&[1.2, 0.5, 0.3], 1.0, false);
    assert_eq!(values.unwrap(), [1.0, 0.5, 0.3]);
    assert!(warnings[0].contains("1 value is out of range and changed: the worst, 1.2, becomes 1.0"));
    // What is within it, or but for rounding, is as it was.
    for fine in [&[0.0, 1.0 + 1e-7][..], &[-0.0, 0.5]] {
        let (values, warnings) = mended(fine, 1.0, false);
        assert_eq!((values.unwrap(), warnings.len()), (fine.to_vec(), 0));
    }
}

#[test]
fn what_must_mean_something_else_is_refused() {
    let refused = |values: &[f32], most| mended(values, most, false).0.unwrap_err();
    let nan = refused(&with(&[0.0, f32::NAN, -1.0]), f32::INFINITY);
    assert_eq!(nan.found, "NaN in number 1, and 1 other value out of range");
    // Rings are small or few.
    let (rings, waves) = (with(&[-0.1; 500]), with(&[-0.3; 30]));
    assert!(mended(&rings, f32::INFINITY, false).0.is_ok());
    assert!(refused(&waves, f32::INFINITY).expected.contains(">= 0"));
    assert!(mended(&with(&[-0.3; 9]), f32::INFINITY, false).0.is_ok());
    // 0 says nothing, however much of it there is.
    let sparse: Vec<f32> = [-1.0, 1.0].into_iter().chain([0.0; 5000]).collect();
    refused(&sparse, f32::INFINITY);
    assert!(refused(&[255.0, 128.0, 0.0], 1.0).expected.contains("from 0 to 1"));
    refused(&[-1.0; 10], f32::INFINITY);
    refused(&[f32::INFINITY; 10], f32::INFINITY);
}

#[test]
fn nothing_is_mended_where_that_is_not_wanted() {
    let (values, warnings) = mended(&with(&[-1e-7]), f32::INFINITY, true);
    assert_eq!(values.unwrap_err().found, "-1e-7 in number 0");
    assert!(warnings.is_empty());
    assert!(mended(&with(&[]), 1.0, true).0.is_ok());
}
