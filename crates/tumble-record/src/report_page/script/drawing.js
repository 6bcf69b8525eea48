// ---- Graphics card ----

const BODY_VERTEX = `#version 300 es
  layout(location = 0) in vec3 corner;
  layout(location = 1) in vec3 normal;
  layout(location = 2) in vec3 place;
  layout(location = 3) in vec4 turn;
  layout(location = 4) in vec3 size;
  layout(location = 5) in vec3 color;
  uniform mat4 projection;
  uniform int before;
  out vec3 facing;
  out vec3 paint;
  out vec3 position;
  flat out int number;
  vec3 turned(vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }
  void main() {
    // Normals go with the inverse of what stretches the surface, which must not be zero.
    facing = turned(normal / max(size, 1e-4 * max(size.x, max(size.y, size.z))));
    paint = color;
    number = before + gl_InstanceID + 1;
    position = place + turned(corner * size);
    gl_Position = projection * vec4(position, 1.0);
  }`;
// Shadows are soft by sixteen points of a spiral (H. Vogel, 1979) that is turned from pixel to pixel (interleaved gradient
// noise, J. Jimenez, SIGGRAPH 2014).
const BODY_FRAGMENT = `#version 300 es
  precision highp float;
  in vec3 facing;
  in vec3 paint;
  in vec3 position;
  uniform vec3 sun;
  uniform vec3 sky;
  uniform mat4 to_map;
  // Widths of a texel: in the units of the place, and on the map; the first is zero where there are no shadows.
  uniform vec2 texel;
  uniform float penumbra;
  uniform highp sampler2DShadow shadows;
  out vec4 result;
  float sunlit(vec3 n) {
    float facing_sun = dot(n, sun);
    if (texel.x == 0.0 || facing_sun <= 0.0) return 1.0;
    // So far off the surface that it does not shade itself within the soft edge.
    float off = texel.x * (1.0 + penumbra * sqrt(1.0 - facing_sun * facing_sun));
    vec3 at = 0.5 + 0.5 * (to_map * vec4(position + off * n, 1.0)).xyz;
    vec2 from_middle = abs(2.0 * at.xy - 1.0);
    float edge = max(from_middle.x, from_middle.y);
    if (edge >= 1.0) return 1.0;
    float angle = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec2 direction = vec2(cos(angle), sin(angle));
    const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
    float seen = 0.0;
    for (int i = 0; i < 16; i += 1) {
      float away = penumbra * texel.y * sqrt((float(i) + 0.5) / 16.0);
      seen += texture(shadows, vec3(at.xy + away * direction, min(at.z, 1.0)));
      direction = golden * direction;
    }
    return mix(seen / 16.0, 1.0, smoothstep(0.94, 1.0, edge));
  }
  void main() {
    vec3 n = normalize(facing) * (gl_FrontFacing ? 1.0 : -1.0);
    float light = 0.36 + 0.20 * dot(n, sky) + 0.80 * max(0.0, dot(n, sun)) * sunlit(n);
    result = vec4(pow(paint * light, vec3(1.0 / 2.2)), 1.0);
  }`;
const LINE_VERTEX = `#version 300 es
  layout(location = 0) in vec3 corner;
  uniform mat4 projection;
  uniform vec3 up;
  out vec3 aside;
  void main() {
    aside = corner - up * dot(corner, up);
    gl_Position = projection * vec4(corner, 1.0);
  }`;
const LINE_FRAGMENT = `#version 300 es
  precision highp float;
  in vec3 aside;
  uniform vec4 paint;
  // How far from the target lines end [its unit], or zero where they do not fade.
  uniform float end;
  out vec4 result;
  void main() { result = paint * (end > 0.0 ? 1.0 - smoothstep(0.25 * end, end, length(aside)) : 1.0); }`;
const SHADOW_FRAGMENT = `#version 300 es
  void main() {}`;
// The number of an instance, from one on, in the colour.
const PICK_FRAGMENT = `#version 300 es
  precision highp float;
  flat in int number;
  out vec4 result;
  void main() { result = vec4(ivec3(number, number >> 8, number >> 16) & 255, 255) / 255.0; }`;

function program(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

function buffer(target, data, usage) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, data, usage);
  return made;
}

function attribute(location, size, type, stride, offset, instanced) {
  gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(location, size, type, type === gl.BYTE, stride, offset);
  gl.vertexAttribDivisor(location, instanced ? 1 : 0);
}

// A place and a rotation, then a size and a colour: numbers of an instance.
const INSTANCE = 13;

