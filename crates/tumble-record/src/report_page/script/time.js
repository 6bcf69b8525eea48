// ---- Time ----

let now = start;
let playing = false;
let drawnAt;
let asked = false;
// The body that is marked, if one is.
let picked;

const digits = duration > 0 ? Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(duration)))) : 3;
const seconds = (time) => (Math.abs(times[lastFrame]) < 1e6 ? time.toFixed(digits) : time.toExponential(3));

function showTime() {
  element('scrub').value = duration > 0 ? 1000 * (now - start) / duration : 0;
  element('scrub').setAttribute('aria-valuetext', `${seconds(now)} seconds`);
  element('clock').textContent = `${seconds(now)} / ${seconds(times[lastFrame])} s`;
  for (const move of cursors) move();
}

// A line in each plot over time, which a press in the plot puts elsewhere.
const cursors = [...document.querySelectorAll('.plot svg[data-x]')].map((plot) => {
  const [left, right, low, high, top, end] = plot.dataset.x.split(' ').map(Number);
  const line = document.createElementNS(plot.namespaceURI, 'path');
  line.setAttribute('class', 'cursor');
  plot.append(line);
  const go = (event) => {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(plot.getScreenCTM().inverse());
    setPlaying(false);
    goTo(low + (high - low) * (place.x - left) / (right - left));
  };
  plot.addEventListener('pointerdown', go);
  plot.addEventListener('pointermove', (event) => { if (event.buttons === 1) go(event); });
  return () => line.setAttribute('d', `M${left + (right - left) * (now - low) / (high - low)} ${top}V${end}`);
});

// Where the marked body is and how fast, from the frames before and after.
function showPicked() {
  element('picked').hidden = picked === undefined;
  if (picked === undefined) return;
  // To a thousandth of the body's size.
  const decimals = Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(reach[picked] || 1))));
  const number = (value) => (Math.abs(value) >= 1e6 ? value.toExponential(3) : value.toFixed(decimals).replace(/^-(?=[0.]*$)/, ''));
  const frame = Math.min(locate(now)[0], Math.max(0, lastFrame - 1));
  const [from, to] = [frame, Math.min(frame + 1, lastFrame)].map((at) => positionOf(at, picked));
  const took = times[Math.min(frame + 1, lastFrame)] - times[frame];
  const speed = took > 0 ? Math.hypot(...to.map((value, i) => value - from[i])) / took : 0;
  const at = [0, 1, 2].map((i) => number(placed.positions[3 * picked + i]));
  element('picked').textContent = `${run.bodies[picked].name} · at ${at.join(', ')} m · ${number(speed)} m/s`;
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
  showPicked();
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
