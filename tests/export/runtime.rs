//! Files that `merlkit.h` loads at run time: what they hold, which are refused, and programs that use them.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use assert_cmd::cargo::cargo_bin;
use merlkit::brdf::Brdf;
use merlkit::export::Export;
use merlkit::files::Overwrite;
use merlkit::glam::Vec3;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit_evaluate::measure::directional_albedo;

use crate::program::{COMPILERS, HERE, compile, runtime_header};
use crate::support::half_vector_preset;
use crate::{ROOT, has};

fn export(material: &str, lookup: LookupRule) -> Export {
    let material = Material::resolve(material).unwrap();
    let loaded = material.load(lookup).unwrap();
    Export::new(&material, &loaded, half_vector_preset("2KB")).unwrap()
}

fn bytes_of(export: &Export, folder: &Path) -> Vec<u8> {
    let path = folder.join("exported.merlkit");
    export.write_runtime(&path, Overwrite::Replace).unwrap();
    std::fs::read(path).unwrap()
}

fn word(bytes: &[u8], index: usize) -> u32 {
    u32::from_le_bytes(bytes[4 * index..4 * index + 4].try_into().unwrap())
}

/// The table in `docs/export.md`, read once more.
#[test]
fn files_hold_what_their_documentation_says() {
    let folder = tempfile::tempdir().unwrap();
    let export = export("nickel", LookupRule::Centred);
    let bytes = bytes_of(&export, folder.path());
    assert_eq!(bytes, bytes_of(&export, folder.path()));
    assert_eq!(bytes[..12], *b"merlkit\0\x01\0\0\0");
    assert_eq!(word(&bytes, 3) as usize * 4, bytes.len());
    let settings = export.table().settings();
    let [t, r, s] = [settings.tables, settings.rows, settings.segments];
    let head = [t as u32, r as u32, s as u32, 1, 2, 180, 0];
    for (index, expected) in (5..).zip(head) {
        assert_eq!(word(&bytes, index), expected, "word {index}");
    }
    assert_eq!(word(&bytes, 4), checksum(&bytes));
    let digest: String = bytes[48..80].iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(
        digest,
        Material::resolve("nickel").unwrap().sha256().unwrap()
    );
    assert_eq!(bytes[80..90], *b"nickel\0\0\0\0");
    assert_eq!(word(&bytes, 32), 1f32.to_bits());
    // The last row of each table ends at 65535, and nodes lie behind slopes.
    let cdf = 32 + t + 2 * (r + 1);
    let last = 4 * cdf + 2 * (r - 1);
    assert_eq!(bytes[last..last + 2], [0xff, 0xff]);
    let values = cdf + (t * r).div_ceil(2) + (t * r).div_ceil(4) + (t * r * (s + 1)).div_ceil(2);
    assert_eq!((bytes.len() / 4 - values) as u32, 3 * 90 * 90 * 180);
    for (index, value) in (values..).zip(export.values()).step_by(1009) {
        assert_eq!(word(&bytes, index), value.to_bits());
    }
}

#[test]
fn the_header_is_plain_and_takes_other_headers_beside_it() {
    let text = runtime_header();
    assert!(text.is_ascii() && text.lines().all(|l| l.trim_end() == l));
    assert_eq!(text, runtime_header());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("merlkit.h"), text).unwrap();
    std::fs::write(
        path.join("teflon.h"),
        export("teflon", LookupRule::Floor).header(),
    )
    .unwrap();
    let main = "int main(void) { merlkit_table t; return merlkit_load(0, 0u, &t) == MERLKIT_TRUNCATED ? 0 : 1; }\n";
    let attribute =
        "#define MERLKIT_FN static inline __attribute__((always_inline))\n#include <assert.h>\n";
    // In any order, and with functions that begin as another compiler wants it.
    for includes in [
        "#include \"merlkit.h\"\n#include \"teflon.h\"\n",
        "#define MERLKIT_STDIO\n#include \"teflon.h\"\n#include \"merlkit.h\"\n",
    ] {
        for compiler in COMPILERS.into_iter().filter(|c| has(c.0, &["--version"])) {
            let source = path.join("main.c");
            std::fs::write(&source, format!("{attribute}{includes}{main}")).unwrap();
            let program = compile(path, compiler, &source, &[]);
            assert!(Command::new(program).status().unwrap().success());
        }
    }
}