// Bodies of one surface: all that have it, and those of them that are drawn as it is now.
function group({ positions, normals, indices }, bodies, most) {
  const layout = gl.createVertexArray();
  gl.bindVertexArray(layout);
  buffer(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
  attribute(0, 3, gl.FLOAT, 0, 0, false);
  buffer(gl.ARRAY_BUFFER, normals, gl.STATIC_DRAW);
  attribute(1, 3, gl.BYTE, 4, 0, false);
  buffer(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  const instances = new Float32Array(INSTANCE * most);
  const numbers = buffer(gl.ARRAY_BUFFER, instances.byteLength, gl.DYNAMIC_DRAW);
  [[2, 3, 0], [3, 4, 12], [4, 3, 28], [5, 3, 40]].forEach(([location, size, offset]) => {
    attribute(location, size, gl.FLOAT, 4 * INSTANCE, offset, true);
  });
  const type = indices instanceof Uint32Array ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
  return { layout, bodies, drawn: [], instances, numbers, corners: indices.length, type };
}

function decoded({ positions, normals, indices, wide }) {
  const numbers = bytes(indices);
  return { positions: bytes(positions), normals: bytes(normals), indices: wide ? new Uint32Array(numbers) : new Uint16Array(numbers) };
}

// For what is too small to tell its shape, of a crowd.
function octahedron() {
  const ends = [0, 1, 2].flatMap((i) => [1, -1].map((side) => [0, 1, 2].map((k) => (k === i ? side : 0))));
  const sides = [0, 1].flatMap((x) => [2, 3].flatMap((y) => [4, 5].flatMap((z) => ((x + y + z) % 2 === 0 ? [x, y, z] : [y, x, z]))));
  return {
    positions: new Float32Array(ends.flat()),
    normals: new Int8Array(ends.flatMap((end) => [...end.map((part) => 127 * part), 0])),
    indices: new Uint16Array(sides),
  };
}

const bodyProgram = program(BODY_VERTEX, BODY_FRAGMENT);
const lineProgram = program(LINE_VERTEX, LINE_FRAGMENT);
const pickProgram = program(BODY_VERTEX, PICK_FRAGMENT);
const shadowProgram = program(BODY_VERTEX, SHADOW_FRAGMENT);
const bodiesOf = run.surfaces.map(() => []);
all.forEach((body) => bodiesOf[run.bodies[body].surface].push(body));
const groups = run.surfaces.map((surface, index) => group(decoded(surface), bodiesOf[index], bodiesOf[index].length));
const triangles = groups.reduce((sum, each) => sum + each.corners * each.bodies.length / 3, 0);
// More triangles than this are too many to draw in each frame.
const far = triangles > 3e5 ? group(octahedron(), [], bodyCount) : undefined;
if (far) groups.push(far);
// Half the size up to which a body is drawn without its shape [pixels], and triangles that are worth it.
const TOO_SMALL = 8;
const MANY = 32;

const lines = gl.createVertexArray();
gl.bindVertexArray(lines);
const lineCorners = buffer(gl.ARRAY_BUFFER, 4 * 3 * 4 * 64, gl.DYNAMIC_DRAW);
attribute(0, 3, gl.FLOAT, 0, 0, false);

// How far from the target the grid reaches [the camera's unit].
const GRID = 6;

// A horizontal grid below the whole path, its lines a round number of metres apart.
function grid() {
  // Where the view follows what moves, the lines stay as far apart as they are.
  const size = (element('follow').value === 'motion' ? usualRadius : camera.unit) / 4;
  const power = 10 ** Math.floor(Math.log10(size));
  const apart = power * [1, 2, 5].reduce((best, step) => (step * power <= size ? step : best), 1);
  const half = Math.min(100, Math.ceil(GRID * camera.unit / apart)) * apart;
  const center = camera.target.map((value) => Math.round(value / apart) * apart);
  const corners = [];
  const put = (along, across) => {
    const point = [0, 0, 0];
    point[axis] = bottom;
    point[first] = center[first] + along;
    point[second] = center[second] + across;
    corners.push(...point.map((value, i) => (value - camera.target[i]) / camera.unit));
  };
  for (let at = -half; at <= half * 1.0001; at += apart) {
    put(at, -half); put(at, half);
    put(-half, at); put(half, at);
  }
  return new Float32Array(corners);
}

// Corners of lines or triangles, in a colour that is multiplied with its opacity; they fade towards an end.
function drawPlain(view, kind, corners, paint, end) {
  gl.useProgram(lineProgram);
  gl.uniformMatrix4fv(gl.getUniformLocation(lineProgram, 'projection'), false, view.matrix);
  gl.uniform4fv(gl.getUniformLocation(lineProgram, 'paint'), paint);
  gl.uniform3fv(gl.getUniformLocation(lineProgram, 'up'), up);
  gl.uniform1f(gl.getUniformLocation(lineProgram, 'end'), end);
  gl.bindVertexArray(lines);
  gl.bindBuffer(gl.ARRAY_BUFFER, lineCorners);
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.drawArrays(kind, 0, corners.length / 3);
  gl.disable(gl.BLEND);
}

// From the target and in the camera's unit.
function anchor(joint, end) {
  const body = joint.bodies[end];
  const [x, y, z, w] = [0, 1, 2, 3].map((i) => placed.rotations[4 * body + i]);
  const arm = joint.anchors[end];
  const bent = cross([x, y, z], cross([x, y, z], arm).map((part, i) => part + w * arm[i]));
  return arm.map((part, i) => (placed.positions[3 * body + i] + part + 2 * bent[i] - camera.target[i]) / camera.unit);
}

// Of joints that hold: a mark at the anchor, and of ropes and rods a band from anchor to anchor.
function jointCorners(view) {
  const pixel = metresOfPixel() / camera.unit;
  const corners = [];
  const quad = (a, b, c, d) => corners.push(...a, ...b, ...c, ...a, ...c, ...d);
  const add = (point, along, by) => point.map((part, i) => part + by * along[i]);
  for (const joint of run.joints) {
    if (joint.until !== null && now >= joint.until) continue;
    const [from, to] = [anchor(joint, 0), anchor(joint, 1)];
    const size = 3.5 * pixel;
    quad(add(to, view.right, size), add(to, view.above, size), add(to, view.right, -size), add(to, view.above, -size));
    if (!joint.line) continue;
    const side = cross(add(to, from, -1), view.towards);
    const half = pixel / (Math.hypot(...side) || 1);
    quad(add(from, side, half), add(to, side, half), add(to, side, -half), add(from, side, -half));
  }
  return new Float32Array(corners);
}

// Joints are mostly inside bodies, and are seen through them.
function drawJoints(view) {
  if (run.joints.length === 0) return;
  gl.disable(gl.DEPTH_TEST);
  drawPlain(view, gl.TRIANGLES, jointCorners(view), [0.85, 0.3, 0.1, 1], 0);
  gl.enable(gl.DEPTH_TEST);
}

// Infinite ground is not seen from below, so that walls on this side do not hide what is between them.
function isHidden(body, eye) {
  if (!run.bodies[body].one_sided) return false;
  const [x, y, z, w] = [0, 1, 2, 3].map((i) => placed.rotations[4 * body + i]);
  const normal = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)];
  return dot(normal, eye.map((value, i) => value - placed.positions[3 * body + i])) <= 0;
}

