//! Sampler files of every method: taken apart, bent and put together with a checksum that fits.

use super::*;

/// A sampler file taken apart, to be put together with a checksum that fits.
#[derive(Clone)]
struct Parts {
    tensors: Vec<(String, Dtype, Vec<u8>)>,
    record: serde_json::Value,
}

impl Parts {
    fn of(spec: SamplerSpec) -> Self {
        let material = Material::resolve("red-plastic").unwrap();
        let sampler = spec.build(&exercise::material()).unwrap();
        let bytes = encode(&sampler, &material).unwrap();
        let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
        let file = SafeTensors::deserialize(&bytes).unwrap();
        let mut tensors: Vec<_> = file
            .iter()
            .map(|(name, v)| (name.to_owned(), v.dtype(), v.data().to_vec()))
            .collect();
        tensors.sort_by(|a, b| a.0.cmp(&b.0));
        let record = serde_json::from_str(&header.metadata().as_ref().unwrap()["merlkit"]).unwrap();
        Self { tensors, record }
    }

    fn write(mut self) -> Vec<u8> {
        let (mut hash, mut data, mut entries) = (Sha256::new(), Vec::new(), Vec::new());
        for (name, dtype, bytes) in &self.tensors {
            hash.update(format!("{name}:{dtype:?}:{}:", bytes.len()));
            hash.update(bytes);
            let (start, length) = (data.len(), bytes.len() * 8 / dtype.bitsize());
            data.extend_from_slice(bytes);
            entries.push(format!(
                "\"{name}\":{{\"dtype\":\"{dtype:?}\",\"shape\":[{length}],\"data_offsets\":[{start},{}]}}",
                data.len()
            ));
        }
        let hex: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        self.record["payload_sha256"] = hex.into();
        let metadata =
            serde_json::to_string(&HashMap::from([("merlkit", self.record.to_string())])).unwrap();
        let json = format!("{{\"__metadata__\":{metadata},{}}}", entries.join(","));
        [
            &(json.len() as u64).to_le_bytes()[..],
            json.as_bytes(),
            &data,
        ]
        .concat()
    }

    /// One change to a value, a length, a name or a setting.
    fn change(&mut self, random: &mut Stream) {
        let which = below(random, self.tensors.len());
        match below(random, 12) {
            0 => drop(self.tensors.remove(which)),
            1 => self.change_setting(random),
            2 => {
                let (_, dtype, bytes) = &mut self.tensors[which];
                let keep =
                    below(random, bytes.len() * 8 / dtype.bitsize() + 1) * dtype.bitsize() / 8;
                bytes.truncate(keep);
            }
            3 => {
                let (_, _, bytes) = &mut self.tensors[which];
                bytes.extend_from_within(..);
            }
            _ => self.change_value(which, random),
        }
    }

    fn change_value(&mut self, which: usize, random: &mut Stream) {
        let (_, dtype, bytes) = &mut self.tensors[which];
        let width = dtype.bitsize() / 8;
        let count = (bytes.len() / width).max(1);
        let at = width * below(random, count);
        let old = bytes[at.min(bytes.len())..]
            .iter()
            .take(width)
            .rev()
            .fold(0, |v, &b| v << 8 | u64::from(b));
        let new = match below(random, 5) {
            0 => NASTY[below(random, NASTY.len())],
            1 => old.wrapping_add(1),
            2 => old.wrapping_sub(1),
            3 => old ^ 1 << below(random, 8 * width),
            _ => random.next_u64(),
        };
        overwrite(bytes, at, width, new);
    }

    fn change_setting(&mut self, random: &mut Stream) {
        let settings = self.record["settings"].as_object_mut().unwrap();
        let keys: Vec<String> = settings.keys().cloned().collect();
        let value = &mut settings[&keys[below(random, keys.len())]];
        *value = match below(random, 8) {
            0 => 0.into(),
            1 => (-1).into(),
            2 => u64::MAX.into(),
            3 => 1e300.into(),
            4 => serde_json::Value::Null,
            5 => below(random, 300).into(),
            6 => random.next_f64().into(),
            _ => (value.as_u64().unwrap_or(3) + 1).into(),
        };
    }
}

fn drive_sampler(name: &str, spec: SamplerSpec) {
    // They share the reader of the file, and each has a reader of its tensors.
    let share = 7;
    let (good, material) = (Parts::of(spec), exercise::material());
    let whole = good.clone().write();
    assert!(
        exercise::sampler(&whole, &material),
        "{name}: what was not mutated is accepted"
    );
    let make = |random: &mut Stream| {
        if below(random, 4) == 0 {
            let mut bytes = whole.clone();
            scramble(&mut bytes, random);
            return bytes;
        }
        let mut parts = good.clone();
        for _ in 0..1 + below(random, 2) {
            if !parts.tensors.is_empty() {
                parts.change(random);
            }
        }
        parts.write()
    };
    drive(name, SAMPLER_FACTOR, share, make, |input| {
        exercise::sampler(input, &material)
    });
}

fn small_disc(leaves: LeafChoice) -> SamplerSpec {
    let settings = AdaptiveDiscSettings {
        tables: 2,
        depth: 2,
        leaves,
        ..Default::default()
    };
    SamplerSpec::new(settings)
}

#[test]
fn sampler_files_of_trees() {
    drive_sampler("sampler-trees", small_disc(LeafChoice::Envelope));
}

#[test]
fn sampler_files_of_warps() {
    drive_sampler("sampler-warps", small_disc(LeafChoice::Warp));
}

#[test]
fn sampler_files_of_curves() {
    let small = CascadeCdfSettings {
        tables: 2,
        theta_h: 6,
        phi_h: 4,
        ..Default::default()
    };
    drive_sampler("sampler-curves", SamplerSpec::new(small));
    let whole = CascadeCdfSettings {
        tolerance: None,
        ..small
    };
    drive_sampler("sampler-curves-whole", SamplerSpec::new(whole));
}

#[test]
fn sampler_files_of_half_vectors() {
    let small = HalfVectorSettings {
        tables: 2,
        rows: 4,
        segments: 2,
        ..HalfVectorSettings::PRESETS[0].1
    };
    drive_sampler("sampler-half-vector", SamplerSpec::new(small));
}

#[test]
fn sampler_files_of_lobes_and_factors() {
    let parameters = Some(LobeParameters {
        along: 0.2,
        across: 0.2,
        diffuse: 0.1,
    });
    let lobe = LobeSettings {
        parameters,
        ..LobeSettings::fitted(LobeKind::Ward)
    };
    drive_sampler("sampler-lobe", SamplerSpec::new(lobe));
    let factors = Some(Factors {
        outer: 2,
        inner: 1,
        theta: 4,
        phi: 3,
        half: true,
        floor: 0.01,
    });
    let settings = FactoredSettings {
        tables: 2,
        factors,
        ..Default::default()
    };
    drive_sampler("sampler-factors", SamplerSpec::new(settings));
}
