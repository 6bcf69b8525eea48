// What the page offers to the check: load(url, bodies), frames(), show(time), pixels() and changed().

import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(800, 600);
renderer.setClearColor(0xf0f0f0);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(40, 800 / 600);

let scene;
let mixer;
let action;
let nodes;
let centers;
let taken = [];

function light() {
  const sun = new THREE.DirectionalLight(0xffffff, 2.5);
  sun.position.set(1, 3, 2);
  return [new THREE.HemisphereLight(0xffffff, 0x606060, 1.5), sun];
}

// An action that has come to its end is paused there.
function goTo(time) {
  action.reset().play();
  mixer.setTime(time);
}

// Looks at all of the scene, from wherever its bodies come and go.
function frame(clip) {
  const box = new THREE.Box3();
  for (const time of [0, 0.5, 1]) {
    if (clip) goTo(time * clip.duration);
    scene.updateMatrixWorld(true);
    box.expandByObject(scene);
  }
  if (box.isEmpty()) box.expandByPoint(new THREE.Vector3());
  const ball = box.getBoundingSphere(new THREE.Sphere());
  const size = ball.radius || 1;
  camera.position.copy(ball.center).add(new THREE.Vector3(0.6, 0.5, 1).normalize().multiplyScalar(size * 3));
  camera.near = size * 0.05;
  camera.far = size * 10;
  camera.updateProjectionMatrix();
  camera.lookAt(ball.center);
}

// Loads a file; the number of its nodes. The bodies of the record's first frame, if given, tell how far each centre of mass is from its node.
window.load = async (url, bodies) => {
  const gltf = await new GLTFLoader().loadAsync(url);
  scene = new THREE.Scene();
  scene.add(gltf.scene, ...light());
  // Names lose characters that three.js gives a meaning to, so nodes are taken by their index.
  nodes = await Promise.all((gltf.parser.json.nodes ?? []).map((_, index) => gltf.parser.getDependency('node', index)));
  mixer = new THREE.AnimationMixer(gltf.scene);
  action = undefined;
  const [clip] = gltf.animations;
  if (clip) {
    action = mixer.clipAction(clip);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
  }
  frame(clip);
  if (clip) goTo(0);
  centers = nodes.map((node, index) => {
    if (!bodies) return new THREE.Vector3();
    const { px, py, pz } = bodies[index];
    return new THREE.Vector3(px, py, pz).sub(node.position).applyQuaternion(node.quaternion.clone().invert());
  });
  taken = [];
  return nodes.length;
};

// How many times the animation has.
window.frames = () => action?.getClip().tracks[0].times.length ?? 0;

// Goes to a time of the animation; where the nodes are then.
window.show = (time) => {
  if (action) goTo(time);
  renderer.render(scene, camera);
  return nodes.map((node, index) => ({
    translation: node.position.toArray(),
    rotation: node.quaternion.toArray(),
    center: centers[index].clone().applyQuaternion(node.quaternion).toArray(),
  }));
};

// Keeps what is on the canvas.
window.pixels = () => {
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * 800 * 600);
  gl.readPixels(0, 0, 800, 600, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  taken.push(pixels);
};

// In how many pixels the first kept picture and the third differ.
window.changed = () => {
  const [a, , b] = taken;
  let count = 0;
  for (let i = 0; i < a.length; i += 4) {
    if (a[i] !== b[i] || a[i + 1] !== b[i + 1] || a[i + 2] !== b[i + 2]) count += 1;
  }
  return count;
};

window.ready = true;
