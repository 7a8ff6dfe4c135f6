//! What a guide knows of a scene: its cells as the camera sees them, the part of the directions that it guides there, its
//! directions in the cells that most pixels see.

use super::{
    picture::false_colour,
    sheet::{self, Row},
};
use crate::{
    bsdf::Transport,
    error::Result,
    film,
    guide::{Guide, Learnt},
    learning::training,
    math::{Spectrum, Vec3, srgb::Srgb, vec2, vec3, warp},
    passes::Settings,
    render::instrument::Instrument,
    sampling::portal,
    scene::{Scene, build::Setup, lights::Starts},
    transport::Interaction,
};
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Instant,
};

/// The files that [`Findings::write`] writes; the first always, the others where a guide was learnt.
pub const FILES: [&str; 3] = ["guide.json", "cells.png", "directions.png"];
/// Cells whose directions are shown; emitters that are named.
const SHOWN: usize = 8;
/// Side of the pictures of directions (pixels).
const SIDE: usize = 128;
/// The least and the most of their densities over an even one, powers of ten.
const LEAST: f32 = -2.0;
const MOST: f32 = 3.0;

/// Walks, and what they are called.
const WALKS: [(Transport, &str); 2] = [(Transport::Radiance, "camera"), (Transport::Importance, "light")];

/// The numbers of a guide.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Time that learning took (s).
    pub seconds: f64,
    /// Memory that what was learnt takes (bytes).
    pub bytes: usize,
    /// The part of the second moment of walks' contributions that the last guide but one left: the less, the better.
    /// Walks followed that one to learn the last.
    pub second_moment: f64,
    /// Of surfaces.
    pub surfaces: Cells,
    /// Of media.
    pub media: Cells,
    /// Openings that much of the light goes through, the most telling first.
    pub portals: Vec<Portal>,
    /// Emitters at which most light subpaths start, once that is learnt, the first of them first.
    pub starts: Vec<Start>,
    /// Those that most pixels see, the most seen first.
    pub seen: Vec<Seen>,
}

/// Cells of one kind.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Cells {
    /// How many there are.
    pub cells: usize,
    /// The part of the directions of the camera's walks and of light's that is guided in them, on average.
    pub guided: [f32; 2],
}

/// What much of the light goes through.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Portal {
    /// In the scene's coordinates.
    pub centre: [f64; 3],
    /// Radius of the smallest sphere around it that walks aim at; the widest is 2.8 times as large. Above 0 (m).
    pub radius: f32,
}

/// How often light subpaths start at an emitter.
#[derive(Clone, Debug, Serialize)]
pub struct Start {
    /// Its number among all emitters.
    pub emitter: usize,
    /// The part of light subpaths that start there without what was learnt.
    pub unlearnt: f32,
    /// The same with it.
    pub learnt: f32,
    /// Openings that a part of them aims at.
    pub portals: Vec<Portal>,
}

/// A cell that pixels see.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Seen {
    /// Its number.
    pub cell: u32,
    /// Where one of the pixels sees it, from where its directions are shown.
    #[serde(skip)]
    place: Vec3,
    /// The part of the image that sees it.
    pub pixels: f64,
    /// The part of the directions of the camera's walks and of light's that is guided.
    pub guided: [f32; 2],
    /// Unit direction of the highest density of either, none where there is no guide.
    pub towards: [Option<[f32; 3]>; 2],
}

/// The cell of what a pixel sees, if it sees any, and where that is.
type SeenCell = Option<(u32, Vec3)>;

/// What was learnt, and where the camera sees it.
pub struct Findings {
    /// The numbers.
    pub report: Report,
    guide: Option<Arc<Guide>>,
    /// Of each pixel.
    cells: Vec<SeenCell>,
    size: [usize; 2],
}

