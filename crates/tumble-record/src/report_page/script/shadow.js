// ---- Light and shadow ----

// Width and height of the shadow map [texels].
const MAP_SIZE = 1024;
// The map reaches this far from the camera's target at most, across the light and along it [the camera's unit].
const MAP_REACH = [1.3, 1.3, 6];
// Radius of the soft edge of a shadow [texels].
const PENUMBRA = 4;

// Towards the sun, and two directions at right angles to it. At first it stands behind the viewer's left shoulder, and it
// stays in the world when the camera turns.
const light = (() => {
  const [rising, near, aside] = [0.74, 0.28, -0.61];
  const sun = [0, 0, 0];
  sun[axis] = rising;
  sun[first] = near * Math.cos(camera.yaw) - aside * Math.sin(camera.yaw);
  sun[second] = near * Math.sin(camera.yaw) + aside * Math.cos(camera.yaw);
  const unit = (vector) => vector.map((part) => part / Math.hypot(...vector));
  const towards = unit(sun);
  const across = unit(cross(up, towards));
  return { towards, across, above: cross(towards, across) };
})();

const shadowMap = (() => {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, MAP_SIZE, MAP_SIZE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, gl.LINEAR);
  for (const which of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, which, gl.CLAMP_TO_EDGE);
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { texture, target };
})();

// A box along the light around nothing.
const emptyBox = () => [0, 1, 2].map(() => [Infinity, -Infinity]);

// Has a box reach around a ball, from the target and in the camera's unit; what is nowhere casts no shadow.
function include(box, place, radius) {
  if (![...place, radius].every(Number.isFinite)) return;
  [light.across, light.above, light.towards].forEach((along, i) => {
    const at = dot(along, place);
    box[i] = [Math.min(box[i][0], at - radius), Math.max(box[i][1], at + radius)];
  });
}

// From the target and in the camera's unit to the map, column by column, with the width of a texel; nothing where no
// body near the target casts a shadow.
function mapOf(box) {
  const parts = box.map(([low, high], i) => [Math.max(low, -MAP_REACH[i]), Math.min(high, MAP_REACH[i])]);
  if (!parts.every(([low, high]) => low < high)) return undefined;
  const [x, y, z] = parts.map(([low, high]) => (low + high) / 2);
  const margin = 1 + 2 * PENUMBRA / MAP_SIZE;
  const half = margin * Math.max(...parts.slice(0, 2).map(([low, high]) => (high - low) / 2));
  const deep = margin * (parts[2][1] - parts[2][0]) / 2;
  const matrix = [0, 1, 2].flatMap((i) => [light.across[i] / half, light.above[i] / half, -light.towards[i] / deep, 0]);
  return { matrix: [...matrix, -x / half, -y / half, z / deep, 1], texel: 2 * half / MAP_SIZE };
}
