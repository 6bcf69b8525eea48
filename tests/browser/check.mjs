// Records scenes with the program, validates every .glb with the Khronos validator, plays it in a browser with three.js, and compares
// where the bodies are with the .csv record of the same run.
//
// usage: node check.mjs PROGRAM [BROWSER]

import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

import validator from 'gltf-validator';
import { chromium } from 'playwright-core';

const here = dirname(fileURLToPath(import.meta.url));
const output = join(here, 'output');
const [program, browserPath = '/usr/bin/chromium'] = process.argv.slice(2);
if (!program) {
  console.error('usage: node check.mjs PROGRAM [BROWSER]');
  process.exit(2);
}

// In the browser numbers go from f32 through slerp in f64; 1e-5 of the size of a scene of some metres is a hundred roundings.
const TOLERANCE = 1e-5;

const kinds = {
  gravity: [0, -1, 0],
  bodies: [
    { name: 'block', shape: { cuboid: { half_extents: [0.5, 0.2, 0.3] } }, mass: 1, position: [-3, 1, 0], angular_velocity: [1, 5, 0.1] },
    { name: 'cone', shape: { cone: { radius: 0.5, half_height: 0.6 } }, mass: 1, position: [-1.5, 1, 0], angular_velocity: [6, 0, 2] },
    { name: 'capsule', shape: { capsule: { radius: 0.3, half_height: 0.4 } }, mass: 1, angular_velocity: [0, 1, 3] },
    { name: 'egg', shape: { ellipsoid: { radii: [0.3, 0.6, 0.4] } }, mass: 1, position: [1.5, 1, 0], linear_velocity: [0, 2, 0] },
    { name: 'drum [1]', shape: { cylinder: { radius: 0.4, half_height: 0.3 } }, mass: 1, position: [3, 1, 0], angular_velocity: [3, 1, 0] },
    { name: 'a dumb.bell', mass: 3, position: [0, 3, 0], angular_velocity: [0, 0, 4], linear_velocity: [0.2, 0, 0],
      shape: { compound: { parts: [
        { shape: { sphere: { radius: 0.4 } }, mass: 2, position: [-0.6, 0, 0] },
        { shape: { hollow_sphere: { radius: 0.25 } }, mass: 1, position: [0.6, 0, 0] },
        { shape: { cylinder: { radius: 0.1, half_height: 0.6 } }, mass: 0.1, orientation: [0, 0, Math.SQRT1_2, Math.SQRT1_2] } ] } } },
    { name: 'bead', mass: 0.1, position: [0, 2, 1], linear_velocity: [1, 0, 0] },
    { name: 'floor', fixed: true, shape: { cuboid: { half_extents: [5, 0.1, 3] } }, position: [0, -2, 0] },
    { name: 'belt', kinematic: true, shape: { cuboid: { half_extents: [1, 0.05, 0.5] } }, position: [0, -1.5, 0], linear_velocity: [0.3, 0, 0], angular_velocity: [0, 1, 0] },
  ],
};

mkdirSync(output, { recursive: true });
writeFileSync(join(output, 'kinds.json'), JSON.stringify(kinds));
writeFileSync(join(output, 'empty.json'), '{ "bodies": [] }');
writeFileSync(join(output, 'still.json'), '{ "bodies": [{ "fixed": true, "shape": { "sphere": { "radius": 1 } } }] }');

// Name, arguments of the run, and whether the motion can be seen in the picture.
const scenes = [
  ['kinds', ['kinds.json', '--steps', '240', '--every', '2'], true],
  ['t-handle', ['t-handle', '--steps', '600', '--every', '3'], true],
  ['raft', ['raft', '--steps', '200'], true],
  ['solar-system', ['solar-system', '--steps', '200'], true],
  ['stress', ['stress', '--bodies', '200', '--steps', '120'], true],
  ['pile', ['pile', '--bodies', '60', '--steps', '120'], true],
  ['bowling', ['bowling', '--steps', '200'], true],
  ['hills', ['hills', '--bodies', '60', '--steps', '120'], true],
  ['everything', [join(here, '../../crates/tumble-scene/tests/gltf_scenes/everything.gltf'), '--steps', '60'], true],
  ['single', ['t-handle', '--steps', '0'], false],
  ['still', ['still.json', '--steps', '3'], false],
  ['empty', ['empty.json', '--steps', '3'], false],
];

function record(name, args) {
  for (const ending of ['csv', 'glb']) {
    execFileSync(program, ['run', ...args, '--quiet', '--record', `${name}.${ending}`], { cwd: output });
  }
}

// Kills a run that would take for ever; what is left is a file with some of its frames.
async function kill(name) {
  const run = spawn(program, ['run', 'stress', '--bodies', '50', '--steps', '1000000000', '--every', '100000', '--quiet', '--record', `${name}.glb`], { cwd: output });
  await new Promise((resolve) => setTimeout(resolve, 3500));
  run.kill('SIGKILL');
  await new Promise((resolve) => run.once('exit', resolve));
}

