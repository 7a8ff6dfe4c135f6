use super::*;
use crate::{
    description::Library,
    format,
    volume::{Place, build},
};

fn volume(fog: &str, place: &Place) -> (Volume, Location) {
    let desk = tempfile::tempdir().unwrap();
    let path = desk.path().join("a.json");
    std::fs::write(&path, format!(r#"{{"type": "scene", "fog": {fog}}}"#)).unwrap();
    let root = format::read(&path, &[]).unwrap();
    let library = Library::new(&root).unwrap();
    let object = library.resolve("fog", &root.location).unwrap();
    (build(object, &library, place).unwrap(), object.location.clone())
}

const HERE: Place = Place::new(DVec3::ZERO, 0.0);
const HALF: Vec3 = Vec3::splat(10.0);

fn checked(fog: &str) -> Result<(), Negative> {
    check_non_negative(&volume(fog, &HERE).0, -HALF, HALF)
}

fn waves(constant: f64) -> String {
    format!(
        r#"{{"type": "cosine", "constant": {constant}, "a": {{"type": "wave", "vector": [0, 15.7, 0]}},
            "b": {{"type": "wave", "amplitude": 0.5, "vector": [0.3, 21, 1]}}}}"#
    )
}

#[test]
fn what_touches_0_passes() {
    let saddle = r#"{"type": "polynomial", "half_width": 3,
        "a": {"type": "term", "powers": [2, 0, 0]}, "b": {"type": "term", "powers": [0, 2, 0]},
        "c": {"type": "term", "powers": [1, 1, 0], "coefficient": -2}}"#;
    for fog in
        [&waves(1.5), saddle, r#"{"type": "constvolume", "value": 0}"#, r#"{"type": "noise", "bias": -1}"#]
    {
        assert_eq!(checked(fog), Ok(()), "{fog}");
    }
}

#[test]
fn what_goes_below_0_is_found() {
    let hole = r#"{"type": "sum", "haze": {"type": "constvolume", "value": 0.5},
        "hole": {"type": "equipotential", "strength": -0.6, "center": [3.1, -7.3, 2.2], "d": 400}}"#;
    let fifth = r#"{"type": "polynomial", "x": "0, 1"}"#;
    let product = format!(r#"{{"type": "product", "a": {}, "b": {{"type": "exponential"}}}}"#, waves(0.0));
    for fog in [&waves(1.49), &waves(1.0), hole, fifth, &product] {
        let Negative { position, value } = checked(fog).unwrap_err();
        assert!(value.min_element() < 0.0 && position.abs().max_element() <= 10.0, "{fog}");
        assert_eq!(volume(fog, &HERE).0.eval::<Spectrum>(position), value);
    }
}

#[test]
fn the_place_is_told_in_the_coordinates_of_the_file() {
    let place = Place::new(DVec3::new(1e5, 0.0, 0.0), 0.0);
    let hole = r#"{"type": "equipotential", "strength": -1, "center": [100003, 1, 2], "d": 1e6, "min": [100002, 0, 1],
        "max": [100003.5, 2, 3]}"#;
    let (hole, location) = volume(hole, &place);
    let error = check_non_negative(&hole, -HALF, HALF).unwrap_err().error(&location, &place);
    let at = error.found.split("at [10000").nth(1).and_then(|rest| rest.chars().next()).unwrap();
    assert!(('2'..='3').contains(&at), "{error}");
    assert!(error.place.ends_with("a.json $.fog"), "{error}");
}
