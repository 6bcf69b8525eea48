#version 100
attribute vec2 corner;
varying float height;

void main() {
    height = 0.5 + 0.5 * corner.y;
    gl_Position = vec4(corner, 0.0, 1.0);
}
