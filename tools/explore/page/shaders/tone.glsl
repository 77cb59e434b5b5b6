#version 300 es
// Linear light on its way to the screen, as the library's PNG pictures: exposure, tone curve, sRGB.
precision highp float;
uniform highp sampler2D light;
uniform float gain;
uniform vec2 scale;
out vec4 colour;

float tone(float x)
{
    return x > 0.5 ? 1.0 - 0.5 * exp(1.0 - 2.0 * x) : max(x, 0.0);
}

float encode(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

void main()
{
    vec3 x = gain * texelFetch(light, ivec2(gl_FragCoord.xy * scale), 0).rgb;
    colour = vec4(encode(tone(x.r)), encode(tone(x.g)), encode(tone(x.b)), 1.0);
}
