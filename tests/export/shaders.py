"""Runs merlkit's shaders on questions about a table, by a driver that needs no GPU.

    shaders.py wgsl|es FOLDER

FOLDER has merlkit.wgsl and merlkit.glsl, table.merlkit, and questions.bin: wo, u and a direction w, eight floats each. Writes
answers.bin: the draw, its density, the density of w and its value, eight floats each. Prints the driver's name.
"""

import sys
from pathlib import Path

import numpy as np

WGSL = """
@group(0) @binding(0) var<storage, read> merlkit_words: array<u32>;
@group(0) @binding(1) var<storage, read> questions: array<f32>;
@group(0) @binding(2) var<storage, read_write> answers: array<f32>;

fn merlkit_word(i: u32) -> u32 {
    return merlkit_words[i];
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = 8u * id.x;
    if (at >= arrayLength(&questions)) {
        return;
    }
    let table = merlkit_open(0u);
    let wo = vec3<f32>(questions[at], questions[at + 1u], questions[at + 2u]);
    let w = vec3<f32>(questions[at + 5u], questions[at + 6u], questions[at + 7u]);
    let draw = merlkit_sample(table, wo, questions[at + 3u], questions[at + 4u]);
    let f = merlkit_eval(table, wo, w);
    answers[at] = draw.wi.x;
    answers[at + 1u] = draw.wi.y;
    answers[at + 2u] = draw.wi.z;
    answers[at + 3u] = draw.pdf;
    answers[at + 4u] = merlkit_pdf(table, wo, w);
    answers[at + 5u] = f.x;
    answers[at + 6u] = f.y;
    answers[at + 7u] = f.z;
}
"""

ES_VERTEX = """#version 300 es
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.0, 1.0); }
"""

# One pixel a question; `part` chooses which four numbers of the answer it gets.
ES_FRAGMENT = """
uniform highp sampler2D questions;
uniform int part;
out vec4 answer;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 a = texelFetch(questions, ivec2(2 * pixel.x, pixel.y), 0);
    vec4 b = texelFetch(questions, ivec2(2 * pixel.x + 1, pixel.y), 0);
    vec3 wo = a.xyz;
    vec3 w = b.yzw;
    merlkit_table table = merlkit_open(0u);
    if (part == 0) {
        merlkit_draw draw = merlkit_sample(table, wo, a.w, b.x);
        answer = vec4(draw.wi, draw.pdf);
    } else {
        answer = vec4(merlkit_pdf(table, wo, w), merlkit_eval(table, wo, w));
    }
}
"""


def run_wgsl(folder, words, questions):
    import wgpu
    from wgpu.utils.compute import compute_with_buffers

    adapter = wgpu.gpu.request_adapter_sync(power_preference="low-power")
    print(adapter.info["device"])
    text = (folder / "merlkit.wgsl").read_text() + WGSL
    groups = (len(questions) + 63) // 64
    out = compute_with_buffers(
        input_arrays={0: words, 1: questions}, output_arrays={2: (questions.size, "f")}, shader=text, n=groups
    )
    return np.frombuffer(out[2], np.float32)


def run_es(folder, words, questions):
    import moderngl

    context = moderngl.create_standalone_context(backend="egl")
    print(context.info["GL_RENDERER"])
    width = 2048
    height = -(-len(words) // width)
    padded = np.zeros(width * height, np.uint32)
    padded[: len(words)] = words
    texture = context.texture((width, height), 1, padded.tobytes(), dtype="u4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    side = 256
    rows = -(-len(questions) // side)
    asked = np.zeros((rows * side, 8), np.float32)
    asked[: len(questions)] = questions
    asked_texture = context.texture((2 * side, rows), 4, asked.tobytes(), dtype="f4")
    asked_texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    fragment = "#version 300 es\n" + (folder / "merlkit.glsl").read_text() + ES_FRAGMENT
    program = context.program(vertex_shader=ES_VERTEX, fragment_shader=fragment)
    program["merlkit_words"] = 0
    program["questions"] = 1
    texture.use(0)
    asked_texture.use(1)
    corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], np.float32).tobytes())
    triangle = context.vertex_array(program, [(corners, "2f", "corner")])
    frame = context.framebuffer([context.texture((side, rows), 4, dtype="f4")])
    frame.use()
    parts = []
    for part in (0, 1):
        program["part"] = part
        triangle.render()
        parts.append(np.frombuffer(frame.read(components=4, dtype="f4"), np.float32).reshape(-1, 4))
    return np.concatenate(parts, axis=1)[: len(questions)]


def main():
    folder = Path(sys.argv[2])
    words = np.fromfile(folder / "table.merlkit", np.uint32)
    questions = np.fromfile(folder / "questions.bin", np.float32).reshape(-1, 8)
    run = {"wgsl": run_wgsl, "es": run_es}[sys.argv[1]]
    np.ascontiguousarray(run(folder, words, questions), np.float32).tofile(folder / "answers.bin")


if __name__ == "__main__":
    main()
