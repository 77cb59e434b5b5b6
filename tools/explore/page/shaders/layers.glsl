#version 300 es
// Layers with one solid each, the nearest on top: it lets some of the next one through. The farthest hides the paper.
precision highp float;
uniform highp sampler2D colour0;
uniform highp sampler2D colour1;
uniform highp sampler2D colour2;
uniform highp sampler2D depth0;
uniform highp sampler2D depth1;
uniform highp sampler2D depth2;
uniform vec3 paper;
uniform int fineness;
uniform int count;
out vec4 painted;

// What a solid hides of those behind it.
const float OPACITY = 0.62;

// Puts the farther of two layers first; their depths are in the fourth member.
void sort_pair(inout vec4 far, inout vec4 near)
{
    if (far.w < near.w) {
        vec4 swapped = far;
        far = near;
        near = swapped;
    }
}

// Puts a layer over what is behind it. A depth of 1 is that of no solid.
vec3 cover(vec3 behind, vec4 layer, bool is_first)
{
    if (layer.w >= 1.0) {
        return behind;
    }
    return is_first ? layer.rgb : mix(behind, layer.rgb, OPACITY);
}

vec3 blend(ivec2 texel)
{
    vec4 a = vec4(texelFetch(colour0, texel, 0).rgb, texelFetch(depth0, texel, 0).r);
    vec4 b = vec4(texelFetch(colour1, texel, 0).rgb, texelFetch(depth1, texel, 0).r);
    vec4 c = vec4(texelFetch(colour2, texel, 0).rgb, texelFetch(depth2, texel, 0).r);
    b.w = count > 1 ? b.w : 1.0;
    c.w = count > 2 ? c.w : 1.0;
    sort_pair(a, b);
    sort_pair(b, c);
    sort_pair(a, b);
    vec3 light = cover(paper, a, true);
    light = cover(light, b, a.w >= 1.0);
    return cover(light, c, b.w >= 1.0);
}

void main()
{
    ivec2 corner = ivec2(gl_FragCoord.xy) * fineness;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < fineness; y++) {
        for (int x = 0; x < fineness; x++) {
            sum += blend(corner + ivec2(x, y));
        }
    }
    painted = vec4(sum / float(fineness * fineness), 1.0);
}
