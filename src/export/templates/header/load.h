
#if defined(MERLKIT_STDIO) && !defined(MERLKIT_GLSL)
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define NAME_FLOATS (3u * 90u * 90u * @PHI_BINS@u)
// The values of NAME_eval from a file, to be given to free(); NULL if it can't be read or is not as long as it must be.
MERLKIT_FN float *NAME_load(const char *path)
{
    unsigned char *bytes = (unsigned char *)malloc(4u * NAME_FLOATS + 1u);
    float *values = (float *)malloc(4u * NAME_FLOATS);
    FILE *file = fopen(path, "rb");
    size_t found = bytes && values && file ? fread(bytes, 1, 4u * NAME_FLOATS + 1u, file) : 0u;
    size_t i;
    if (file) {
        fclose(file);
    }
    if (found != 4u * NAME_FLOATS) {
        free(values);
        values = NULL;
    }
    for (i = 0u; values && i < NAME_FLOATS; i++) {
        const unsigned char *four = bytes + 4u * i;
        uint32_t word = (uint32_t)four[0] | (uint32_t)four[1] << 8 | (uint32_t)four[2] << 16 | (uint32_t)four[3] << 24;
        memcpy(values + i, &word, 4u);
    }
    free(bytes);
    return values;
}
#endif
