#version 100
precision mediump float;
varying float height;
uniform vec3 below;
uniform vec3 above;

void main() {
    gl_FragColor = vec4(mix(below, above, smoothstep(0.0, 1.0, height)), 1.0);
}
