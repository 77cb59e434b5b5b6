//! The header as GLSL: whether a compiler takes it.

use std::path::Path;
use std::process::Command;

use merlkit::export::Export;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::sampler::HalfVectorSettings;

use crate::has;

/// A compute shader of two materials, one of which has no values and therefore no `eval`.
fn shader(version: &str) -> String {
    let header = |material: &str, lookup, preset: usize| {
        let (material, settings) = (
            Material::resolve(material).unwrap(),
            HalfVectorSettings::PRESETS[preset].1,
        );
        Export::new(&material, &material.load(lookup).unwrap(), settings)
            .unwrap()
            .header()
    };
    let headers = [
        header("nickel", LookupRule::Linear, 2),
        header("blue-metallic-paint", LookupRule::Floor, 0),
        header("teflon", LookupRule::Floor, 0),
    ];
    format!(
        "#version {version}\n\
         layout(local_size_x = 64) in;\n\
         layout(std430, binding = 0) readonly buffer A {{ float nickel_values[]; }};\n\
         #define nickel_VALUE(i) nickel_values[i]\n\
         layout(std430, binding = 1) readonly buffer B {{ float paint[]; }};\n\
         #define blue_metallic_paint_VALUE(i) paint[i]\n\
         layout(std430, binding = 3) readonly buffer D {{ uint paint_words[]; }};\n\
         #define blue_metallic_paint_WORD(i) paint_words[i]\n\
         layout(std430, binding = 2) buffer C {{ vec4 points[]; }};\n\
         {}\
         void main() {{\n\
             vec4 point = points[gl_GlobalInvocationID.x];\n\
             vec3 wo = normalize(vec3(point.xy, 1.0));\n\
             merlkit_draw draw = nickel_sample(wo, point.z, point.w);\n\
             vec3 f = nickel_eval(wo, draw.wi) + blue_metallic_paint_eval(wo, draw.wi);\n\
             float pdf = draw.pdf + blue_metallic_paint_pdf(wo, draw.wi) + teflon_sample(wo, point.z, point.w).pdf;\n\
             points[gl_GlobalInvocationID.x] = vec4(f * draw.wi.z / pdf, pdf);\n\
         }}\n",
        headers.concat()
    )
}

/// A fragment shader of GLSL ES 3.00 with one material in textures.
fn fragment_shader() -> String {
    let material = Material::resolve("nickel").unwrap();
    let loaded = material.load(LookupRule::Linear).unwrap();
    let settings = HalfVectorSettings::PRESETS[0].1;
    let header = Export::new(&material, &loaded, settings).unwrap().header();
    format!(
        "#version 300 es\n\
         uniform highp usampler2D words;\nuniform highp sampler2D values;\n\
         #define nickel_WORD(i) texelFetch(words, ivec2(int((i) & 1023u), int((i) >> 10u)), 0).r\n\
         #define nickel_VALUE(i) texelFetch(values, ivec2((i) & 2047, (i) >> 11), 0).r\n\
         {header}\
         in vec3 wo;\nout vec4 colour;\nvoid main() {{\n\
             merlkit_draw draw = nickel_sample(wo, 0.5, 0.25);\n\
             colour = vec4(nickel_eval(wo, draw.wi) * draw.wi.z / draw.pdf, nickel_pdf(wo, draw.wi));\n}}\n"
    )
}

fn compile(folder: &Path, shader: &str, arguments: &[&str]) -> (bool, String) {
    let path = folder.join("shader.comp");
    std::fs::write(&path, shader).unwrap();
    let output = Command::new("glslangValidator")
        .args(arguments)
        .arg(&path)
        .current_dir(folder)
        .output()
        .unwrap();
    (
        output.status.success(),
        String::from_utf8(output.stdout).unwrap(),
    )
}

#[test]
fn glslang_takes_the_header() {
    if !has("glslangValidator", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 3] = [
        ("430 core", &[]),
        ("450", &["-V", "-o", "shader.spv"]),
        ("460 core", &["-G", "-o", "shader.spv"]),
    ];
    for (version, arguments) in cases {
        let (fine, said) = compile(folder.path(), &shader(version), arguments);
        assert!(fine && !said.contains("WARNING"), "{version}: {said}");
    }
    // In GLSL ES 3.00 words and values come from textures.
    let (fine, said) = compile(folder.path(), &fragment_shader(), &["-S", "frag"]);
    assert!(fine && !said.contains("WARNING"), "{said}");
    // It reads what it is given: without its values, a material has no eval.
    let without = shader("430 core").replace("#define nickel_VALUE(i) nickel_values[i]", "");
    let (fine, said) = compile(folder.path(), &without, &[]);
    assert!(!fine && said.contains("nickel_eval"), "{said}");
}
