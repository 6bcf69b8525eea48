#version 100
attribute vec3 corner;
attribute vec3 place;
attribute vec4 turn;
attribute vec3 size;
uniform mat4 to_map;

vec3 turned(vec3 v) {
    return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v);
}

void main() {
    gl_Position = to_map * vec4(place + turned(corner * size), 1.0);
    // What is before or behind the map shades what is on it, or nothing.
    gl_Position.z = clamp(gl_Position.z, -1.0, 1.0);
}
