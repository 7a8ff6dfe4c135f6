//! What is told of the strategies of a scene.

use crate::analysis::study::outcome::Interval;
use serde::Serialize;

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Which program made it, with its version.
    pub made_by: String,
    /// Kinds of strategies that ran.
    pub strategies: Vec<&'static str>,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Passes that made the images.
    pub passes: usize,
    /// Mean luminance of the image.
    pub luminance: f64,
    /// Variance of one pass by luminance, summed over pixels; none of a single pass.
    pub variance: Option<f64>,
    /// Time of one pass, summed over threads (s).
    pub seconds: f64,
    /// Share of time of camera subpaths, without connections.
    pub eye_walks: f64,
    /// Share of time of light subpaths, without connections.
    pub light_walks: f64,
    /// Vertices of camera subpaths at which light may scatter on, per pixel and pass.
    pub eye_vertices: f64,
    /// Those of light subpaths.
    pub light_vertices: f64,
    /// Share of variance that is none of a single strategy's: covariances between them. Often negative or positive by
    /// a lot, as strategies share their walks.
    pub covariances: Option<f64>,
    /// Rows of the sheets.
    pub rows: Vec<RowReport>,
    /// Strategies that ran.
    pub cells: Vec<CellReport>,
    /// Sets of strategies that the scene might do with.
    pub subsets: Vec<SubsetReport>,
    /// What follows from them; none where none were compared.
    pub advice: Option<String>,
}

/// A row of the sheets.
#[derive(Clone, Debug, Serialize)]
pub struct RowReport {
    /// Segments of its paths; none for all longer ones.
    pub length: Option<u32>,
    /// Factor on its radiance before it is shown.
    pub exposure: f64,
    /// Share of the image's mean luminance.
    pub energy: f64,
}

/// One strategy, or all of a kind on longer paths.
#[derive(Clone, Debug, Serialize)]
pub struct CellReport {
    /// As in the image files.
    pub name: String,
    /// Segments of its paths; none for longer ones.
    pub length: Option<u32>,
    /// Light vertices; none for longer paths.
    pub s: Option<u32>,
    /// Camera vertices, the lens among them; none for longer paths.
    pub t: Option<u32>,
    /// Its kind.
    pub kind: &'static str,
    /// Share of the image's mean luminance.
    pub energy: f64,
    /// Mean luminance of what it contributes alone, over that of all paths of its length: 1 where it can make
    /// all of them; none where there is no light on paths of its length, or on longer ones, of which several
    /// strategies count here.
    pub alone: Option<f64>,
    /// Its weighted contribution's variance, by luminance and summed over pixels, over that of the image. Of one pass.
    pub variance: Option<f64>,
    /// The same of what it contributes alone.
    pub variance_alone: Option<f64>,
    /// Share of time.
    pub time: f64,
    /// How often it is tried per pixel and pass.
    pub tries: f64,
}

/// A set of strategies.
#[derive(Clone, Debug, Serialize)]
pub struct SubsetReport {
    /// As for `--strategies`.
    pub strategies: String,
    /// What it leaves out of the full set.
    pub without: String,
    /// Paths that the full set can make and this one cannot: it is no choice for this scene.
    pub lacks: Option<String>,
    /// relMSE x time of the full set over its own; more than 1 is better.
    pub gain: Option<Interval>,
}
