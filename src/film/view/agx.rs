//! AgX (Sobotka, <https://github.com/sobotka/AgX>, 2022), in the primaries that Blender and Filament have made usual.
//!
//! In Rec. 2020 a matrix mixes the channels (the inset: pure colours come to have some of every channel, so that they
//! reach white when they are bright). The logarithm of each then goes through a sigmoid, which has 16.5 stops, middle
//! grey 6.5 below its white. A second matrix (the outset) gives back most of the purity. All rows sum to 1: grey stays
//! grey, black is black, and 0.18 becomes 0.5^2.2 = 0.218.

use crate::math::{Mat3, Spectrum, vec3};

/// Stops from black to white, and from black to middle grey.
const STOPS: f64 = 16.5;
const STOPS_TO_GREY: f64 = 10.0;
/// Middle grey.
const GREY: f64 = 0.18;
/// What the sigmoid makes of it, its slope there, and the powers of its toe and shoulder (Sobotka's figures).
const SHOWN_GREY: f64 = 0.5;
const SLOPE: f64 = 2.0;
const TOE: f64 = 3.0;
const SHOULDER: f64 = 3.25;
/// Exponent of the display that the sigmoid is made for.
const GAMMA: f32 = 2.2;

/// Rec. 709 to Rec. 2020 (ITU-R BT.2087), by columns.
const TO_REC2020: Mat3 =
    Mat3::from_cols(vec3(0.6274, 0.0691, 0.0164), vec3(0.3293, 0.9195, 0.0880), vec3(0.0433, 0.0114, 0.8956));
/// The inset of Blender's AgX (E. Chow, 2023), by columns.
const INSET: Mat3 = Mat3::from_cols(
    vec3(0.856_627_15, 0.137_318_97, 0.111_898_21),
    vec3(0.095_121_24, 0.761_242, 0.076_799_42),
    vec3(0.048_251_61, 0.101_439_04, 0.811_302_37),
);
/// Its outset, by columns.
const OUTSET: Mat3 = Mat3::from_cols(
    vec3(1.127_100_6, -0.141_329_76, -0.141_329_76),
    vec3(-0.110_606_64, 1.157_823_7, -0.110_606_64),
    vec3(-0.016_493_94, -0.016_493_94, 1.251_936_4),
);

/// The transform: its matrices.
pub(super) struct Agx {
    inset: Mat3,
    back: Mat3,
}

impl Agx {
    pub(super) fn new() -> Self {
        Self { inset: INSET * TO_REC2020, back: TO_REC2020.inverse() }
    }

    /// Linear sRGB for a screen, of finite channels from 0. What a screen's primaries cannot show is below 0 or above 1.
    pub(super) fn map(&self, pixel: Spectrum) -> Spectrum {
        let inset = self.inset * pixel;
        let curved = Spectrum::from_array(inset.to_array().map(curve));
        self.back * (OUTSET * curved).max(Spectrum::ZERO).powf(GAMMA)
    }
}

/// From linear to display-encoded, 0 to 1.
fn curve(linear: f32) -> f32 {
    let stops = (f64::from(linear) / GREY).log2() + STOPS_TO_GREY;
    sigmoid((stops / STOPS).clamp(0.0, 1.0)) as f32
}

/// A line of that slope through middle grey, bent at both ends so that it passes through (0, 0) and (1, 1).
fn sigmoid(x: f64) -> f64 {
    let grey = STOPS_TO_GREY / STOPS;
    if x < grey {
        SHOWN_GREY - bent(grey - x, grey, SHOWN_GREY, TOE)
    } else {
        SHOWN_GREY + bent(x - grey, 1.0 - grey, 1.0 - SHOWN_GREY, SHOULDER)
    }
}

/// SLOPE x for small x, `most_y` at `most_x`: y^-p is (SLOPE x)^-p and a constant. 0 at 0, where the power is infinite.
fn bent(x: f64, most_x: f64, most_y: f64, power: f64) -> f64 {
    let constant = most_y.powf(-power) - (SLOPE * most_x).powf(-power);
    ((SLOPE * x).powf(-power) + constant).powf(-1.0 / power)
}
