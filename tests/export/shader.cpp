// Answers questions about the file named, by the text SHADER of a shader as C++: what it has of GLSL and HLSL means the same
// here. Reads and writes as runtime_driver.c does.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

typedef std::uint32_t uint;

struct vec3 {
    float x, y, z;

    vec3(float a = 0.0f, float b = 0.0f, float c = 0.0f) : x(a), y(b), z(c)
    {
    }
};
typedef vec3 float3;

static std::vector<uint> words;

static inline float uintBitsToFloat(uint word)
{
    float value;
    std::memcpy(&value, &word, sizeof(value));
    return value;
}

#define asfloat(x) uintBitsToFloat(x)
#define MERLKIT_WORD(i) words.at(i)
using std::abs;
using std::sqrt;
// Functions that read the words take a table in every language, which shaders need not.
#pragma GCC diagnostic ignored "-Wunused-parameter"
namespace {
#include SHADER
}

int main(int count, char **arguments)
{
    std::FILE *file = count == 2 ? std::fopen(arguments[1], "rb") : NULL;
    uint word;
    while (file && std::fread(&word, sizeof(word), 1, file) == 1) {
        words.push_back(word);
    }
    float in[8];
    while (std::fread(in, sizeof(float), 8, stdin) == 8) {
        vec3 wo(in[0], in[1], in[2]), w(in[5], in[6], in[7]);
        merlkit_table table = merlkit_open(0u);
        merlkit_draw draw = merlkit_sample(table, wo, in[3], in[4]);
        vec3 f = merlkit_eval(table, wo, w);
        float out[8] = {draw.wi.x, draw.wi.y, draw.wi.z, draw.pdf, merlkit_pdf(table, wo, w), f.x, f.y, f.z};
        if (std::fwrite(out, sizeof(float), 8, stdout) != 8) {
            return 1;
        }
    }
    return 0;
}
