// What the window in the page asks for and shows: see `page.rs`. `gl.js` is the loader of miniquad.
'use strict';

const scenes = document.querySelector('#scenes');
const about = document.querySelector('#about');
const [step, hash, same] = ['#step', '#hash', '#same'].map(id => document.querySelector(id));
// How many scenes have been chosen, and whether the last is not shown yet.
let choices = 0;
let isChosen = false;

// What the window says, by its first line.
const said = {
  scenes(text) {
    for (const name of text.split('\n')) scenes.add(new Option(name));
  },
  state(text) {
    const [scene, steps, state, isUntouched] = text.split(' ');
    if (isChosen && Number(scene) !== scenes.selectedIndex) return;
    isChosen = false;
    scenes.selectedIndex = Number(scene);
    step.textContent = steps;
    hash.textContent = state;
    same.textContent = isUntouched === 'true'
      ? `the same bits on your own machine: tumble run ${scenes.value} --steps ${steps}`
      : 'changed by hand';
  },
  failure(text) {
    about.textContent = text;
  },
};

function say(text) {
  const bytes = new TextEncoder().encode(text);
  const at = wasm_exports.allocate_vec_u8(bytes.length);
  new Uint8Array(wasm_memory.buffer, at, bytes.length).set(bytes);
  wasm_exports.on_clipboard_paste(at, bytes.length);
}

function press(code) {
  for (const kind of ['keydown', 'keyup']) {
    canvas.dispatchEvent(new KeyboardEvent(kind, { code }));
  }
  canvas.focus();
}

miniquad_add_plugin({
  name: 'tumble_page',
  version: 1,
  register_plugin(imports) {
    // WebGL 2 wants the size of depths, which the loader does not give.
    const glTexImage2D = imports.env.glTexImage2D;
    imports.env.glTexImage2D = (target, level, internal, ...rest) =>
      glTexImage2D(target, level, internal === gl.DEPTH_COMPONENT ? gl.DEPTH_COMPONENT16 : internal, ...rest);
    // The clipboard of the window is the way of its texts to the page.
    imports.env.sapp_set_clipboard = (at, length) => {
      const text = UTF8ToString(at, length);
      const end = text.indexOf('\n');
      said[text.slice(0, end)](text.slice(end + 1));
    };
  },
});

scenes.addEventListener('change', () => {
  choices += 1;
  isChosen = true;
  say(`scene ${scenes.selectedIndex} ${choices}`);
});
for (const button of document.querySelectorAll('button[data-key]')) {
  button.addEventListener('click', () => press(button.dataset.key));
}
// A right drag moves the view, and a drag may end outside.
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
// Tab leaves the window for the buttons.
document.addEventListener('keydown', event => {
  if (event.code === 'Tab') event.stopPropagation();
}, true);
// The loader sees changes of the whole page only.
new ResizeObserver(() => window.onresize?.()).observe(canvas);
load('tumble-view.wasm');
canvas.focus();
