#ifndef MERLKIT_FN
#define MERLKIT_FN static inline
#endif
#ifndef MERLKIT_SQRT
#include <math.h>
#define MERLKIT_SQRT(x) sqrtf(x)
#endif
#ifndef MERLKIT_ABS
#include <math.h>
#define MERLKIT_ABS(x) fabsf(x)
#endif
#include <stdbool.h>
#include <stdint.h>
#define MERLKIT_CONST static const
#define MERLKIT_ARRAY(type) {
#define MERLKIT_ARRAY_END }
#define MERLKIT_UINT uint32_t
#define MERLKIT_TO_UINT(x) ((uint32_t)(x))
#define MERLKIT_TO_INT(x) ((int)(x))
#define MERLKIT_TO_FLOAT(x) ((float)(x))
#define MERLKIT_VALUES const float *values,
typedef struct merlkit_vec3 merlkit_vec3;
typedef struct merlkit_draw merlkit_draw;
typedef struct merlkit_about merlkit_about;
typedef struct merlkit_place merlkit_place;
typedef struct merlkit_segment merlkit_segment;
typedef struct merlkit_bins merlkit_bins;
typedef struct merlkit_pair merlkit_pair;
typedef struct merlkit_cell merlkit_cell;
struct merlkit_vec3 {
    float x, y, z;
};
MERLKIT_FN merlkit_vec3 merlkit_v(float x, float y, float z)
{
    merlkit_vec3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