/// What renders of `setup` by `settings` learn for samples of the number `sample`.
pub fn examine(setup: &Setup, settings: &Settings, sample: usize) -> Findings {
    let began = Instant::now();
    let rounds = training::rounds_for(&setup.film, settings, sample);
    let learnt = training::learn_rounds(&setup.scene, &setup.film, settings, rounds);
    let seconds = began.elapsed().as_secs_f64();
    let seen = Instrument::new(&setup.scene, &setup.film, settings).first_interactions();
    let cell = |seen: &Option<Interaction>| {
        let seen = seen.as_ref().filter(|seen| seen.is_connectible(&setup.scene))?;
        Some((learnt.guide.as_deref()?.cell(seen.position(), seen.normal()), seen.position()))
    };
    let cells: Vec<SeenCell> = seen.iter().map(cell).collect();
    let report = report(&setup.scene, &learnt, &cells, seconds);
    let size = [setup.film.width as usize, setup.film.height as usize];
    Findings { report, guide: learnt.guide, cells, size }
}

fn report(scene: &Scene, learnt: &Learnt, cells: &[SeenCell], seconds: f64) -> Report {
    let guide = learnt.guide.as_deref();
    let (all, of_surfaces) = guide.map_or((0, 0), |guide| (guide.cells(), guide.cells_of_surfaces()));
    let kind = |from: usize, to: usize| {
        let guided = |(transport, _)| {
            let of = |cell: usize| guide.map_or(0.0, |guide| guide.guided(cell as u32, transport));
            // The sum of nothing is -0.
            (0.0 + (from..to).map(of).sum::<f32>()) / (to - from).max(1) as f32
        };
        Cells { cells: to - from, guided: WALKS.map(guided) }
    };
    Report {
        seconds,
        bytes: learnt.bytes(),
        second_moment: guide.map_or(1.0, |guide| guide.second_moment),
        surfaces: kind(0, of_surfaces),
        media: kind(of_surfaces, all),
        portals: guide.map_or(Vec::new(), |guide| portals(scene, guide.portals().iter())),
        starts: learnt.starts.as_deref().map_or(Vec::new(), |starts| most_started(scene, starts)),
        seen: guide.map_or(Vec::new(), |guide| seen(guide, cells)),
    }
}

fn portals<'a>(scene: &Scene, portals: impl Iterator<Item = &'a portal::Portal>) -> Vec<Portal> {
    let placed = |portal: &portal::Portal| Portal {
        centre: (portal.smallest.centre.as_dvec3() + scene.recentre).to_array(),
        radius: portal.smallest.radius_squared.sqrt(),
    };
    portals.map(placed).collect()
}

fn most_started(scene: &Scene, starts: &Starts) -> Vec<Start> {
    let start = |emitter| Start {
        emitter,
        unlearnt: scene.lights.start_probability(emitter),
        learnt: starts.probability(&scene.lights, emitter),
        portals: portals(scene, starts.portals(emitter)),
    };
    let mut all: Vec<Start> = (0..scene.lights.all.len()).map(start).collect();
    all.sort_by(|a, b| b.learnt.total_cmp(&a.learnt));
    all.truncate(SHOWN);
    all
}

/// The cells that most of the pixels see.
fn seen(guide: &Guide, cells: &[SeenCell]) -> Vec<Seen> {
    let mut places = vec![Vec::new(); guide.cells()];
    cells.iter().flatten().for_each(|(cell, position)| {
        if let Some(places) = places.get_mut(*cell as usize) {
            places.push(*position);
        }
    });
    let mut order: Vec<usize> = (0..places.len()).filter(|cell| !places[*cell].is_empty()).collect();
    order.sort_by_key(|cell| std::cmp::Reverse(places[*cell].len()));
    let seen = |cell: usize| {
        let place = places[cell][places[cell].len() / 2];
        Seen {
            cell: cell as u32,
            place,
            pixels: places[cell].len() as f64 / cells.len() as f64,
            guided: WALKS.map(|(transport, _)| guide.guided(cell as u32, transport)),
            towards: WALKS.map(|(transport, _)| towards(guide, (cell as u32, place), transport)),
        }
    };
    order.into_iter().take(SHOWN).map(seen).collect()
}

