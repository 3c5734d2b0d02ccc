// Loads splatlas.wasm, and class Splatlas: an atlas with one selection, camera and picture. A plain script without
// dependencies for windows, workers (importScripts) and Node (require); assigns globalThis.Splatlas.
//
//   const splatlas = await Splatlas.load(bytesOfModule);
//   splatlas.open(bytesOfAtlas);
//   splatlas.select('Brain:surface');
//   splatlas.fit(512, 512);
//   const {width, height, data} = splatlas.render(512, 512);  // new ImageData(data, width, height)
//
// Calls are synchronous. They throw Splatlas.Error with a message of one line and a code: 'failed', 'usage',
// 'invalid-atlas', 'not-found', 'limit' or 'cancelled'. The module then keeps its state. After any other exception,
// such as a trap, load the module anew.
'use strict';

(() => {
const kCodes = ['failed', 'usage', 'invalid-atlas', 'not-found', 'limit', 'cancelled'];
const kCaps = ['values', 'labels', 'both', 'none'];
const kQualities = ['draft', 'normal', 'high'];

class SplatlasError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'SplatlasError';
    this.code = code;
  }
}

/** The position of a name in a list. */
function indexOf(names, name, what) {
  const n = names.indexOf(name);
  if (n < 0) throw new SplatlasError('usage', `${what}: ${name}: must be one of ${names.join(', ')}`);
  return n;
}

/** The module's imports: a clock and the end of the process. `memory` returns the instance's memory. */
function importsOf(memory) {
  const kMonotonic = 1;
  const now = id => (id >= kMonotonic ? performance.now() : Date.now());
  return {
    wasi_snapshot_preview1: {
      clock_time_get(id, precision, time) {
        new DataView(memory().buffer).setBigUint64(time, BigInt(Math.round(now(id) * 1e6)), true);
        return 0;
      },
      proc_exit(status) {
        throw new Error(`splatlas.wasm ended with status ${status}`);
      },
    },
  };
}

class Splatlas {
  #wasm;
  #values = 0;  // of the latest picture
  #cuts = [];

  /** @param {WebAssembly.Instance} instance see load() */
  constructor(instance) {
    this.#wasm = instance.exports;
    this.#wasm.__wasm_call_ctors();
    /** Camera of the next picture; see view(). */
    this.camera = {};
  }

  /** Starts an instance.
   * @param {BufferSource|WebAssembly.Module} module bytes of splatlas.wasm, or the compiled module, which a page can
   *   post to its workers
   * @returns {Promise<Splatlas>} */
  static async load(module) {
    if (!(module instanceof WebAssembly.Module)) module = await WebAssembly.compile(module);
    let instance = null;
    instance = await WebAssembly.instantiate(module, importsOf(() => instance.exports.memory));
    return new Splatlas(instance);
  }

  /** Opens an atlas in place of the one before. Nothing is selected; the camera is anterior.
   * @param {Uint8Array|ArrayBuffer} bytes of the file; copied */
  open(bytes) {
    this.#give(bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes));
    this.#call('open');
    this.camera = {};
  }

  /** Opens an atlas on a server: the caller fetches what wanted() names, gives it, and opens again until it is open.
   * Later pictures and fits may want more; their parts are missing until they are given.
   * @param {number} size of the file in bytes
   * @returns {boolean} whether it is open */
  openRemote(size) {
    try {
      this.#call('open_remote', size);
    } catch (error) {
      if (error.code !== 'failed') throw error;
      return false;
    }
    this.camera = {};
    return true;
  }

  /** Ranges of the file that calls have missed since the last wanted(). @returns {number[][]} [offset, bytes] */
  wanted() {
    return this.#answer('wanted');
  }

  /** Adds a piece of the file. @param {Uint8Array} bytes */
  give(offset, bytes) {
    this.#give(bytes);
    this.#call('give', offset);
  }

  /** What the atlas holds: the document of `splatlas-player info --json`. `structures` are in the order of their
   * indices, with id, name, parents (ids), color, voxels, triangles and terms (synonyms, languages, codes); `scenes`
   * have name, question, caption, select, azimuth, elevation, zoom, cuts and center; `views` name, azimuth and elevation; `display` the window of
   * grey values and the bounding sphere; `provenance` title, citation and licence.
   * @returns {object} */
  info() {
    return this.#answer('info');
  }

  /** Selects structures, as `splatlas-player render --select`. An error keeps the selection.
   * @param {string} text
   * @returns {string[]} warnings about terms without effect */
  select(text) {
    this.#give(new TextEncoder().encode(text));
    return this.#answer('select');
  }

  /** Mode, opacity and colour of every structure in the selection, by index.
   * @returns {Array[]} ['surface', 0.4, '#c0392b'] or ['off']; a surface
   *   may be a 'ghost'; the opacity is null where it is the default */
  drawn() {
    return this.#answer('drawn');
  }

