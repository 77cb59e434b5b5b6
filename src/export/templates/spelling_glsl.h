#ifdef GL_ES
precision highp float;
precision highp int;
#endif
#define MERLKIT_GLSL 1
#define MERLKIT_FN
#define MERLKIT_CONST const
#define MERLKIT_ARRAY(type) type[](
#define MERLKIT_ARRAY_END )
#define MERLKIT_UINT uint
#define MERLKIT_TO_UINT(x) uint(x)
#define MERLKIT_TO_INT(x) int(x)
#define MERLKIT_TO_FLOAT(x) float(x)
#define MERLKIT_SQRT(x) sqrt(x)
#define MERLKIT_ABS(x) abs(x)
#define MERLKIT_VALUES
#define merlkit_vec3 vec3
#define merlkit_v(x, y, z) vec3(x, y, z)
