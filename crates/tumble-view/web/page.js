// What the window in the page asks for and shows: see `page.rs`. `gl.js` is the loader of miniquad.
'use strict';

const scenes = document.querySelector('#scenes');
const about = document.querySelector('#about');
const [step, hash, same] = ['#step', '#hash', '#same'].map(id => document.querySelector(id));
// From one; zero is none.
let chosen = 0;

const text = (at, length) => new TextDecoder().decode(new Uint8Array(wasm_memory.buffer, at, length));

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
    imports.env.tumble_add_scene = (at, length) => scenes.add(new Option(text(at, length)));
    imports.env.tumble_take_choice = () => {
      const scene = chosen;
      chosen = 0;
      return scene;
    };
    imports.env.tumble_show = (scene, steps, upper, lower, isUntouched) => {
      if (chosen === 0) scenes.selectedIndex = scene - 1;
      step.textContent = steps;
      hash.textContent = [upper, lower].map(half => (half >>> 0).toString(16).padStart(8, '0')).join('');
      same.textContent = isUntouched
        ? `the same bits on your own machine: tumble run ${scenes.value} --steps ${steps}`
        : 'changed by hand';
    };
    imports.env.tumble_fail = (at, length) => {
      about.textContent = text(at, length);
    };
  },
});

scenes.addEventListener('change', () => {
  chosen = scenes.selectedIndex + 1;
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
