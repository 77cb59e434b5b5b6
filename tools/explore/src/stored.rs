//! A page that holds its answers itself, in one file.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use merlkit::files::{Overwrite, write_new};
use merlkit::material::Origin;
use merlkit::{Error, SamplerSpec};
use serde_json::json;
use sha2::{Digest, Sha256};

use crate::materials::describe_session;
use crate::page::{INDEX, SCRIPT, STYLE};
use crate::refusal::Refusal;
use crate::registry::Registered;
use crate::session::Session;

/// The angles of `wo` that a page holds, in degrees.
const THETAS: [u32; 7] = [0, 15, 30, 45, 60, 75, 85];
/// The bounds of trials that its discs are built with.
const N_MAX: [f64; 3] = [1.5, 2.0, 4.0];
/// The angles φh and φd of its slices of anisotropic materials, in degrees.
const SLICES: [u32; 4] = [0, 45, 90, 135];
/// The samplers whose draws it holds.
const SAMPLERS: [&str; 4] = ["cosine", "half-vector", "adaptive-disc", "lobe:ggx"];
/// Draws of each.
const COUNT: usize = 1024;
/// Their seed.
const SEED: u64 = 1;
/// Rows and columns of a lobe.
const LOBE: [usize; 2] = [90, 180];
/// The environment that it holds.
const ENVIRONMENT: &str = "studio";
/// Ways of choosing directions of it.
const STRATEGIES: [&str; 3] = ["light", "brdf", "ris"];

/// The line that says how the page comes by its data, and what it is in an exported page.
const LIVE_MODE: &str = r#"<meta name="merlkit-mode" content="live">"#;
const STORED_MODE: &str = r#"<meta name="merlkit-mode" content="stored">"#;
/// The line of the style.
const STYLE_LINE: &str = r#"<link rel="stylesheet" href="explore.css">"#;
/// The line of the script.
const SCRIPT_LINE: &str = r#"<script type="module" src="explore.js"></script>"#;

/// The answers of a grid of keys, for all materials of a session.
pub struct StoredPage {
    answers: BTreeMap<String, Vec<u8>>,
}

impl StoredPage {
    /// Computes the answers.
    ///
    /// # Errors
    /// The first [`Refusal`] of a key.
    pub fn compute(session: &Session) -> Result<Self, Refusal> {
        let mut keys = Vec::new();
        let all = session.registry.all();
        for registered in &all {
            keys.extend(material_keys(registered)?);
        }
        keys.push(format!("api/v1/environment?name={ENVIRONMENT}"));
        for id in 0..session.meshes.describe().len() {
            keys.push(format!("api/v1/mesh?mesh={id}"));
        }
        let mut answers = BTreeMap::new();
        // One after another: each computes on all threads itself.
        for key in keys {
            let answer = session.answer(&key)?;
            answers.insert(key, answer.bytes.to_vec());
        }
        for registered in &all {
            add_table_words(session, registered, &mut answers)?;
        }
        let mut samplers = Vec::new();
        for spec in SamplerSpec::parse_all(&SAMPLERS)? {
            samplers.push(spec.to_string());
        }
        let stored = json!({
            "thetas": THETAS,
            "phis": [0],
            "phi_h": SLICES,
            "phi_d": SLICES,
            "n_max": N_MAX,
            "samplers": samplers,
            "count": COUNT,
            "seed": SEED,
            "lobe": { "rows": LOBE[0], "columns": LOBE[1] },
        });
        let catalogue = describe_session(session, stored)?;
        answers.insert(
            "api/v1/materials".into(),
            catalogue.to_string().into_bytes(),
        );
        Ok(Self { answers })
    }

    /// The keys that it holds, in order.
    pub fn keys(&self) -> Vec<&str> {
        self.answers.keys().map(String::as_str).collect()
    }

    /// The page as HTML: the style, the script and the data in one text, which names no address outside.
    ///
    /// # Errors
    /// A [`Refusal`] of status 500 if the page that is built in lacks a line that is to be replaced.
    pub fn html(&self) -> Result<String, Refusal> {
        let mut data = BTreeMap::new();
        for (key, bytes) in &self.answers {
            data.insert(key.as_str(), STANDARD.encode(compress(bytes)?));
        }
        let data = serde_json::to_string(&data)
            .map_err(|e| Refusal::new(500, format!("the answers are no JSON: {e}")))?;
        // A script ends at the first "</script", a style at "</style".
        let script = SCRIPT.replace("</script", "<\\/script");
        let style = STYLE.replace("</style", "<\\/style");
        let policy = format!(
            "default-src 'none'; script-src '{}'; style-src '{}'; img-src blob: data:; base-uri 'none'; form-action 'none'",
            hash_source(&script),
            hash_source(&style)
        );
        let mode = format!(
            "<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n{STORED_MODE}"
        );
        let scripts = format!(
            "<script type=\"application/json\" id=\"data\" data-encoding=\"gzip\">{data}</script>\n\
             <script type=\"module\">{script}</script>"
        );
        let html = replace_line(INDEX, LIVE_MODE, &mode)?;
        let html = replace_line(&html, STYLE_LINE, &format!("<style>{style}</style>"))?;
        replace_line(&html, SCRIPT_LINE, &scripts)
    }

