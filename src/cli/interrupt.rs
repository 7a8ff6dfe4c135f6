//! Ctrl-C and its like: the first one asks a render to end in order, the second one ends the program at once.

use signal_hook::{consts, flag};
use std::{
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

/// The signals that end a render, and what they are called.
#[cfg(unix)]
const SIGNALS: [(i32, &str); 3] =
    [(consts::SIGINT, "Ctrl-C"), (consts::SIGTERM, "SIGTERM"), (consts::SIGHUP, "SIGHUP")];
#[cfg(not(unix))]
const SIGNALS: [(i32, &str); 2] = [(consts::SIGINT, "Ctrl-C"), (consts::SIGTERM, "SIGTERM")];

/// A signal that follows one of its kind sooner is the same wish: `timeout` sends one to a program and one to its group.
const TOGETHER: Duration = Duration::from_millis(100);

/// The signal that came; 0 before.
static CAME: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// From here on signals are kept for [`signal`]. Where the machine allows no handlers, they end the program as before.
pub(super) fn listen() {
    if CAME.get().is_some() {
        return;
    }
    let (came, ignored) = (CAME.get_or_init(|| Arc::new(AtomicUsize::new(0))), ignored());
    let kept = SIGNALS.into_iter().filter(|(signal, _)| ignored >> (signal - 1) & 1 == 0);
    let heard = kept.map(|(signal, _)| {
        let [once, again] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
        let _ = flag::register_conditional_shutdown(signal, exit_code(signal).into(), again.clone());
        let _ = flag::register(signal, once.clone());
        let _ = flag::register_usize(signal, came.clone(), signal as usize);
        (once, again)
    });
    let heard: Vec<_> = heard.collect();
    let _ = thread::Builder::new().spawn(move || arm(&heard));
}

/// Has another signal of a kind end the program, a while after the first one came. Never returns.
fn arm(heard: &[(Arc<AtomicBool>, Arc<AtomicBool>)]) {
    let mut before = vec![false; heard.len()];
    loop {
        thread::sleep(TOGETHER);
        for ((once, again), before) in heard.iter().zip(&mut before) {
            again.store(*before, Ordering::Relaxed);
            *before = once.load(Ordering::Relaxed);
        }
    }
}

/// The signals that whoever started the program wants it to ignore (nohup does), as bits from 0; on other systems than
/// Linux they are not known.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// From here on as if the terminal had gone.
pub(super) fn hang_up() {
    #[cfg(unix)]
    const GONE: i32 = consts::SIGHUP;
    #[cfg(not(unix))]
    const GONE: i32 = consts::SIGTERM;
    if let Some(came) = CAME.get() {
        came.store(GONE as usize, Ordering::Relaxed);
    }
}

/// True once a signal came.
pub(super) fn came() -> bool {
    signal().is_some()
}

/// The signal that came, by name, with the exit code that it gives.
pub(super) fn signal() -> Option<(&'static str, u8)> {
    let came = CAME.get()?.load(Ordering::Relaxed);
    let found = SIGNALS.iter().find(|(signal, _)| *signal as usize == came);
    found.map(|(signal, name)| (*name, exit_code(*signal)))
}

/// As shells report a process that a signal ended.
fn exit_code(signal: i32) -> u8 {
    128 + signal as u8
}
