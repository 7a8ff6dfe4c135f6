//! Layers that contributions are sorted into, beside the image with all of them: by group of emitters, and by component
//! of radiance. An observer, used only where such layers are requested, sees where each contribution comes from.
//!
//! An image and these layers are planes of one array, the image first. Code that adds, keeps and merges passes treats
//! them as one larger image.

use crate::{
    film::{
        Film,
        layer::{Component, Content, Layer, Part},
        sharing::FilmSamples,
    },
    math::{Spectrum, Vec2},
    passes::{
        blocks::CameraStart,
        compiled::Compiled,
        faults::{Cause, Fault, guarded},
        observe::BlockObserver,
        pass::Outcome,
        splats::Splats,
    },
    scene::{
        Scene,
        lights::{EmissionSample, EmitterSample, Lights},
    },
    transport::{
        Contribution, Event, Interaction,
        observer::{Meeting, Observer, put},
    },
};
use std::cell::Cell;

/// Which plane contributions belong to, besides the image.
#[derive(Clone, Debug)]
pub(super) struct Sorter {
    /// The plane of each component of each emitter's light; none where no layer has it.
    of_emitters: Vec<[Option<usize>; Component::ALL.len()]>,
    /// Number of planes, including the image.
    planes: usize,
}

impl Sorter {
    /// The sorter for `layers` of `scene`; none where no layer asks for it. No two layers have the same light.
    pub(super) fn new(scene: &Scene, layers: &[Layer]) -> Option<Self> {
        let part = |layer: &Layer| if let Content::Part(part) = layer.content { Some(part) } else { None };
        let parts: Vec<Part> = layers.iter().filter_map(part).collect();
        let names = scene.lights.groups();
        let plane = |group: usize, component| {
            let at = parts.iter().position(|part| part.has(group as u32, component));
            at.map(|at| at + 1)
        };
        let groups = scene.lights.all.iter().map(|light| {
            let group = Lights::group_of(light);
            names.iter().position(|name| *name == group).unwrap_or(names.len())
        });
        let of_emitters =
            groups.map(|group| Component::ALL.map(|component| plane(group, component))).collect();
        (!parts.is_empty()).then_some(Self { of_emitters, planes: 1 + parts.len() })
    }

    /// The plane of light that comes from an emitter as a component; none where no layer has it.
    #[inline]
    fn plane(&self, light: u32, component: Component) -> Option<usize> {
        self.of_emitters[light as usize][component as usize]
    }
}

/// The walk so far, of a camera or light subpath.
#[derive(Clone, Copy, Debug, Default)]
struct Trail {
    /// Vertices in media, the last one included.
    collisions: u32,
    /// The first vertex is in a medium, and the last one.
    is_first_in_medium: bool,
    is_last_in_medium: bool,
}

impl Trail {
    /// The same with `event` at its end.
    #[inline]
    fn with(self, event: &Event<'_>) -> Self {
        let is_in_medium = matches!(event.interaction, Interaction::Medium(..));
        // With forced interaction, a second walk of the same observer begins here.
        let is_first = event.arrival.edges == 1;
        Self {
            collisions: if is_first { 0 } else { self.collisions } + u32::from(is_in_medium),
            is_first_in_medium: if is_first { is_in_medium } else { self.is_first_in_medium },
            is_last_in_medium: is_in_medium,
        }
    }
}

/// A light vertex in the cache: its emitter, and the number of vertices in media up to there.
#[derive(Clone, Copy, Debug)]
struct Kept {
    light: u32,
    collisions: u32,
}

/// See [`Compiled::render`]; the planes of layers follow that of the image.
pub(super) fn block(
    compiled: &dyn Compiled,
    sorter: &Sorter,
    [pass, block]: [usize; 2],
    wants: &dyn Fn(usize) -> bool,
) -> Outcome {
    guarded(pass, |failed, at| {
        let is_wanted = |pixel: usize| wants(pixel) && !failed.contains(&(pixel as u32));
        let mut sorted = Sorted::new(compiled, sorter, pass, at);
        compiled.observe(pass, block, &is_wanted, &mut sorted);
        let Sorted { light, camera, .. } = sorted;
        let faults = [light.faults, camera.faults].concat();
        Outcome::of_parts(camera.values, light.splats.into_values(), faults)
    })
}

/// A block in the making.
struct Sorted<'a> {
    /// The pixel at hand.
    at: &'a Cell<Option<u32>>,
    light: LightPathObserver<'a>,
    camera: CameraPathObserver<'a>,
}

impl<'a> Sorted<'a> {
    fn new(compiled: &'a dyn Compiled, sorter: &'a Sorter, pass: usize, at: &'a Cell<Option<u32>>) -> Self {
        let (film, sample) = (compiled.film(), pass as u64);
        let light = LightPathObserver::new(compiled, sorter, pass);
        let place = Fault { cause: Cause::NotFinite { s: 0, t: 0 }, sample, pixel: None };
        let camera = CameraPathObserver {
            film,
            sorter,
            trail: Trail::default(),
            kept: Vec::new(),
            hero: 0,
            weight: 1.0,
            sums: vec![Spectrum::ZERO; sorter.planes],
            values: Vec::new(),
            place,
            faults: Vec::new(),
        };
        Self { at, light, camera }
    }
}

