
// ---- Loading ----

#include <stddef.h>

typedef enum merlkit_status {
    MERLKIT_OK,
    MERLKIT_UNALIGNED,
    MERLKIT_TRUNCATED,
    MERLKIT_FOREIGN,
    MERLKIT_BYTE_ORDER,
    MERLKIT_OTHER_VERSION,
    MERLKIT_BAD_SETTINGS,
    MERLKIT_BAD_LENGTH,
    MERLKIT_BAD_TABLE,
    MERLKIT_BAD_CHECKSUM,
    MERLKIT_BAD_VALUES,
    MERLKIT_UNREADABLE,
    MERLKIT_NO_MEMORY
} merlkit_status;

// What is wrong, and what to do.
static inline const char *merlkit_message(merlkit_status status)
{
    switch (status) {
    case MERLKIT_OK:
        return "the table is loaded";
    case MERLKIT_UNALIGNED:
        return "the bytes are not aligned to 4: read the file into memory from malloc, or map it";
    case MERLKIT_TRUNCATED:
        return "the file is shorter than its header says: copy or export it again";
    case MERLKIT_FOREIGN:
        return "this is not a file of merlkit export --format runtime";
    case MERLKIT_BYTE_ORDER:
        return "the file is little-endian and this machine is not: swap the bytes of its words first";
    case MERLKIT_OTHER_VERSION:
        return "the file has another version than merlkit.h: export both with the same merlkit";
    case MERLKIT_BAD_SETTINGS:
        return "the settings in the header of the file are out of range: export it again";
    case MERLKIT_BAD_LENGTH:
        return "the file is not as long as its settings demand: export it again";
    case MERLKIT_BAD_TABLE:
        return "the table holds probabilities that no table can hold: export it again";
    case MERLKIT_BAD_CHECKSUM:
        return "the file is damaged, as its checksum shows: copy or export it again";
    case MERLKIT_BAD_VALUES:
        return "the file holds values that no material can have: export it again";
    case MERLKIT_UNREADABLE:
        return "the file cannot be opened and read";
    case MERLKIT_NO_MEMORY:
        return "there is not enough memory for the file";
    }
    return "this is no status of merlkit.h";
}

// The first 32 words of a file; `length` is that of the whole file in bytes.
static inline merlkit_status merlkit_check_head(const uint32_t *words, size_t length)
{
    if (length < 128u) {
        return MERLKIT_TRUNCATED;
    }
    if (words[0] == 0x6d65726cu && words[1] == 0x6b697400u) {
        return MERLKIT_BYTE_ORDER;
    }
    if (words[0] != 0x6c72656du || words[1] != 0x0074696bu) {
        return MERLKIT_FOREIGN;
    }
    if (words[2] != 1u) {
        return MERLKIT_OTHER_VERSION;
    }
    if (words[5] < 1u || words[5] > 1024u || words[6] < 2u || words[6] > 79u || words[7] < 1u || words[7] > 256u
        || words[8] > 1u || words[9] > 2u || (words[10] != 180u && words[10] != 360u) || words[11] > 1u
        || words[31] >> 24u != 0u) {
        return MERLKIT_BAD_SETTINGS;
    }
    return MERLKIT_OK;
}

// Cosines fall from 1 and stay above 0.
static inline bool merlkit_cosines_fall(const merlkit_table *table)
{
    float above = 2.0f;
    uint32_t i;
    for (i = 0u; i < table->tables; i++) {
        float cosine = merlkit_table_cosine(table, i);
        if (!(cosine > 0.0f && cosine < above && (i > 0u || (cosine >= 1.0f && cosine <= 1.0f)))) {
            return false;
        }
        above = cosine;
    }
    return true;
}

// Edges of rows rise for every wo. They are linear in the cap of the largest theta_h, so its least and largest are enough.
static inline bool merlkit_edges_rise(const merlkit_table *table)
{
    int end;
    for (end = 0; end < 2; end++) {
        float top = end == 0 ? 0.14644661f : 0.5f;
        float below = -1.0f;
        uint32_t i;
        for (i = 0u; i <= table->rows; i++) {
            float cap = merlkit_table_edge_fixed(table, i) + merlkit_table_edge_weight(table, i) * top;
            if (!(cap >= 0.0f && cap > below && cap <= 0.5f)) {
                return false;
            }
            below = cap;
        }
    }
    return true;
}

// In each table the probabilities rise from above 0 to 1 and slopes are within 122/128.
static inline bool merlkit_rows_rise(const merlkit_table *table)
{
    uint32_t below = 0u;
    uint32_t i;
    for (i = 0u; i < table->tables * table->rows; i++) {
        uint32_t to = merlkit_table_u16(table, table->cdf, i);
        uint32_t slope = merlkit_table_u8(table, table->slopes, i);
        bool last = (i + 1u) % table->rows == 0u;
        if (to <= below || (last && to != 65535u) || slope < 6u || slope > 250u) {
            return false;
        }
        below = last ? 0u : to;
    }
    return true;
}

