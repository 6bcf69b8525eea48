#version 100
attribute vec3 corner;
attribute vec3 normal;
attribute vec3 place;
attribute vec4 turn;
attribute vec3 size;
attribute vec4 paint;
uniform mat4 projection;
varying vec3 facing;
varying vec4 color;
varying vec3 position;

vec3 turned(vec3 v) {
    return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
}

void main() {
    // Normals go with the inverse of what stretches the surface, which must not be zero.
    float largest = max(size.x, max(size.y, size.z));
    facing = turned(normal * largest / max(size, vec3(1e-4 * largest)));
    color = paint;
    position = place + turned(corner * size);
    gl_Position = projection * vec4(position, 1.0);
}
