//! Matrices that change in time. Their numbers cannot change one by one: halfway between two rotations there would be a
//! squeezed object. Each matrix is a stretch, then a rotation, then a translation (its polar decomposition: Shoemake
//! and Duff 1992, "Matrix Animation and Polar Decomposition"). Stretches and translations are interpolated by their
//! numbers, rotations about the axis from one to the next.

use crate::{
    description::{
        object::{Property, Value},
        transform::TransformStep,
    },
    error::{Error, Result},
    math::{DMat3, DMat4, DQuat, DVec3},
};

/// Steps by which a turn is found; each doubles its digits.
const MOST_STEPS: usize = 60;
/// How far a turn may be from the one of the step before.
const CLOSE: f64 = 1e-14;

/// The matrices of a value, row major, in order.
pub(super) fn of(value: &Value) -> impl Iterator<Item = &[f64; 16]> {
    let steps: &[TransformStep] = if let Value::Transform(steps) = value { steps } else { &[] };
    steps.iter().filter_map(|step| match step {
        TransformStep::Matrix(rows) => Some(rows),
        _ => None,
    })
}

/// The same to be changed.
pub(super) fn of_mut(value: &mut Value) -> impl Iterator<Item = &mut [f64; 16]> {
    let steps: &mut [TransformStep] = if let Value::Transform(steps) = value { steps } else { &mut [] };
    steps.iter_mut().filter_map(|step| match step {
        TransformStep::Matrix(rows) => Some(rows),
        _ => None,
    })
}

/// The matrices of a key must be turns and stretches, which mirror if those of the `first` key do.
pub(super) fn check(key: &Property, first: &Property) -> Result<()> {
    for (rows, others) in of(&key.value).zip(of(&first.value)) {
        let mirrors = |rows: &[f64; 16]| DMat3::from_mat4(matrix(rows)).determinant() < 0.0;
        let (expected, found, remedy) = if Parts::of(rows).is_none() {
            let remedy = "write keyframes of translate, rotate and scale";
            ("a matrix that can be inverted, its last row 0 0 0 1", format!("{rows:?}"), remedy)
        } else if mirrors(rows) != mirrors(others) {
            let remedy =
                "mirror all of them or none, or leave a millionth of a second between two keys for a jump";
            ("a matrix that mirrors if that of the first key does", format!("{rows:?}"), remedy)
        } else {
            continue;
        };
        return Err(Error::new(&key.location, expected, found, remedy));
    }
    Ok(())
}

fn matrix(rows: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(rows).transpose()
}

/// A matrix as what is done one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    /// Symmetric; of a matrix that mirrors, of negative scales.
    stretch: DMat3,
    turn: DQuat,
    translation: DVec3,
}

impl Parts {
    /// None of what cannot be inverted or is no affine map.
    pub(super) fn of(rows: &[f64; 16]) -> Option<Self> {
        let whole = matrix(rows);
        let linear = DMat3::from_mat4(whole);
        let turn = orthogonal(linear)?;
        let turn = turn * turn.determinant().signum();
        let is_affine = rows[12..] == [0.0, 0.0, 0.0, 1.0] && whole.is_finite();
        let parts = Self {
            stretch: turn.transpose() * linear,
            turn: DQuat::from_mat3(&turn).normalize(),
            translation: whole.w_axis.truncate(),
        };
        is_affine.then_some(parts)
    }

    /// Interpolates between `all`: `of` makes each number from theirs. A rotation is as far as its angle, summed up
    /// from key to key.
    pub(super) fn mixed(all: &[Self], of: impl Fn(Vec<f64>) -> f64) -> Self {
        let number = |get: &dyn Fn(&Self) -> f64| of(all.iter().map(get).collect());
        let vector =
            |get: &dyn Fn(&Self) -> DVec3| DVec3::from_array([0, 1, 2].map(|i| number(&|one| get(one)[i])));
        let mut angles = vec![0.0];
        for pair in all.windows(2) {
            angles.push(angles[angles.len() - 1] + pair[0].turn.angle_between(pair[1].turn));
        }
        let angle = of(angles.clone());
        let next = angles.partition_point(|at| *at <= angle).clamp(1, all.len() - 1);
        let (from, length) = (next - 1, angles[next] - angles[next - 1]);
        let share = if length > 0.0 { ((angle - angles[from]) / length).clamp(0.0, 1.0) } else { 0.0 };
        Self {
            stretch: DMat3::from_cols(
                vector(&|one| one.stretch.x_axis),
                vector(&|one| one.stretch.y_axis),
                vector(&|one| one.stretch.z_axis),
            ),
            turn: all[from].turn.slerp(all[next].turn, share),
            translation: vector(&|one| one.translation),
        }
    }

    /// As one matrix, row major.
    pub(super) fn rows(&self) -> [f64; 16] {
        let linear = DMat3::from_quat(self.turn) * self.stretch;
        let mut whole = DMat4::from_mat3(linear);
        whole.w_axis = self.translation.extend(1.0);
        whole.transpose().to_cols_array()
    }
}

/// The nearest orthogonal matrix: the limit of means of a matrix and its inverse's transpose (Higham 1986), each brought to the
/// other's length first; none of what has no inverse.
fn orthogonal(linear: DMat3) -> Option<DMat3> {
    let length =
        |m: DMat3| (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt();
    let mut turn = linear * (1.0 / length(linear));
    for _ in 0..MOST_STEPS {
        let inverse = turn.inverse().transpose();
        let scale = (length(inverse) / length(turn)).sqrt();
        let mean = (turn * scale + inverse * (1.0 / scale)) * 0.5;
        if !mean.is_finite() {
            return None;
        }
        let is_close = length(mean - turn) <= CLOSE * length(mean);
        turn = mean;
        if is_close {
            return Some(turn);
        }
    }
    None
}
