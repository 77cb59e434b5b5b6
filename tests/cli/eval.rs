//! `eval`.

use crate::run::{fails, run, succeeds};

pub const HEADING: &str = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n";

#[test]
fn eval_reads_lines_with_or_without_a_heading() {
    let lines = "0.6,0,0.8,-0.6,0,0.8\n\n 0 , 0 , 1 , 0.6,0,0.8\r\n0,0,1,0,0,-1";
    let bare = succeeds(run(&["eval", "nickel"], lines));
    assert_eq!(
        bare,
        succeeds(run(
            &["eval", "nickel", "--lookup", "floor"],
            &format!("\n{HEADING}{lines}\n")
        ))
    );
    let rows: Vec<_> = bare.lines().collect();
    assert_eq!(rows.len(), 4);
    assert_eq!((rows[0], rows[3]), ("f_r,f_g,f_b", "0.0,0.0,0.0"));
    for row in &rows[1..3] {
        let values: Vec<f32> = row.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(
            values.len() == 3 && values.iter().all(|v| *v > 0.0),
            "{row}"
        );
    }
    assert_ne!(
        bare,
        succeeds(run(&["eval", "nickel", "--lookup", "centred"], lines))
    );
    assert_eq!(succeeds(run(&["eval", "nickel"], "")), "f_r,f_g,f_b\n");
}

#[test]
fn eval_in_degrees_equals_eval_in_vectors() {
    let (s, c) = 30f64.to_radians().sin_cos();
    for (line, wi) in [
        (format!("{s},0,{c},0,{c},{s}"), "60,90"),
        (format!("{s},0,{c},0,-{c},{s}"), "60,-90"),
        // The mirror direction, exactly: θh is 0 and not merely small.
        (format!("{s},0,{c},-{s},0,{c}"), "30,180"),
        (format!("{s},0,{c},{s},0,{c}"), "30,720"),
        (format!("{s},0,{c},1,0,0"), "90,0"),
        (format!("{s},0,{c},0,0,-1"), "180,0"),
    ] {
        let by_vectors = succeeds(run(&["eval", "teflon"], &line));
        assert_eq!(
            by_vectors,
            succeeds(run(&["eval", "teflon", "--wo", "30,0", "--wi", wi], "")),
            "{wi}"
        );
    }
    for angles in ["40", "40,0,0", "x,0", "181,0", "-1,0", "nan,0"] {
        fails(run(
            &[
                "eval",
                "teflon",
                &format!("--wo={angles}"),
                "--wi",
                "40,180",
            ],
            "",
        ));
    }
    fails(run(&["eval", "teflon", "--wo", "40,0"], ""));
}

#[test]
fn eval_names_the_line_it_cannot_read() {
    let good = "0,0,1,0,0,1\n";
    for (line, expected) in [
        (
            "0,0,1,0,0",
            "line 4: expected 6 numbers wo_x,wo_y,wo_z,wi_x,wi_y,wi_z, found \"0,0,1,0,0\"",
        ),
        ("0,0,one,0,0,1", "line 4: expected a number, found \"one\""),
        (
            "0,0,2,0,0,1",
            "line 4: expected wo of length 1 within 0.001, found \"length 2\"",
        ),
        ("0,0,1,0,0,0", "line 4: expected wi of length 1"),
        ("0,0,1,0,nan,1", "line 4: expected wi of length 1"),
        ("0,0,1,0,0,inf", "line 4: expected wi of length 1"),
        (HEADING.trim(), "line 4: expected a number, found \"wo_x\""),
    ] {
        let output = run(
            &["eval", "nickel"],
            &format!("{good}\n{good}{line}\n{good}"),
        );
        assert_eq!(
            String::from_utf8_lossy(&output.stdout).lines().count(),
            3,
            "the lines before it are answered"
        );
        let text = fails(output);
        assert!(
            text.starts_with("merlkit: standard input, ") && text.contains(expected),
            "{text}"
        );
    }
    // The other order of directions is not taken for a heading.
    assert!(fails(run(&["eval", "nickel"], "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n")).contains("line 1"));
}

#[test]
fn a_line_without_end_is_refused_while_it_arrives() {
    let text = fails(run(&["eval", "nickel"], &"1".repeat(1 << 20)));
    assert!(
        text.contains("line 1") && text.contains("without a line break"),
        "{text}"
    );
    // Not text, empty fields, too many fields, numbers that are none.
    for line in [
        "\0\0\0",
        ",,,,,",
        "0,0,1,0,0,1,",
        "nan,0,1,0,0,1",
        "inf,0,1,0,0,1",
        "1e999,0,0,0,0,1",
        "0x0,0,1,0,0,1",
    ] {
        let text = fails(run(&["eval", "nickel"], line));
        assert!(text.contains("line 1"), "{line}: {text}");
    }
}
