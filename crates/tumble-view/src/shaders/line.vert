#version 100
// A corner of the line's strip: which end, 0 or 1, and which side, -1 or 1.
attribute vec2 corner;
attribute vec3 start;
attribute vec3 end;
attribute vec4 start_color;
attribute vec4 end_color;
attribute float width;
uniform mat4 projection;
uniform vec2 viewport;
uniform float near;
uniform float fade;
varying vec4 color;

// The part of the line that is in front of the camera.
vec4 clipped(vec4 a, vec4 b) {
    return a.w < near ? mix(a, b, clamp((near - a.w) / max(b.w - a.w, 1e-9), 0.0, 1.0)) : a;
}

void main() {
    vec4 a = projection * vec4(start, 1.0);
    vec4 b = projection * vec4(end, 1.0);
    vec4 from = clipped(a, b);
    vec4 to = clipped(b, a);
    vec2 along = (to.xy / to.w - from.xy / from.w) * viewport;
    float size = length(along);
    vec2 across = size > 1e-6 ? vec2(-along.y, along.x) / size : vec2(1.0, 0.0);
    vec4 here = corner.x < 0.5 ? from : to;
    here.xy += across * corner.y * width / viewport * here.w;
    // Lines on a surface are to be seen.
    here.z -= 0.0004 * here.w;
    color = corner.x < 0.5 ? start_color : end_color;
    color.a *= fade;
    gl_Position = here;
}
