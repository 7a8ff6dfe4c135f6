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

/// Signals that follow the first one sooner are the same wish: `timeout` sends one to a program and one to its group.
const TOGETHER: Duration = Duration::from_millis(200);
/// Time between two questions whether one came.
const NAP: Duration = Duration::from_millis(50);

/// The signal that came; 0 before.
static CAME: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// From here on signals are kept for [`signal`]. Where the machine allows no handlers, they end the program as before.
pub(super) fn listen() {
    let came = CAME.get_or_init(|| Arc::new(AtomicUsize::new(0)));
    let (ignored, again) = (ignored(), Arc::new(AtomicBool::new(false)));
    for (signal, _) in SIGNALS.into_iter().filter(|(signal, _)| ignored >> (signal - 1) & 1 == 0) {
        let _ = flag::register_conditional_shutdown(signal, exit_code(signal).into(), again.clone());
        let _ = flag::register_usize(signal, came.clone(), signal as usize);
    }
    thread::spawn(move || {
        while signal().is_none() {
            thread::sleep(NAP);
        }
        thread::sleep(TOGETHER);
        again.store(true, Ordering::Relaxed);
    });
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
