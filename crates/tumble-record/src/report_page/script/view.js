// ---- What the camera shows ----

// Bodies that move, or all where none does: ground may be far larger than what happens on it.
const all = run.bodies.map((_, body) => body);
const moving = all.filter((body) => run.bodies[body].moves);
const seen = moving.length > 0 ? moving : all;

const positionOf = (frame, body) => [0, 1, 2].map((i) => positions[3 * (frame * bodyCount + body) + i]);

// A ball around bodies in some frames; of many, a few that stray far from the others are left out.
function ballAround(frames, bodies) {
  // As many places as are sorted quickly.
  const each = Math.ceil(frames.length * bodies.length / (frames.length === 1 ? 1000 : 5000));
  const sample = bodies.filter((_, at) => at % each === 0);
  const places = frames.flatMap((frame) => sample.map((body) => [positionOf(frame, body), reach[body]]));
  const whole = ballOf(places, 0);
  const most = places.length > 40 ? ballOf(places, 0.02) : whole;
  return whole.radius > 1.4 * most.radius ? most : whole;
}

// Without this part of the places at either end.
function ballOf(places, left) {
  const [low, high] = [0, 1, 2].map((i) => {
    const [lows, highs] = [-1, 1].map((side) => places.map(([at, far]) => at[i] + side * far).sort((a, b) => a - b));
    return [lows[Math.floor(left * lows.length)], highs[Math.ceil((1 - left) * highs.length) - 1]];
  }).reduce(([low, high], [a, b]) => [[...low, a], [...high, b]], [[], []]);
  const middle = low.map((value, i) => (value + high[i]) / 2);
  const distances = places.map(([at, far]) => Math.hypot(...at.map((value, i) => value - middle[i])) + far).sort((a, b) => a - b);
  return { middle, radius: distances[Math.ceil((1 - 2 * left) * distances.length) - 1] || 1 };
}

// At most thirty frames tell how far the bodies come.
const some = times.map((_, frame) => frame).filter((frame) => frame % Math.ceil(times.length / 30) === 0 || frame === lastFrame);
const wholePath = ballAround(some, seen);
// The lowest height that something that moves reaches.
let bottom = Infinity;

// Whether a body moves or turns between two frames by what can be seen.
function movesBetween(from, to, body) {
  const a = from * bodyCount + body;
  const b = to * bodyCount + body;
  let square = 0;
  for (let i = 0; i < 3; i += 1) square += (positions[3 * b + i] - positions[3 * a + i]) ** 2;
  let along = 0;
  for (let i = 0; i < 4; i += 1) along += rotations[4 * a + i] * rotations[4 * b + i] / 32767 ** 2;
  return square > (0.05 * reach[body]) ** 2 || Math.abs(along) < 0.999;
}

// A ball around what moves about the time of some frames, and their times.
function ballsOfMotion() {
  const count = Math.min(lastFrame, 96);
  const frames = Array.from({ length: count + 1 }, (_, key) => Math.round(count > 0 ? key * lastFrame / count : 0));
  // What is about to move is shown before it does.
  const around = (frame) => [-0.03, 0.05].map((part, end) => {
    const there = locate(times[frame] + part * duration)[0];
    return Math.min(lastFrame, Math.max(0, end === 0 ? Math.min(there, frame - 1) : Math.max(there, frame + 1)));
  });
  let before = seen;
  const balls = frames.map((frame) => {
    const [from, to] = around(frame);
    const moved = seen.filter((body) => movesBetween(from, to, body));
    if (moved.length > 0) before = moved;
    const ball = ballAround([frame], before);
    return { ...ball, radius: Math.max(ball.radius, 4 * before.reduce((most, body) => Math.min(most, reach[body]), Infinity)) };
  });
  // Smooth, so that the camera does not jump.
  const wide = Math.ceil(0.05 * count);
  return frames.map((frame, key) => {
    const near = balls.slice(Math.max(0, key - wide), key + wide + 1);
    const mean = (of) => near.reduce((sum, ball) => sum + of(ball), 0) / near.length;
    // What is outside of the middle's ball is to be in this one as well.
    const middle = [0, 1, 2].map((i) => mean((ball) => ball.middle[i]));
    const away = Math.hypot(...middle.map((value, i) => value - balls[key].middle[i]));
    return { time: times[frame], middle, radius: Math.max(Math.exp(mean((ball) => Math.log(ball.radius))), balls[key].radius + away) };
  });
}

const motion = ballsOfMotion();
const usualRadius = motion.map((ball) => ball.radius).sort((a, b) => a - b)[motion.length >> 1];

// The ball around what moves at a time.
function ballAt(time) {
  const after = motion.findIndex((ball) => ball.time > time);
  if (after <= 0) return motion[after < 0 ? motion.length - 1 : 0];
  const [a, b] = [motion[after - 1], motion[after]];
  const share = (time - a.time) / (b.time - a.time);
  return { middle: a.middle.map((value, i) => value + share * (b.middle[i] - value)), radius: a.radius + share * (b.radius - a.radius) };
}

// ---- Camera ----

const up = run.up;
const axis = up.indexOf(1);
// The two axes of the horizon, so that axis, first and second turn the same way round as x, y and z.
const [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
// The target is moved by what the reader moved it by [m].
const camera = { yaw: 0.7, pitch: 0.42, distance: 1, target: [0, 0, 0], by: [0, 0, 0], unit: 1 };
const FIELD_OF_VIEW = 0.62;
// Half the size of the smallest thing that is seen well [pixels].
const SMALLEST = 5;

function reset() {
  Object.assign(camera, { yaw: 0.7, pitch: 0.42, by: [0, 0, 0] });
  // On an upright screen the width is what has to do.
  const narrow = Math.min(1, canvas.clientWidth / Math.max(1, canvas.clientHeight));
  camera.distance = 1.02 / (Math.sin(FIELD_OF_VIEW / 2) * narrow);
  redraw();
}

// The ball that is to be in the picture.
function shown() {
  const choice = element('follow').value;
  if (choice === 'path') return wholePath;
  if (choice === 'motion') return ballAt(now);
  const body = Number(choice);
  return { middle: [0, 1, 2].map((i) => placed.positions[3 * body + i]), radius: 2.2 * reach[body] || 1 };
}

function aim() {
  const { middle, radius } = shown();
  camera.unit = radius;
  camera.target = middle.map((value, i) => value + camera.by[i]);
}

// How many metres a pixel is where the camera looks.
const metresOfPixel = () => 2 * camera.unit * camera.distance * Math.tan(FIELD_OF_VIEW / 2) / Math.max(1, canvas.clientHeight);

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
  const far = distance + 5 * Math.max(2, wholePath.radius / camera.unit);
  const [depth, shift] = [(far + near) / (near - far), 2 * far * near / (near - far)];
  const matrix = [];
  for (let i = 0; i < 3; i += 1) matrix.push(wide * right[i], focal * above[i], depth * towards[i], -towards[i]);
  matrix.push(0, 0, -depth * distance + shift, distance);
  return { matrix, towards, right, above };
}

