//! The shaders of run-time tables: compilers take them, and they do what the library does.

use std::path::Path;
use std::process::{Command, Output};

use merlkit::export::Export;
use merlkit::files::Overwrite;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;

use crate::has;
use crate::program::{Answer, Beyond, COMPILERS, HERE, Program, Question};
use crate::program::{compare, expected, question_bytes, questions, read_answers, runtime_code};
use crate::support::half_vector_preset;

/// A draw, its value and a density, in GLSL and HLSL.
const ESTIMATE: &str = "merlkit_table table = merlkit_open(16u);\n\
                        merlkit_draw draw = merlkit_sample(table, wo, 0.5, 0.25);\n\
                        float pdf = merlkit_pdf(table, wo, draw.wi);\n";

fn fragment_glsl(version: &str, words: &str) -> String {
    let text = runtime_code("merlkit.glsl");
    format!(
        "#version {version}\n{words}{text}in vec3 wo;\nout vec4 colour;\nvoid main() {{\n{ESTIMATE}\
         colour = vec4(merlkit_eval(table, wo, draw.wi) * draw.wi.z / draw.pdf, pdf);\n}}\n"
    )
}

fn compute_glsl(version: &str) -> String {
    let text = runtime_code("merlkit.glsl");
    format!(
        "#version {version}\nlayout(local_size_x = 64) in;\n\
         layout(std430, binding = 0) readonly buffer A {{ uint words[]; }};\n#define MERLKIT_WORD(i) words[i]\n\
         layout(std430, binding = 1) buffer B {{ vec4 answers[]; }};\n{text}void main() {{\n\
         vec3 wo = answers[gl_GlobalInvocationID.x].xyz;\n{ESTIMATE}\
         answers[gl_GlobalInvocationID.x] = vec4(merlkit_eval(table, wo, draw.wi), pdf);\n}}\n"
    )
}

fn pixel_hlsl(words: &str) -> String {
    let text = runtime_code("merlkit.hlsl");
    format!(
        "{words}{text}float4 main(float3 wo : WO) : SV_Target\n{{\n{ESTIMATE}\
         return float4(merlkit_eval(table, wo, draw.wi) * draw.wi.z / draw.pdf, pdf);\n}}\n"
    )
}

fn run(folder: &Path, program: &str, arguments: &str, name: &str, text: &str) -> Output {
    std::fs::write(folder.join(name), text).unwrap();
    Command::new(program)
        .args(arguments.split_whitespace())
        .arg(name)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn assert_taken(folder: &Path, program: &str, arguments: &str, name: &str, text: &str) {
    let output = run(folder, program, arguments, name, text);
    let said = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && !said.contains("WARNING"),
        "{arguments} {name}: {said}"
    );
}

