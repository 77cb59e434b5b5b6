//! The exported page holds the answers of its keys, and nothing else is needed.

use std::collections::BTreeMap;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use merlkit::files::Overwrite;
use merlkit_explore::StoredPage;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::read::session;

/// The text between two others.
fn between<'a>(text: &'a str, before: &str, after: &str) -> &'a str {
    let rest = text.split_once(before).expect(before).1;
    rest.split_once(after).expect(after).0
}

fn unpack(text: &str) -> Vec<u8> {
    let compressed = STANDARD.decode(text).unwrap();
    let mut bytes = Vec::new();
    GzDecoder::new(&compressed[..])
        .read_to_end(&mut bytes)
        .unwrap();
    bytes
}

/// The keys that a page of nickel holds.
fn expected_keys() -> Vec<String> {
    let mut keys = vec![
        "api/v1/environment?name=studio".to_owned(),
        "api/v1/materials".to_owned(),
        "api/v1/runtime?material=0".to_owned(),
        "api/v1/table?material=0".to_owned(),
    ];
    for theta in [0, 15, 30, 45, 60, 75, 85] {
        let wo = format!("theta={theta}&phi=0");
        keys.push(format!("api/v1/albedo?material=0&{wo}"));
        keys.push(format!("api/v1/lobe?material=0&{wo}&rows=90&columns=180"));
        for n_max in ["1.5", "2", "4"] {
            keys.push(format!(
                "api/v1/disc?material=0&theta={theta}&n_max={n_max}"
            ));
        }
        for sampler in [
            "cosine",
            "half-vector%3A64KB",
            "adaptive-disc",
            "lobe%3Aggx",
        ] {
            let rest = format!("{wo}&count=1024&seed=1");
            keys.push(format!("api/v1/draws?material=0&sampler={sampler}&{rest}"));
        }
        for strategy in ["light", "brdf", "ris"] {
            let rest = format!("strategy={strategy}&{wo}&keep=1024&candidates=8&seed=1");
            keys.push(format!(
                "api/v1/environment-draws?name=studio&material=0&{rest}"
            ));
        }
    }
    keys.sort();
    keys
}

#[test]
fn an_exported_page_holds_its_keys_and_no_address() {
    let session = session(&["nickel"]);
    let page = StoredPage::compute(&session).unwrap();
    assert_eq!(page.keys(), expected_keys());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    let bytes = page.write(&path, Overwrite::Refuse).unwrap();
    assert!(page.write(&path, Overwrite::Refuse).is_err());
    let html = std::fs::read_to_string(path).unwrap();
    assert_eq!(bytes, html.len() as u64);
    assert!(bytes < 8_000_000, "{bytes}");

    assert!(html.contains(r#"<meta name="merlkit-mode" content="stored">"#));
    let before = r#"<script type="application/json" id="data" data-encoding="gzip">"#;
    let data: BTreeMap<String, String> =
        serde_json::from_str(between(&html, before, "</script>")).unwrap();
    let keys: Vec<&str> = data.keys().map(String::as_str).collect();
    assert_eq!(keys, page.keys());
    for (key, text) in &data {
        let stored = unpack(text);
        let answer = session.answer(key).unwrap();
        match key.as_str() {
            "api/v1/materials" => {
                let catalogue: Value = serde_json::from_slice(&stored).unwrap();
                assert_eq!(catalogue["stored"]["n_max"], json!([1.5, 2.0, 4.0]));
            }
            // The values are left out.
            "api/v1/runtime?material=0" => {
                assert!(answer.bytes.starts_with(&stored) && stored.len() > 50_000)
            }
            _ => assert!(answer.bytes.as_ref() == stored, "{key}"),
        }
    }

    // The policy allows the one script and the one style, and no address.
    let policy = between(&html, "Content-Security-Policy\" content=\"", "\"");
    for (before, after) in [
        ("<script type=\"module\">", "</script>"),
        ("<style>", "</style>"),
    ] {
        let digest = STANDARD.encode(Sha256::digest(between(&html, before, after)));
        assert!(policy.contains(&format!("'sha256-{digest}'")), "{policy}");
    }
    assert!(policy.starts_with("default-src 'none'") && !policy.contains("unsafe"));
    for outside in ["src=", "<link rel=\"stylesheet\"", "<iframe", "@import"] {
        assert!(
            !between(&html, "<head>", before).contains(outside),
            "{outside}"
        );
    }
}
