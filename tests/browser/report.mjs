// Writes reports of scenes with the program and opens each report.html from the disk: nothing is said on the console, nothing is
// loaded, what is drawn changes with the time, and a page of ten thousand bodies is there within two seconds.
//
// usage: node report.mjs PROGRAM [BROWSER]

import { execFileSync } from 'node:child_process';
import { mkdirSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { chromium } from 'playwright-core';

const output = join(dirname(fileURLToPath(import.meta.url)), 'output', 'reports');
const [programPath, browserPath = '/usr/bin/chromium'] = process.argv.slice(2);
if (!programPath) {
  console.error('usage: node report.mjs PROGRAM [BROWSER]');
  process.exit(2);
}
const program = resolve(programPath);

// From the beginning of the navigation to the first frame on the canvas [ms].
const OPENS_WITHIN = 2000;
const attack = '</script><img src=x onerror=alert(1)>';

mkdirSync(output, { recursive: true });
writeFileSync(join(output, 'attack.json'), JSON.stringify({
  name: `${attack}<!--slot:data-->`,
  description: `${attack} "quoted" & so on`,
  bodies: [{ name: attack, shape: { cuboid: { half_extents: [0.5, 0.2, 0.1] } }, mass: 1, angular_velocity: [1, 5, 0.1] }],
}));
writeFileSync(join(output, 'empty.json'), '{ "bodies": [] }');
writeFileSync(join(output, 'still.json'), '{ "bodies": [{ "fixed": true, "shape": { "sphere": { "radius": 1 } } }] }');

// Name, arguments of the run, and whether the motion can be seen.
const scenes = [
  ['t-handle', ['t-handle'], true],
  ['raft', ['raft'], true],
  ['satellite', ['satellite'], true],
  ['solar-system', ['solar-system'], true],
  ['stress', ['stress', '--bodies', '300', '--steps', '240'], true],
  ['pile', ['pile', '--bodies', '120', '--steps', '240'], true],
  ['hills', ['hills', '--bodies', '120', '--steps', '240'], true],
  ['many', ['stress', '--bodies', '10000', '--steps', '600'], true],
  ['bowling', ['bowling'], true],
  ['pyramid', ['pyramid'], true],
  ['attack', ['attack.json'], true],
  ['single', ['t-handle', '--steps', '0'], false],
  ['still', ['still.json', '--steps', '3'], false],
  ['empty', ['empty.json', '--steps', '3'], false],
];
// Pictures to look at: names of scenes, sizes and schemes.
const pictured = ['t-handle', 'raft', 'solar-system', 'stress', 'pile', 'hills', 'many', 'bowling', 'pyramid'];
const sizes = [[1280, 800], [390, 844]];
const schemes = ['light', 'dark'];

function report(name, args) {
  execFileSync(program, ['run', ...args, '--quiet', '--report', name], { cwd: output });
  return join(output, name, 'report.html');
}

// A page that tells of everything that should not be.
async function open(browser, file, options, problems, before = () => {}) {
  const context = await browser.newContext(options);
  await context.addInitScript(before);
  const page = await context.newPage();
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => {
    // That the check itself reads pixels back is slow, and said.
    const ours = message.text().includes('GPU stall due to ReadPixels');
    if (['error', 'warning'].includes(message.type()) && !ours) problems.push(message.text());
  });
  page.on('dialog', (dialog) => { problems.push(`a dialog: ${dialog.message()}`); dialog.dismiss(); });
  const own = pathToFileURL(file).href;
  page.on('request', (request) => { if (request.url() !== own && !request.url().startsWith('data:')) problems.push(`loads ${request.url()}`); });
  await page.goto(own);
  await page.waitForFunction(() => document.body.dataset.replay);
  return page;
}

// Pixels of the canvas at some share of the run, kept in the page under a name.
async function keep(page, name, share) {
  await page.evaluate(async ([name, share]) => {
    const scrub = document.getElementById('scrub');
    scrub.value = 1000 * share;
    scrub.dispatchEvent(new Event('input'));
    for (let i = 0; i < 2; i += 1) await new Promise(requestAnimationFrame);
    const stage = document.getElementById('stage');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [stage.width, stage.height];
    const context = copy.getContext('2d');
    context.drawImage(stage, 0, 0);
    window.kept = { ...window.kept, [name]: context.getImageData(0, 0, copy.width, copy.height).data };
  }, [name, share]);
}

// How many pixels of two kept pictures differ.
function difference(page, one, other) {
  return page.evaluate(([one, other]) => {
    const [a, b] = [window.kept[one], window.kept[other]];
    let count = 0;
    for (let i = 0; i < a.length; i += 4) if ([0, 1, 2, 3].some((part) => a[i + part] !== b[i + part])) count += 1;
    return count;
  }, [one, other]);
}

