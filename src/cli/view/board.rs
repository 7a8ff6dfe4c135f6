//! What the page and the painter tell each other: the picture so far, and what is wished.

use crate::{
    cli::{display::Display, interrupt},
    film::view::{Exposure, MOST_STOPS, View},
    math::Spectrum,
};
use serde::{Deserialize, Serialize};
use std::{
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// How long a page waits for another picture before it asks again.
const PATIENCE: Duration = Duration::from_secs(20);
/// No gesture is larger than this: a hand makes many small ones.
const LARGEST: f64 = 100.0;

/// Of the process: a budget asks a plain function.
static STALE: AtomicBool = AtomicBool::new(false);

/// True once the picture in progress is not the one that is wished.
pub(super) fn is_stale() -> bool {
    STALE.load(Ordering::Relaxed) || interrupt::came()
}

/// What a user does. Lengths are in widths of the image, to the right and down.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Wish {
    /// Takes hold of what is in the middle of the image: all gestures that follow are about this.
    Grip,
    /// Turns the camera about it.
    Orbit([f64; 2]),
    /// Moves the camera sideways.
    Pan([f64; 2]),
    /// Brings the camera nearer, so many times by the factor e.
    Dolly(f64),
    /// Moves the camera ahead: this many times the way to what is in the middle.
    Walk(f64),
    /// Brings the camera back to where the scene has it.
    Home,
    /// Shows the picture with another exposure (2^stops times as bright); none: auto.
    Exposure(Option<f64>),
    /// Shows the picture by another view transform.
    View(Name),
    /// The scene's files have changed.
    #[serde(skip)]
    Reload,
}

/// A view transform, by its name.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(try_from = "String")]
pub(super) struct Name(View);

impl TryFrom<String> for Name {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let found = View::NAMES.iter().find(|(known, _)| *known == name);
        found.map(|(_, view)| Self(*view)).ok_or_else(|| format!("no view transform is called {name}"))
    }
}

impl Wish {
    /// False for what no hand does.
    pub(super) fn is_possible(self) -> bool {
        match self {
            Self::Orbit(way) | Self::Pan(way) => way.iter().all(|part| part.abs() <= LARGEST),
            Self::Dolly(times) | Self::Walk(times) => times.abs() <= LARGEST,
            Self::Exposure(stops) => stops.is_none_or(|stops| stops.abs() <= MOST_STOPS),
            Self::Grip | Self::Home | Self::View(_) | Self::Reload => true,
        }
    }
}

/// A picture, finished or not.
#[derive(Debug, Default)]
pub(super) struct Picture {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Row-major radiance, top row first.
    pub pixels: Vec<Spectrum>,
    /// What stands beside it.
    pub caption: Caption,
}

/// What a picture is of, and how it was made.
#[derive(Debug, Default, Serialize)]
pub(super) struct Caption {
    /// The name of the scene.
    pub scene: String,
    /// Pixels across and down of the image of the best pictures.
    pub film: [u32; 2],
    /// The lines of a scene file that place the camera; why there are none.
    pub camera: String,
    /// The camera can be moved.
    pub moves: bool,
    /// Samples, time, noise.
    pub said: String,
}

/// The place where both look.
#[derive(Debug)]
pub(super) struct Board {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    wishes: Vec<Wish>,
    picture: Arc<Picture>,
    error: Option<String>,
    display: Display,
    /// Grows with each change of what is shown.
    number: u64,
    is_closed: bool,
}

/// What a page shows.
pub(super) struct Shown {
    /// The number of the change that made it.
    pub number: u64,
    /// The picture.
    pub picture: Arc<Picture>,
    /// What is wrong with the scene as it is now.
    pub error: Option<String>,
    /// How it is shown.
    pub display: Display,
}

impl Board {
    /// An empty one, whose pictures are shown by `display`.
    pub(super) fn new(display: Display) -> Self {
        let state = State { display, ..State::default() };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes `wishes`. Those that concern the look of the picture are fulfilled at once, the others by the painter.
    pub(super) fn wish(&self, wishes: impl IntoIterator<Item = Wish>) {
        let mut state = self.state();
        for wish in wishes {
            match wish {
                Wish::Exposure(stops) => {
                    state.display.exposure = Some(stops.map_or(Exposure::Auto, Exposure::Stops));
                    state.number += 1;
                }
                Wish::View(Name(view)) => {
                    state.display.view = Some(view);
                    state.number += 1;
                }
                // Once is enough, however often files are written while they are read.
                Wish::Reload if state.wishes.contains(&wish) => {}
                _ => {
                    state.wishes.push(wish);
                    STALE.store(true, Ordering::Relaxed);
                }
            }
        }
        self.changed.notify_all();
    }

    /// The wishes so far; nothing is stale that is begun from here on.
    pub(super) fn take_wishes(&self) -> Vec<Wish> {
        let mut state = self.state();
        STALE.store(false, Ordering::Relaxed);
        std::mem::take(&mut state.wishes)
    }

    /// Waits until something is wished, or so long.
    pub(super) fn rest(&self, time: Duration) {
        let state = self.state();
        let is_idle = |state: &mut State| state.wishes.is_empty() && !state.is_closed;
        drop(self.changed.wait_timeout_while(state, time, is_idle));
    }

    /// Shows `picture`.
    pub(super) fn show(&self, picture: Picture) {
        self.change(|state| state.picture = Arc::new(picture));
    }

    /// Tells what is wrong with the scene, if anything is.
    pub(super) fn tell(&self, error: Option<String>) {
        self.change(|state| state.error = error);
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.state();
        change(&mut state);
        state.number += 1;
        self.changed.notify_all();
    }

    /// What is to be shown after the change `number`, once there is something; none where nothing came, or the program ends.
    pub(super) fn after(&self, number: u64) -> Option<Shown> {
        let is_old = |state: &mut State| {
            let is_empty = state.picture.pixels.is_empty() && state.error.is_none();
            !state.is_closed && (state.number <= number || is_empty)
        };
        let waited = self.changed.wait_timeout_while(self.state(), PATIENCE, is_old);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let State { number, display, .. } = *state;
        let is_news = !state.is_closed && !is_old(&mut state);
        is_news.then(|| Shown { number, picture: state.picture.clone(), error: state.error.clone(), display })
    }

    /// True once everybody is to go.
    pub(super) fn is_closed(&self) -> bool {
        self.state().is_closed
    }

    /// Lets everybody go who waits.
    pub(super) fn close(&self) {
        self.change(|state| state.is_closed = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_read_once_however_often_it_is_written_meanwhile() {
        let board = Board::new(Display::default());
        board.wish([Wish::Reload, Wish::Home, Wish::Reload]);
        assert_eq!(board.take_wishes(), [Wish::Reload, Wish::Home]);
        board.wish([Wish::Reload]);
        assert_eq!(board.take_wishes(), [Wish::Reload]);
    }

    #[test]
    fn an_error_is_shown_before_there_is_a_picture() {
        let board = Board::new(Display::default());
        board.tell(Some("error".to_owned()));
        let shown = board.after(0).expect("the error");
        assert_eq!((shown.error.as_deref(), shown.picture.size), (Some("error"), [0, 0]));
    }
}
