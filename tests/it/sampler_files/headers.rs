//! Headers that lie, values that cannot be, and texts that contradict their settings.

use super::*;

/// A file of the given header, JSON, and bytes of tensors.
fn with_header(json: &str, data: &[u8]) -> Vec<u8> {
    [
        &(json.len() as u64).to_le_bytes()[..],
        json.as_bytes(),
        data,
    ]
    .concat()
}

fn refusal(bytes: Vec<u8>) -> (u64, String) {
    match SamplerFile::from_bytes(bytes, Path::new("forged")) {
        Err(merlkit::Error::Invalid { offset, found, .. }) => (offset, found),
        other => panic!("{other:?}"),
    }
}

#[test]
fn headers_that_lie_are_refused_with_their_place() {
    assert_eq!(refusal(vec![1, 2, 3]).0, 3);
    assert_eq!(refusal(u64::MAX.to_le_bytes().to_vec()).0, 0);
    assert_eq!(refusal(with_header("{", b"")).0, 8);
    assert_eq!(refusal(with_header("{\"a\":7}", b"")).0, 8 + 6);
    assert_eq!(refusal(with_header("{}", b"trailing")).0, 10);
    // The sum of what the tensors claim and of what stands before them passes 2⁶⁴.
    let part = (1u64 << 61) - 1;
    let mut tensors: Vec<String> = (0..8)
        .map(|k| tensor(&format!("t{k}"), part, k * part))
        .collect();
    tensors.push(tensor("u", 7, 8 * part));
    let (_, found) = refusal(with_header(&format!("{{{}}}", tensors.join(",")), b"few"));
    assert!(found.contains("3 bytes of tensors"), "{found}");
}

fn tensor(name: &str, length: u64, start: u64) -> String {
    format!(
        "\"{name}\":{{\"dtype\":\"U8\",\"shape\":[{length}],\"data_offsets\":[{start},{}]}}",
        start + length
    )
}

#[test]
fn a_bad_value_is_told_with_tensor_and_byte() {
    let folder = tempfile::tempdir().unwrap();
    let (_, brdf, path) = built(specs()[0].clone(), folder.path());
    let mut file = Forged::read(&std::fs::read(&path).unwrap());
    let marker = f32::from_bits(0xffc1_2345);
    file.set_f32("leaf.bound", 2, marker);
    let bytes = file.write();
    let at = bytes
        .windows(4)
        .position(|w| w == marker.to_le_bytes())
        .unwrap() as u64;
    match SamplerFile::from_bytes(bytes, &path).and_then(|f| f.into_sampler(&loaded(&brdf))) {
        Err(merlkit::Error::Invalid {
            offset, expected, ..
        }) => {
            assert_eq!(offset, at);
            assert!(expected.contains("in tensor \"leaf.bound\""), "{expected}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_file_whose_text_and_settings_contradict_each_other_is_refused() {
    assert_each_is_refused(
        SamplerSpec::new(HalfVectorSettings::default()),
        &[(
            "another size in the text",
            |f| f.record["spec"] = "half-vector:2KB".into(),
            "the settings of half-vector:2KB",
        )],
    );
    assert_each_is_refused(
        SamplerSpec::new(LobeSettings::fitted(LobeKind::Ggx)),
        &[(
            "another lobe in the text",
            |f| f.record["spec"] = "lobe:ward".into(),
            "the settings of lobe:ward",
        )],
    );
}