impl BlockObserver for Sorted<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        &mut self.light
    }

    fn lit(&mut self) {
        self.camera.kept = std::mem::take(&mut self.light.kept);
    }

    fn camera(&mut self, pixel: usize, start: &CameraStart) -> &mut dyn Observer {
        self.at.set(Some(pixel as u32));
        self.camera.begin(pixel, start);
        &mut self.camera
    }

    fn ended(&mut self, pixel: usize) {
        self.camera.end(pixel);
    }
}

/// Contributions of light subpaths to the film, by where they come from.
struct LightPathObserver<'a> {
    film: &'a Film,
    film_samples: FilmSamples,
    sorter: &'a Sorter,
    sample: u64,
    /// Of the light subpath at hand.
    light: u32,
    is_from_medium: bool,
    trail: Trail,
    hero: usize,
    /// Every vertex in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<Kept>>,
    splats: Splats,
    faults: Vec<Fault>,
}

impl<'a> LightPathObserver<'a> {
    fn new(compiled: &'a dyn Compiled, sorter: &'a Sorter, pass: usize) -> Self {
        Self {
            film: compiled.film(),
            film_samples: compiled.film_samples(),
            sorter,
            sample: pass as u64,
            light: 0,
            is_from_medium: false,
            trail: Trail::default(),
            hero: 0,
            kept: vec![Vec::new(); compiled.heroes()],
            splats: Splats::default(),
            faults: Vec::new(),
        }
    }
}

impl Observer for LightPathObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        (self.light, self.is_from_medium, self.hero) = (start.light, start.point.is_volume(), hero);
    }

    fn arrive(&mut self, event: Event<'_>) {
        self.trail = self.trail.with(&event);
    }

    fn keep(&mut self, place: usize) {
        let kept = Kept { light: self.light, collisions: self.trail.collisions };
        put(&mut self.kept[self.hero], place, kept);
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(Contribution { value, .. })) = (meeting, contribution) else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, sample: self.sample, pixel: None });
        }
        let component = match s {
            1 => Component::of_emitter(self.is_from_medium),
            _ => Component::of(self.trail.is_last_in_medium, self.trail.collisions),
        };
        let first = self.sorter.plane(self.light, component).map(|plane| plane * self.film.len());
        let splats = &mut self.splats;
        self.film_samples.splat(self.film, self.sample, film, *value, |pixel, value| {
            splats.push(pixel as u32, value);
            if let Some(first) = first {
                splats.push((first + pixel) as u32, value);
            }
        });
    }
}

/// Contributions of camera subpaths to each plane.
struct CameraPathObserver<'a> {
    film: &'a Film,
    sorter: &'a Sorter,
    trail: Trail,
    /// The vertices in the cache, per hero channel.
    kept: Vec<Vec<Kept>>,
    /// Of the camera subpath at hand.
    hero: usize,
    weight: f32,
    sums: Vec<Spectrum>,
    /// Of those before.
    values: Vec<(u32, Spectrum)>,
    /// A fault at this place, without its cause.
    place: Fault,
    faults: Vec<Fault>,
}

impl CameraPathObserver<'_> {
    fn begin(&mut self, pixel: usize, start: &CameraStart) {
        (self.hero, self.weight, self.trail) = (start.hero, start.weight, Trail::default());
        self.place.pixel = Some(pixel as u32);
        self.sums.fill(Spectrum::ZERO);
    }

    fn end(&mut self, pixel: usize) {
        let Self { film, weight, .. } = self;
        let value = |(plane, sum): (usize, &Spectrum)| ((plane * film.len() + pixel) as u32, *sum * *weight);
        self.values.extend(self.sums.iter().enumerate().map(value));
    }

    /// The emitter and the component of a contribution with `t` camera vertices; none for connections to the lens.
    fn origin(&self, t: u32, meeting: &Meeting<'_>) -> Option<(u32, Component)> {
        let Trail { is_first_in_medium, collisions, .. } = self.trail;
        let by_trail = |more| Component::of(is_first_in_medium, collisions + more);
        let of = |sample: &EmitterSample, component| Some((sample.light, component));
        match meeting {
            Meeting::Met(_, sample) if t == 2 => of(sample, Component::of_emitter(sample.point.is_volume())),
            Meeting::Met(_, sample) | Meeting::Emitter(sample) | Meeting::Bent { sample, .. } => {
                of(sample, by_trail(0))
            }
            Meeting::Pivot(_, _, sample) => of(sample, Component::Single),
            Meeting::Light(index, _) => {
                let Kept { light, collisions } = self.kept[self.hero][*index];
                Some((light, by_trail(collisions)))
            }
            Meeting::Lens(_) => None,
        }
    }
}

impl Observer for CameraPathObserver<'_> {
    fn arrive(&mut self, event: Event<'_>) {
        self.trail = self.trail.with(&event);
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let Some(Contribution { value, .. }) = contribution else { return };
        if !value.is_finite() {
            let cause = Cause::NotFinite { s, t };
            return self.faults.push(Fault { cause, ..self.place.clone() });
        }
        let Some((light, component)) = self.origin(t, &meeting) else { return };
        self.sums[0] += *value;
        if let Some(plane) = self.sorter.plane(light, component) {
            self.sums[plane] += *value;
        }
    }
}