// The rows of a .csv by step, and the columns by name. Names of these scenes have no commas.
function frames(name) {
  const [head, ...lines] = readFileSync(join(output, `${name}.csv`), 'utf8').trim().split('\n');
  const columns = head.split(',');
  const found = new Map();
  for (const line of lines) {
    const row = Object.fromEntries(line.split(',').map((value, index) => [columns[index], value]));
    for (const column of columns) if (column !== 'body') row[column] = Number(row[column]);
    if (!found.has(row.step)) found.set(row.step, { time: row.time, bodies: [] });
    found.get(row.step).bodies.push(row);
  }
  return [...found.values()];
}

async function validate(name) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(join(output, `${name}.glb`))), { maxIssues: 100 });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  const counts = new Map();
  for (const { code } of messages) counts.set(code, (counts.get(code) ?? 0) + 1);
  const codes = [...counts].map(([code, count]) => `${code} ${count}`).join(', ');
  if (numErrors || numWarnings) {
    console.error(JSON.stringify(messages.slice(0, 10), null, 1));
    throw new Error(`${name}.glb: ${numErrors} errors, ${numWarnings} warnings`);
  }
  return `0 errors, 0 warnings, ${numInfos} infos, ${numHints} hints${codes && ` (${codes})`}`;
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.glb': 'model/gltf-binary' };

function serve() {
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, 'http://localhost').pathname);
    try {
      const body = readFileSync(join(here, path));
      response.writeHead(200, { 'content-type': types[extname(path)] ?? 'application/octet-stream' }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  return new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(server)));
}

// Where three.js has the centres of mass and the frames of the bodies, against the record.
function compare(name, shown, frame, extent) {
  let [position, angle] = [0, 0];
  frame.bodies.forEach((body, index) => {
    const { translation: t, rotation: q, center: c } = shown[index];
    // The file has the frame's origin; the record has the centre of mass, which the first frame tells in the body's frame.
    const world = [t[0] + c[0], t[1] + c[1], t[2] + c[2]];
    position = Math.max(position, ...['px', 'py', 'pz'].map((axis, i) => Math.abs(world[i] - body[axis]) / extent));
    const sign = Math.sign(q[0] * body.qx + q[1] * body.qy + q[2] * body.qz + q[3] * body.qw);
    angle = Math.max(angle, ...['qx', 'qy', 'qz', 'qw'].map((axis, i) => Math.abs(q[i] - sign * body[axis])));
  });
  if (!(position <= TOLERANCE && angle <= TOLERANCE)) {
    throw new Error(`${name} at ${frame.time} s: positions off by ${position} of the scene, quaternions by ${angle}`);
  }
  return [position, angle];
}

async function play(page, name, seen) {
  const all = frames(name);
  const numbers = all.flatMap((frame) => frame.bodies.flatMap((body) => [body.px, body.py, body.pz])).map(Math.abs);
  const extent = numbers.reduce((a, b) => Math.max(a, b), 1);
  const first = all[0]?.bodies ?? [];
  const nodes = await page.evaluate(({ url, bodies }) => window.load(url, bodies), { url: `output/${name}.glb`, bodies: first });
  if (nodes !== first.length) throw new Error(`${name}: ${nodes} nodes, ${first.length} bodies`);
  let worst = [0, 0];
  const pictures = [];
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    const frame = all[Math.round(share * (all.length - 1))];
    if (!frame) break;
    const shown = await page.evaluate((time) => window.show(time), frame.time);
    worst = compare(name, shown, frame, extent).map((value, i) => Math.max(value, worst[i]));
    pictures.push(await page.evaluate(() => window.pixels()));
    if (share === 0.5) await page.screenshot({ path: join(output, `${name}.png`) });
  }
  const changed = pictures.length > 1 ? await page.evaluate(() => window.changed()) : 0;
  if (seen && !(changed > 100)) throw new Error(`${name}: only ${changed} pixels differ between two times`);
  return `${nodes} nodes, ${all.length} frames, positions within ${worst[0].toExponential(1)} of the scene, quaternions within ${worst[1].toExponential(1)}, ${changed} pixels differ`;
}

const server = await serve();
const browser = await chromium.launch({
  executablePath: browserPath,
  args: ['--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'],
});
try {
  const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
  const problems = [];
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
  await page.goto(`http://127.0.0.1:${server.address().port}/page.html`);
  await page.waitForFunction(() => window.ready);
  for (const [name, args, seen] of scenes) {
    record(name, args);
    console.log(`${name}.glb: ${await validate(name)}`);
    console.log(`  ${await play(page, name, seen)}`);
  }
  await kill('killed');
  console.log(`killed.partial.glb: ${await validate('killed.partial')}`);
  const left = await page.evaluate((url) => window.load(url), 'output/killed.partial.glb');
  const frames = await page.evaluate(() => window.frames());
  if (left !== 50 || frames < 2) throw new Error(`killed.partial.glb: ${left} nodes, ${frames} frames`);
  console.log(`  ${left} nodes, ${frames} frames`);
  if (problems.length) throw new Error(`the page said: ${problems.join('; ')}`);
  console.log('all well');
} finally {
  await browser.close();
  server.close();
}
