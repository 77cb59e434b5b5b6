/* Loads a file of merlkit.h many times, each time damaged in another way, and draws from what is accepted. Compiled with
   sanitizers, it ends at the first read outside of the file and the first undefined operation. Prints how often each status
   came. */
#define MERLKIT_STDIO
#include "merlkit.h"
#include <string.h>

static uint32_t state = 2463534242u;

/* A number below `end`, by Marsaglia's xorshift. */
static uint32_t below(uint32_t end)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state % end;
}

static float fraction(void)
{
    return (float)below(1u << 24) / 16777216.0f;
}

/* Draws and asks; 1 unless all answers are finite and at least 0. */
static int use(const merlkit_table *table)
{
    int bad = 0;
    int i;
    for (i = 0; i < 20; i++) {
        merlkit_vec3 wo = merlkit_v(fraction() - 0.5f, fraction() - 0.5f, fraction() + 1e-4f);
        merlkit_draw draw = merlkit_sample(table, wo, fraction(), fraction());
        merlkit_vec3 f = merlkit_eval(table, wo, draw.wi);
        float pdf = merlkit_pdf(table, wo, merlkit_v(fraction() - 0.5f, fraction() - 0.5f, fraction()));
        bad |= !(draw.pdf >= 0.0f && draw.pdf <= 3.4028234e38f && pdf >= 0.0f && pdf <= 3.4028234e38f);
        bad |= !(f.x >= 0.0f && f.y >= 0.0f && f.z >= 0.0f && draw.wi.z > 0.0f && draw.wi.z < 2.0f);
        bad |= !(f.x <= 3.4028234e38f && f.y <= 3.4028234e38f && f.z <= 3.4028234e38f);
    }
    return bad;
}

/* One flipped bit, one random word, or a word that is a limit of something. */
static uint32_t damaged(uint32_t word)
{
    static const uint32_t limits[] = {0u, 1u, 2u, 79u, 80u, 256u, 257u, 1024u, 1025u, 180u, 360u, 0x7fffffffu, 0xffffffffu,
                                      0x7f800000u, 0x7fc00000u, 0x80000000u, 0x3f800000u, 0xbf800000u};
    switch (below(3u)) {
    case 0u:
        return word ^ 1u << below(32u);
    case 1u:
        return below(0xffffffffu);
    }
    return limits[below(sizeof(limits) / sizeof(limits[0]))];
}

/* Loads; a right table with a wrong checksum is given the right one and loaded again. */
static merlkit_status load(uint32_t *words, size_t length, int *bad)
{
    merlkit_table table;
    merlkit_status status = merlkit_load(words, length, &table);
    if (status == MERLKIT_BAD_CHECKSUM) {
        words[4] = merlkit_checksum(words, words[3]);
        status = merlkit_load(words, length, &table);
    }
    if (status == MERLKIT_OK) {
        *bad += use(&table);
    }
    return status;
}

/* A copy that ends early or has a few bytes more, in memory of just that length, of which `shift` bytes are left out. */
static merlkit_status load_other_length(const uint32_t *words, size_t length, size_t shift, int *bad)
{
    size_t whole = 4u * (size_t)words[3];
    unsigned char *copy = (unsigned char *)malloc(length + 1u);
    merlkit_table table;
    merlkit_status status;
    memset(copy, 1, length + 1u);
    memcpy(copy, words, length < whole ? length : whole);
    status = merlkit_load(copy + shift, length, &table);
    *bad += status == MERLKIT_OK;
    free(copy);
    return status;
}

int main(int count, char **arguments)
{
    unsigned long mutations = count == 3 ? strtoul(arguments[2], NULL, 10) : 0u;
    unsigned long counts[MERLKIT_NO_MEMORY + 1] = {0};
    unsigned long i;
    merlkit_table table;
    uint32_t *words;
    int bad = 0;
    if (!mutations || merlkit_load_file(arguments[1], &table) != MERLKIT_OK) {
        return 1;
    }
    words = (uint32_t *)malloc(4u * (size_t)table.words[3]);
    memcpy(words, table.words, 4u * (size_t)table.words[3]);
    for (i = 0u; i < mutations; i++) {
        size_t whole = 4u * (size_t)words[3];
        uint32_t kind = below(100u);
        if (kind < 20u) {
            /* Mostly short ones, for the time of a copy. */
            size_t length = kind == 0u ? below((uint32_t)whole) : kind == 1u ? whole + below(9u) : below(20000u);
            counts[load_other_length(words, length == whole ? 7u : length, kind == 2u, &bad)] += 1u;
        } else {
            /* Up to three words: of the head, of floats and tables, or of values. */
            uint32_t places[3], before[3], k;
            uint32_t changes = 1u + below(3u);
            uint32_t sum = words[4];
            for (k = 0u; k < changes; k++) {
                uint32_t first = kind < 45u ? 0u : kind < 97u ? 32u : table.values;
                uint32_t end = kind < 23u ? 32u : kind < 45u ? 11u : kind < 65u ? table.cdf : kind < 97u ? table.values : words[3];
                places[k] = first + below(end > first ? end - first : 1u);
                before[k] = words[places[k]];
                words[places[k]] = damaged(before[k]);
            }
            counts[load(words, whole, &bad)] += 1u;
            while (k-- > 0u) {
                words[places[k]] = before[k];
            }
            words[4] = sum;
        }
    }
    for (i = 0u; i <= MERLKIT_NO_MEMORY; i++) {
        printf("%lu\n", counts[i]);
    }
    free(words);
    merlkit_free(&table);
    return bad == 0 ? 0 : 1;
}
