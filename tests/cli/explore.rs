//! `merlkit explore` from its start to Ctrl-C, and its exported page.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Command, Stdio};

use crate::run::{fails, run_in, succeeds};

#[test]
fn the_server_answers_and_ctrl_c_ends_it() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_merlkit"))
        .args(["explore", "lambert:reflectance=0.5", "--no-open"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut address = String::new();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    stdout.read_line(&mut address).unwrap();
    let (page, token) = address.trim().split_once("/#token=").unwrap();
    let host = page.strip_prefix("http://").unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let request = format!(
        "GET /api/v1/materials HTTP/1.1\r\nHost: {host}\r\nX-Merlkit-Token: {token}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut response = String::new();
    stream.read_to_string(&mut response).unwrap();
    assert!(response.starts_with("HTTP/1.1 200"), "{response}");
    assert!(
        response.contains("\"lambert:reflectance=0.5\""),
        "{response}"
    );

    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    let ended = child.wait_with_output().unwrap();
    let messages = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(0), "{messages}");
    assert!(!messages.contains("interrupted"), "{messages}");
}

#[test]
fn a_page_is_exported_once() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["explore", "ward:sx=0.2,sy=0.4", "--export", "page.html"];
    let written = succeeds(run_in(folder.path(), &arguments, ""));
    assert!(written.starts_with("wrote page.html: "), "{written}");
    let html = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(html.contains(r#"content="stored""#));
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("--force"));
}
