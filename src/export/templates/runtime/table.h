// ---- The table: docs/export.md of merlkit describes its file ----

// Settings of a table, and the words of its file at which its arrays begin.
struct merlkit_table {
@WORDS_MEMBER@    MERLKIT_UINT tables;
    MERLKIT_UINT rows;
    MERLKIT_UINT segments;
    MERLKIT_UINT fold;
    MERLKIT_UINT rule;
    int phi_bins;
    MERLKIT_UINT cosines;
    MERLKIT_UINT edges_fixed;
    MERLKIT_UINT edges_weight;
    MERLKIT_UINT cdf;
    MERLKIT_UINT slopes;
    MERLKIT_UINT density;
    MERLKIT_UINT values;
    float node_unit;
    float per_segment;
    float offset;
};

@OPEN_COMMENT@
MERLKIT_FN merlkit_table merlkit_open(@OPEN_PARAMETER@)
{
    merlkit_table table;
@SET_WORDS@    table.tables = @WORD_5@;
    table.rows = @WORD_6@;
    table.segments = @WORD_7@;
    table.fold = @WORD_8@;
    table.rule = @WORD_9@;
    table.phi_bins = MERLKIT_TO_INT(@WORD_10@);
    MERLKIT_UINT rows = table.tables * table.rows;
    MERLKIT_UINT nodes = rows * (table.segments + 1u);
    table.cosines = @FIRST@32u;
    table.edges_fixed = table.cosines + table.tables;
    table.edges_weight = table.edges_fixed + table.rows + 1u;
    table.cdf = table.edges_weight + table.rows + 1u;
    table.slopes = table.cdf + ((rows + 1u) >> 1u);
    table.density = table.slopes + ((rows + 3u) >> 2u);
    table.values = table.density + ((nodes + 1u) >> 1u);
    float segments = MERLKIT_TO_FLOAT(table.segments);
    table.node_unit = 0.5f * (2.0f * segments * @NODE_UNIT@f);
    table.per_segment = 1.0f / segments;
    table.offset = merlkit_pick(table.rule == 2u, 0.5f, 0.0f);
    return table;
}

MERLKIT_FN float NAME_cosine(@TABLE@MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(@T@cosines + i));
}

MERLKIT_FN float NAME_edge_fixed(@TABLE@MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(@T@edges_fixed + i));
}

MERLKIT_FN float NAME_edge_weight(@TABLE@MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(@T@edges_weight + i));
}

MERLKIT_FN float NAME_value(@TABLE@int i)
{
    return MERLKIT_BITS(MERLKIT_WORD(@T@values + MERLKIT_TO_UINT(i)));
}