  /** Shows a scene of the atlas, as `splatlas-player render --scene`: selects, turns and fits the camera.
   * @param {number} n index in info().scenes
   * @returns {{name: string, question: string, caption: string, select: string, camera: object, warnings: string[]}} */
  scene(n, width, height) {
    const scene = this.#answer('scene', n, width, height);
    this.camera = scene.camera;
    this.#cuts = this.info().scenes[n].cuts;
    return scene;
  }

  /** Changes the camera: azimuth and elevation in degrees, zoom (1: the atlas fills the picture), center in LPS mm or
   * null for that of the atlas, projection 'parallel' or 'perspective', fieldOfView in degrees. What is not given stays.
   * @param {object} camera */
  view(camera) {
    this.camera = {...this.camera, ...camera};
  }

  /** Fits the camera to the selection, or to its part in a structure with its descendants. Keeps the direction.
   * @param {number} [structure] index; none: the whole selection
   * @returns {object} the camera */
  fit(width, height, structure = -1) {
    this.#setCamera();
    this.camera = this.#answer('fit', width, height, structure);
    return this.camera;
  }

  /** Replaces the cuts, at most six: each removes the points p with normal.p > offset, in LPS mm.
   * @param {{normal: number[], offset: number}[]} planes */
  cut(planes) {
    const set = each => {
      this.#wasm.splatlas_clear_cuts();
      for (const {normal, offset} of each) this.#call('cut', ...normal, offset);
    };
    try {
      set(planes);
    } catch (error) {
      set(this.#cuts);
      throw error;
    }
    this.#cuts = [...planes];
  }

  /** Options of pictures.
   * @param {object} options caps: faces of cuts, 'values', 'labels', 'both' (default) or 'none'; depthCue: darken what is
   *   behind (default false); shading: light boundary voxels (default true); draftBudget: ms for a draft, 0 (default)
   *   for any */
  options({caps = 'both', depthCue = false, shading = true, draftBudget = 0} = {}) {
    this.#call('options', indexOf(kCaps, caps, 'caps'), +depthCue, +shading, draftBudget);
  }

  /** Renders a picture.
   * @param {number} width in pixels, an integer like the height
   * @param {'draft'|'normal'|'high'} quality
   * @returns {{width: number, height: number, data: Uint8ClampedArray, missing: string[]}} sRGB with straight alpha, as
   *   ImageData; `missing` tells what a damaged atlas lacks */
  render(width, height, quality = 'normal') {
    for (const side of [width, height]) {
      if (!Number.isInteger(side)) throw new SplatlasError('usage', `size: ${side}: must be an integer`);
    }
    this.#setCamera();
    this.#values = 0;
    const missing = this.#answer('render', width, height, indexOf(kQualities, quality, 'quality'));
    this.#values = 4 * width * height;
    const pixels = this.#wasm.splatlas_pixels();
    if (pixels === 0) throw new SplatlasError('limit', 'out of memory');
    const view = new Uint8ClampedArray(this.#wasm.memory.buffer, pixels, this.#values);
    return {width, height, data: view.slice(), missing};
  }

  /** The latest picture in linear RGBA, premultiplied. @returns {Float32Array} 4 * width * height values */
  floats() {
    return new Float32Array(this.#wasm.memory.buffer, this.#wasm.splatlas_floats(), this.#values).slice();
  }

  /** The structure that the latest picture shows at picture coordinates; (0.5, 0.5) is the middle of the first pixel.
   * @returns {?{index: number, id: string, name: string, path: string, point: number[]}} point in LPS mm */
  pick(x, y) {
    return this.#answer('pick', x, y);
  }

  /** Counts and times, in ms, of the latest picture. @returns {object} */
  stats() {
    return this.#answer('stats');
  }

  #setCamera() {
    const {azimuth = 0, elevation = 0, zoom = 1, center = null, projection = 'parallel', fieldOfView = 30} = this.camera;
    const [x, y, z] = center ?? [0, 0, 0];
    const isPerspective = indexOf(['parallel', 'perspective'], projection, 'projection');
    this.#wasm.splatlas_camera(azimuth, elevation, zoom, center ? 1 : 0, x, y, z, isPerspective, fieldOfView);
  }

  /** Copies the input of the next call. Views of the memory die when it grows: they are made anew after each call. */
  #give(bytes) {
    const input = this.#wasm.splatlas_input(bytes.length);
    if (input === 0) throw new SplatlasError('limit', 'out of memory');
    new Uint8Array(this.#wasm.memory.buffer, input, bytes.length).set(bytes);
  }

  /** Calls a function. Returns its text. */
  #call(name, ...numbers) {
    const status = this.#wasm['splatlas_' + name](...numbers);
    const begin = this.#wasm.splatlas_text();
    const bytes = new Uint8Array(this.#wasm.memory.buffer, begin, this.#wasm.splatlas_text_bytes());
    const text = new TextDecoder().decode(bytes);
    if (status !== 0) throw new SplatlasError(kCodes[status - 1], text);
    return text;
  }

  #answer(name, ...numbers) {
    return JSON.parse(this.#call(name, ...numbers));
  }
}

Splatlas.Error = SplatlasError;
globalThis.Splatlas = Splatlas;
})();
