//! Requests that memory can't hold are refused before the system is asked, which might grant them and end the process later.

use pyo3::PyResult;
use pyo3::exceptions::PyMemoryError;

/// Requests below this are left to the system.
const LEAST_CHECKED: u128 = 256 << 20;

/// Refuses arrays of `rows` rows of `bytes` bytes each if they don't fit the memory that is available.
///
/// # Errors
/// `MemoryError` with both numbers.
pub fn require(rows: usize, bytes: usize) -> PyResult<()> {
    let needed = rows as u128 * bytes as u128;
    if needed < LEAST_CHECKED {
        return Ok(());
    }
    match available() {
        Some(available) if needed > available => Err(PyMemoryError::new_err(format!(
            "{rows} rows need {:.1} GB of memory, and {:.1} GB are available; pass fewer rows at a time",
            needed as f64 * 1e-9,
            available as f64 * 1e-9
        ))),
        _ => Ok(()),
    }
}

/// Bytes that can be allocated without swapping, as Linux estimates it; `None` elsewhere.
fn available() -> Option<u128> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    for line in text.lines() {
        if let Some(kilobytes) = line.strip_prefix("MemAvailable:") {
            let number = kilobytes.trim().trim_end_matches("kB").trim();
            return Some(number.parse::<u128>().ok()? * 1024);
        }
    }
    None
}
