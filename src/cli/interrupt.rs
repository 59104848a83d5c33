//! Signals such as Ctrl-C: partial files are removed before the program ends.

/// Removes partial files when a signal ends the program, and then ends it by that signal.
///
/// A signal that the program was started to ignore, as with `nohup`, stays ignored.
#[cfg(unix)]
pub(super) fn watch() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;
    use splatref::io::replace::remove_partial_files;

    survive_large_files();
    let wait = || {
        let ignored = ignored();
        let signals = [SIGHUP, SIGINT, SIGTERM].into_iter();
        let watched = signals.filter(|signal| ignored >> (signal - 1) & 1 == 0);
        // If signals cannot be watched, they keep their default effect.
        let Ok(mut signals) = Signals::new(watched) else { return };
        for signal in signals.forever() {
            let _none_from_now_on = remove_partial_files();
            let _ = emulate_default_handler(signal);
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

/// Makes a write beyond `ulimit -f` an error of the file. By default SIGXFSZ would end the program, without a
/// line of complaint, and partial files would stay.
#[cfg(unix)]
fn survive_large_files() {
    use std::sync::{Arc, atomic::AtomicBool};

    // With a handler, whatever it does, the write fails. If there can be none, the signal keeps its effect.
    let seen = Arc::<AtomicBool>::default();
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen);
}

/// The ignored signals, signal n as bit n - 1; 0 if the system does not tell.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// On other systems partial files stay when a signal ends the program.
#[cfg(not(unix))]
pub(super) fn watch() {}
