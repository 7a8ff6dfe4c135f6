use super::*;
use crate::{description::transform::compose, math::DMat4, testing::nowhere};

fn keyframes(interpolation: Interpolation, keys: &[(f64, Value)]) -> Result<Keyframes> {
    let key = |(time, value): &(f64, Value)| {
        let value = Property { name: String::new(), value: value.clone(), location: nowhere() };
        Key { time: *time, value }
    };
    Keyframes::new(interpolation, keys.iter().map(key).collect(), &nowhere())
}

fn of_numbers(interpolation: Interpolation, keys: &[(f64, f64)]) -> Keyframes {
    let keys: Vec<_> = keys.iter().map(|(time, x)| (*time, Value::Float(*x))).collect();
    keyframes(interpolation, &keys).unwrap()
}

fn number(value: Value) -> f64 {
    if let Value::Float(x) = value { x } else { panic!("{value:?} is no number") }
}

const KEYS: [(f64, f64); 6] = [(-1.0, 0.3), (0.5, 2.0), (1.0, 2.0), (3.0, 5.0), (3.5, 5.5), (6.0, -1.0)];

const BOTH: [Interpolation; 2] = [Interpolation::Linear, Interpolation::Smooth];

#[test]
fn keys_hold_at_their_times_and_beyond_the_ends() {
    for interpolation in BOTH {
        let keyframes = of_numbers(interpolation, &KEYS);
        for (time, x) in KEYS {
            assert_eq!(number(keyframes.at(time)), x);
        }
        assert_eq!(number(keyframes.at(-1e9)), 0.3);
        assert_eq!(number(keyframes.at(1e9)), -1.0);
        assert_eq!(number(keyframes.at(0.7)), 2.0);
    }
    let linear = of_numbers(Interpolation::Linear, &KEYS);
    assert!((number(linear.at(2.0)) - 3.5).abs() < 1e-15);
}

#[test]
fn smooth_curves_stay_between_their_keys_and_have_no_corners() {
    let keyframes = of_numbers(Interpolation::Smooth, &KEYS);
    let value = |time: f64| number(keyframes.at(time));
    for pair in KEYS.windows(2) {
        let [(first, a), (last, b)] = [pair[0], pair[1]];
        let mut before = a;
        for i in 1..=1000 {
            let x = value(first + (last - first) * f64::from(i) / 1000.0);
            assert!((x - before) * (b - a) >= -1e-12, "between {first} s and {last} s");
            before = x;
        }
    }
    for (time, x) in KEYS {
        let [before, after] = [-1e-6, 1e-6].map(|step| (value(time + step) - x) / step);
        assert!((before - after).abs() < 1e-4, "{before} {after} at {time} s");
    }
}

#[test]
fn means_are_those_of_quadrature() {
    for interpolation in BOTH {
        let keyframes = of_numbers(interpolation, &KEYS);
        for time in [-4.0, -0.5, 0.0, 1e-3, 0.5, 2.0, 5.9, 6.0, 20.0] {
            const STEPS: u32 = 20_000;
            let at = |i: u32| number(keyframes.at(time * (f64::from(i) + 0.5) / f64::from(STEPS)));
            let mean = (0..STEPS).map(at).sum::<f64>() / f64::from(STEPS);
            let found = number(keyframes.mean(time));
            assert!((found - mean).abs() < 1e-6, "{found} {mean} until {time} s");
        }
    }
}

#[test]
fn every_kind_of_number_changes_and_the_rest_stays() {
    let steps = |angle, x| {
        let turn = TransformStep::Rotate { axis: [0.0, 1.0, 0.0], angle };
        Value::Transform(vec![turn, TransformStep::Translate([x, 0.0, 2.0])])
    };
    let text = |text: &str| Value::String(text.into());
    let cases = [
        (Value::Integer(1), Value::Float(2.0), Value::Float(1.5)),
        (Value::Rgb([0.0, 1.0, 2.0]), Value::Rgb([1.0; 3]), Value::Rgb([0.5, 1.0, 1.5])),
        (Value::Vector([0.0, 1.0, 2.0]), Value::Vector([1.0; 3]), Value::Vector([0.5, 1.0, 1.5])),
        (
            Value::Spectrum(vec![(400.0, 1.0), (700.0, 3.0)]),
            Value::Spectrum(vec![(400.0, 2.0), (700.0, 3.0)]),
            Value::Spectrum(vec![(400.0, 1.5), (700.0, 3.0)]),
        ),
        (steps(0.0, 1.0), steps(360.0, 3.0), steps(180.0, 2.0)),
        (text("1, 0, -2"), text("3 0,-1.0"), text("2.0, 0.0, -1.5")),
    ];
    for (first, last, middle) in cases {
        for interpolation in BOTH {
            let keyframes = keyframes(interpolation, &[(0.0, first.clone()), (2.0, last.clone())]);
            assert_eq!(keyframes.unwrap().at(1.0), middle);
        }
    }
}

