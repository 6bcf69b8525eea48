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

// Names that are listed; others are added when they are picked.
const MOST_NAMES = 200;

function fillFollow() {
  const select = element('follow');
  option(select, 'motion', 'what moves');
  option(select, 'path', 'the whole way');
  run.bodies.slice(0, MOST_NAMES).forEach((body, index) => option(select, index, body.name));
  // Where bodies go far, or not all at once, the whole way shows little of them.
  select.value = wholePath.radius > 1.5 * usualRadius ? 'motion' : 'path';
}

function follow(body) {
  const select = element('follow');
  if (![...select.options].some((each) => each.value === String(body))) option(select, body, run.bodies[body].name);
  select.value = body;
  reset();
}

function turnBy(dx, dy) {
  camera.yaw -= 0.008 * dx;
  camera.pitch = Math.min(1.55, Math.max(-1.55, camera.pitch + 0.008 * dy));
  redraw();
}
function zoomBy(factor) {
  camera.distance = Math.min(60, Math.max(0.15, camera.distance * factor));
  redraw();
}
function panBy(dx, dy) {
  const { right, above } = projection();
  const pixel = metresOfPixel();
  camera.by = camera.by.map((value, i) => value + pixel * (dy * above[i] - dx * right[i]));
  redraw();
}

const fingers = new Map();
// How far apart two fingers are, and where the middle between them is.
function spread() {
  const [a, b] = [...fingers.values()];
  return [Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), (a.clientX + b.clientX) / 2, (a.clientY + b.clientY) / 2];
}
// Where a press began, as long as it may be a click.
let pressed;

canvas.addEventListener('pointerdown', (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, event);
  pressed = fingers.size === 1 && event.button === 0 ? event : undefined;
});
canvas.addEventListener('pointermove', (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 4) pressed = undefined;
  const [apart, x, y] = fingers.size === 2 ? spread() : [];
  fingers.set(event.pointerId, event);
  const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
  if (fingers.size === 2) {
    const [wide, middleX, middleY] = spread();
    zoomBy(apart / Math.max(1, wide));
    panBy(middleX - x, middleY - y);
  } else if (event.shiftKey || event.buttons > 1) panBy(dx, dy);
  else if (!pressed) turnBy(dx, dy);
});
canvas.addEventListener('pointerup', () => {
  if (pressed) {
    const box = canvas.getBoundingClientRect();
    picked = bodyAt(pressed.clientX - box.left, pressed.clientY - box.top);
    redraw();
  }
});
for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
canvas.addEventListener('dblclick', () => { if (picked !== undefined) follow(picked); });
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
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
    Escape: () => {
      picked = undefined;
      redraw();
    },
  };
  const action = Object.hasOwn(keys, event.key) ? keys[event.key] : undefined;
  if (!action) return;
  event.preventDefault();
  action();
});

for (const frame of some) {
  for (const body of seen) bottom = Math.min(bottom, positions[3 * (frame * bodyCount + body) + axis] - reach[body]);
}
if (duration === 0) for (const id of ['play', 'scrub', 'speed']) element(id).disabled = true;
fillSpeeds();
fillFollow();
showTime();
reset();

// It plays as soon as it is seen, where the reader has not asked for less motion.
if (duration > 0 && !window.matchMedia('(prefers-reduced-motion: reduce)').matches) {
  const watch = new IntersectionObserver(([entry]) => {
    if (!entry.isIntersecting) return;
    watch.disconnect();
    setPlaying(true);
  }, { threshold: 0.5 });
  watch.observe(canvas);
}
