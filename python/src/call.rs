//! Long calls: they release the interpreter, report their progress, and stop on Ctrl-C.

use crate::error::raised;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use splatref::frame::Exec;
use splatref::frame::tile::Stopped;
use splatref::progress::Progress;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// How often signals are looked for, and progress is shown.
const GLANCE: Duration = Duration::from_millis(50);
/// The stack of the thread that works; only what is touched takes memory.
const STACK: usize = 16 << 20;

/// How a call works: what it computes does not depend on it.
#[derive(FromPyObject)]
pub(crate) struct How {
    threads: usize,
    tile: u32,
    /// A function of a step, how much of it is done, and the total.
    progress: Option<Py<PyAny>>,
}

/// The step that runs.
#[derive(Default)]
struct Step {
    name: String,
    done: u64,
    of: u64,
}

pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The threads of earlier calls, which later calls use again. A process that was forked has none of
/// its parent's threads.
fn exec(threads: usize, tile: u32, stop: Arc<AtomicBool>) -> splatref::Result<Exec> {
    type Key = (u32, usize, u32);
    static ALL: Mutex<Vec<(Key, Exec)>> = Mutex::new(Vec::new());
    let key = (std::process::id(), threads, tile);
    let mut all = locked(&ALL);
    if let Some((_, known)) = all.iter().find(|(other, _)| *other == key) {
        return Ok(known.stoppable(stop));
    }
    let new = Exec::new(threads, tile)?;
    let stoppable = new.stoppable(stop);
    all.push((key, new));
    Ok(stoppable)
}

/// Runs `work` in a thread of its own, while this thread waits without the interpreter.
///
/// A signal such as Ctrl-C stops the work at its next tile or chunk, and raises its exception.
/// Nothing that `work` writes is half-written, because files are complete or absent.
pub(crate) fn call<T: Send>(
    py: Python<'_>,
    how: &How,
    work: impl FnOnce(&Exec, Progress<'_>) -> splatref::Result<T> + Send,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let exec = exec(how.threads, how.tile, stop.clone()).map_err(raised)?;
    let (step, ended) = (Mutex::new(Step::default()), (Mutex::new(false), Condvar::new()));
    thread::scope(|scope| {
        let run = || {
            let show = |name: &str, done, of| {
                exec.check_stop();
                let mut step = locked(&step);
                if step.name != name {
                    name.clone_into(&mut step.name);
                }
                (step.done, step.of) = (done, of);
            };
            let result = catch_unwind(AssertUnwindSafe(|| work(&exec, &show)));
            *locked(&ended.0) = true;
            ended.1.notify_one();
            result
        };
        let thread = thread::Builder::new().name("splatref".into()).stack_size(STACK);
        let worker = thread.spawn_scoped(scope, run)?;
        let mut interrupted = None;
        while !py.detach(|| wait(&ended)) {
            if interrupted.is_none()
                && let Err(error) = glance(py, how, &step)
            {
                stop.store(true, Ordering::Relaxed);
                interrupted = Some(error);
            }
        }
        let result = worker.join().and_then(|result| result);
        match (interrupted, result) {
            (Some(error), _) => Err(error),
            (None, Ok(result)) => result.map_err(raised),
            (None, Err(panic)) => Err(bug(&*panic)),
        }
    })
}

/// Waits for the end of the work, but not long; whether it has ended.
fn wait((ended, changed): &(Mutex<bool>, Condvar)) -> bool {
    let waited = changed.wait_timeout_while(locked(ended), GLANCE, |ended| !*ended);
    *waited.unwrap_or_else(PoisonError::into_inner).0
}

/// Looks for signals, and shows the progress.
fn glance(py: Python<'_>, how: &How, step: &Mutex<Step>) -> PyResult<()> {
    py.check_signals()?;
    if let Some(progress) = &how.progress {
        let (name, done, of) = {
            let step = locked(step);
            (step.name.clone(), step.done, step.of)
        };
        progress.call1(py, (name, done, of))?;
    }
    Ok(())
}

/// The exception for a panic of the library.
fn bug(panic: &(dyn Any + Send)) -> PyErr {
    if panic.is::<Stopped>() {
        return PyRuntimeError::new_err("the work was stopped");
    }
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
    PyRuntimeError::new_err(format!("a bug in splatref, please report it: {text}"))
}

/// Panics inside a call, or works until it is stopped: for the tests of the package.
#[pyfunction]
pub(crate) fn fail(py: Python<'_>, how: How, forever: bool) -> PyResult<()> {
    call(py, &how, |exec, show| {
        for round in 0_u64.. {
            if !forever {
                panic!("this is a test");
            }
            show("waiting", round, 0);
            exec.ordered((0..8).collect(), |_: u32| thread::sleep(Duration::from_millis(5)));
        }
        Ok(())
    })
}

/// Checks that the process may hold so many bytes more.
#[pyfunction]
pub(crate) fn ask(bytes: u64, what: String) -> PyResult<()> {
    splatref::memory::ask(bytes, || what).map_err(raised)
}
