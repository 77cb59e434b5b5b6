/* Answers questions about MATERIAL, whose header is HEADER, with the values in the file named: reads wo, u and a direction w,
   eight floats each, and writes the draw, its density, the density of w and its value, eight floats each. */
#define MERLKIT_STDIO
#include HEADER
#define JOINED(a, b) a##b
#define OF(material, function) JOINED(material, function)

int main(int count, char **arguments)
{
    float *values = count == 2 ? OF(MATERIAL, _load)(arguments[1]) : NULL;
    float in[8];
    if (!values) {
        return 1;
    }
    while (fread(in, sizeof(float), 8, stdin) == 8) {
        merlkit_vec3 wo = merlkit_v(in[0], in[1], in[2]);
        merlkit_vec3 w = merlkit_v(in[5], in[6], in[7]);
        merlkit_draw draw = OF(MATERIAL, _sample)(wo, in[3], in[4]);
        merlkit_vec3 f = OF(MATERIAL, _eval)(values, wo, w);
        float out[8];
        out[0] = draw.wi.x;
        out[1] = draw.wi.y;
        out[2] = draw.wi.z;
        out[3] = draw.pdf;
        out[4] = OF(MATERIAL, _pdf)(wo, w);
        out[5] = f.x;
        out[6] = f.y;
        out[7] = f.z;
        if (fwrite(out, sizeof(float), 8, stdout) != 8) {
            return 1;
        }
    }
    free(values);
    return 0;
}
