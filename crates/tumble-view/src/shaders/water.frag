#version 100
precision mediump float;
varying vec2 place;

void main() {
    float seen = 1.0 - smoothstep(0.35, 1.0, length(place));
    gl_FragColor = vec4(0.16, 0.44, 0.62, 0.42 * seen);
}
