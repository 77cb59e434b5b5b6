//! The machine that times are measured on, and the day.

use std::env::consts::{ARCH, OS};
use std::time::{SystemTime, UNIX_EPOCH};

use merlkit_evaluate::report::Machine;

/// This machine.
pub fn detect() -> Machine {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Machine {
        processor: processor().unwrap_or_else(|| ARCH.to_owned()),
        cores,
        system: format!("{ARCH} {OS}"),
    }
}

/// Name of the processor, where the system has it in a file.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    find_processor(&text)
}

/// The name of the first processor in Linux's list; x86 calls it "model name", other architectures "Model" or "cpu".
fn find_processor(list: &str) -> Option<String> {
    for key in ["model name", "Model", "cpu"] {
        for line in list.lines() {
            if let Some((name, value)) = line.split_once(':')
                && name.trim() == key
                && !value.trim().is_empty()
            {
                return Some(value.trim().to_owned());
            }
        }
    }
    None
}

/// Today in UTC, as 2026-11-30.
pub fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    write_day(since.map_or(0, |s| s.as_secs() / SECONDS_A_DAY))
}

const SECONDS_A_DAY: u64 = 86_400;

/// A day that is so many days after 1970-01-01, in the Gregorian calendar.
fn write_day(days: u64) -> String {
    let (mut year, mut rest) = (1970, days);
    // Whole years, then whole months of the year that is left.
    while rest >= days_of_year(year) {
        rest -= days_of_year(year);
        year += 1;
    }
    let mut month = 0;
    while rest >= days_of_month(year, month) {
        rest -= days_of_month(year, month);
        month += 1;
    }
    format!("{year:04}-{:02}-{:02}", month + 1, rest + 1)
}

fn is_leap(year: u64) -> bool {
    year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
}

fn days_of_year(year: u64) -> u64 {
    if is_leap(year) { 366 } else { 365 }
}

/// Days of a month; January is 0.
fn days_of_month(year: u64, month: u64) -> u64 {
    match month {
        1 if is_leap(year) => 29,
        1 => 28,
        3 | 5 | 8 | 10 => 30,
        _ => 31,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_the_calendars_names() {
        for (days, name) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
            (20_453, "2025-12-31"),
            (20_454, "2026-01-01"),
            (47_540, "2100-02-28"),
            (47_541, "2100-03-01"),
        ] {
            assert_eq!(write_day(days), name);
        }
    }

    #[test]
    fn processors_are_named_on_several_architectures() {
        let x86 = "processor\t: 0\nmodel\t\t: 1\nmodel name\t: AMD EPYC 7B13\n";
        assert_eq!(find_processor(x86).as_deref(), Some("AMD EPYC 7B13"));
        let arm = "processor : 0\n\nModel : Raspberry Pi 5\n";
        assert_eq!(find_processor(arm).as_deref(), Some("Raspberry Pi 5"));
        assert_eq!(find_processor("nothing"), None);
    }
}
