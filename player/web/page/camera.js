// Moves of the camera, as those of player/camera_moves.h. Part of the page's script.
'use strict';

const Camera = (() => {
const kFit = 0.96;  // diameter of the atlas at zoom 1, relative to the smaller side of the picture
const kMinZoom = 0.05;
const kMaxZoom = 200;
const kRadians = Math.PI / 180;

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** Directions of the picture's right and upper side, in LPS. */
function sides({azimuth, elevation}) {
  const [a, e] = [azimuth * kRadians, elevation * kRadians];
  return {
    right: [Math.cos(a), Math.sin(a), 0],
    up: [-Math.sin(e) * Math.sin(a), Math.sin(e) * Math.cos(a), Math.cos(e)],
  };
}

return {
  kMinZoom, kMaxZoom,

  isPerspective(camera) { return camera.projection === 'perspective'; },

  /** Millimetres of a pixel, in perspective at the centre. `size`: [width, height]; `display`: that of the atlas. */
  mmPerPixel(camera, size, display) {
    return 2 * (display.radius_mm || 1) / (kFit * Math.min(...size) * camera.zoom);
  },

  /** Turns by degrees. */
  turned(camera, azimuth, elevation) {
    const turn = ((camera.azimuth + azimuth + 180) % 360 + 360) % 360 - 180;
    return {...camera, azimuth: turn, elevation: clamp(camera.elevation + elevation, -90, 90)};
  },

  /** Turns by a drag of pixels: the side that faces the viewer follows the pointer. */
  turnedByDrag(camera, dx, dy, size) {
    const degrees = 180 / Math.min(...size);
    return Camera.turned(camera, -dx * degrees, dy * degrees);
  },

  /** Moves by a drag of pixels: what is under the pointer follows it. A camera that is to be fitted stays. */
  movedByDrag(camera, dx, dy, size, display) {
    if (camera.fit) return camera;
    const {right, up} = sides(camera);
    const mm = Camera.mmPerPixel(camera, size, display);
    const center = camera.center ?? display.center_lps_mm;
    return {...camera, center: center.map((c, axis) => c + (-dx * right[axis] + dy * up[axis]) * mm)};
  },

  /** Zooms about the point (x, y) of the picture, which stays where it is. */
  zoomedAt(camera, factor, x, y, size, display) {
    if (camera.fit) return {...camera, fit: {...camera.fit, zoom: camera.fit.zoom * factor}};
    const zoom = clamp(camera.zoom * factor, kMinZoom, kMaxZoom);
    const [dx, dy] = [x - size[0] / 2, y - size[1] / 2];
    const kept = 1 - zoom / camera.zoom;
    return Camera.movedByDrag({...camera, zoom}, dx * kept, dy * kept, size, display);
  },

  /** The camera on the way from one to another, `at` from 0 to 1. Both are placed. */
  between(from, to, at, display) {
    const mix = (a, b) => a + (b - a) * at;
    const turn = ((to.azimuth - from.azimuth + 180) % 360 + 360) % 360 - 180;
    const [a, b] = [from.center ?? display.center_lps_mm, to.center ?? display.center_lps_mm];
    return at >= 1 ? to : {
      ...to, azimuth: from.azimuth + turn * at, elevation: mix(from.elevation, to.elevation),
      zoom: from.zoom * (to.zoom / from.zoom) ** at, center: a.map((c, axis) => mix(c, b[axis])),
    };
  },

  /** Letters of the directions at the four sides of the picture: {left: 'R', ...}. */
  letters(camera) {
    const {right, up} = sides(camera);
    const letter = direction => {
      const axis = [0, 1, 2].reduce((a, b) => (Math.abs(direction[b]) > Math.abs(direction[a]) + 1e-9 ? b : a));
      return ['LR', 'PA', 'SI'][axis][direction[axis] > 0 ? 0 : 1];
    };
    const against = direction => direction.map(value => -value);
    return {right: letter(right), left: letter(against(right)), top: letter(up), bottom: letter(against(up))};
  },
};
})();
