// node check_module.js CHECK MODULE FOLDER: a check of splatlas.wasm with the scenes of splatlas-web-scenes in FOLDER.
//   pictures   equal the native ones, to 2e-5 of full scale; picks are the same
//   interface  imports and exports are exactly those listed here
//   pieces     an atlas in pieces, as from a server, gives the same pictures, and not all of it is read
//   hostile    atlases with right checksums and wrong contents do as they do natively, never trap
// Exit status 77: there is no module.
'use strict';
const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');
require('../../../player/web/splatlas.js');

const kImports = ['wasi_snapshot_preview1.clock_time_get', 'wasi_snapshot_preview1.proc_exit'];
const kExports = ['__wasm_call_ctors', 'memory', 'splatlas_call', 'splatlas_floats', 'splatlas_input', 'splatlas_pixels',
  'splatlas_rest', 'splatlas_text', 'splatlas_text_bytes'];

function draw(splatlas, atlas, scene) {
  splatlas.open(atlas);
  splatlas.draw(scene);
  return splatlas.floats();
}

const valuesOf = bytes => new Float32Array(Uint8Array.from(bytes).buffer);

/** The largest difference, which must be small. */
function compare(floats, expected, what) {
  assert.strictEqual(floats.length, expected.length);
  let difference = 0;
  for (let i = 0; i < floats.length; ++i) difference = Math.max(difference, Math.abs(floats[i] - expected[i]));
  assert(difference <= 2e-5, `${what}: ${difference} of full scale`);
  return difference;
}

async function checkPictures(module, folder) {
  const splatlas = await Splatlas.load(module);
  const scenes = fs.readdirSync(folder).filter(name => name.endsWith('.json')).map(name => parseInt(name, 10));
  assert(scenes.length >= 100);
  let worst = 0, shown = 0, picked = 0;
  for (const n of scenes.sort((a, b) => a - b)) {
    const file = ending => fs.readFileSync(path.join(folder, `${n}.${ending}`));
    const floats = draw(splatlas, file('atlas'), JSON.parse(file('json')));
    const expected = valuesOf(file('floats'));
    worst = Math.max(worst, compare(floats, expected, `scene ${n}`));
    for (const {at, answer} of JSON.parse(file('picks'))) {
      assert.deepStrictEqual(splatlas.pick(...at)?.path, answer?.path, `scene ${n}: pick at ${at}`);
      picked += answer !== null;
    }
    shown += expected.some(value => value > 0);
  }
  assert(shown > 50 && picked > 50);
  checkScenes(splatlas, fs.readFileSync(path.join(folder, 'lesson.atlas')));
  assert(splatlas.draw({size: [8, 8], camera: {}}).heap < 32 << 20, 'the module keeps too much memory');
  console.log(`${scenes.length} pictures, ${shown} not empty, ${picked} picks: at most ${worst} of full scale apart`);
}

/** Scenes are what info() tells of them. */
function checkScenes(splatlas, lesson) {
  splatlas.open(lesson);
  const size = [160, 120];
  splatlas.info().scenes.forEach(scene => {
    const camera = {azimuth: scene.azimuth, elevation: scene.elevation, fit: {zoom: scene.zoom, center: scene.center}};
    splatlas.draw({select: scene.select, cuts: scene.cuts, camera, size});
    const floats = splatlas.floats();
    assert(floats.some(value => value > 0), scene.name);
    const {azimuth, elevation, select, cuts} = scene;
    const {zoom, center} = splatlas.fitted({select, cuts, size, camera: {azimuth, elevation, fit: {}}});
    const placed = {azimuth, elevation, zoom: zoom * scene.zoom, center: scene.center ?? center};
    splatlas.draw({select, cuts, size, camera: placed});
    assert.deepStrictEqual(splatlas.floats(), floats, scene.name);
  });
}

function checkInterface(module) {
  assert.deepStrictEqual(WebAssembly.Module.imports(module).map(i => `${i.module}.${i.name}`).sort(), kImports);
  assert.deepStrictEqual(WebAssembly.Module.exports(module).map(e => e.name).sort(), kExports);
}

async function checkPieces(module, folder) {
  const atlas = fs.readFileSync(path.join(folder, 'lesson.atlas'));
  const [whole, remote] = [await Splatlas.load(module), await Splatlas.load(module)];
  let read = 0, rounds = 0;
  const give = () => {
    const ranges = remote.wanted();
    for (const [offset, bytes] of ranges) {
      remote.give(offset, atlas.subarray(offset, offset + bytes));
      read += bytes;
    }
    rounds += ranges.length > 0;
    return ranges.length > 0;
  };
  const floatsOf = (splatlas, select) => {
    try {
      splatlas.draw({select, size: [120, 90], camera: {azimuth: 30, elevation: 20, fit: {}}});
    } catch (error) {
      assert(splatlas === remote && error.code === 'failed', error);  // nothing of it is there
      return null;
    }
    return splatlas.floats();
  };
  whole.open(atlas);
  while (!remote.openRemote(atlas.length)) assert(give(), 'the atlas does not open');
  const directory = read;
  for (const select of ['Sphere_1:surface', 'Sphere_1:both', '*:volume', '*:surface(ghost)']) {
    const expected = floatsOf(whole, select);
    let floats = floatsOf(remote, select);
    while (give()) floats = floatsOf(remote, select);
    assert.deepStrictEqual(floats, expected, select);
    if (select === 'Sphere_1:surface') assert(read - directory < 0.7 * atlas.length, 'read too much');
  }
  console.log(`${read} of ${atlas.length} bytes in ${rounds} rounds`);
  assert(read <= atlas.length);
  remote.openRemote(atlas.length);
  assert.deepStrictEqual(remote.wanted(), [[0, 64]]);
}

async function checkHostile(module, folder) {
  const splatlas = await Splatlas.load(module);
  const counts = {error: 0, part: 0, whole: 0};
  let slowest = 0;
  for (let n = 0; n < 400; ++n) {
    const [atlas, picture] = ['atlas', 'floats'].map(ending => path.join(folder, 'hostile', `${n}.${ending}`));
    const expected = fs.existsSync(picture) ? valuesOf(fs.readFileSync(picture)) : null;
    const begin = performance.now();
    let outcome = 'error';
    try {
      splatlas.open(fs.readFileSync(atlas));
      splatlas.info();
      const state = {select: '*:both', size: [32, 32], caps: 'values', camera: {azimuth: 20, elevation: 10}};
      outcome = splatlas.draw(state).missing.length > 0 ? 'part' : 'whole';
    } catch (error) {
      if (!(error instanceof Splatlas.Error)) throw error;
      assert(expected === null || error.code === 'limit', `atlas ${n}: ${error}`);
    }
    slowest = Math.max(slowest, performance.now() - begin);
    if (outcome === 'whole') compare(splatlas.floats(), expected, `atlas ${n}`);
    ++counts[outcome];
  }
  console.log(counts, `slowest ${slowest.toFixed(0)} ms`);
  assert(counts.error > 100 && counts.part > 20 && counts.whole > 20);
}

async function main([check, file, folder]) {
  if (!fs.existsSync(file)) return 77;
  const module = await WebAssembly.compile(fs.readFileSync(file));
  await {pictures: checkPictures, interface: checkInterface, pieces: checkPieces, hostile: checkHostile}[check](module, folder);
  return 0;
}

main(process.argv.slice(2)).then(
  status => process.exit(status),
  error => {
    console.error(error);
    process.exit(1);
  });
