/* Answers questions about the file named, by HEADER: reads wo, u and a direction w, eight floats each, and writes the draw, its
   density, the density of w and its value, eight floats each. */
#define MERLKIT_STDIO
#include HEADER

int main(int count, char **arguments)
{
    merlkit_table table;
    merlkit_status status = count == 2 ? merlkit_load_file(arguments[1], &table) : MERLKIT_UNREADABLE;
    float in[8];
    if (status != MERLKIT_OK) {
        fprintf(stderr, "%d: %s\n", (int)status, merlkit_message(status));
        return 1;
    }
    while (fread(in, sizeof(float), 8, stdin) == 8) {
        merlkit_vec3 wo = merlkit_v(in[0], in[1], in[2]);
        merlkit_vec3 w = merlkit_v(in[5], in[6], in[7]);
        merlkit_draw draw = merlkit_sample(&table, wo, in[3], in[4]);
        merlkit_vec3 f = merlkit_eval(&table, wo, w);
        float out[8];
        out[0] = draw.wi.x;
        out[1] = draw.wi.y;
        out[2] = draw.wi.z;
        out[3] = draw.pdf;
        out[4] = merlkit_pdf(&table, wo, w);
        out[5] = f.x;
        out[6] = f.y;
        out[7] = f.z;
        if (fwrite(out, sizeof(float), 8, stdout) != 8) {
            return 1;
        }
    }
    merlkit_free(&table);
    return 0;
}