#[test]
fn glslang_takes_glsl_and_hlsl() {
    if !has("glslangValidator", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let take = |arguments: &str, name: &str, text: &str| {
        assert_taken(folder.path(), "glslangValidator", arguments, name, text);
    };
    for version in ["300 es", "320 es", "330 core", "460 core"] {
        take("", "shader.frag", &fragment_glsl(version, ""));
    }
    // Words that are elsewhere.
    let split = "uniform highp usampler2D other;\n\
                 #define MERLKIT_WORD(i) texelFetch(other, ivec2(int((i) & 4095u), int((i) >> 12u)), 0).r\n";
    let declared = "precision highp float;\nprecision highp int;\n";
    take(
        "",
        "shader.frag",
        &fragment_glsl("300 es", &format!("{declared}{split}")),
    );
    for (version, arguments) in [
        ("310 es", ""),
        ("430 core", ""),
        ("450", "-V -o shader.spv"),
    ] {
        take(arguments, "shader.comp", &compute_glsl(version));
    }
    let bytes = "ByteAddressBuffer bytes;\n#define MERLKIT_WORD(i) bytes.Load(4u * (i))\n";
    for words in ["", bytes] {
        take(
            "-D -e main -S frag -V -o shader.spv",
            "shader.hlsl",
            &pixel_hlsl(words),
        );
    }
    // It reads what it is given.
    let spoilt = fragment_glsl("300 es", "").replace("float scaled =", "float scaled");
    assert!(
        !run(
            folder.path(),
            "glslangValidator",
            "",
            "shader.frag",
            &spoilt
        )
        .status
        .success()
    );
}

#[test]
fn naga_takes_wgsl() {
    if !has("naga", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let text = runtime_code("merlkit.wgsl")
        + "@group(0) @binding(0) var<storage, read> merlkit_words: array<u32>;\n\
           fn merlkit_word(i: u32) -> u32 { return merlkit_words[i]; }\n\
           @fragment fn main(@location(0) wo: vec3<f32>) -> @location(0) vec4<f32> {\n\
           let table = merlkit_open(16u);\nlet draw = merlkit_sample(table, wo, 0.5, 0.25);\n\
           let f = merlkit_eval(table, wo, draw.wi) * draw.wi.z / draw.pdf;\n\
           return vec4<f32>(f, merlkit_pdf(table, wo, draw.wi));\n}\n";
    assert_taken(folder.path(), "naga", "", "shader.wgsl", &text);
    let spoilt = text.replacen("var scaled: f32", "var scaled: u32", 1);
    assert!(
        !run(folder.path(), "naga", "", "shader.wgsl", &spoilt)
            .status
            .success()
    );
}

fn export(material: &str, lookup: LookupRule, size: &str) -> Export {
    let material = Material::resolve(material).unwrap();
    let loaded = material.load(lookup).unwrap();
    Export::new(&material, &loaded, half_vector_preset(size)).unwrap()
}

/// Answers beyond 10⁻⁵ that are allowed of 20,000, as for C.
const ALLOWED: Beyond = Beyond {
    draws: 3,
    densities: 3,
    values: 3,
};

/// GLSL and HLSL are C++ once their types and functions are defined.
#[test]
fn glsl_and_hlsl_as_cpp_agree_with_the_library() {
    if !has(COMPILERS[1].0, &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (rule, size) in [(LookupRule::Floor, "64KB"), (LookupRule::Centred, "2KB")] {
        let export = export("nickel", rule, size);
        let questions = questions(&export, 20_000, 11);
        let expected = expected(&export, &questions);
        for name in ["merlkit.glsl", "merlkit.hlsl"] {
            let program = Program::shader(name, &export, folder.path(), &runtime_code(name));
            let beyond = compare(&program.ask(&questions), &expected, 1e-5);
            assert!(beyond.within(ALLOWED), "{name}, {rule:?}: {beyond:?}");
        }
    }
    // It tells a wrong shader from a right one.
    let export = export("nickel", LookupRule::Floor, "2KB");
    let questions = questions(&export, 1000, 12);
    let wrong = runtime_code("merlkit.hlsl").replace("16.0f * len", "16.001f * len");
    let program = Program::shader("merlkit.hlsl", &export, folder.path(), &wrong);
    let beyond = compare(
        &program.ask(&questions),
        &expected(&export, &questions),
        1e-5,
    );
    assert!(beyond.draws > 990, "{beyond:?}");
}

/// Both by Mesa's llvmpipe: WGSL by naga and Vulkan, GLSL ES 3.00 by OpenGL with the words in a texture.
#[test]
fn wgsl_and_glsl_es_run_as_the_library() {
    let probes = [
        (
            "wgsl",
            "import wgpu; print(wgpu.gpu.request_adapter_sync().info['device'])",
        ),
        (
            "es",
            "import moderngl; print(moderngl.create_standalone_context(backend='egl').info['GL_RENDERER'])",
        ),
    ];
    for (language, probe) in probes {
        let text = format!("import numpy; {probe}");
        if !has("python3", &["-c", &text]) {
            continue;
        }
        let output = Command::new("python3")
            .args(["-c", &text])
            .output()
            .unwrap();
        if !String::from_utf8_lossy(&output.stdout).contains("llvmpipe") {
            // Bounds are those of one driver: others may divide with less precision.
            continue;
        }
        for (rule, size) in [(LookupRule::Floor, "64KB"), (LookupRule::Centred, "2KB")] {
            let export = export("nickel", rule, size);
            let questions = questions(&export, 20_000, 13);
            let found = run_shader(language, &export, &questions);
            assert_near(&questions, &found, &expected(&export, &questions), language);
        }
    }
}

fn run_shader(language: &str, export: &Export, questions: &[Question]) -> Vec<Answer> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["merlkit.glsl", "merlkit.wgsl"] {
        std::fs::write(path.join(name), runtime_code(name)).unwrap();
    }
    export
        .write_runtime(&path.join("table.merlkit"), Overwrite::Refuse)
        .unwrap();
    std::fs::write(path.join("questions.bin"), question_bytes(questions)).unwrap();
    let output = Command::new("python3")
        .arg(Path::new(HERE).join("shaders.py"))
        .args([language.as_ref(), path.as_os_str()])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    read_answers(&std::fs::read(path.join("answers.bin")).unwrap())
}

/// Directions and values are as near as those of C. Near the horizon f32 resolves a density poorly, and compilers of shaders
/// round otherwise: there, densities are within 2.5 %, and within 4·10⁻⁵ from 6° above it.
fn assert_near(questions: &[Question], found: &[Answer], expected: &[Answer], language: &str) {
    assert_eq!(found.len(), expected.len());
    let [mut directions, mut values, mut densities] = [0; 3];
    for ((question, found), expected) in questions.iter().zip(found).zip(expected) {
        directions += usize::from(!found.wi.abs_diff_eq(expected.wi, 1e-5));
        let near = |channel: usize| {
            (found.f[channel] - expected.f[channel]).abs() <= 1e-5 * expected.f[channel]
        };
        values += usize::from(!(0..3).all(near));
        let is_high = question.wo.z.min(question.w.z) > 0.105;
        let most = if is_high { 4e-5 } else { 0.025 };
        densities += usize::from((found.pdf - expected.pdf).abs() > most * expected.pdf);
    }
    let found = [directions, values, densities];
    assert!(
        found.iter().all(|&count| count <= 3),
        "{language}: {found:?}"
    );
}
