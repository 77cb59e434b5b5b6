//! Work that takes time: on threads that belong to this process, and while other Python threads run.
//!
//! rayon's own pool does not survive a fork: a child that waits for its threads waits forever. So the package has a pool for
//! each process, made when it is first used.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyResult, Python};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The pool and the process that it belongs to.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

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
