//! How much memory the process may take: asked before what is large is allocated.
//!
//! Without a limit nothing is refused. The program sets one; a library user may. What is asked for
//! is an upper estimate of what the work holds at once, and what the process holds already counts
//! too, where the system tells (on Linux). Small things are not asked for.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicU64, Ordering};

#[cfg(feature = "cli")]
mod available;

static LIMIT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Sets how many bytes the process may hold; [`u64::MAX`] is no limit.
pub fn set_limit(bytes: u64) {
    LIMIT.store(bytes, Ordering::Relaxed);
}

/// The limit that the program sets: three quarters of what the machine, the container, the control
/// groups and `ulimit` leave to the process, whichever is least. [`u64::MAX`] if the system does
/// not tell. Needs the feature `cli`.
#[cfg(feature = "cli")]
#[must_use]
pub fn usual_limit() -> u64 {
    match available::total() {
        0 => u64::MAX,
        total => total / 4 * 3,
    }
}

/// Whether `bytes` more may be held, for what `what` says.
///
/// # Errors
/// [`Error::Invalid`] if not: what, how much, and the limit.
pub fn ask(bytes: u64, what: impl FnOnce() -> String) -> Result<()> {
    try_ask(bytes, what).map_err(Error::Invalid)
}

/// [`ask`] with the reason alone, where the error names a file.
pub(crate) fn try_ask(
    bytes: u64,
    what: impl FnOnce() -> String,
) -> std::result::Result<(), String> {
    try_ask_or(bytes, what, "reduce the work")
}

/// [`try_ask`] for work with a cure of its own.
pub(crate) fn try_ask_or(
    bytes: u64,
    what: impl FnOnce() -> String,
    cure: &str,
) -> std::result::Result<(), String> {
    let limit = LIMIT.load(Ordering::Relaxed);
    if limit == u64::MAX || bytes <= limit.saturating_sub(held()) {
        return Ok(());
    }
    let held = held();
    let digits = digits_apart(bytes.saturating_add(held), limit);
    Err(format!(
        "{} needs up to {} of memory, beside {} in use, but the limit is {}; {cure}, or \
         raise --memory",
        what(),
        in_words(bytes, digits),
        in_words(held, digits),
        in_words(limit, digits)
    ))
}

/// How many bytes more may be held.
#[must_use]
pub fn left() -> u64 {
    match LIMIT.load(Ordering::Relaxed) {
        u64::MAX => u64::MAX,
        limit => limit.saturating_sub(held()),
    }
}

/// How many digits after the point tell two numbers of bytes apart, in words.
fn digits_apart(one: u64, other: u64) -> usize {
    (1..9).find(|&digits| in_words(one, digits) != in_words(other, digits)).unwrap_or(9)
}

/// How many bytes the process holds; 0 where the system does not tell.
fn held() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kilobytes.unwrap_or(0).saturating_mul(1024)
}

/// Bytes as people say them, with at most this many digits after the point: 1.5 GiB.
fn in_words(bytes: u64, digits: usize) -> String {
    const UNITS: [&str; 5] = ["bytes", "KiB", "MiB", "GiB", "TiB"];
    let power = (bytes.max(1).ilog2() / 10).min(4);
    let value = bytes as f64 / (1_u64 << (10 * power)) as f64;
    let value = format!("{value:.digits$}");
    let value = value.trim_end_matches('0').trim_end_matches('.');
    format!("{value} {}", UNITS[power as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_in_words() {
        let words = [0, 1023, 1024, 1536, 3 << 29, u64::MAX].map(|bytes| in_words(bytes, 1));
        let expected = ["0 bytes", "1023 bytes", "1 KiB", "1.5 KiB", "1.5 GiB", "16777216 TiB"];
        assert_eq!(words, expected);
    }

    #[test]
    fn numbers_that_differ_look_different() {
        let limit = 1 << 30;
        for more in [1 << 29, 1 << 24, 1 << 20, 1 << 10, 8] {
            let digits = digits_apart(limit + more, limit);
            assert_ne!(in_words(limit + more, digits), in_words(limit, digits), "{more}");
        }
        assert_eq!(digits_apart(3 << 29, 1 << 30), 1);
        assert_eq!(
            in_words((1 << 30) + (1 << 20), digits_apart((1 << 30) + (1 << 20), 1 << 30)),
            "1.001 GiB"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_held_is_known() {
        assert!(held() > 1 << 20, "{}", held());
    }
}