// It plays by itself, and the lines in the plots go along.
async function playsByItself(page, name) {
  const cursor = () => page.getAttribute('.plot.wide .cursor', 'd');
  const before = await cursor();
  await page.waitForFunction((before) => document.querySelector('.plot.wide .cursor').getAttribute('d') !== before, before);
  await keep(page, 'stopped', 0.5);
  const place = await cursor();
  const plot = page.locator('.plot.wide svg').first();
  const box = await plot.boundingBox();
  await plot.click({ position: { x: 0.4 * box.width, y: 0.5 * box.height } });
  if (await cursor() === place) throw new Error(`${name}: a press in a plot goes nowhere`);
}

// A press in the middle of the picture of a body that is followed marks it.
async function marks(page, name) {
  await page.selectOption('#follow', { index: 2 });
  await keep(page, 'followed', 0.3);
  await page.locator('#stage').click();
  await page.waitForFunction(() => !document.getElementById('picked').hidden);
  await page.selectOption('#follow', { index: 0 });
  await page.keyboard.press('Escape');
  return page.textContent('#picked');
}

async function use(page, name) {
  await playsByItself(page, name);
  const marked = await marks(page, name);
  await keep(page, 'start', 0);
  await keep(page, 'later', 0.37);
  const scrubbed = await difference(page, 'start', 'later');
  await page.keyboard.press('ArrowRight');
  const clock = await page.textContent('#clock');
  await page.keyboard.press(' ');
  await page.waitForFunction((before) => document.getElementById('clock').textContent !== before, clock);
  await page.keyboard.press(' ');
  await keep(page, 'before', 0.37);
  await page.locator('#stage').scrollIntoViewIfNeeded();
  const box = await page.locator('#stage').boundingBox();
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 290, box.y + 190, { steps: 4 });
  await page.mouse.up();
  await page.mouse.wheel(0, -240);
  await keep(page, 'turned', 0.37);
  const turned = await difference(page, 'before', 'turned');
  await page.keyboard.down('Shift');
  await page.mouse.down();
  await page.mouse.move(box.x + 220, box.y + 160, { steps: 4 });
  await page.mouse.up();
  await page.keyboard.up('Shift');
  await keep(page, 'moved', 0.37);
  const moved = await difference(page, 'turned', 'moved');
  if (!(scrubbed > 100 && turned > 100 && moved > 100)) {
    throw new Error(`${name}: ${scrubbed} pixels changed by time, ${turned} by turning, ${moved} by moving`);
  }
  return `${scrubbed} pixels change with time, ${turned} by turning, ${moved} by moving; marked ${marked}`;
}

async function picture(browser, name, file, problems) {
  for (const [width, height] of sizes) {
    for (const colorScheme of schemes) {
      const phone = width < 600 ? { deviceScaleFactor: 2, hasTouch: true, isMobile: true } : {};
      const page = await open(browser, file, { viewport: { width, height }, colorScheme, ...phone }, problems);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      if (wide > width) throw new Error(`${name}: ${wide} pixels wide in a window of ${width}`);
      await keep(page, 'shown', 0.4);
      await page.screenshot({ path: join(output, `${name}-${width}-${colorScheme}.png`), fullPage: true });
      await page.context().close();
    }
  }
}

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'],
});
try {
  for (const [name, args, moves] of scenes) {
    const problems = [];
    const file = report(name, args);
    const page = await open(browser, file, { viewport: { width: 1280, height: 800 } }, problems);
    const drawn = await page.evaluate(() => performance.getEntriesByName('first frame')[0]?.startTime);
    const used = moves ? await use(page, name) : 'nothing moves';
    if (await page.locator('img').count()) throw new Error(`${name}: a name became an element`);
    if (name !== 'empty' && !(drawn < OPENS_WITHIN)) throw new Error(`${name}: first frame after ${drawn} ms`);
    const said = await page.textContent('.thinned');
    if (name === 'many' && !said.includes('All bodies are shown.')) throw new Error(`${name}: says ${said}`);
    await page.context().close();
    if (pictured.includes(name)) await picture(browser, name, file, problems);
    if (problems.length) throw new Error(`${name}: ${problems.join('; ')}`);
    console.log(`${name}: ${(statSync(file).size / 1e6).toFixed(2)} MB, first frame after ${drawn?.toFixed(0) ?? '-'} ms, ${used}`);
  }
  const problems = [];
  const blind = () => { HTMLCanvasElement.prototype.getContext = () => null; };
  const page = await open(browser, join(output, 'raft', 'report.html'), {}, problems, blind);
  const sorry = await page.textContent('#sorry');
  if (!sorry.includes('no WebGL 2') || problems.length) throw new Error(`without WebGL: ${sorry} ${problems.join('; ')}`);
  console.log('without WebGL the page says so');
  console.log('all well');
} finally {
  await browser.close();
}
