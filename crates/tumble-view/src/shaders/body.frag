#version 100
precision highp float;
varying vec3 facing;
varying vec4 color;
varying vec3 position;
uniform mat4 to_map;
uniform vec3 sun;
uniform vec3 across;
uniform vec3 above;
uniform vec3 sky;
uniform vec3 towards;
uniform highp sampler2D shadows;
// Width of a texel of the shadow map.
uniform float texel;
// Change of depth for each distance on the map where a surface has a slope of 45 degrees.
uniform float steepness;
// Radius of a penumbra on the map to the difference in depth from what casts it.
uniform float softness;
// Depth in the map that two surfaces differ by at least if one shades the other.
uniform float slack;

// Penumbras have radii between these, in texels.
const float NARROWEST = 1.2;
const float WIDEST = 24.0;

// How far behind the surface of the map a place beside the fragment is, in the plane of its surface.
// Depths of the map are those of the middles of texels, in 16 bits; smooth normals are a little off.
float behind(vec3 on_map, vec2 offset, vec2 slope) {
    vec2 there = (floor((on_map.xy + offset) / texel) + 0.5) * texel;
    vec2 off = there - on_map.xy;
    float tolerance = slack + 3e-5 + steepness * (0.3 * texel + 0.15 * length(off));
    return min(on_map.z + dot(slope, off), 1.0) - tolerance - texture2D(shadows, there).r;
}

// How much of the sun is seen: percentage-closer soft shadows (R. Fernando, SIGGRAPH 2005), on a
// spiral of points (H. Vogel, 1979) that is turned from pixel to pixel.
float sunlit(vec3 n) {
    // Place on the map and depth in it, from 0 to 1.
    vec3 on_map = 0.5 + 0.5 * (to_map * vec4(position, 1.0)).xyz;
    vec2 from_middle = abs(2.0 * on_map.xy - 1.0);
    float edge = max(from_middle.x, from_middle.y);
    if (edge >= 1.0) {
        return 1.0;
    }
    vec2 slope = steepness * vec2(dot(n, across), dot(n, above)) / max(dot(n, sun), 0.05);
    // Interleaved gradient noise (J. Jimenez, SIGGRAPH 2014).
    float angle = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec2 first = vec2(cos(angle), sin(angle));
    const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
    vec2 direction = first;
    float gaps = 0.0;
    float blockers = 0.0;
    for (int i = 0; i < 8; i++) {
        float gap = behind(on_map, direction * (WIDEST * texel * sqrt((float(i) + 0.5) / 8.0)), slope);
        blockers += step(0.0, gap);
        gaps += max(gap, 0.0);
        direction = golden * direction;
    }
    float fade = 1.0 - smoothstep(0.97, 1.0, edge);
    if (blockers == 0.0 || blockers == 8.0) {
        return 1.0 - blockers / 8.0 * fade;
    }
    float radius = clamp(softness * gaps / blockers, NARROWEST * texel, WIDEST * texel);
    direction = first;
    float dark = 0.0;
    for (int i = 0; i < 16; i++) {
        dark += step(0.0, behind(on_map, direction * (radius * sqrt((float(i) + 0.5) / 16.0)), slope));
        direction = golden * direction;
    }
    return 1.0 - dark / 16.0 * fade;
}

void main() {
    vec3 n = normalize(facing);
    if (!gl_FrontFacing) {
        n = -n;
    }
    // The camera stands a unit away from the origin.
    vec3 eye = normalize(towards - position);
    // Light from the sky above and from the viewer, a sun, and a little of it mirrored.
    float diffuse = max(0.0, 0.88 * dot(n, sun) + 0.12);
    // What hardly faces the sun shades itself, more and more.
    float seen_of_sun = smoothstep(0.0, 0.2, dot(n, sun));
    if (seen_of_sun > 0.0) {
        seen_of_sun *= sunlit(n);
    }
    float light = 0.22 + 0.12 * dot(n, sky) + 0.08 * max(0.0, dot(n, eye)) + 0.62 * diffuse * seen_of_sun;
    float mirrored = max(0.0, dot(n, normalize(sun + eye)));
    float gloss = 0.03 * pow(mirrored, 8.0) + 0.10 * pow(mirrored, 60.0);
    // Edges that turn away catch light, so that dark bodies stand out from a dark ground.
    float rim = 0.07 * pow(1.0 - max(0.0, dot(n, eye)), 3.0);
    vec3 linear = color.rgb * light + vec3(gloss * seen_of_sun + rim) + max(color.a, 0.0) * vec3(0.10, 0.11, 0.12);
    // Below zero it is the distance at which what has no end is no longer seen.
    float seen = color.a < 0.0 ? 1.0 - smoothstep(0.3, 1.0, length(position) / -color.a) : 1.0;
    gl_FragColor = vec4(pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2)), seen);
}
