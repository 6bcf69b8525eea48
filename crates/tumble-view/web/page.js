// What the window in the page asks for and tells: see `page.rs`. `gl.js` is the loader of miniquad.
'use strict';

const scenes = document.querySelector('#scenes');
const [step, hash, command] = ['#step', '#hash', '#command'].map(id => document.querySelector(id));
// From one; zero is none.
let chosen = 0;

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
    imports.env.tumble_scene = (at, length, isFirst) => {
      const name = new TextDecoder().decode(new Uint8Array(wasm_memory.buffer, at, length));
      scenes.add(new Option(name, name, isFirst === 1, isFirst === 1));
    };
    imports.env.tumble_chosen = () => {
      const scene = chosen;
      chosen = 0;
      return scene;
    };
    imports.env.tumble_shows = (steps, upper, lower) => {
      step.textContent = steps;
      hash.textContent = [upper, lower].map(half => (half >>> 0).toString(16).padStart(8, '0')).join('');
      command.textContent = `tumble run ${scenes.value} --steps ${steps}`;
    };
  },
});

scenes.addEventListener('change', () => {
  chosen = scenes.selectedIndex + 1;
  canvas.focus();
});
for (const button of document.querySelectorAll('button[data-key]')) {
  button.addEventListener('click', () => press(button.dataset.key));
}
// Shift-drag and keys are the window's.
canvas.addEventListener('contextmenu', event => event.preventDefault());
load('tumble-view.wasm');
canvas.focus();
