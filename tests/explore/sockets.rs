//! A server on a real port: who is answered, who is not, and how it ends.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use merlkit_explore::Explorer;

use crate::read::session;

/// Sends a request with these headers, and returns the whole response.
fn exchange(port: u16, target: &str, headers: &[(&str, &str)]) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .unwrap();
    let mut text = format!("GET {target} HTTP/1.1\r\nConnection: close\r\n");
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    stream.write_all(format!("{text}\r\n").as_bytes()).unwrap();
    let mut response = Vec::new();
    stream.read_to_end(&mut response).unwrap();
    String::from_utf8_lossy(&response).into_owned()
}

fn status(response: &str) -> u16 {
    response.split(' ').nth(1).unwrap().parse().unwrap()
}

#[test]
fn only_the_page_with_the_token_is_answered() {
    let explorer = Explorer::bind(session(&["lambert"]), 0).unwrap();
    let address = explorer.address();
    let (page, token) = address.split_once("/#token=").unwrap();
    assert_eq!(token.len(), 64);
    let host = page.strip_prefix("http://").unwrap().to_owned();
    let port = host.strip_prefix("127.0.0.1:").unwrap().parse().unwrap();
    let stopper = explorer.stopper();
    let running = std::thread::spawn(move || explorer.run());
    let key = "/api/v1/materials";
    let own = ("Host", host.as_str());
    let right = ("X-Merlkit-Token", token);
    let localhost = format!("localhost:{port}");
    let origin = format!("http://{host}");
    for headers in [
        vec![own, right],
        vec![("Host", &localhost), right],
        vec![
            own,
            right,
            ("Origin", &origin),
            ("Sec-Fetch-Site", "same-origin"),
        ],
    ] {
        let response = exchange(port, key, &headers);
        assert_eq!(status(&response), 200, "{headers:?}");
        assert!(response.contains("\"lambert"), "{response}");
        for header in ["cache-control: no-store", "x-content-type-options: nosniff"] {
            assert!(response.contains(header), "{response}");
        }
    }
    let wrong = token.replace(|c: char| c.is_ascii_digit(), "f");
    let foreign = format!("127.0.0.1:{}", port ^ 1);
    for headers in [
        vec![own],
        vec![own, ("X-Merlkit-Token", &wrong)],
        vec![own, ("X-Merlkit-Token", &token[..63])],
        vec![own, ("X-Merlkit-Token", "")],
        vec![own, ("Cookie", token)],
        vec![own, right, right],
        vec![("Host", "merlkit.example"), right],
        vec![("Host", &foreign), right],
        vec![("Host", "127.0.0.1"), right],
        vec![own, right, ("Origin", "http://merlkit.example")],
        vec![own, right, ("Origin", "null")],
        vec![own, right, ("Origin", &format!("https://{host}"))],
        vec![own, right, ("Sec-Fetch-Site", "cross-site")],
    ] {
        let response = exchange(port, key, &headers);
        assert_eq!(status(&response), 403, "{headers:?}");
        assert!(!response.contains("lambert"), "{response}");
    }
    assert_eq!(
        status(&exchange(port, &format!("{key}?token={token}"), &[own])),
        403
    );
    // Static files need no token, and still no other host may have them.
    let page = exchange(port, "/", &[own]);
    assert_eq!(status(&page), 200);
    assert!(page.contains("script-src 'self'") && !page.contains(token));
    assert_eq!(
        status(&exchange(port, "/", &[("Host", "merlkit.example")])),
        403
    );
    assert_eq!(
        status(&exchange(port, "/../Cargo.toml", &[own, right])),
        404
    );
    stopper.stop();
    running.join().unwrap().unwrap();
    assert!(TcpStream::connect(("127.0.0.1", port)).is_err());
}
