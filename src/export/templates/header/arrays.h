// ---- The table ----

#define NAME_TABLES @TABLES@u
#define NAME_ROWS @ROWS@u
#define NAME_SEGMENTS @SEGMENTS@u
#define NAME_FOLD @FOLD@u
#define NAME_NODE_UNIT @NODE_UNIT@f
#define NAME_PER_SEGMENT @PER_SEGMENT@f

// cos(theta_o) of each table.
MERLKIT_CONST float NAME_cosines[@TABLES@] = MERLKIT_ARRAY(float)
@COSINE@MERLKIT_ARRAY_END;

// Caps at the edges of rows: cap = fixed + weight * top.
MERLKIT_CONST float NAME_edges_fixed[@EDGES@] = MERLKIT_ARRAY(float)
@EDGE_FIXED@MERLKIT_ARRAY_END;
MERLKIT_CONST float NAME_edges_weight[@EDGES@] = MERLKIT_ARRAY(float)
@EDGE_WEIGHT@MERLKIT_ARRAY_END;

// Three arrays in words of 32 bits, the first number of each in the lowest bits. [table, row], 16 bits each: probability of
// the rows up to and with this one, in 1/65535. From NAME_SLOPES on [table, row], 8 bits each: slope of the density over the
// cap in 1/128, and 128 more. From NAME_DENSITY on [table, row, node], 16 bits each: density over the azimuth; the trapezoids
// of a row sum to 65534.
#define NAME_CDF 0u
#define NAME_SLOPES @CDF_WORDS@u
#define NAME_DENSITY @DENSITY_FROM@u
#ifndef NAME_WORD
#define NAME_WORD(i) NAME_words[i]
MERLKIT_CONST MERLKIT_UINT NAME_words[@WORDS@] = MERLKIT_ARRAY(MERLKIT_UINT)
@WORD_LINES@MERLKIT_ARRAY_END;
#endif

MERLKIT_FN float NAME_cosine(MERLKIT_UINT i)
{
    return NAME_cosines[i];
}

MERLKIT_FN float NAME_edge_fixed(MERLKIT_UINT i)
{
    return NAME_edges_fixed[i];
}

MERLKIT_FN float NAME_edge_weight(MERLKIT_UINT i)
{
    return NAME_edges_weight[i];
}