/// Without a library of C: nothing is left to be linked.
#[test]
fn the_header_needs_no_library_where_roots_are_defined() {
    if !has("gcc", &["--version"]) || !has("nm", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("merlkit.h"), runtime_header()).unwrap();
    let source = "#define MERLKIT_SQRT(x) __builtin_sqrtf(x)\n#define MERLKIT_ABS(x) __builtin_fabsf(x)\n\
                  #include \"merlkit.h\"\n\
                  float drawn(const void *bytes, size_t length, merlkit_vec3 wo);\n\
                  float drawn(const void *bytes, size_t length, merlkit_vec3 wo)\n{\n    merlkit_table table;\n    \
                  merlkit_status status = merlkit_load(bytes, length, &table);\n    \
                  if (status != MERLKIT_OK) {\n        return (float)merlkit_message(status)[0];\n    }\n    \
                  return merlkit_sample(&table, wo, 0.5f, 0.5f).pdf * merlkit_eval(&table, wo, wo).x;\n}\n";
    std::fs::write(folder.path().join("kernel.c"), source).unwrap();
    let arguments = "-std=c99 -Wall -Wextra -Wpedantic -Werror -O2 -ffreestanding -fno-math-errno -nostdlib -c kernel.c";
    let compiled = Command::new("gcc")
        .args(arguments.split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let missing = Command::new("nm")
        .args(["-u", "kernel.o"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    // Compilers may call these where they see fit; every environment has them.
    let missing = String::from_utf8(missing.stdout).unwrap();
    let foreign = missing
        .split_whitespace()
        .filter(|n| !["U", "memcpy", "memset"].contains(n));
    assert_eq!(foreign.count(), 0, "{missing}");
}

const NO_TABLE: &str = "probabilities that no table can hold";

/// FNV-1a of the words behind the checksum.
fn checksum(bytes: &[u8]) -> u32 {
    let words = 5..bytes.len() / 4;
    words.fold(0x811c_9dc5_u32, |sum, index| {
        (sum ^ word(bytes, index)).wrapping_mul(0x0100_0193)
    })
}

/// A change of a file, and what the header says to it.
type Fault = (fn(&mut Vec<u8>), &'static str);

fn set(bytes: &mut [u8], index: usize, value: u32) {
    bytes[4 * index..4 * index + 4].copy_from_slice(&value.to_le_bytes());
}

#[test]
fn each_fault_of_a_file_has_its_message() {
    let compiler = COMPILERS[0];
    if !has(compiler.0, &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("material.h"), runtime_header()).unwrap();
    let source = Path::new(HERE).join("runtime_driver.c");
    let define = ["-DHEADER=\"material.h\"".to_owned()];
    let program = compile(folder.path(), compiler, &source, &define);
    let good = bytes_of(&export("nickel", LookupRule::Linear), folder.path());
    let faults: [Fault; 17] = [
        (|b| b.truncate(127), "shorter than its header says"),
        (|b| b.truncate(b.len() - 1), "shorter than its header says"),
        (|b| b.push(0), "not as long as its settings demand"),
        (|b| b[0] = b'M', "not a file of merlkit export"),
        (
            |b| {
                b.as_chunks_mut::<4>()
                    .0
                    .iter_mut()
                    .for_each(|w| w.reverse())
            },
            "this machine is not",
        ),
        (|b| set(b, 2, 2), "another version than merlkit.h"),
        (|b| set(b, 6, 80), "settings in the header"),
        (|b| set(b, 7, 17), "not as long as its settings demand"),
        (|b| set(b, 33, 2f32.to_bits()), NO_TABLE),
        // An edge of a row, a probability, a slope, a node; and a value, with the checksum that belongs to it.
        (|b| set(b, 40, f32::NAN.to_bits()), NO_TABLE),
        (|b| set(b, 85, 0), NO_TABLE),
        (|b| set(b, 162, 0), NO_TABLE),
        (|b| set(b, 201, 0), NO_TABLE),
        (
            |b| {
                set(b, 509, f32::INFINITY.to_bits());
                let sum = checksum(b);
                set(b, 4, sum);
            },
            "values that no material can have",
        ),
        (|b| *b.last_mut().unwrap() ^= 1, "as its checksum shows"),
        (|b| b[50] ^= 1, "as its checksum shows"),
        (|_| (), ""),
    ];
    let path = folder.path().join("tried.merlkit");
    for (index, (change, expected)) in faults.into_iter().enumerate() {
        let mut bytes = good.clone();
        change(&mut bytes);
        std::fs::write(&path, bytes).unwrap();
        let output = Command::new(&program)
            .arg(&path)
            .stdin(std::process::Stdio::null())
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            output.status.success(),
            expected.is_empty(),
            "{index}: {said}"
        );
        assert!(said.contains(expected), "{index}: {said}");
    }
    let absent = Command::new(&program).arg("absent").output().unwrap();
    assert!(
        String::from_utf8(absent.stderr)
            .unwrap()
            .contains("cannot be opened")
    );
}

/// Ten thousand damaged files with the sanitizers of gcc, which end the program at the first fault.
#[test]
fn hostile_files_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("empty.c"), "int main(void) { return 0; }\n").unwrap();
    let empty = path.join("empty.c");
    let sanitizers = "-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all";
    let mut probe: Vec<&str> = sanitizers.split(' ').collect();
    let executable = path.join("probe");
    probe.extend([empty.to_str().unwrap(), "-o", executable.to_str().unwrap()]);
    if !has("gcc", &probe) {
        return;
    }
    std::fs::write(path.join("merlkit.h"), runtime_header()).unwrap();
    let more: Vec<String> = sanitizers.split(' ').map(str::to_owned).collect();
    let program = compile(
        path,
        COMPILERS[0],
        &Path::new(HERE).join("hostile.c"),
        &more,
    );
    for rule in [LookupRule::Floor, LookupRule::Centred] {
        let data = path.join("exported.merlkit");
        bytes_of(&export("nickel", rule), path);
        let output = Command::new(&program)
            .arg(&data)
            .arg("5000")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{said}");
        let counts = String::from_utf8(output.stdout).unwrap();
        let counts: Vec<u32> = counts.lines().map(|l| l.parse().unwrap()).collect();
        assert_eq!(counts.iter().sum::<u32>(), 5000);
        // Most are refused, each check refuses some, and some are harmless.
        assert!(counts[0] > 50 && counts[0] < 1500, "{counts:?}");
        for status in [1, 2, 3, 5, 6, 7, 8, 10] {
            assert!(counts[status] > 0, "status {status}: {counts:?}");
        }
    }
}

/// The means of a sphere that is seen from far away: under an environment of radiance 1, and lit by a distant light of
/// irradiance π.
fn expected_means(brdf: &dyn Brdf) -> [f64; 2] {
    let light = Vec3::new(0.48, 0.64, 0.6);
    // Over the disc, s = r² is uniform and cos θo = √(1 − s).
    let mut environment = 0.0;
    for k in 0..200 {
        let cosine = (1.0 - (k as f64 + 0.5) / 200.0).sqrt();
        environment += f64::from(directional_albedo(brdf, cosine.acos())[1]) / 200.0;
    }
    let (mut lit, mut count, side) = (0.0, 0.0, 1200);
    for pixel in 0..side * side {
        let x = 2.0 * ((pixel % side) as f32 + 0.5) / side as f32 - 1.0;
        let y = 2.0 * ((pixel / side) as f32 + 0.5) / side as f32 - 1.0;
        let z2 = 1.0 - x * x - y * y;
        if z2 > 0.0 {
            // The isotropic f_r·cos depends on the angles to the normal and between the directions alone.
            let normal = Vec3::new(x, y, z2.sqrt());
            let (t, b) = normal.any_orthonormal_pair();
            let [wo, wi] = [Vec3::Z, light].map(|w| Vec3::new(w.dot(t), w.dot(b), w.dot(normal)));
            lit += std::f64::consts::PI * f64::from(brdf.eval_cos(wo, wi)[1]);
            count += 1.0;
        }
    }
    [environment, lit / count]
}

/// The author of a renderer: from tables to a picture with `merlkit.h`, in a program that knows no material in advance.
#[test]
fn a_renderer_in_cpp_has_materials_by_name() {
    let compiler = COMPILERS[1];
    if !has(compiler.0, &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let names = ["nickel", "teflon"];
    let started = Instant::now();
    let exported = Command::new(cargo_bin!("merlkit"))
        .args([
            "export", names[0], names[1], "--format", "runtime", "-o", ".",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        exported.status.success(),
        "{}",
        String::from_utf8_lossy(&exported.stderr)
    );
    let seconds_exported = started.elapsed().as_secs_f64();
    let program = compile(
        folder.path(),
        compiler,
        &Path::new(HERE).join("../tasks/renderer/sphere.cpp"),
        &[],
    );
    let seconds_compiled = started.elapsed().as_secs_f64();
    let rendered = Command::new(program)
        .args(["picture.pfm", "96", "16", names[0], names[1]])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        rendered.status.success(),
        "{}",
        String::from_utf8_lossy(&rendered.stderr)
    );
    println!(
        "export {seconds_exported:.1} s, compile {:.1} s, load and render {:.1} s",
        seconds_compiled - seconds_exported,
        started.elapsed().as_secs_f64() - seconds_compiled
    );
    let head = b"PF\n192 96\n-1.0\n";
    let picture = std::fs::read(folder.path().join("picture.pfm")).unwrap();
    assert_eq!(
        (&picture[..head.len()], picture.len()),
        (&head[..], head.len() + 12 * 192 * 96)
    );
    let said = String::from_utf8(rendered.stdout).unwrap();
    assert_eq!(said.lines().count(), 2, "{said}");
    for (line, name) in said.lines().zip(names) {
        let (found, numbers) = line.split_once(' ').unwrap();
        assert_eq!(found, name);
        let numbers: Vec<f64> = numbers.split(' ').map(|x| x.parse().unwrap()).collect();
        let loaded = Material::resolve(name)
            .unwrap()
            .load(LookupRule::Floor)
            .unwrap();
        let expected = expected_means(&**loaded.brdf());
        for ((pair, expected), most) in numbers
            .as_chunks::<2>()
            .0
            .iter()
            .zip(expected)
            .zip([0.003, 0.05])
        {
            let [mean, error] = *pair;
            let is_near = (mean - expected).abs() < 4.0 * error && error < most * mean;
            assert!(is_near, "{line}: {mean} ± {error}, not {expected}");
        }
    }
}

/// The examples of the documentation are programs once they have a beginning and an end.
#[test]
fn the_documented_example_compiles_and_runs() {
    let compiler = COMPILERS[0];
    if !has(compiler.0, &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let document = std::fs::read_to_string(Path::new(ROOT).join("docs/export.md")).unwrap();
    let (_, section) = document.split_once("## Materials at run time").unwrap();
    let (_, example) = section.split_once("```c\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    std::fs::write(folder.path().join("merlkit.h"), runtime_header()).unwrap();
    std::fs::write(folder.path().join("example.c"), example).unwrap();
    let data = folder.path().join("nickel.merlkit");
    export("nickel", LookupRule::Floor)
        .write_runtime(&data, Overwrite::Refuse)
        .unwrap();
    let program = compile(
        folder.path(),
        compiler,
        &folder.path().join("example.c"),
        &[],
    );
    let output = Command::new(program).arg(data).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    // The albedo of nickel at 60° in red, from 10,000 draws.
    let albedo: f64 = said
        .trim()
        .strip_prefix("nickel: ")
        .unwrap()
        .parse()
        .unwrap();
    let nickel = Material::resolve("nickel")
        .unwrap()
        .load(LookupRule::Floor)
        .unwrap();
    let expected = f64::from(directional_albedo(&**nickel.brdf(), 60f64.to_radians())[0]);
    assert!(
        (albedo / expected - 1.0).abs() < 0.01,
        "{said}, not {expected}"
    );
}
