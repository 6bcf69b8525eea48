#version 100
attribute vec2 corner;
uniform mat4 projection;
uniform vec3 middle;
uniform vec3 along;
uniform vec3 across;
varying vec2 place;

void main() {
    place = corner;
    gl_Position = projection * vec4(middle + corner.x * along + corner.y * across, 1.0);
}
