//! Where results come from: what a reader needs to repeat them or to cite them.

use serde::Serialize;

/// The program, its command line, what it read, and for measured times the machine and the day.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// Version of merlkit.
    pub version: String,
    /// The command line as a shell takes it, without the options that say where files go.
    pub command: String,
    /// Seed of the random numbers, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// The materials, each once.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialChecksum>,
    /// Day on which the results were written (UTC), where times were measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// What the times were measured on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
}

/// A material and what tells its data from others'.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MaterialChecksum {
    /// Its name.
    pub material: String,
    /// SHA-256 of its data in hexadecimal.
    pub sha256: String,
}

/// A machine on which times were measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Name of the processor, or its architecture where the system does not say it.
    pub processor: String,
    /// Processors that the program may use at the same time.
    pub cores: usize,
    /// Architecture and operating system.
    pub system: String,
}

impl Machine {
    /// "AMD EPYC 7B13, 2 cores, x86_64 linux".
    pub fn sentence(&self) -> String {
        let plural = if self.cores == 1 { "" } else { "s" };
        format!(
            "{}, {} core{plural}, {}",
            self.processor, self.cores, self.system
        )
    }
}

impl Provenance {
    /// Lines of text for the headers of files that have no fields.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            format!("merlkit {}", self.version),
            format!("command: {}", self.command),
        ];
        for one in &self.materials {
            lines.push(format!(
                "material: {}, SHA-256 {}",
                one.material, one.sha256
            ));
        }
        lines.extend(self.date.iter().map(|date| format!("date: {date}")));
        let machine = self.machine.as_ref().map(Machine::sentence);
        lines.extend(machine.map(|machine| format!("machine: {machine}")));
        lines
    }
}
