// The replay of a run: the bodies at some of its times, drawn with WebGL 2.
//
// Data: the element #run, written by the program. Lengths are in metres and times in seconds until they are handed to the
// graphics card, which gets everything relative to where the camera looks and in units of what it looks at, so that single
// precision does for molecules and planets.
'use strict';

(() => {
  const run = JSON.parse(document.getElementById('run').textContent);
  const element = (id) => document.getElementById(id);
  const canvas = element('stage');
  const gl = canvas.getContext('webgl2', { antialias: true, alpha: true, preserveDrawingBuffer: true });

  const bodyCount = run.bodies.length;
  const times = run.times;
  const lastFrame = times.length - 1;
  const start = lastFrame >= 0 ? times[0] : 0;
  const duration = lastFrame > 0 ? times[lastFrame] - start : 0;

  if (!gl || bodyCount === 0 || lastFrame < 0) {
    element('sorry').textContent = bodyCount === 0 || lastFrame < 0
      ? 'There are no bodies to show.'
      : 'This browser has no WebGL 2, so the replay cannot be shown. Everything else on this page is complete.';
    element('sorry').hidden = false;
    for (const id of ['play', 'scrub', 'speed', 'follow', 'fit']) element(id).disabled = true;
    document.body.dataset.replay = 'none';
    return;
  }

  // ---- Data ----

  function bytes(base64) {
    const text = atob(base64);
    const result = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i += 1) result[i] = text.charCodeAt(i);
    return result.buffer;
  }

  // Of frame f and body b, from 3 (f n + b) and 4 (f n + b) on.
  const positions = new Float32Array(bytes(run.positions));
  const rotations = new Int16Array(bytes(run.rotations));

  // How far a body's surface reaches from its frame's origin.
  const reach = run.bodies.map((body) => {
    const [low, high] = run.surfaces[body.surface].box;
    return Math.hypot(...[0, 1, 2].map((i) => body.scale[i] * Math.max(Math.abs(low[i]), Math.abs(high[i]))));
  });

  // ---- Where the bodies are at a time ----

  const placed = { positions: new Float64Array(3 * bodyCount), rotations: new Float32Array(4 * bodyCount) };

  // The frame at or before a time, and how far it is to the next.
  function locate(time) {
    let [low, high] = [0, lastFrame];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    if (low === lastFrame) return [low, 0];
    return [low, Math.min(1, Math.max(0, (time - times[low]) / (times[low + 1] - times[low])))];
  }

  function place(time) {
    const [frame, share] = locate(time);
    const next = Math.min(frame + 1, lastFrame);
    for (let body = 0; body < bodyCount; body += 1) {
      const [a, b] = [frame * bodyCount + body, next * bodyCount + body];
      for (let i = 0; i < 3; i += 1) {
        const from = positions[3 * a + i];
        placed.positions[3 * body + i] = from + share * (positions[3 * b + i] - from);
      }
      // Of the two quaternions of the later rotation, the one nearer to the earlier.
      let along = 0;
      for (let i = 0; i < 4; i += 1) along += rotations[4 * a + i] * rotations[4 * b + i];
      const toward = along < 0 ? -share : share;
      let square = 0;
      for (let i = 0; i < 4; i += 1) {
        const part = (1 - share) * rotations[4 * a + i] + toward * rotations[4 * b + i];
        placed.rotations[4 * body + i] = part;
        square += part * part;
      }
      const length = Math.sqrt(square) || 1;
      for (let i = 0; i < 4; i += 1) placed.rotations[4 * body + i] /= length;
    }
  }

  // ---- What to look at ----

  // Bodies that move, or all where none does: ground may be far larger than what happens on it.
  const all = run.bodies.map((_, body) => body);
  const moving = all.filter((body) => run.bodies[body].moves);
  const seen = moving.length > 0 ? moving : all;

  function middleOf(frame) {
    const middle = [0, 0, 0];
    for (const body of seen) {
      for (let i = 0; i < 3; i += 1) middle[i] += positions[3 * (frame * bodyCount + body) + i] / seen.length;
    }
    return middle;
  }

  // The middle of the box around the bodies in some frames, each frame moved by an offset, and how far some share of them is from it.
  function bounds(frames, offset, share) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const each = (visit) => {
      for (const frame of frames) {
        const by = offset(frame);
        for (const body of seen) visit(body, [0, 1, 2].map((i) => positions[3 * (frame * bodyCount + body) + i] - by[i]));
      }
    };
    each((body, at) => {
      for (let i = 0; i < 3; i += 1) {
        low[i] = Math.min(low[i], at[i] - reach[body]);
        high[i] = Math.max(high[i], at[i] + reach[body]);
      }
    });
    const middle = low.map((value, i) => (value + high[i]) / 2);
    const distances = [];
    each((body, at) => distances.push(Math.hypot(...at.map((value, i) => value - middle[i])) + reach[body]));
    distances.sort((a, b) => a - b);
    return { middle, radius: distances[Math.ceil(share * (distances.length - 1))] || 1 };
  }

  // At most thirty frames tell how far the bodies come.
  const some = times.map((_, frame) => frame).filter((frame) => frame % Math.ceil(times.length / 30) === 0 || frame === lastFrame);
  const wholePath = bounds(some, () => [0, 0, 0], 1);
  // Of a crowd a few stray far from the others, and would make it small.
  const together = bounds(some, middleOf, seen.length > 20 ? 0.85 : 1);
  let bottom = 0;

  // ---- Camera ----

  const up = run.up;
  const axis = up.indexOf(1);
  // The two axes of the horizon, so that axis, first and second turn the same way round as x, y and z.
  const [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
  const camera = { yaw: 0.7, pitch: 0.42, distance: 1, target: [0, 0, 0], unit: 1 };
  const FIELD_OF_VIEW = 0.62;
  // Half the size of the smallest thing that is seen well [pixels].
  const SMALLEST = 5;

  function reset() {
    const choice = element('follow').value;
    camera.yaw = 0.7;
    camera.pitch = 0.42;
    camera.unit = wholePath.radius;
    if (choice === 'middle') camera.unit = together.radius;
    else if (choice !== 'path') camera.unit = 2.2 * reach[Number(choice)] || 1;
    // On an upright screen the width is what has to do.
    const narrow = Math.min(1, canvas.clientWidth / Math.max(1, canvas.clientHeight));
    camera.distance = 1.02 / (Math.sin(FIELD_OF_VIEW / 2) * narrow);
    redraw();
  }

  function aim() {
    const choice = element('follow').value;
    if (choice === 'path') {
      camera.target = wholePath.middle;
    } else if (choice === 'middle') {
      const middle = [0, 0, 0];
      for (const body of seen) {
        for (let i = 0; i < 3; i += 1) middle[i] += placed.positions[3 * body + i] / seen.length;
      }
      camera.target = middle.map((value, i) => value + together.middle[i]);
    } else {
      camera.target = [0, 1, 2].map((i) => placed.positions[3 * Number(choice) + i]);
    }
  }

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

  // From the target and in the camera's unit to the canvas, column by column; and the direction towards the viewer.
  function projection() {
    const { yaw, pitch, distance } = camera;
    const towards = [0, 0, 0];
    towards[axis] = Math.sin(pitch);
    towards[first] = Math.cos(pitch) * Math.cos(yaw);
    towards[second] = Math.cos(pitch) * Math.sin(yaw);
    const right = [0, 0, 0];
    right[first] = -Math.sin(yaw);
    right[second] = Math.cos(yaw);
    const above = cross(towards, right);
    const focal = 1 / Math.tan(FIELD_OF_VIEW / 2);
    const wide = focal * canvas.height / canvas.width;
    const near = 0.02 * distance;
    const far = distance + 4 * Math.max(2, wholePath.radius / camera.unit);
    const [depth, shift] = [(far + near) / (near - far), 2 * far * near / (near - far)];
    const matrix = [];
    for (let i = 0; i < 3; i += 1) matrix.push(wide * right[i], focal * above[i], depth * towards[i], -towards[i]);
    matrix.push(0, 0, -depth * distance + shift, distance);
    return { matrix, towards, right, above };
  }

  // ---- Graphics card ----

  const BODY_VERTEX = `#version 300 es
    layout(location = 0) in vec3 corner;
    layout(location = 1) in vec3 normal;
    layout(location = 2) in vec3 place;
    layout(location = 3) in vec4 turn;
    layout(location = 4) in vec3 size;
    layout(location = 5) in vec3 color;
    uniform mat4 projection;
    out vec3 facing;
    out vec3 paint;
    vec3 turned(vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }
    void main() {
      // Normals go with the inverse of what stretches the surface, which must not be zero.
      facing = turned(normal / max(size, 1e-4 * max(size.x, max(size.y, size.z))));
      paint = color;
      gl_Position = projection * vec4(place + turned(corner * size), 1.0);
    }`;
  const BODY_FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 facing;
    in vec3 paint;
    uniform vec3 sun;
    uniform vec3 sky;
    out vec4 result;
    void main() {
      vec3 n = normalize(facing) * (gl_FrontFacing ? 1.0 : -1.0);
      float light = 0.30 + 0.22 * dot(n, sky) + 0.85 * max(0.0, dot(n, sun));
      result = vec4(pow(paint * light, vec3(1.0 / 2.2)), 1.0);
    }`;
  const LINE_VERTEX = `#version 300 es
    layout(location = 0) in vec3 corner;
    uniform mat4 projection;
    void main() { gl_Position = projection * vec4(corner, 1.0); }`;
  const LINE_FRAGMENT = `#version 300 es
    precision mediump float;
    uniform vec4 paint;
    out vec4 result;
    void main() { result = paint; }`;

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

  function group(surface, bodies) {
    const layout = gl.createVertexArray();
    gl.bindVertexArray(layout);
    buffer(gl.ARRAY_BUFFER, bytes(surface.positions), gl.STATIC_DRAW);
    attribute(0, 3, gl.FLOAT, 0, 0, false);
    buffer(gl.ARRAY_BUFFER, bytes(surface.normals), gl.STATIC_DRAW);
    attribute(1, 3, gl.BYTE, 4, 0, false);
    buffer(gl.ELEMENT_ARRAY_BUFFER, bytes(surface.indices), gl.STATIC_DRAW);
    const instances = new Float32Array(INSTANCE * bodies.length);
    const numbers = buffer(gl.ARRAY_BUFFER, instances.byteLength, gl.DYNAMIC_DRAW);
    [[2, 3, 0], [3, 4, 12], [4, 3, 28], [5, 3, 40]].forEach(([location, size, offset]) => {
      attribute(location, size, gl.FLOAT, 4 * INSTANCE, offset, true);
    });
    return { layout, bodies, instances, numbers, corners: surface.corners, type: surface.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT };
  }

  const bodyProgram = program(BODY_VERTEX, BODY_FRAGMENT);
  const lineProgram = program(LINE_VERTEX, LINE_FRAGMENT);
  const groups = run.surfaces.map((surface, index) => group(surface, all.filter((body) => run.bodies[body].surface === index)));
  const lines = gl.createVertexArray();
  gl.bindVertexArray(lines);
  const lineCorners = buffer(gl.ARRAY_BUFFER, 4 * 3 * 4 * 64, gl.DYNAMIC_DRAW);
  attribute(0, 3, gl.FLOAT, 0, 0, false);

  // A horizontal grid below the whole path, its lines a round number of metres apart.
  function grid() {
    const size = wholePath.radius / 5;
    const power = 10 ** Math.floor(Math.log10(size));
    const apart = power * [1, 2, 5].reduce((best, step) => (step * power <= size ? step : best), 1);
    const half = Math.ceil(1.3 * wholePath.radius / apart) * apart;
    const center = wholePath.middle.map((value) => Math.round(value / apart) * apart);
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

  // Corners of lines or triangles, in a colour that is multiplied with its opacity.
  function drawPlain(view, kind, corners, paint) {
    gl.useProgram(lineProgram);
    gl.uniformMatrix4fv(gl.getUniformLocation(lineProgram, 'projection'), false, view.matrix);
    gl.uniform4fv(gl.getUniformLocation(lineProgram, 'paint'), paint);
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
    const pixel = 2 * camera.distance * Math.tan(FIELD_OF_VIEW / 2) / Math.max(1, canvas.clientHeight);
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
    drawPlain(view, gl.TRIANGLES, jointCorners(view), [0.85, 0.3, 0.1, 1]);
    gl.enable(gl.DEPTH_TEST);
  }

  // Infinite ground is not seen from below, so that walls on this side do not hide what is between them.
  function isHidden(body, eye) {
    if (!run.bodies[body].one_sided) return false;
    const [x, y, z, w] = [0, 1, 2, 3].map((i) => placed.rotations[4 * body + i]);
    const normal = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)];
    return dot(normal, eye.map((value, i) => value - placed.positions[3 * body + i])) <= 0;
  }

  function fill({ bodies, instances }, eye) {
    // What would be smaller than this on the screen is drawn as large, so that planets are seen beside their orbits.
    const smallest = SMALLEST * camera.unit * camera.distance * Math.tan(FIELD_OF_VIEW / 2) / (canvas.clientHeight / 2);
    bodies.forEach((body, index) => {
      const at = INSTANCE * index;
      const enlarged = isHidden(body, eye) ? 0 : Math.max(1, smallest / reach[body]);
      for (let i = 0; i < 3; i += 1) {
        instances[at + i] = (placed.positions[3 * body + i] - camera.target[i]) / camera.unit;
        instances[at + 7 + i] = enlarged * run.bodies[body].scale[i] / camera.unit;
        instances[at + 10 + i] = run.colors[run.bodies[body].color][i];
      }
      for (let i = 0; i < 4; i += 1) instances[at + 3 + i] = placed.rotations[4 * body + i];
    });
  }

  function drawBodies(view) {
    // The sun stands behind the viewer's left shoulder.
    const sun = [0, 1, 2].map((i) => 0.62 * view.towards[i] - 0.42 * view.right[i] + 0.66 * view.above[i]);
    const length = Math.sqrt(dot(sun, sun));
    gl.useProgram(bodyProgram);
    gl.uniformMatrix4fv(gl.getUniformLocation(bodyProgram, 'projection'), false, view.matrix);
    gl.uniform3fv(gl.getUniformLocation(bodyProgram, 'sun'), sun.map((value) => value / length));
    gl.uniform3fv(gl.getUniformLocation(bodyProgram, 'sky'), up);
    const eye = camera.target.map((value, i) => value + camera.unit * camera.distance * view.towards[i]);
    for (const each of groups) {
      fill(each, eye);
      gl.bindVertexArray(each.layout);
      gl.bindBuffer(gl.ARRAY_BUFFER, each.numbers);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, each.instances);
      gl.drawElementsInstanced(gl.TRIANGLES, each.corners, each.type, 0, each.bodies.length);
    }
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
    // What moves past a grid that stays behind says nothing; it is for looking at the whole.
    if (element('follow').value === 'path') drawPlain(view, gl.LINES, grid(), [0.21, 0.2226, 0.2352, 0.42]);
    drawJoints(view);
    if (!document.body.dataset.replay) {
      // The measure of how fast the page opens: the pixels are there.
      gl.finish();
      performance.mark('first frame');
      document.body.dataset.replay = 'ready';
    }
  }

  // ---- Time ----

  let now = start;
  let playing = false;
  let drawnAt;
  let asked = false;

  const digits = duration > 0 ? Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(duration)))) : 3;
  const seconds = (time) => (Math.abs(times[lastFrame]) < 1e6 ? time.toFixed(digits) : time.toExponential(3));

  function showTime() {
    element('scrub').value = duration > 0 ? 1000 * (now - start) / duration : 0;
    element('scrub').setAttribute('aria-valuetext', `${seconds(now)} seconds`);
    element('clock').textContent = `${seconds(now)} / ${seconds(times[lastFrame])} s`;
  }

  function tick(at) {
    asked = false;
    if (playing) {
      now += (at - (drawnAt ?? at)) / 1000 * Number(element('speed').value);
      drawnAt = at;
      if (now >= times[lastFrame]) {
        now = times[lastFrame];
        setPlaying(false);
      }
      showTime();
    }
    draw();
    if (playing) redraw();
  }

  function redraw() {
    if (!asked) {
      asked = true;
      requestAnimationFrame(tick);
    }
  }

  function setPlaying(wanted) {
    if (wanted && now >= times[lastFrame]) now = start;
    playing = wanted && duration > 0;
    drawnAt = undefined;
    element('play').textContent = playing ? '❚❚' : '▶';
    element('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
    redraw();
  }

  function goTo(time) {
    now = Math.min(times[lastFrame], Math.max(start, time));
    showTime();
    redraw();
  }

  // To a frame before or after the one that is shown.
  function stepBy(frames) {
    setPlaying(false);
    const [frame, share] = locate(now);
    const from = frames < 0 && share > 0 ? frame + 1 : frame;
    goTo(times[Math.min(lastFrame, Math.max(0, from + frames))]);
  }

  // ---- Controls ----

  function option(select, value, text) {
    const made = document.createElement('option');
    made.value = value;
    made.textContent = text;
    select.append(made);
  }

  function fillSpeeds() {
    const select = element('speed');
    if (duration >= 0.5 && duration <= 90) {
      for (const speed of [0.1, 0.25, 0.5, 1, 2, 4, 8]) option(select, speed, `${speed}×`);
      select.value = '1';
    } else {
      for (const length of [60, 30, 15, 8, 4]) option(select, duration / length, `all in ${length} s`);
      select.selectedIndex = 2;
    }
  }

  function fillFollow() {
    const select = element('follow');
    option(select, 'path', 'the whole way');
    option(select, 'middle', 'their middle');
    run.bodies.forEach((body, index) => option(select, index, body.name));
    // Where the bodies go far together, the whole way shows little of them.
    select.value = wholePath.radius > 1.8 * together.radius ? 'middle' : 'path';
  }

  const fingers = new Map();
  function turnBy(dx, dy) {
    camera.yaw -= 0.008 * dx;
    camera.pitch = Math.min(1.55, Math.max(-1.55, camera.pitch + 0.008 * dy));
    redraw();
  }
  function zoomBy(factor) {
    camera.distance = Math.min(60, Math.max(0.15, camera.distance * factor));
    redraw();
  }
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
  };

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const apart = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size === 1) turnBy(event.clientX - before.clientX, event.clientY - before.clientY);
    else if (fingers.size === 2) zoomBy(apart / Math.max(1, spread()));
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    // Lines and pages are other units than pixels.
    zoomBy(Math.exp(0.0012 * event.deltaY * [1, 16, 400][event.deltaMode]));
  }, { passive: false });

  element('play').addEventListener('click', () => setPlaying(!playing));
  element('scrub').addEventListener('input', (event) => {
    setPlaying(false);
    goTo(start + duration * Number(event.target.value) / 1000);
  });
  element('follow').addEventListener('change', reset);
  element('fit').addEventListener('click', reset);
  window.addEventListener('resize', redraw);

  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === 'SELECT') return;
    const onButton = event.target.tagName === 'BUTTON';
    const keys = {
      ' ': onButton ? undefined : () => setPlaying(!playing),
      ArrowLeft: () => stepBy(event.shiftKey ? -10 : -1),
      ArrowRight: () => stepBy(event.shiftKey ? 10 : 1),
    };
    const action = Object.hasOwn(keys, event.key) ? keys[event.key] : undefined;
    if (!action) return;
    event.preventDefault();
    action();
  });

  // The grid lies below everything that moves.
  bottom = Infinity;
  for (const frame of some) {
    for (const body of seen) bottom = Math.min(bottom, positions[3 * (frame * bodyCount + body) + axis] - reach[body]);
  }
  if (duration === 0) for (const id of ['play', 'scrub', 'speed']) element(id).disabled = true;
  fillSpeeds();
  fillFollow();
  showTime();
  reset();
})();
