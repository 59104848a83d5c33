//! Ctrl-C and its like: what is half written goes before the program does.

/// Has partial files removed when a signal ends the program, which then ends as by that signal.
///
/// A signal that the program was started to ignore, as by `nohup`, stays ignored.
#[cfg(unix)]
pub(super) fn watch() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;
    use splatref::io::replace::remove_partial_files;

    let wait = || {
        let ignored = ignored();
        let signals = [SIGHUP, SIGINT, SIGTERM].into_iter();
        let watched = signals.filter(|signal| ignored >> (signal - 1) & 1 == 0);
        // Where they cannot be watched, signals do what they do by themselves.
        let Ok(mut signals) = Signals::new(watched) else { return };
        for signal in signals.forever() {
            let _none_from_now_on = remove_partial_files();
            let _ = emulate_default_handler(signal);
        }
    };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

/// The signals that are ignored, signal n as bit n - 1; none where the system does not tell.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Elsewhere partial files stay when the program is ended from outside.
#[cfg(not(unix))]
pub(super) fn watch() {}
