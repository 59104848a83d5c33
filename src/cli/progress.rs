//! Progress on stderr, of what takes over a second, where a person is looking.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

/// How long work may take unnoticed.
const PATIENCE: Duration = Duration::from_secs(1);

/// The progress of steps that know how far they are.
pub(super) struct Steps {
    start: Instant,
    bar: ProgressBar,
}

impl Steps {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:32}] {percent} %") {
            bar.set_style(style);
        }
        Self { start: Instant::now(), bar }
    }

    /// Step `what` has done so many of so many.
    pub(super) fn show(&self, what: &str, done: u64, of: u64) {
        if self.bar.is_hidden() && self.start.elapsed() > PATIENCE {
            // Stays hidden where stderr is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        if self.bar.message() != what {
            self.bar.set_message(what.to_owned());
        }
        self.bar.set_length(of);
        self.bar.set_position(done);
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Does work that cannot tell how far it is, with a sign of life.
pub(super) fn during<T>(what: &'static str, work: impl FnOnce() -> T) -> T {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    let (end, ended) = mpsc::channel::<()>();
    let watch = move || {
        if ended.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
            let sign = ProgressBar::new_spinner().with_message(what);
            sign.enable_steady_tick(Duration::from_millis(100));
            let _ = ended.recv();
            sign.finish_and_clear();
        }
    };
    // Where there are no threads there is no sign of life.
    let watcher = thread::Builder::new().spawn(watch).ok();
    let done = work();
    drop(end);
    if let Some(watcher) = watcher {
        let _ = watcher.join();
    }
    done
}
