//! Paints what the camera sees: at once and coarsely, then better and better, until something else is wished.

use super::{
    Arguments,
    board::{Board, Caption, Picture, Wish, is_stale},
    camera::Camera,
    loaded::Loaded,
};
use crate::{
    cli::{
        console::complain,
        interrupt,
        progress::{noise_text, samples_text},
    },
    error::{Error, Result},
    film::Film,
    passes::{Settings, budget::Budget},
    render::{
        self, Image,
        sums::{AnySums, Kept},
    },
    transport::Algorithm,
};
use std::time::{Duration, Instant};

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// A preview that is there before the hand has moved on.
    Quick,
    /// So many samples of pixels so many times as wide, shown once there are `least`.
    Coarse { divisor: u32, samples: u64, least: u64 },
    /// As many samples as a render takes.
    Whole,
}

/// One after the other. A finer picture is shown once it has the samples of the coarser one, so that noise only falls.
const STAGES: [Stage; 4] = [
    Stage::Quick,
    Stage::Coarse { divisor: 4, samples: 16, least: 1 },
    Stage::Coarse { divisor: 2, samples: 4, least: 4 },
    Stage::Whole,
];

/// The time that a quick picture should take, and the sizes of its pixels.
const QUICK: [Duration; 2] = [Duration::from_millis(20), Duration::from_millis(60)];
const QUICK_DIVISORS: [u32; 2] = [1, 16];
/// Films are not made smaller than this (pixels).
const SMALLEST: u32 = 24;
/// Samples of the preview `fog`, where that is what is to be seen.
const FOG_SAMPLES: u64 = 4;
/// Time between two pictures of one stage, at least; and how many times longer than showing one.
const EVERY: Duration = Duration::from_millis(100);
const LONGER: u32 = 10;
/// Time between two questions whether the program ends, when all is painted.
const IDLE: Duration = Duration::from_millis(500);

/// Who paints.
pub(super) struct Painter<'a> {
    arguments: &'a Arguments,
    board: &'a Board,
    loaded: Loaded,
    /// None of a sensor that cannot be moved.
    camera: Option<Camera>,
    /// The number of the next stage.
    stage: usize,
    /// What there is of it.
    sums: Option<AnySums>,
    /// How many times as wide the pixels of quick pictures are.
    quick: u32,
    /// The camera is where it cannot be built.
    is_lost: bool,
}

impl<'a> Painter<'a> {
    /// Reads the scene.
    pub(super) fn new(arguments: &'a Arguments, board: &'a Board) -> Result<Self> {
        let loaded = Loaded::new(arguments)?;
        let camera = loaded.home.clone().ok();
        Ok(Self { arguments, board, loaded, camera, stage: 0, sums: None, quick: 4, is_lost: false })
    }

    /// Paints until the program ends.
    pub(super) fn paint(&mut self) {
        while !interrupt::came() {
            self.obey();
            let Some(stage) = STAGES.get(self.stage) else {
                self.board.rest(IDLE);
                continue;
            };
            match self.make(*stage) {
                Ok(()) if *stage != Stage::Quick && is_stale() => {}
                Ok(()) => {
                    (self.stage, self.sums) = (self.stage + 1, None);
                    if std::mem::take(&mut self.is_lost) {
                        self.board.tell(None);
                    }
                }
                Err(error) => {
                    (self.stage, self.is_lost) = (STAGES.len(), true);
                    self.fail(&error);
                }
            }
        }
    }

    /// Does what is wished.
    fn obey(&mut self) {
        for wish in self.board.take_wishes() {
            match wish {
                _ if interrupt::came() => return,
                Wish::Reload => self.reload(),
                _ => self.follow(wish),
            }
        }
    }

    /// Begins from the first stage.
    fn begin(&mut self) {
        (self.stage, self.sums) = (0, None);
    }

    /// Reads the scene again. The camera stays where it was moved to, unless the scene places its own elsewhere now. Of a
    /// scene with a mistake, the picture stays.
    fn reload(&mut self) {
        self.is_lost = false;
        match Loaded::new(self.arguments) {
            Ok(loaded) => {
                let is_alike =
                    |home: &Camera| self.camera.as_ref().is_some_and(|camera| camera.is_like(home));
                let stays = loaded.home.as_ref().is_ok_and(is_alike);
                match (&mut self.camera, &loaded.home) {
                    (Some(camera), Ok(home)) if stays && loaded.placement == self.loaded.placement => {
                        camera.frame_as(home);
                    }
                    _ => self.camera = loaded.home.clone().ok(),
                }
                self.loaded = loaded;
                self.board.tell(None);
                self.begin();
            }
            Err(error) => self.fail(&error),
        }
    }

    fn fail(&self, error: &Error) {
        let text = format!("error: {error}");
        complain(&text);
        self.board.tell(Some(text));
    }

    /// Moves the camera.
    fn follow(&mut self, wish: Wish) {
        let Some(camera) = &mut self.camera else { return };
        if wish == Wish::Grip {
            // Gestures before it may not have been painted.
            let is_there = self.loaded.setup.look(&camera.steps(), self.loaded.film.clone()).is_ok();
            let ahead = self.loaded.setup.distance_ahead().filter(|_| is_there);
            ahead.into_iter().for_each(|distance| camera.grip(distance));
            return;
        }
        let breadth = camera.breadth_at(camera.distance());
        match wish {
            Wish::Orbit(way) => camera.orbit(way),
            Wish::Pan(way) => camera.pan(way.map(|part| part * breadth)),
            Wish::Dolly(times) => camera.dolly(times),
            Wish::Walk(times) => camera.walk(times),
            Wish::Home => self.loaded.home.iter().for_each(|home| *camera = home.clone()),
            Wish::Grip | Wish::Exposure(_) | Wish::View(_) | Wish::Reload => {}
        }
        self.begin();
    }

