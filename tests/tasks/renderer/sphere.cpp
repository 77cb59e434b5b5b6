// A renderer of its own that has measured materials by name: spheres side by side under an environment of radiance 1 and a
// distant light of irradiance pi, seen from far away. Materials are files of merlkit.h that it loads when it runs.
//
//     sphere picture.pfm SIZE SAMPLES nickel teflon
//
// Prints the mean over each sphere, and its standard error, of the environment's part and of the light's part in green.
#define MERLKIT_STDIO
#include "merlkit.h"
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

struct Frame {
    merlkit_vec3 t, b, n;

    // A basis around the unit normal.
    explicit Frame(merlkit_vec3 normal) : t(), b(), n(normal)
    {
        float sign = std::copysign(1.0f, n.z);
        float a = -1.0f / (sign + n.z);
        float c = n.x * n.y * a;
        t = merlkit_v(1.0f + sign * n.x * n.x * a, sign * c, -sign * n.x);
        b = merlkit_v(c, sign + n.y * n.y * a, -n.y);
    }

    static float dot(merlkit_vec3 v, merlkit_vec3 w)
    {
        return v.x * w.x + v.y * w.y + v.z * w.z;
    }

    merlkit_vec3 to_local(merlkit_vec3 w) const
    {
        return merlkit_v(dot(w, t), dot(w, b), dot(w, n));
    }
};

struct Random {
    std::mt19937 engine;
    std::uniform_real_distribution<float> uniform{0.0f, 1.0f};

    float next()
    {
        return uniform(engine);
    }
};

// Sums of an estimate.
struct Mean {
    double sum = 0.0, squares = 0.0, count = 0.0;

    void add(double x)
    {
        sum += x;
        squares += x * x;
        count += 1.0;
    }

    void print() const
    {
        double mean = sum / count;
        std::printf(" %.8g %.8g", mean, std::sqrt((squares / count - mean * mean) / count));
    }
};

static const float PI = 3.14159265f;

static void add(merlkit_vec3 &sum, merlkit_vec3 f, float weight)
{
    sum.x += f.x * weight;
    sum.y += f.y * weight;
    sum.z += f.z * weight;
}

// Light of the constant environment: a direction of the material's and a uniform one, combined by the balance heuristic.
static merlkit_vec3 environment(const merlkit_table &material, merlkit_vec3 wo, Random &random)
{
    const float uniform = 0.5f / PI;
    merlkit_vec3 sum = merlkit_v(0.0f, 0.0f, 0.0f);
    float u1 = random.next(), u2 = random.next();
    merlkit_draw draw = merlkit_sample(&material, wo, u1, u2);
    if (draw.pdf > 0.0f) {
        add(sum, merlkit_eval(&material, wo, draw.wi), draw.wi.z / (draw.pdf + uniform));
    }
    float z = 1.0f - random.next(), phi = 2.0f * PI * random.next(), r = std::sqrt(1.0f - z * z);
    merlkit_vec3 wi = merlkit_v(r * std::cos(phi), r * std::sin(phi), z);
    add(sum, merlkit_eval(&material, wo, wi), z / (uniform + merlkit_pdf(&material, wo, wi)));
    return sum;
}

int main(int count, char **arguments)
{
    if (count < 5) {
        return 2;
    }
    int size = std::atoi(arguments[2]), samples = std::atoi(arguments[3]), spheres = count - 4;
    std::map<std::string, merlkit_table> materials;
    for (int k = 4; k < count; k++) {
        merlkit_status status = merlkit_load_file((std::string(arguments[k]) + ".merlkit").c_str(), &materials[arguments[k]]);
        if (status != MERLKIT_OK) {
            std::fprintf(stderr, "%s: %s\n", arguments[k], merlkit_message(status));
            return 1;
        }
    }
    const merlkit_vec3 view = merlkit_v(0.0f, 0.0f, 1.0f), light = merlkit_v(0.48f, 0.64f, 0.6f);
    std::vector<float> picture(static_cast<std::size_t>(3 * size * size * spheres));
    Random random;
    for (int k = 0; k < spheres; k++) {
        const merlkit_table &material = materials[arguments[4 + k]];
        Mean indirect, direct;
        for (int pixel = 0; pixel < size * size * samples; pixel++) {
            int at = pixel / samples, row = at / size, column = at % size;
            float x = 2.0f * (static_cast<float>(column) + random.next()) / static_cast<float>(size) - 1.0f;
            float y = 2.0f * (static_cast<float>(row) + random.next()) / static_cast<float>(size) - 1.0f;
            if (x * x + y * y >= 1.0f) {
                continue;
            }
            Frame frame(merlkit_v(x, y, std::sqrt(1.0f - x * x - y * y)));
            merlkit_vec3 wo = frame.to_local(view), wi = frame.to_local(light);
            merlkit_vec3 sum = environment(material, wo, random);
            indirect.add(sum.y);
            merlkit_vec3 lit = merlkit_v(0.0f, 0.0f, 0.0f);
            add(lit, merlkit_eval(&material, wo, wi), PI * std::fmax(wi.z, 0.0f));
            direct.add(lit.y);
            add(sum, lit, 1.0f);
            float *out = &picture[static_cast<std::size_t>(3 * ((row * spheres + k) * size + column))];
            out[0] += sum.x / static_cast<float>(samples);
            out[1] += sum.y / static_cast<float>(samples);
            out[2] += sum.z / static_cast<float>(samples);
        }
        std::printf("%s", merlkit_name(&material));
        indirect.print();
        direct.print();
        std::printf("\n");
    }
    std::FILE *file = std::fopen(arguments[1], "wb");
    if (!file) {
        return 1;
    }
    std::fprintf(file, "PF\n%d %d\n-1.0\n", size * spheres, size);
    std::fwrite(picture.data(), sizeof(float), picture.size(), file);
    std::fclose(file);
    for (std::map<std::string, merlkit_table>::iterator m = materials.begin(); m != materials.end(); ++m) {
        merlkit_free(&m->second);
    }
    return 0;
}
