//! Work that takes time: on threads that belong to this process, and while other Python threads run.
//!
//! rayon's own pool does not survive a fork: a child that waits for its threads waits forever. So the package has a pool for
//! each process, made when it is first used.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyErr, PyResult, Python};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The pool and the process that it belongs to.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// How often a call that waits for its work looks for Ctrl-C.
const LISTEN: Duration = Duration::from_millis(50);

/// Runs `work` on the package's threads, and looks for signals meanwhile. After Ctrl-C the call ends at once with
/// `KeyboardInterrupt`. `work` is given a flag that is set then: it may end early, and otherwise runs to its end by itself; its
/// result is dropped.
///
/// # Errors
/// `KeyboardInterrupt`, or what else a signal's handler raises; `RuntimeError` if the system gives no threads.
pub fn on_threads_until_interrupt<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> R + Send + 'static,
) -> PyResult<R> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut receiver) = channel();
    let flag = stop.clone();
    pool()?.spawn(move || {
        // Nobody may be left to hear of it.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&flag))));
    });
    loop {
        let (heard, kept) = listen(py, receiver);
        receiver = kept;
        if let Some(result) = heard {
            return Ok(result);
        }
        if let Err(interrupt) = py.check_signals() {
            stop.store(true, Ordering::Relaxed);
            abandon_pool();
            return Err(interrupt);
        }
    }
}

/// Runs `work`, which calls Python, on one thread, and looks for signals meanwhile. After Ctrl-C, `give_up` is called with the exception,
/// after which the work must come to its end soon.
///
/// # Errors
/// `RuntimeError` if the system gives no thread.
pub fn on_one_thread_until_interrupt<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> R + Send + 'static,
    give_up: impl Fn(PyErr),
) -> PyResult<R> {
    let pool = ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let (sender, mut receiver) = channel();
    let worker = thread::spawn(move || {
        let work = AssertUnwindSafe(|| pool.install(work));
        let _ = sender.send(catch_unwind(work));
    });
    loop {
        let (heard, kept) = listen(py, receiver);
        receiver = kept;
        if let Some(result) = heard {
            // It has nothing left to do but to end its pool.
            py.detach(|| worker.join().ok());
            return Ok(result);
        }
        if let Err(interrupt) = py.check_signals() {
            give_up(interrupt);
        }
    }
}

/// Waits a moment for a result, while other Python threads run. A panic goes on here.
fn listen<R: Send>(
    py: Python<'_>,
    receiver: Receiver<thread::Result<R>>,
) -> (Option<R>, Receiver<thread::Result<R>>) {
    // The receiver goes along, because two threads can't have one.
    let (heard, receiver) = py.detach(move || (receiver.recv_timeout(LISTEN), receiver));
    match heard {
        Ok(Ok(result)) => (Some(result), receiver),
        Ok(Err(panic)) => resume_unwind(panic),
        Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => (None, receiver),
    }
}

/// Runs `work` on the package's threads, of which `RAYON_NUM_THREADS` sets the number.
///
/// # Errors
/// `RuntimeError` if the system gives no threads.
pub fn on_threads<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    py.detach(|| Ok(pool()?.install(work)))
}

/// Runs `work` on one thread, for what calls Python: two threads would only wait for each other.
///
/// # Errors
/// `RuntimeError` if the system gives no thread.
pub fn on_one_thread<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    py.detach(|| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        Ok(pool.install(work))
    })
}

/// Lets the next call have threads of its own, because those of the pool are busy with work that nobody waits for. They end with it.
fn abandon_pool() {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    // Those of a parent process can't be joined here.
    if let Some((owner, pool)) = held.take()
        && owner != std::process::id()
    {
        std::mem::forget(pool);
    }
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*held
        && *owner == process
    {
        return Ok(pool.clone());
    }
    let built = ThreadPoolBuilder::new()
        .build()
        .map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let pool = Arc::new(built);
    // The threads of a parent process can't be joined here, so its pool is left as it is.
    std::mem::forget(held.replace((process, pool.clone())));
    Ok(pool)
}
