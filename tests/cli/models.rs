//! `merlkit models`, and models as materials.

use crate::run::{fails, json, run, succeeds};

/// What `merlkit models` lists is what a MATERIAL may be.
#[test]
fn models_are_listed_with_their_parameters() {
    let all = succeeds(run(&["models"], ""));
    for name in ["lambert", "ward", "he", "coated", "disney"] {
        assert!(all.contains(&format!("| {name} ")), "{name}: {all}");
    }
    let ashikhmin = succeeds(run(&["models", "ashikhmin"], ""));
    for word in [
        "ex, nu",
        "0 to 1000000",
        "Reciprocal: yes",
        "Albedo: ",
        "***",
    ] {
        assert!(ashikhmin.contains(word), "{word}: {ashikhmin}");
    }
    let document = json(&succeeds(run(&["models", "ward:sx=0.1", "--json"], "")));
    assert_eq!(document["kind"], "models");
    let ward = &document["results"][0];
    assert_eq!(ward["material"], "ward:sx=0.1,sy=0.7765,ks=0.05,kd=0.4");
    assert_eq!(ward["symmetry"], "quarter");
    let text = ward["material"].as_str().unwrap();
    let value = succeeds(run(&["eval", text, "--wo", "30,0", "--wi", "30,180"], ""));
    assert!(!value.is_empty());
}

#[test]
fn mistakes_are_answered_with_names_and_domains() {
    for (text, words) in [
        ("wrad", "ward"),
        ("ward:sz=1", "sx, sy, ks, kd"),
        ("ward:sx=-1", "0.001 to 10"),
        ("ward:sx=nan", "0.001 to 10"),
    ] {
        let message = fails(run(&["models", text], ""));
        assert!(message.contains(words), "{text}: {message}");
    }
    assert!(fails(run(&["info", "wrad"], "")).contains("ward"));
}

#[test]
fn albedos_above_one_are_said_once() {
    let pair = ["--wo", "30,0", "--wi", "30,180"];
    let loud = ["eval", "phong:form=printed"];
    let output = run(&[&loud[..], &pair].concat(), "");
    let notes = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        notes.matches("more light than it receives").count(),
        1,
        "{notes}"
    );
    let quiet = run(&[&["eval", "phong"][..], &pair].concat(), "");
    assert!(quiet.stderr.is_empty());
}