#[test]
fn keys_out_of_order_and_values_that_cannot_change_are_refused() {
    let float = Value::Float;
    let linear = |keys: &[(f64, Value)]| keyframes(Interpolation::Linear, keys);
    assert!(linear(&[(3.0, float(1.0))]).is_ok());
    let matrix = |diagonal: [f64; 4]| {
        let rows = DMat4::from_diagonal(diagonal.into()).to_cols_array();
        Value::Transform(vec![TransformStep::Matrix(rows)])
    };
    let usual = matrix([1.0; 4]);
    let refused: [&[(f64, Value)]; 11] = [
        &[],
        &[(0.0, Value::Boolean(true))],
        &[(0.0, Value::String("water.vdb".into()))],
        &[(0.0, float(1.0)), (0.0, float(2.0))],
        &[(0.0, float(1.0)), (-1.0, float(2.0))],
        &[(0.0, float(1.0)), (f64::NAN, float(2.0))],
        &[(0.0, float(1.0)), (1.0, Value::Rgb([1.0; 3]))],
        &[(0.0, Value::String("1, 2".into())), (1.0, Value::String("1, 2, 3".into()))],
        &[(0.0, usual.clone()), (1.0, matrix([1.0, 0.0, 1.0, 1.0]))],
        &[(0.0, usual.clone()), (1.0, matrix([1.0, 1.0, 1.0, 2.0]))],
        &[(0.0, usual), (1.0, matrix([-1.0, 1.0, 1.0, 1.0]))],
    ];
    for keys in refused {
        assert!(linear(keys).is_err(), "{keys:?}");
    }
}

/// The matrix that `steps` make.
fn as_matrix(steps: &[TransformStep]) -> Value {
    Value::Transform(vec![TransformStep::Matrix(compose(steps).transpose().to_cols_array())])
}

fn composed(value: &Value) -> DMat4 {
    let Value::Transform(steps) = value else { panic!("no transform") };
    compose(steps)
}

#[test]
fn between_matrices_things_turn_and_stretch_as_by_steps() {
    let steps = |x: f64, angle: f64, size: f64| {
        let turn = TransformStep::Rotate { axis: [1.0, -2.0, 0.5], angle };
        [TransformStep::Scale([size, -1.0, 0.01]), turn, TransformStep::Translate([x, 1e3, 2.0])]
    };
    let keys =
        [(0.0, 0.0, 10.0, 2.0), (1.0, 3.0, 170.0, 2.5), (3.0, 3.0, 170.0, 2.5), (4.0, -2.0, 20.0, 1e-3)];
    for interpolation in BOTH {
        let by = |of: &dyn Fn(&[TransformStep]) -> Value| {
            let keys = keys.map(|(time, x, angle, size)| (time, of(&steps(x, angle, size))));
            keyframes(interpolation, &keys).unwrap()
        };
        let (by_steps, by_matrices) = (by(&|steps| Value::Transform(steps.to_vec())), by(&as_matrix));
        for time in [-1.0, 0.0, 0.2, 0.5, 1.0, 1.7, 3.0, 3.3, 3.9, 4.0, 9.0] {
            let (a, b) = (composed(&by_steps.at(time)), composed(&by_matrices.at(time)));
            assert!(a.abs_diff_eq(b, 1e-9), "{interpolation:?} at {time} s: {a} {b}");
        }
    }
}

#[test]
fn a_matrix_that_stays_keeps_its_bits() {
    let value = as_matrix(&[TransformStep::Rotate { axis: [1.0, 2.0, 3.0], angle: 77.0 }]);
    let keyframes = keyframes(Interpolation::Linear, &[(0.0, value.clone()), (1.0, value.clone())]).unwrap();
    assert_eq!(keyframes.at(0.3), value);
}