// The infinite ground, where it is alone, is drawn as far as bodies get.
const grounds = all.filter((body) => run.bodies[body].one_sided);
const groundReach = grounds.length === 1 ? Math.hypot(...positionOf(0, grounds[0]).map((value, i) => value - wholePath.middle[i])) + 3 * wholePath.radius : 0;

function put(to, body, size) {
  const at = INSTANCE * to.drawn.length;
  to.drawn.push(body);
  for (let i = 0; i < 3; i += 1) {
    to.instances[at + i] = (placed.positions[3 * body + i] - camera.target[i]) / camera.unit;
    to.instances[at + 7 + i] = size(i) / camera.unit;
    // What was picked is drawn lighter.
    const color = run.colors[run.bodies[body].color][i];
    to.instances[at + 10 + i] = body === picked ? 0.5 + 0.5 * color : color;
  }
  for (let i = 0; i < 4; i += 1) to.instances[at + 3 + i] = placed.rotations[4 * body + i];
}

// Places the bodies of all groups as they are seen from a place; returns a box along the light around those that cast
// shadows.
function fill(eye, towards) {
  // What would be smaller than this on the screen is drawn as large, so that planets are seen beside their orbits.
  const pixel = metresOfPixel();
  const away = camera.unit * camera.distance;
  const box = emptyBox();
  for (const each of groups) each.drawn.length = 0;
  for (const each of groups) {
    for (const body of each.bodies) {
      const { scale, one_sided: isGround, surface } = run.bodies[body];
      const from = [0, 1, 2].map((i) => placed.positions[3 * body + i]);
      const depth = dot(towards, eye.map((value, i) => value - from[i]));
      const least = isGround ? groundReach : SMALLEST * pixel;
      const enlarged = isHidden(body, eye) ? 0 : Math.max(1, least / reach[body]);
      const radius = enlarged * reach[body];
      const seen = radius / pixel * away / Math.max(depth, 0.02 * away);
      if (!isGround) include(box, from.map((value, i) => (value - camera.target[i]) / camera.unit), radius / camera.unit);
      if (far && seen < TOO_SMALL && each.corners > 3 * MANY) {
        const [low, high] = run.surfaces[surface].box;
        put(far, body, (i) => enlarged * scale[i] * (high[i] - low[i]) / 2);
      } else put(each, body, (i) => enlarged * scale[i]);
    }
  }
  return box;
}

