//! Progress on stderr, of what takes over a second, where a person is looking.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long work may take unnoticed.
const PATIENCE: Duration = Duration::from_secs(1);
/// Of a step that cannot tell how far it is, and of one that can.
const STYLES: [&str; 2] = ["{spinner} {msg}", "{spinner} {msg} [{bar:32}] {percent} %"];

/// The progress of work, step by step: a sign of life from the first second on, and how far a step
/// is where it can tell.
pub(super) struct Steps {
    bar: ProgressBar,
    /// Ends the watcher; none where nobody is looking, or where there are no threads.
    watcher: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Steps {
    /// Begins with a step that cannot tell how far it is.
    pub(super) fn new(what: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        style(&bar, STYLES[0]);
        bar.set_message(what.to_owned());
        let watcher = std::io::stderr().is_terminal().then(|| watch(bar.clone())).flatten();
        Self { bar, watcher }
    }

    /// Step `what` has done so many of so many; one of one is no measure.
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

/// Does work that cannot tell how far it is.
pub(super) fn during<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let _steps = Steps::new(what);
    work()
}

fn style(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

/// Lets the bar be seen, and move, when the work has taken long enough.
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