/// Unit direction of the highest density.
fn towards(guide: &Guide, (cell, place): (u32, Vec3), transport: Transport) -> Option<[f32; 3]> {
    let density = |at: &usize| guide.density(cell, transport, place, direction(*at));
    density(&0)?;
    let best = (0..SIDE * SIDE).max_by(|a, b| density(a).partial_cmp(&density(b)).unwrap_or(a.cmp(b)))?;
    Some(direction(best).to_array())
}

/// That of a pixel of a picture of all directions, in which equal areas are equal solid angles: the azimuth grows to the right,
/// the cosine to +z downwards.
fn direction(pixel: usize) -> Vec3 {
    warp::to_sphere((vec2((pixel % SIDE) as f32, (pixel / SIDE) as f32) + 0.5) / SIDE as f32)
}

impl Findings {
    /// Writes numbers and pictures into `folder`, which exists; the files.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let [json, cells, directions] = FILES.map(|name| folder.join(name));
        let text = serde_json::to_string_pretty(&self.report).unwrap_or_default();
        film::output::write(&json, |out| writeln!(out, "{text}"))?;
        let Some(guide) = &self.guide else { return Ok(vec![json]) };
        let [width, height] = self.size;
        sheet::write(&cells, width, height, &[self.seen(guide)])?;
        sheet::write(&directions, SIDE, SIDE, &self.directions(guide))?;
        Ok(vec![json, cells, directions])
    }

    /// The cells, each by a colour of its own, and the parts of directions that are guided in them.
    fn seen(&self, guide: &Guide) -> Row {
        let colour = |cell: &SeenCell| cell.map_or(Spectrum::ZERO, |(cell, _)| colour_of(cell));
        let guided = |(transport, walk): (Transport, &str)| {
            let part = |cell: &SeenCell| cell.map_or(0.0, |(cell, _)| guide.guided(cell, transport));
            let parts: Vec<f32> = self.cells.iter().map(part).collect();
            (format!("guided, {walk}"), linear(&false_colour(&parts, (0.0, 1.0))))
        };
        let cells = (format!("{} cells", guide.cells()), self.cells.iter().map(colour).collect());
        let images = std::iter::once(cells).chain(WALKS.map(guided)).collect();
        Row { caption: String::new(), exposure: 1.0, images }
    }

    /// Where walks go from the cells that most pixels see.
    fn directions(&self, guide: &Guide) -> Vec<Row> {
        let row = |seen: &Seen| {
            let image = |(index, (transport, walk)): (usize, (Transport, &str))| {
                let density = |pixel| guide.density(seen.cell, transport, seen.place, direction(pixel));
                let power =
                    |pixel| density(pixel).map_or(0.0, |density| (density / warp::SPHERE_PDF).log10());
                let powers: Vec<f32> = (0..SIDE * SIDE).map(|pixel| power(pixel) - LEAST).collect();
                let colours = false_colour(&powers, (0.0, MOST - LEAST));
                (format!("{walk} {:.0} %", 100.0 * seen.guided[index]), linear(&colours))
            };
            let images = WALKS.into_iter().enumerate().map(image).collect();
            Row { caption: format!("{}: {:.1} %", seen.cell, 100.0 * seen.pixels), exposure: 1.0, images }
        };
        self.report.seen.iter().map(row).collect()
    }
}

/// A colour that few other cells have.
fn colour_of(cell: u32) -> Spectrum {
    let part = |factor: f32| 0.15 + 0.8 * ((cell as f32 + 1.0) * factor).fract();
    vec3(part(0.618_034), part(0.754_878), part(0.569_840))
}

fn linear(bytes: &[u8]) -> Vec<Spectrum> {
    let decoded = |byte: u8| (f32::from(byte) / 255.0).srgb_decoded();
    bytes.chunks_exact(3).map(|rgb| vec3(decoded(rgb[0]), decoded(rgb[1]), decoded(rgb[2]))).collect()
}
