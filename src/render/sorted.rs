//! Layers that contributions are sorted into, beside the image that has all of them: what every group of emitters
//! contributes. An observer that is chosen only where such layers are requested sees where each contribution comes from.
//!
//! An image and such layers of it are planes of one array, the image first: what adds up, keeps and merges passes treats
//! them as an image of that many more pixels. To sort by something else is another [`Sorter`].

use super::{
    block::Outcome,
    compiled::Ready,
    faults::{Cause, Fault},
};
use crate::{
    film::{
        Film,
        layer::{Content, Layer},
    },
    math::{Channels, Spectrum, Vec2},
    scene::{
        Scene,
        lights::{EmissionSample, Light, Lights},
    },
    transport::{
        Contribution, MisSums,
        observer::{Meeting, Observer},
        profile::Profile,
    },
};
use std::cell::Cell;

/// Where a contribution comes from.
#[derive(Clone, Copy, Debug)]
pub struct Origin {
    /// The emitter.
    pub light: u32,
}

/// Which plane contributions belong to, besides the image.
#[derive(Clone, Debug)]
pub struct Sorter {
    /// That of each emitter; none where no layer has it.
    of_emitters: Vec<Option<usize>>,
    /// How many there are, the image among them.
    planes: usize,
}

impl Sorter {
    /// What `layers` of `scene` request; none where that is nothing.
    pub fn new(scene: &Scene, layers: &[Layer]) -> Option<Self> {
        let contents: Vec<Content> =
            layers.iter().filter(|layer| layer.is_sorted()).map(|layer| layer.content).collect();
        let names = scene.lights.groups();
        let plane = |light: &Light| {
            let group = names.iter().position(|name| *name == Lights::group_of(light))?;
            contents.iter().position(|content| *content == Content::Group(group as u32))
        };
        let of_emitters = scene.lights.all.iter().map(|light| plane(light).map(|at| at + 1)).collect();
        (!contents.is_empty()).then_some(Self { of_emitters, planes: 1 + contents.len() })
    }

    /// The plane of a contribution that comes from `origin`; none where no layer has it.
    #[inline]
    fn plane(&self, origin: Origin) -> Option<usize> {
        self.of_emitters[origin.light as usize]
    }
}

/// How many layers of an image contributions are sorted into.
pub fn count(layers: &[Layer]) -> usize {
    layers.iter().filter(|layer| layer.is_sorted()).count()
}

/// See [`super::block::Blocks::render`]; the planes of layers follow that of the image.
pub(super) fn block<P: Profile>(
    ready: &Ready<'_, P>,
    sorter: &Sorter,
    [pass, block]: [usize; 2],
    wants: &dyn Fn(usize) -> bool,
    at: &Cell<Option<u32>>,
) -> Outcome {
    let Ready { estimator, blocks, scene, film, seed } = ready;
    let mut light = LightPathObserver::new(film, sorter, pass, P::Channels::COUNT);
    // Compiled for instruments in any case.
    let mut observer: &mut dyn Observer<P::MisSums> = &mut light;
    let cache = blocks.trace_light(estimator, *seed, pass, block, &mut observer);
    let LightPathObserver { kept, values, mut faults, .. } = light;
    let mut camera = Vec::new();
    for pixel in blocks.pixels(block).filter(|pixel| wants(*pixel)) {
        at.set(Some(pixel as u32));
        let start = blocks.camera_start(scene, film, *seed, pass, pixel);
        let (weight, kept) = (start.weight, kept[start.hero].as_slice());
        let mut sums = vec![Spectrum::ZERO; sorter.planes];
        let place =
            Fault { cause: Cause::NotFinite { s: 0, t: 0 }, sample: pass as u64, pixel: Some(pixel as u32) };
        let mut observer =
            CameraPathObserver { sorter, kept, sums: &mut sums, place: &place, faults: &mut faults };
        start.trace(estimator, &cache, &mut observer as &mut dyn Observer<P::MisSums>);
        let planes = sums.iter().enumerate();
        camera.extend(planes.map(|(plane, sum)| ((plane * film.len() + pixel) as u32, *sum * weight)));
    }
    Outcome::of_parts(camera, values, faults)
}

/// What light subpaths contribute to the film, and which emitters they come from.
struct LightPathObserver<'a> {
    film: &'a Film,
    sorter: &'a Sorter,
    sample: u64,
    /// Of the light subpath at hand.
    origin: Origin,
    hero: usize,
    /// Of every vertex in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<Origin>>,
    values: Vec<(u32, Spectrum)>,
    faults: Vec<Fault>,
}

impl<'a> LightPathObserver<'a> {
    fn new(film: &'a Film, sorter: &'a Sorter, pass: usize, heroes: usize) -> Self {
        Self {
            film,
            sorter,
            sample: pass as u64,
            origin: Origin { light: 0 },
            hero: 0,
            kept: vec![Vec::new(); heroes],
            values: Vec::new(),
            faults: Vec::new(),
        }
    }
}

impl<S: MisSums> Observer<S> for LightPathObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        (self.origin, self.hero) = (Origin { light: start.light }, hero);
    }

    fn keep(&mut self) {
        self.kept[self.hero].push(self.origin);
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(Contribution { value, .. })) = (meeting, contribution) else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, sample: self.sample, pixel: None });
        }
        let first = self.sorter.plane(self.origin).map(|plane| plane * self.film.len());
        let values = &mut self.values;
        self.film.spread(film, *value, |pixel, value| {
            values.push((pixel as u32, value));
            values.extend(first.map(|first| ((first + pixel) as u32, value)));
        });
    }
}

/// What one camera subpath contributes to each plane.
struct CameraPathObserver<'a> {
    sorter: &'a Sorter,
    /// Where the vertices in the cache come from.
    kept: &'a [Origin],
    sums: &'a mut [Spectrum],
    /// Where faults are, but for their cause.
    place: &'a Fault,
    faults: &'a mut Vec<Fault>,
}

impl<S: MisSums> Observer<S> for CameraPathObserver<'_> {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let Some(Contribution { value, .. }) = contribution else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, ..self.place.clone() });
        }
        let origin = match meeting {
            Meeting::Met(_, sample) | Meeting::Emitter(sample) | Meeting::Pivot(_, _, sample) => {
                Origin { light: sample.light }
            }
            Meeting::Light(index, _) => self.kept[index],
            // Of light subpaths.
            Meeting::Lens(_) => return,
        };
        self.sums[0] += *value;
        if let Some(plane) = self.sorter.plane(origin) {
            self.sums[plane] += *value;
        }
    }
}
