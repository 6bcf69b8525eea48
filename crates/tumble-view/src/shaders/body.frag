#version 100
precision highp float;
varying vec3 facing;
varying vec4 color;
uniform vec3 sun;
uniform vec3 sky;
uniform vec3 towards;

void main() {
    vec3 n = normalize(facing);
    if (!gl_FrontFacing) {
        n = -n;
    }
    // Light from the sky above, a sun whose edge is soft, and a little of it mirrored.
    float diffuse = max(0.0, 0.9 * dot(n, sun) + 0.1);
    float light = 0.36 + 0.16 * dot(n, sky) + 0.80 * diffuse;
    float gloss = 0.16 * pow(max(0.0, dot(n, normalize(sun + towards))), 36.0);
    // Edges that turn away catch light, so that dark bodies stand out from a dark ground.
    float rim = 0.10 * pow(1.0 - max(0.0, dot(n, towards)), 3.0);
    vec3 linear = color.rgb * light + vec3(gloss + rim) + color.a * vec3(0.10, 0.11, 0.12);
    gl_FragColor = vec4(pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}
