// The states of the bodies over time.
//
// Data: the element #run, written by the program. Lengths are in metres and times in seconds until they are handed to the
// graphics card, which gets everything relative to where the camera looks and in units of what it looks at, so that single
// precision does for molecules and planets.
//
// This and the files after it are one function on the page, which ends early where nothing can be drawn.

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

// Positions in metres, or where bodies are many as parts of the way of each in 16 bits.
function positionsOf({ positions, ways }) {
  if (ways === '') return new Float32Array(bytes(positions));
  const [parts, ends] = [new Uint16Array(bytes(positions)), new Float32Array(bytes(ways))];
  const width = 3 * bodyCount;
  const result = new Float32Array(parts.length);
  for (let at = 0; at < parts.length; at += 1) {
    const end = 6 * Math.floor((at % width) / 3) + at % 3;
    result[at] = ends[end] + parts[at] / 65535 * ends[end + 3];
  }
  return result;
}

// Of frame f and body b, from 3 (f n + b) and 4 (f n + b) on.
const positions = positionsOf(run);
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
