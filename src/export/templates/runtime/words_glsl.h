#ifndef MERLKIT_WORD
uniform highp usampler2D merlkit_words;
#define MERLKIT_WORD(i) merlkit_texel(i)
uint merlkit_texel(uint i)
{
    return texelFetch(merlkit_words, ivec2(int(i % @TEXELS@u), int(i / @TEXELS@u)), 0).r;
}
#endif
#define MERLKIT_BITS(x) uintBitsToFloat(x)