// Nodes are above 0 and the trapezoids of each row sum to 65534.
static inline bool merlkit_nodes_sum(const merlkit_table *table)
{
    uint32_t row;
    for (row = 0u; row < table->tables * table->rows; row++) {
        uint32_t first = row * (table->segments + 1u);
        uint32_t sum = 0u;
        uint32_t i;
        for (i = 0u; i <= table->segments; i++) {
            uint32_t node = merlkit_table_u16(table, table->density, first + i);
            if (node == 0u) {
                return false;
            }
            sum += i == 0u || i == table->segments ? node : 2u * node;
        }
        if (sum != 65534u) {
            return false;
        }
    }
    return true;
}

// Every value is finite and at least 0, or -1 where nothing was measured. Between bins, that holds for whole cells.
static inline bool merlkit_values_hold(const merlkit_table *table, uint32_t end)
{
    const uint32_t missing = 0xbf800000u;
    uint32_t i;
    for (i = table->values; i < end; i += 3u) {
        uint32_t r = table->words[i];
        uint32_t g = table->words[i + 1u];
        uint32_t b = table->words[i + 2u];
        if ((r >= 0x7f800000u && r != missing) || (g >= 0x7f800000u && g != missing)
            || (b >= 0x7f800000u && b != missing)) {
            return false;
        }
        if (table->rule != 0u && ((r == missing) != (g == missing) || (r == missing) != (b == missing))) {
            return false;
        }
    }
    return true;
}

// FNV-1a of the words behind the checksum.
static inline uint32_t merlkit_checksum(const uint32_t *words, uint32_t count)
{
    uint32_t sum = 2166136261u;
    uint32_t i;
    for (i = 5u; i < count; i++) {
        sum = (sum ^ words[i]) * 16777619u;
    }
    return sum;
}

// A table from the bytes of its file, which must be aligned to 4 and outlive it. Unless it returns MERLKIT_OK, the table must
// not be used.
static inline merlkit_status merlkit_load(const void *bytes, size_t length, merlkit_table *table)
{
    const uint32_t *words = (const uint32_t *)bytes;
    merlkit_status status;
    uint32_t count;
    if ((uintptr_t)bytes % 4u != 0u) {
        return MERLKIT_UNALIGNED;
    }
    status = merlkit_check_head(words, length);
    if (status != MERLKIT_OK) {
        return status;
    }
    *table = merlkit_open(words);
    count = table->values + 3u * 90u * 90u * words[10];
    if (words[3] != count) {
        return MERLKIT_BAD_LENGTH;
    }
    if (length != 4u * (size_t)count) {
        return length < 4u * (size_t)count ? MERLKIT_TRUNCATED : MERLKIT_BAD_LENGTH;
    }
    if (!merlkit_cosines_fall(table) || !merlkit_edges_rise(table) || !merlkit_rows_rise(table)
        || !merlkit_nodes_sum(table)) {
        return MERLKIT_BAD_TABLE;
    }
    if (merlkit_checksum(words, count) != words[4]) {
        return MERLKIT_BAD_CHECKSUM;
    }
    return merlkit_values_hold(table, count) ? MERLKIT_OK : MERLKIT_BAD_VALUES;
}

// The name of the material in UTF-8, cut to 47 bytes. It lies in the file.
static inline const char *merlkit_name(const merlkit_table *table)
{
    return (const char *)(table->words + 20);
}

#ifdef MERLKIT_STDIO
#include <stdio.h>
#include <stdlib.h>
// A table from a file, in memory of its own: give it to merlkit_free at the end, if MERLKIT_OK was returned.
static inline merlkit_status merlkit_load_file(const char *path, merlkit_table *table)
{
    uint32_t head[32];
    uint32_t *words = NULL;
    merlkit_status status = MERLKIT_UNREADABLE;
    FILE *file = fopen(path, "rb");
    if (!file) {
        return status;
    }
    status = merlkit_check_head(head, fread(head, 1, sizeof(head), file));
    if (status == MERLKIT_OK) {
        // One byte more than the header says, to see that the file ends there.
        size_t length = 4u * (size_t)head[3];
        merlkit_table opened = merlkit_open(head);
        status = MERLKIT_BAD_LENGTH;
        if (head[3] == opened.values + 3u * 90u * 90u * head[10]) {
            words = (uint32_t *)malloc(length + 1u);
            status = MERLKIT_NO_MEMORY;
        }
        if (words) {
            rewind(file);
            status = merlkit_load(words, fread(words, 1, length + 1u, file), table);
        }
    }
    fclose(file);
    if (status != MERLKIT_OK) {
        free(words);
    }
    return status;
}

static inline void merlkit_free(merlkit_table *table)
{
    free((void *)table->words);
    table->words = NULL;
}
#endif

#endif // MERLKIT_H