// With one of the programs for bodies, which are numbered through all groups.
function drawGroups(matrix, use, isDrawn = () => true) {
  gl.useProgram(use);
  gl.uniformMatrix4fv(gl.getUniformLocation(use, 'projection'), false, matrix);
  let before = 0;
  for (const { layout, corners, type, drawn } of groups.filter((each) => each.drawn.length > 0)) {
    gl.uniform1i(gl.getUniformLocation(use, 'before'), before);
    gl.bindVertexArray(layout);
    if (isDrawn(drawn[0])) gl.drawElementsInstanced(gl.TRIANGLES, corners, type, 0, drawn.length);
    before += drawn.length;
  }
}

// The shadow map, of all but infinite ground.
function drawShadows(map) {
  gl.bindFramebuffer(gl.FRAMEBUFFER, shadowMap.target);
  gl.viewport(0, 0, MAP_SIZE, MAP_SIZE);
  gl.clear(gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 4);
  drawGroups(map.matrix, shadowProgram, (body) => !run.bodies[body].one_sided);
  gl.disable(gl.POLYGON_OFFSET_FILL);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, canvas.width, canvas.height);
}

function drawBodies(view) {
  const eye = camera.target.map((value, i) => value + camera.unit * camera.distance * view.towards[i]);
  const map = mapOf(fill(eye, view.towards));
  for (const { numbers, instances, drawn } of groups.filter((each) => each.drawn.length > 0)) {
    gl.bindBuffer(gl.ARRAY_BUFFER, numbers);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, instances, 0, INSTANCE * drawn.length);
  }
  if (map) drawShadows(map);
  const uniform = (name) => gl.getUniformLocation(bodyProgram, name);
  gl.useProgram(bodyProgram);
  gl.uniform3fv(uniform('sun'), light.towards);
  gl.uniform3fv(uniform('sky'), up);
  gl.uniform2fv(uniform('texel'), map ? [map.texel, 1 / MAP_SIZE] : [0, 0]);
  gl.uniform1f(uniform('penumbra'), PENUMBRA);
  if (map) gl.uniformMatrix4fv(uniform('to_map'), false, map.matrix);
  gl.bindTexture(gl.TEXTURE_2D, shadowMap.texture);
  drawGroups(view.matrix, bodyProgram);
}

// The body at a place of the canvas, of those that were drawn last.
function bodyAt(x, y) {
  const [made, picture, depth] = [gl.createFramebuffer(), gl.createRenderbuffer(), gl.createRenderbuffer()];
  gl.bindFramebuffer(gl.FRAMEBUFFER, made);
  for (const [storage, format, place] of [[picture, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT16, gl.DEPTH_ATTACHMENT]]) {
    gl.bindRenderbuffer(gl.RENDERBUFFER, storage);
    gl.renderbufferStorage(gl.RENDERBUFFER, format, canvas.width, canvas.height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, storage);
  }
  const scale = canvas.width / Math.max(1, canvas.clientWidth);
  const [column, row] = [Math.floor(x * scale), canvas.height - 1 - Math.floor(y * scale)];
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(column, row, 1, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  drawGroups(projection().matrix, pickProgram);
  const found = new Uint8Array(4);
  gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, found);
  gl.disable(gl.SCISSOR_TEST);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(made);
  for (const storage of [picture, depth]) gl.deleteRenderbuffer(storage);
  const number = found[0] + 256 * found[1] + 65536 * found[2];
  return groups.flatMap((each) => each.drawn)[number - 1];
}

function draw() {
  const density = Math.min(2, window.devicePixelRatio || 1);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(size * density)));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  place(now);
  aim();
  const view = projection();
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  drawBodies(view);
  // Far below it would be a patch of lines and no ground.
  if (camera.target[axis] - bottom < 3 * camera.unit) drawPlain(view, gl.LINES, grid(), [0.21, 0.2226, 0.2352, 0.42], GRID);
  drawJoints(view);
  if (!document.body.dataset.replay) {
    // The measure of how fast the page opens: the pixels are there.
    gl.finish();
    performance.mark('first frame');
    document.body.dataset.replay = 'ready';
  }
}

