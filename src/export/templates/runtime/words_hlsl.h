#ifndef MERLKIT_WORD
StructuredBuffer<uint> merlkit_words;
#define MERLKIT_WORD(i) merlkit_words[i]
#endif
#define MERLKIT_BITS(x) asfloat(x)

