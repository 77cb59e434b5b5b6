#define MERLKIT_WORD(i) table->words[i]
#ifndef MERLKIT_BITS
#define MERLKIT_BITS(x) merlkit_bits(x)
#ifndef __GNUC__
#include <string.h>
#endif
// The float with these bits.
MERLKIT_FN float merlkit_bits(uint32_t word)
{
#ifdef __CUDA_ARCH__
    return __uint_as_float(word);
#else
    float value;
#ifdef __GNUC__
    __builtin_memcpy(&value, &word, sizeof(value));
#else
    memcpy(&value, &word, sizeof(value));
#endif
    return value;
#endif
}
#endif
typedef struct merlkit_table merlkit_table;

