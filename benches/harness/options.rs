//! The command line of a bench.

use std::path::PathBuf;

/// What was asked for.
#[derive(Default)]
pub struct Options {
    /// Lines that contain one of these are timed; all if there is none.
    pub words: Vec<String>,
    /// Rounds of every group, if given.
    pub rounds: Option<u64>,
    /// The same bench of another build.
    pub against: Option<PathBuf>,
    /// Whether another build asks for each round on standard input.
    pub follows: bool,
    json: Option<PathBuf>,
}

impl Options {
    /// Those of the command line. Exits with status 2 where one lacks its value.
    pub fn from_command_line() -> Self {
        let mut options = Self::default();
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                // Cargo says so to every bench.
                "--bench" => {}
                "--follow" => options.follows = true,
                "--json" => options.json = Some(required(arguments.next(), "--json FILE").into()),
                "--against" => {
                    options.against = Some(required(arguments.next(), "--against BINARY").into());
                }
                "--rounds" => {
                    let number = arguments.next().and_then(|n| n.parse().ok());
                    options.rounds = Some(required(number.filter(|n| *n > 0), "--rounds N"));
                }
                word if word.starts_with('-') => {
                    required::<()>(
                        None,
                        "[WORD…] [--rounds N] [--json FILE] [--against BINARY]",
                    );
                }
                word => options.words.push(word.to_owned()),
            }
        }
        options
    }

    /// Whether a contender of a group is to be timed.
    pub fn chooses(&self, group: &str, name: &str) -> bool {
        let line = format!("{group}/{name}");
        self.words.is_empty() || self.words.iter().any(|word| line.contains(word.as_str()))
    }

    /// Where the result of a bench is written, if anywhere.
    pub fn json_path(&self, bench: &str) -> Option<PathBuf> {
        let folder = std::env::var_os("MERLKIT_BENCH_JSON").map(PathBuf::from);
        let in_folder = folder.map(|folder| folder.join(format!("{bench}.json")));
        self.json.clone().or(in_folder)
    }
}

/// The value, or the usage and exit status 2.
fn required<T>(value: Option<T>, usage: &str) -> T {
    value.unwrap_or_else(|| {
        eprintln!("usage: cargo bench --bench NAME -- {usage}");
        std::process::exit(2);
    })
}