    /// Writes [`Self::html`]; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`write_new`].
    pub fn write(&self, path: &Path, overwrite: Overwrite) -> merlkit::Result<u64> {
        let html = self
            .html()
            .map_err(|refusal| Error::argument(refusal.message, "report this"))?;
        write_new(path, overwrite, |out| {
            out.write_all(html.as_bytes())
                .map_err(|e| Error::io(path, "write", e))
        })?;
        Ok(html.len() as u64)
    }
}

/// The keys of a material that are answered as the server answers them.
fn material_keys(registered: &Registered) -> Result<Vec<String>, Refusal> {
    let id = registered.id;
    let facts = &registered.facts;
    let mut keys = Vec::new();
    if facts.is_isotropic() {
        keys.push(format!("api/v1/table?material={id}"));
    } else {
        keys.push(format!("api/v1/grid?material={id}"));
        for phi_h in SLICES {
            for phi_d in SLICES {
                keys.push(format!(
                    "api/v1/slice?material={id}&phi_h={phi_h}&phi_d={phi_d}"
                ));
            }
        }
    }
    if let Origin::Formula(text) = registered.material.origin() {
        keys.push(format!("api/v1/formula?text={}", encode(text)));
    }
    for theta in THETAS {
        let [rows, columns] = LOBE;
        keys.push(format!(
            "api/v1/lobe?material={id}&theta={theta}&phi=0&rows={rows}&columns={columns}"
        ));
        keys.push(format!("api/v1/albedo?material={id}&theta={theta}&phi=0"));
        for n_max in N_MAX {
            keys.push(format!(
                "api/v1/disc?material={id}&theta={theta}&n_max={n_max}"
            ));
        }
        for strategy in STRATEGIES {
            keys.push(format!(
                "api/v1/environment-draws?name={ENVIRONMENT}&material={id}&strategy={strategy}&theta={theta}&phi=0\
                 &keep=1024&candidates=8&seed={SEED}"
            ));
        }
        for spec in SamplerSpec::parse_all(&SAMPLERS)? {
            if spec.check_supports(facts).is_ok() {
                let sampler = encode(&spec.to_string());
                keys.push(format!(
                    "api/v1/draws?material={id}&sampler={sampler}&theta={theta}&phi=0&count={COUNT}&seed={SEED}"
                ));
            }
        }
    }
    Ok(keys)
}

/// Of a MERL table, the file that programs load at run time, up to its values: the half-vector table.
fn add_table_words(
    session: &Session,
    registered: &Registered,
    answers: &mut BTreeMap<String, Vec<u8>>,
) -> Result<(), Refusal> {
    let (_, loaded) = session.load(registered.id)?;
    let Some(measured) = loaded.table() else {
        return Ok(());
    };
    let key = format!("api/v1/runtime?material={}", registered.id);
    let answer = session.answer(&key)?;
    // Three values of four bytes a cell end the file.
    let values = 12 * measured.table().header().cells();
    let words = answer.bytes.len().saturating_sub(values);
    answers.insert(key, answer.bytes[..words].to_vec());
    Ok(())
}

/// A value of a key, as `encodeURIComponent` of JavaScript writes those that occur.
fn encode(text: &str) -> String {
    form_urlencoded::byte_serialize(text.as_bytes()).collect()
}

fn compress(bytes: &[u8]) -> Result<Vec<u8>, Refusal> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::new(7));
    encoder.write_all(bytes).map_err(cannot_compress)?;
    encoder.finish().map_err(cannot_compress)
}

fn cannot_compress(error: std::io::Error) -> Refusal {
    Refusal::new(500, format!("an answer can't be compressed: {error}"))
}

/// What a policy calls a script or a style of this text.
fn hash_source(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

/// Replaces a line that must be there once.
fn replace_line(html: &str, line: &str, replacement: &str) -> Result<String, Refusal> {
    match html.split_once(line) {
        Some((before, after)) if !after.contains(line) => {
            Ok(format!("{before}{replacement}{after}"))
        }
        _ => Err(Refusal::new(500, format!("the page lacks the line {line}"))),
    }
}
