// Serves the window that `crates/tumble-view/web/build` has made and opens it: it runs, its buttons do
// what they say, and the state of a scene after some steps has the hash that the program prints for it.
//
// usage: node window.mjs PROGRAM [BROWSER [SCENE...]]

import { execFileSync } from 'node:child_process';
import { createReadStream, existsSync, mkdirSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import { chromium } from 'playwright-core';

const here = dirname(fileURLToPath(import.meta.url));
const site = join(here, '..', '..', 'target', 'web');
const output = join(here, 'output', 'window');
const [programPath, browserPath = '/usr/bin/chromium', ...scenes] = process.argv.slice(2);
if (!programPath || !existsSync(join(site, 'tumble-view.wasm'))) {
  console.error('usage: node window.mjs PROGRAM [BROWSER [SCENE...]], after crates/tumble-view/web/build');
  process.exit(2);
}
const program = resolve(programPath);
mkdirSync(output, { recursive: true });

// Bytes of the program when a server compresses it; of a build in haste they may be more.
const MOST_COMPRESSED = Number(process.env.MOST_COMPRESSED ?? 2e6);
const compared = scenes.length > 0 ? scenes : ['bowling', 'pyramid', 'ragdoll', 'hills', 'solar-system', 'crane', 'raft', 't-handle'];

let failures = 0;
function check(what, is, detail = '') {
  if (!is) failures += 1;
  console.log(`${is ? 'ok  ' : 'FAIL'} ${what}${detail ? `: ${detail}` : ''}`);
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
const server = createServer((request, response) => {
  const name = request.url === '/' ? 'index.html' : request.url.slice(1);
  const file = join(site, name);
  if (name.includes('/') || !existsSync(file)) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
});
await new Promise(done => server.listen(0, '127.0.0.1', done));

const bytes = gzipSync(readFileSync(join(site, 'tumble-view.wasm')), { level: 9 }).length;
check('size', bytes <= MOST_COMPRESSED, `${bytes} bytes compressed`);

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const said = [];
page.on('console', message => {
  if (['error', 'warning'].includes(message.type())) said.push(message.text());
});
page.on('pageerror', error => said.push(`${error}`));
await page.goto(`http://127.0.0.1:${server.address().port}/`);

const read = () => page.evaluate(() => ({ step: Number(document.querySelector('#step').textContent), hash: document.querySelector('#hash').textContent }));
// The limit is for a page that hangs, not for a busy machine.
const LIMIT = 300_000;
const until = async (is, limit = LIMIT) => {
  const begin = Date.now();
  for (;;) {
    const state = await read();
    if (is(state) || Date.now() - begin > limit) return state;
    await page.waitForTimeout(100);
  }
};
// Seen at one of its first steps, or long enough ago.
const begun = () => until(({ step }) => step > 0 && step < 20, 20_000);
const frames = count => page.evaluate(count => new Promise(done => {
  const next = () => (count-- > 0 ? requestAnimationFrame(next) : done());
  next();
}), count);
const paused = async () => {
  for (let before = -1; ;) {
    await frames(5);
    const state = await read();
    if (state.step === before) return state;
    before = state.step;
  }
};
const text = (selector, part) => page.waitForFunction(
  ([selector, part]) => document.querySelector(selector).textContent.includes(part), [selector, part], { timeout: LIMIT },
).catch(() => {});
const button = code => page.click(`button[data-key="${code}"]`);
const hashOf = (scene, steps) => JSON.parse(execFileSync(program, ['run', scene, '--steps', `${steps}`, '--json'], { encoding: 'utf8' })).state_hash;

const running = await until(({ step }) => step > 20);
check('it runs', running.step > 20, `step ${running.step}`);
check('scenes', (await page.$$('#scenes option')).length > 20);

for (const scene of compared) {
  await page.selectOption('#scenes', scene);
  await begun();
  await until(({ step }) => step >= 20);
  await button('Space');
  const state = await paused();
  await page.screenshot({ path: join(output, `${scene}.png`) });
  check(`${scene} has the bits of the program`, state.step >= 20 && state.hash === hashOf(scene, state.step), `step ${state.step}, ${state.hash}`);
  if (scene === 'pyramid') {
    await button('Period');
    const next = await until(({ step }) => step === state.step + 1);
    check('a step', next.step === state.step + 1 && next.hash === hashOf(scene, next.step));
    await button('Comma');
    const back = await until(({ step }) => step === state.step);
    check('a step back', back.step === state.step && back.hash === state.hash);
    await button('KeyP');
    await page.waitForTimeout(500);
    await page.screenshot({ path: join(output, 'settings.png') });
    await button('KeyP');
  }
  await button('Space');
}

const same = () => page.textContent('#same');
await page.selectOption('#scenes', 'bowling');
await begun();
await button('Space');
const before = await paused();
check('an untouched scene names its command', (await same()).endsWith(`tumble run bowling --steps ${before.step}`));
check('and has its bits', before.hash === hashOf('bowling', before.step));
await button('KeyO');
await text('#same', 'changed by hand');
check('a ball that is shot changes it', (await same()) === 'changed by hand' && (await read()).hash !== before.hash);
await button('KeyR');
await until(({ step }) => step === 0);
check('a restart is the scene again', (await same()).endsWith('tumble run bowling --steps 0'));
// The page down key goes to the next scene.
await page.focus('#glcanvas');
await page.keyboard.press('PageDown');
await text('#same', 'tumble run clockwork ');
check('the list follows the keys', (await page.inputValue('#scenes')) === 'clockwork');
await page.keyboard.press('q');
await page.waitForTimeout(500);
await page.selectOption('#scenes', 'bowling');
await text('#same', 'tumble run bowling ');
check('Q does not end it', (await same()).includes('tumble run bowling'));

await page.setViewportSize({ width: 390, height: 844 });
await page.waitForTimeout(1000);
await page.screenshot({ path: join(output, 'phone.png') });
const fits = await page.evaluate(() => canvas.width === Math.floor(canvas.clientWidth * devicePixelRatio) && canvas.height === Math.floor(canvas.clientHeight * devicePixelRatio));
check('the picture has the size of its place', fits);
check('no wider than a phone', await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
check('nothing is said on the console', said.length === 0, said.join(' | '));
await browser.close();
server.close();
process.exit(failures === 0 ? 0 : 1);