    /// Paints a stage, or as much of it as is still wished.
    fn make(&mut self, stage: Stage) -> Result<()> {
        let most = self.loaded.setup.samples_per_pixel;
        match stage {
            Stage::Quick => self.make_quick(),
            Stage::Coarse { divisor, .. } if !self.may_be_coarse(divisor) => Ok(()),
            Stage::Coarse { divisor, samples, least } => {
                let size = format!(" at 1/{divisor} of the size");
                self.refine(self.loaded.film.coarser(divisor), samples.min(most), least.min(most), &size)
            }
            Stage::Whole => self.refine(self.loaded.film.clone(), most, 1, ""),
        }
    }

    fn may_be_coarse(&self, divisor: u32) -> bool {
        let Film { width, height, .. } = self.loaded.film;
        self.camera.is_some() && width.min(height) / divisor >= SMALLEST
    }

    /// Paints surfaces in fog, one ray a pixel; the next time by larger pixels if that takes too long.
    fn make_quick(&mut self) -> Result<()> {
        let started = Instant::now();
        let divisor = (1..=self.quick).rev().find(|divisor| self.may_be_coarse(*divisor)).unwrap_or(1);
        self.look(self.loaded.film.coarser(divisor))?;
        let image = self.fog(Budget { interrupted: interrupt::came, ..Budget::samples(1) })?;
        self.board.show(self.picture(image, "a quick preview".to_owned()));
        let [short, long] = QUICK_DIVISORS;
        match started.elapsed() {
            time if time < QUICK[0] => self.quick = (self.quick / 2).max(short),
            time if time > QUICK[1] => self.quick = (self.quick * 2).min(long),
            _ => {}
        }
        Ok(())
    }

    /// The preview `fog`.
    fn fog(&self, budget: Budget) -> Result<Image> {
        let setup = &self.loaded.setup;
        let settings = Settings { budget, ..self.loaded.settings };
        render::preview(&setup.scene, &setup.film, &settings, &setup.integrator.fog, &[], &mut |_| {})
    }

    /// Puts the camera where it is wished, and `film` into it.
    fn look(&mut self, film: Film) -> Result<()> {
        let Some(camera) = &self.camera else { return Ok(()) };
        self.loaded.setup.look(&camera.steps(), film)?;
        if let Some(medium) = self.loaded.medium
            && self.loaded.home.as_ref().is_ok_and(|home| camera.is_at(home))
        {
            self.loaded.setup.enter(medium);
        }
        Ok(())
    }

    /// Paints so many samples of each pixel of `film`, as the scene or the user wants them made; shows them from `least` on.
    fn refine(&mut self, film: Film, samples: u64, least: u64, size: &str) -> Result<()> {
        self.look(film)?;
        let budget = Budget { interrupted: is_stale, ..Budget::samples(samples) };
        if self.loaded.settings.options.algorithm != Algorithm::Fog {
            return self.sample(budget, least, size);
        }
        let image = self.fog(Budget { samples_per_pixel: Some(FOG_SAMPLES), ..budget })?;
        self.show(image, size);
        Ok(())
    }

    /// Goes on with the samples of this stage.
    fn sample(&mut self, budget: Budget, least: u64, size: &str) -> Result<()> {
        let (settings, setup) = (Settings { budget, ..self.loaded.settings }, &self.loaded.setup);
        let mut sums = self.sums.take().unwrap_or_else(|| AnySums::new(&setup.film, &[], None));
        let mut due = Instant::now();
        let watch = &mut |progress: render::Progress, kept: &dyn Kept| {
            if progress.passes >= least && (progress.is_last || due <= Instant::now()) {
                let started = Instant::now();
                self.show(kept.image(), size);
                due = Instant::now() + EVERY.max(started.elapsed() * LONGER);
            }
        };
        render::go_on(&setup.scene, &setup.film, &settings, &[], &mut sums, watch)?;
        self.sums = Some(sums);
        Ok(())
    }

    /// Shows an image of pixels of `size`, unless another one is wished: that of a moment ago would come in between, or have
    /// holes.
    fn show(&self, image: Image, size: &str) {
        if !is_stale() {
            let said = said(&image, size);
            self.board.show(self.picture(image, said));
        }
    }

    fn picture(&self, image: Image, said: String) -> Picture {
        let Film { width, height, .. } = self.loaded.setup.film;
        Picture { size: [width, height], pixels: image.pixels, caption: self.caption(said) }
    }

    fn caption(&self, said: String) -> Caption {
        let Film { width, height, .. } = self.loaded.film;
        let scene = self.arguments.scene.name().display().to_string();
        let (camera, moves) = self.loaded.lines(self.camera.as_ref());
        Caption { scene, film: [width, height], camera, moves, said }
    }
}

/// What is said of an image of pixels of `size`.
fn said(image: &Image, size: &str) -> String {
    let (samples, seconds) = (samples_text(image.samples()), image.elapsed.as_secs_f64());
    let noise = image.noise.map_or(String::new(), |noise| format!(", {}", noise_text(noise)));
    format!("{samples} samples/pixel{size} in {seconds:.1} s{noise}")
}
