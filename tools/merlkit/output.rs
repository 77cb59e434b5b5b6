//! Where results go: standard output or a file; messages go to standard error.

use std::convert::Infallible;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::PathBuf;
use std::str::FromStr;

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable, write_new};

use merlkit_evaluate::measure::LARGEST_ALBEDO_ERROR;

use crate::failure::Failure;
use crate::progress::print_above;

/// `-` for standard output, or a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// Standard output.
    Stdout,
    /// A file, replaced only with `--force`.
    File(PathBuf),
}

impl FromStr for Destination {
    type Err = Infallible;

    fn from_str(argument: &str) -> Result<Self, Infallible> {
        Ok(if argument == "-" {
            Self::Stdout
        } else {
            Self::File(argument.into())
        })
    }
}

impl Destination {
    /// Refuses an existing file before the work begins.
    pub fn check(&self, overwrite: Overwrite) -> Result<(), Error> {
        match self {
            Self::Stdout => Ok(()),
            Self::File(path) => check_writable(path, overwrite),
        }
    }

    /// Writes all of the output through `fill`.
    pub fn write(
        &self,
        overwrite: Overwrite,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        match self {
            Self::Stdout => stdout(fill),
            Self::File(path) => {
                write_new(path, overwrite, |out| {
                    fill(out).map_err(|e| Error::io(path, "write", e))
                })?;
                Ok(())
            }
        }
    }
}

/// Refuses to write JSON and CSV to the same place.
pub fn refuse_same(json: Option<&Destination>, csv: Option<&Destination>) -> Result<(), Error> {
    if json.is_some() && json == csv {
        return Err(Error::argument(
            "--json and --csv name the same output",
            "name two files, or omit one of the options",
        ));
    }
    Ok(())
}

/// Writes to standard output through a buffer; the only way a command prints.
pub fn stdout(fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let printed = if io::stdout().is_terminal() {
        print_above(|| write_stdout(fill))
    } else {
        write_stdout(fill)
    };
    printed.map_err(Failure::stdout)
}

fn write_stdout(fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    fill(&mut out)?;
    out.flush()
}

/// Writes a line to standard error; there is nobody to tell if that fails.
pub fn message(line: &str) {
    print_above(|| {
        let _ = writeln!(io::stderr().lock(), "{line}");
    });
}

/// Whether an albedo error, as a fraction, leaves `what` fit to be written; if not, says why it is not.
pub fn is_acceptable(albedo_error: f64, what: &str) -> bool {
    // A NaN is no error to accept.
    if albedo_error <= LARGEST_ALBEDO_ERROR {
        return true;
    }
    message(&format!(
        "merlkit: {what} is not written: its albedo is off by {:.0} %, more than the limit of {:.0} %; choose another lookup \
         rule, more values or another file, or write it anyway with --accept-error",
        100.0 * albedo_error,
        100.0 * LARGEST_ALBEDO_ERROR
    ));
    false
}

/// Prints on standard error what to know before trusting a material or its figures, a line a note.
pub fn print_notes(material: &str, notes: &[String]) {
    for note in notes {
        message(&format!("merlkit: note: {material}: {note}"));
    }
}

/// What `--force` means.
pub fn overwrite(force: bool) -> Overwrite {
    if force {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    }
}
