#define MERLKIT_FN
#define MERLKIT_UINT uint
#define MERLKIT_TO_UINT(x) uint(x)
#define MERLKIT_TO_INT(x) int(x)
#define MERLKIT_TO_FLOAT(x) float(x)
#define MERLKIT_SQRT(x) sqrt(x)
#define MERLKIT_ABS(x) abs(x)
#define merlkit_vec3 float3
#define merlkit_v(x, y, z) float3(x, y, z)
