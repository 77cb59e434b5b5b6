//! The same bench of another build, in a process of its own, which times a round whenever it is asked to.
//!
//! It is started with `--follow`. For each group it writes a line of JSON with the group's name and its contenders. Then it
//! answers every line `round` with the nanoseconds of its contenders, until a line `next`.

use std::io::{BufRead, BufReader, Error, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::{Value, json};

/// The other build, as the one that asks sees it.
pub struct OtherBuild {
    child: Child,
    requests: ChildStdin,
    replies: BufReader<ChildStdout>,
}

impl OtherBuild {
    /// Starts it with the same words.
    pub fn start(binary: &Path, words: &[String]) -> std::io::Result<Self> {
        let mut child = Command::new(binary)
            .arg("--follow")
            .args(words)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (requests, replies) = match (child.stdin.take(), child.stdout.take()) {
            (Some(requests), Some(replies)) => (requests, BufReader::new(replies)),
            _ => return Err(Error::other("no pipes")),
        };
        Ok(Self {
            child,
            requests,
            replies,
        })
    }

    /// Waits until it is ready for a group. Both must have the same contenders.
    pub fn enter(&mut self, group: &str, names: &[&str]) {
        let expected = json!({"group": group, "names": names});
        let found = self.read();
        assert_eq!(
            found, expected,
            "the other build times other calls: build it with the benches of this one"
        );
    }

    /// Nanoseconds a call of each contender in one round.
    pub fn time_round(&mut self) -> Vec<f64> {
        self.write("round");
        serde_json::from_value(self.read()).expect("nanoseconds of the other build")
    }

    /// Sends it to its next group.
    pub fn leave(&mut self) {
        self.write("next");
    }

    fn write(&mut self, line: &str) {
        writeln!(self.requests, "{line}").expect("the other build to listen");
    }

    fn read(&mut self) -> Value {
        let mut line = String::new();
        self.replies.read_line(&mut line).expect("a line");
        serde_json::from_str(&line).expect("an answer of the other build")
    }
}

impl Drop for OtherBuild {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The other build's side: times a round for every request, until it is sent to the next group.
pub fn answer_rounds(group: &str, names: &[&str], mut time_round: impl FnMut(u64) -> Vec<f64>) {
    println!("{}", json!({"group": group, "names": names}));
    for (round, line) in std::io::stdin().lines().enumerate() {
        if line.expect("a line") == "next" {
            return;
        }
        println!("{}", json!(time_round(round as u64)));
    }
    // The one that asks has gone away.
    std::process::exit(0);
}
