//! Fits that `merlkit fit` stored as JSON: the file is the material of its best model.

use std::path::Path;

use super::analytic::{Formulas, canonical_text};
use super::format::{MaterialFormat, Origin, TableReading};
use super::{Loaded, MaterialFacts};
use crate::files::RegularFile;
use crate::{Error, Result};

/// JSON documents of the kind "fit", about one material.
pub(super) struct StoredFits;

/// Larger files are no fit of one material.
const LARGEST_FILE: u64 = 16_000_000;

/// The bytes in front of which a document says its kind.
const HEAD: usize = 256;

impl MaterialFormat for StoredFits {
    fn recognises(&self, origin: &Origin) -> bool {
        match origin {
            Origin::File(path) => begins_as_fit(path),
            _ => false,
        }
    }

    fn facts(&self, origin: &Origin) -> Result<MaterialFacts> {
        Formulas.facts(&read_formula(origin.path())?)
    }

    fn load(&self, origin: &Origin, reading: TableReading) -> Result<Loaded> {
        let loaded = Formulas.load(&read_formula(origin.path())?, reading)?;
        Ok(loaded.with_reading("values of a fitted formula"))
    }
}

/// The formula of an origin that is one, or names a stored fit.
///
/// # Errors
/// Those of a stored fit that does not read.
pub(super) fn formula_text(origin: &Origin) -> Result<Option<String>> {
    match origin {
        Origin::Formula(text) => Ok(Some(text.clone())),
        Origin::File(path) if begins_as_fit(path) => match read_formula(path)? {
            Origin::Formula(text) => Ok(Some(text)),
            _ => Ok(None),
        },
        _ => Ok(None),
    }
}

/// Whether a file is JSON that names the kind "fit" near its beginning.
fn begins_as_fit(path: &Path) -> bool {
    let Ok(mut file) = RegularFile::open(path) else {
        return false;
    };
    let length = usize::try_from(file.len()).unwrap_or(usize::MAX);
    let mut head = vec![0; length.min(HEAD)];
    if file.read_at(0, &mut head).is_err() {
        return false;
    }
    let text = String::from_utf8_lossy(&head);
    text.trim_start().starts_with('{') && text.contains("\"kind\": \"fit\"")
}

/// The formula of the least error in a document of one material.
///
/// # Errors
/// [`Error::Unsupported`] for a document that is cut off or bent, or is about several materials; [`Error::Argument`] for a formula
/// that does not read.
fn read_formula(path: &Path) -> Result<Origin> {
    let bytes = RegularFile::open(path)?.read_all(LARGEST_FILE)?;
    let document: serde_json::Value = serde_json::from_slice(&bytes)
        .map_err(|e| unreadable(path, &format!("JSON that does not read: {e}")))?;
    let materials = document["results"]["materials"].as_array();
    let Some([material]) = materials.map(Vec::as_slice) else {
        return Err(unreadable(path, "a fit of no or of several materials"));
    };
    let mut best: Option<(f64, &str)> = None;
    for fit in material["fits"].as_array().into_iter().flatten() {
        if let (Some(error), Some(text)) = (fit["error"].as_f64(), fit["material"].as_str())
            && best.is_none_or(|best| error < best.0)
        {
            best = Some((error, text));
        }
    }
    let formula = best.and_then(|best| canonical_text(best.1).transpose());
    match formula {
        Some(text) => Ok(Origin::Formula(text?)),
        None => Err(unreadable(path, "a fit without a formula")),
    }
}

fn unreadable(path: &Path, what: &str) -> Error {
    Error::Unsupported {
        path: path.to_owned(),
        what: what.to_owned(),
        fix: "write it again with `merlkit fit MATERIAL --format json -o FILE`".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{LookupRule, Material};
    use glam::Vec3;

    fn resolve(text: &str) -> Result<Loaded> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        std::fs::write(&path, text).unwrap();
        Material::resolve(path.to_str().unwrap())?.load(LookupRule::Floor)
    }

    #[test]
    fn a_stored_fit_is_its_best_formula() {
        let fits = r#"[{"error": 0.2, "material": "lambert:reflectance=1"},
                       {"error": 0.1, "material": "lambert:reflectance=0.5+ward:sx=0.1,sy=0.1"}]"#;
        let text = |materials: &str| {
            format!(
                "{{\"schema\": 3, \"kind\": \"fit\", \"results\": {{\"materials\": [{materials}]}}}}"
            )
        };
        let one = format!("{{\"fits\": {fits}}}");
        let value = |loaded: Loaded| loaded.brdf().eval(Vec3::Z, Vec3::Z);
        let direct = Material::resolve("lambert:reflectance=0.5+ward:sx=0.1,sy=0.1").unwrap();
        let direct = direct.load(LookupRule::Floor).unwrap();
        assert_eq!(value(resolve(&text(&one)).unwrap()), value(direct));
        for (bent, what) in [
            (text(&format!("{one},{one}")), "several"),
            (text(""), "several"),
            (text("{\"fits\": []}"), "without a formula"),
            (text(&one.replace("ward", "wrad")), "ward"),
            (text(&one.replace("sx=0.1", "sx=nan")), "0.001 to 10"),
            (text(&one)[..120].to_owned(), "does not read"),
        ] {
            let message = resolve(&bent).err().unwrap().to_string();
            assert!(message.contains(what), "{bent}: {message}");
        }
    }
}
