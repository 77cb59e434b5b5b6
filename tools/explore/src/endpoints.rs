//! All keys: their paths, their parameters in the order of an exported page, and what answers them.

use crate::answer::Answer;
use crate::disc::disc;
use crate::draws::draws;
use crate::environment::{environment, environment_draws};
use crate::fit::fit;
use crate::grid::{grid, slice};
use crate::materials::{formula, materials, upload};
use crate::meshes::mesh;
use crate::query::{Query, shorten};
use crate::refusal::Refusal;
use crate::session::Session;
use crate::table::{runtime, table};
use crate::values::{albedo, lobe};

/// Longer keys are refused.
const LONGEST_KEY: usize = 4096;

/// A kind of key.
struct Endpoint {
    path: &'static str,
    parameters: &'static [&'static str],
    /// Whether the same key has the same answer for ever.
    is_fixed: bool,
    answer: fn(&Session, &Query) -> Result<Answer, Refusal>,
}

const ENDPOINTS: [Endpoint; 14] = [
    Endpoint {
        path: "api/v1/materials",
        parameters: &[],
        is_fixed: false,
        answer: materials,
    },
    Endpoint {
        path: "api/v1/formula",
        parameters: &["text"],
        is_fixed: false,
        answer: formula,
    },
    Endpoint {
        path: "api/v1/mesh",
        parameters: &["mesh"],
        // Its bytes are kept with the mesh.
        is_fixed: false,
        answer: mesh,
    },
    fixed("api/v1/table", &["material"], table),
    fixed("api/v1/runtime", &["material"], runtime),
    fixed("api/v1/grid", &["material"], grid),
    fixed("api/v1/slice", &["material", "phi_h", "phi_d"], slice),
    fixed(
        "api/v1/lobe",
        &["material", "theta", "phi", "rows", "columns"],
        lobe,
    ),
    fixed("api/v1/albedo", &["material", "theta", "phi"], albedo),
    fixed(
        "api/v1/draws",
        &["material", "sampler", "theta", "phi", "count", "seed"],
        draws,
    ),
    fixed("api/v1/disc", &["material", "theta", "n_max"], disc),
    fixed("api/v1/environment", &["name"], environment),
    fixed(
        "api/v1/environment-draws",
        &[
            "name",
            "material",
            "strategy",
            "theta",
            "phi",
            "keep",
            "candidates",
            "seed",
        ],
        environment_draws,
    ),
    fixed("api/v1/fit", &["material", "model"], fit),
];

/// An endpoint whose answers can be kept.
const fn fixed(
    path: &'static str,
    parameters: &'static [&'static str],
    answer: fn(&Session, &Query) -> Result<Answer, Refusal>,
) -> Endpoint {
    Endpoint {
        path,
        parameters,
        is_fixed: true,
        answer,
    }
}

impl Session {
    /// The answer of a key such as `api/v1/table?material=0`.
    ///
    /// # Errors
    /// A [`Refusal`] for an unknown path (404), and for parameters that are missing, unknown, given twice or outside their domains (400).
    pub fn answer(&self, key: &str) -> Result<Answer, Refusal> {
        if key.len() > LONGEST_KEY {
            let message = format!(
                "the key has {} bytes; give at most {LONGEST_KEY}",
                key.len()
            );
            return Err(Refusal::bad(message));
        }
        let (path, query) = key.split_once('?').unwrap_or((key, ""));
        let Some(endpoint) = ENDPOINTS.iter().find(|e| e.path == path) else {
            let message = format!("there is nothing at \"{}\"", shorten(path));
            return Err(Refusal::missing(message));
        };
        let query = Query::parse(query, endpoint.parameters)?;
        if !endpoint.is_fixed {
            return (endpoint.answer)(self, &query);
        }
        self.answers
            .get_or_insert_with(key, || (endpoint.answer)(self, &query))
    }

    /// Computes the table that the page asks for first, if the first material is one.
    pub(crate) fn prepare_first_view(&self) {
        let first = self.registry.find(0);
        if first.is_ok_and(|first| first.facts.has_table) {
            // A refusal is computed again when the page asks.
            let _ = self.answer("api/v1/table?material=0");
        }
    }

    /// The answer of a file that is sent: `bytes` of a MERL binary or a `.bsdf` file, with the query `name=FILE`.
    ///
    /// # Errors
    /// A [`Refusal`] for what is no such file.
    pub fn answer_upload(&self, query: &str, bytes: &[u8]) -> Result<Answer, Refusal> {
        upload(self, &Query::parse(query, &["name"])?, bytes)
    }
}
