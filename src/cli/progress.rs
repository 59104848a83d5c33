//! Progress bars on stderr for work that takes over a second, if stderr is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long work may take before a bar appears.
const PATIENCE: Duration = Duration::from_secs(1);
/// The style of a step of unknown length, and the style of one of known length.
const STYLES: [&str; 2] = ["{spinner} {msg}", "{spinner} {msg} [{bar:32}] {percent} %"];

/// The progress of work, step by step. A bar appears after a second, and shows how far a step is if
/// the step can tell.
pub(super) struct Steps {
    bar: ProgressBar,
    /// Ends the watcher; `None` if stderr is no terminal, or if no thread can be started.
    watcher: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Steps {
    /// Begins with a step of unknown length.
    pub(super) fn new(what: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        style(&bar, STYLES[0]);
        bar.set_message(what.to_owned());
        let watcher = std::io::stderr().is_terminal().then(|| watch(bar.clone())).flatten();
        Self { bar, watcher }
    }

    /// Shows that step `what` has done `done` of `of` units. One unit is no measure of length.
    pub(super) fn show(&self, what: &str, done: u64, of: u64) {
        if self.bar.message() != what {
            self.bar.set_message(what.to_owned());
            style(&self.bar, STYLES[usize::from(of > 1)]);
        }
        self.bar.set_length(of);
        self.bar.set_position(done);
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        if let Some((end, watcher)) = self.watcher.take() {
            drop(end);
            let _ = watcher.join();
        }
        self.bar.finish_and_clear();
    }
}

/// Does work of unknown length, with progress.
pub(super) fn during<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let _steps = Steps::new(what);
    work()
}

fn style(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

/// Starts a thread that shows the bar once the work has taken long enough.
fn watch(bar: ProgressBar) -> Option<(Sender<()>, JoinHandle<()>)> {
    let (end, ended) = mpsc::channel::<()>();
    let watch = move || {
        if ended.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.enable_steady_tick(Duration::from_millis(100));
        }
    };
    thread::Builder::new().spawn(watch).ok().map(|watcher| (end, watcher))
}
