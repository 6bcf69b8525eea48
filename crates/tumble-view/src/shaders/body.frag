#version 100
precision highp float;
varying vec3 facing;
varying vec4 color;
varying vec3 position;
uniform vec3 sun;
uniform vec3 sky;
uniform vec3 towards;

void main() {
    vec3 n = normalize(facing);
    if (!gl_FrontFacing) {
        n = -n;
    }
    // The camera stands a unit away from the origin.
    vec3 eye = normalize(towards - position);
    // Light from the sky above, a sun whose edge is soft, and a little of it mirrored.
    float diffuse = max(0.0, 0.88 * dot(n, sun) + 0.12);
    float light = 0.24 + 0.12 * dot(n, sky) + 0.66 * diffuse;
    float mirrored = max(0.0, dot(n, normalize(sun + eye)));
    float gloss = 0.03 * pow(mirrored, 8.0) + 0.10 * pow(mirrored, 60.0);
    // Edges that turn away catch light, so that dark bodies stand out from a dark ground.
    float rim = 0.07 * pow(1.0 - max(0.0, dot(n, eye)), 3.0);
    vec3 linear = color.rgb * light + vec3(gloss + rim) + max(color.a, 0.0) * vec3(0.10, 0.11, 0.12);
    // Below zero it is the distance at which what has no end is no longer seen.
    float seen = color.a < 0.0 ? 1.0 - smoothstep(0.3, 1.0, length(position) / -color.a) : 1.0;
    gl_FragColor = vec4(pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2)), seen);
}
