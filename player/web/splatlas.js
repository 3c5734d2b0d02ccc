// Loads splatlas.wasm, and class Splatlas: an atlas with one selection and picture. A plain script without
// dependencies for windows, workers (importScripts) and Node (require); assigns globalThis.Splatlas.
// Calls are synchronous. They throw Splatlas.Error with a message of one line and a code: 'failed', 'usage',
// 'invalid-atlas', 'not-found', 'limit' or 'cancelled'. The module then keeps its state. After any other exception,
// such as a trap, load the module anew.
'use strict';

(() => {
const kCodes = ['failed', 'usage', 'invalid-atlas', 'not-found', 'limit', 'cancelled'];

class SplatlasError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'SplatlasError';
    this.code = code;
  }
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
      proc_exit(status) { throw new Error(`splatlas.wasm ended with status ${status}`); },
    },
  };
}

/** An engine in a WebAssembly instance. */
class Module {
  #wasm;

  constructor(instance) {
    this.#wasm = instance.exports;
    this.#wasm.__wasm_call_ctors();
  }

  /** Answers a request and bytes: [status, text]. Views of the memory die when it grows: they are made anew. */
  call(request, bytes) {
    const text = new TextEncoder().encode(request);
    const input = this.#wasm.splatlas_input(bytes.length + text.length);
    if (input === 0) return [kCodes.indexOf('limit') + 1, 'out of memory'];
    const place = new Uint8Array(this.#wasm.memory.buffer, input, bytes.length + text.length);
    place.set(bytes);
    place.set(text, bytes.length);
    const status = this.#wasm.splatlas_call(text.length);
    const answer = new Uint8Array(this.#wasm.memory.buffer, this.#wasm.splatlas_text(), this.#wasm.splatlas_text_bytes());
    return [status, new TextDecoder().decode(answer)];
  }

  picture(width, height, quality) {
    const pixels = this.#wasm.splatlas_pixels();
    if (pixels === 0) throw new SplatlasError('limit', 'out of memory');
    const data = new Uint8ClampedArray(this.#wasm.memory.buffer, pixels, 4 * width * height).slice();
    if (quality !== 'draft') this.#wasm.splatlas_rest();
    return {data, part: [0, 0, width, height], heap: this.#wasm.memory.buffer.byteLength};
  }

  floats(count) {
    return new Float32Array(this.#wasm.memory.buffer, this.#wasm.splatlas_floats(), count).slice();
  }
}

/** An engine in the program that serves the page, for workers: they may wait for an answer. */
class Server {
  #url;
  #picture = null;  // of the latest answer

  constructor(url) { this.#url = url; }

  /** The answer is its status, the bytes of its text, the picture's part, the text, and the pixels of the part. */
  call(request) {
    const exchange = new XMLHttpRequest();
    exchange.open('POST', this.#url, false);
    exchange.responseType = 'arraybuffer';
    exchange.send(request);
    if (exchange.status !== 200) throw new Error(`the player answers ${exchange.status}`);
    const [status, bytes, ...part] = new Int32Array(exchange.response, 0, 6);
    this.#picture = {data: new Uint8ClampedArray(exchange.response, 24 + bytes), part};
    return [status, new TextDecoder().decode(new Uint8Array(exchange.response, 24, bytes))];
  }

  picture() { return this.#picture; }
}

class Splatlas {
  #engine;
  #values = 0;  // of the latest picture

  /** @param {Module|Server} engine see load() and connect() */
  constructor(engine) { this.#engine = engine; }

  /** Starts an instance of the module.
   * @param {BufferSource|WebAssembly.Module} module bytes of splatlas.wasm, or the compiled module, which a page can
   *   post to its workers
   * @returns {Promise<Splatlas>} */
  static async load(module) {
    if (!(module instanceof WebAssembly.Module)) module = await WebAssembly.compile(module);
    let instance = null;
    instance = await WebAssembly.instantiate(module, importsOf(() => instance.exports.memory));
    return new Splatlas(new Module(instance));
  }

  /** Takes the engine of `splatlas-player ATLAS`, which has opened its atlas. @returns {Splatlas} */
  static connect(url) { return new Splatlas(new Server(url)); }

  /** Opens an atlas in place of the one before. Nothing is selected.
   * @param {Uint8Array|ArrayBuffer} bytes of the file; copied */
  open(bytes) { this.#call('open', {}, bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes)); }

  /** Opens an atlas on a server: the caller fetches what wanted() names, gives it, and opens again until it is open.
   * Later pictures and fits may want more; their parts are missing until they are given.
   * @param {number} size of the file in bytes
   * @returns {boolean} whether it is open */
  openRemote(size) {
    try {
      this.#call('openRemote', {size});
    } catch (error) {
      if (error.code !== 'failed') throw error;
      return false;
    }
    return true;
  }

  /** Ranges of the file that calls have missed since the last wanted(). @returns {number[][]} [offset, bytes] */
  wanted() { return this.#call('wanted'); }

  /** Adds a piece of the file. @param {Uint8Array} bytes */
  give(offset, bytes) { this.#call('give', {offset}, bytes); }

  /** What the atlas holds: the document of `splatlas-player info --json`, see docs/web.md. @returns {object} */
  info() { return this.#call('info'); }

  /** Selects structures, as `splatlas-player render --select`. An error keeps the selection.
   * @param {string} text
   * @returns {string[]} warnings about terms without effect */
  select(text) { return this.#call('select', {select: text}); }

  /** Renders a state. docs/web.md has its keys, and those of the picture. @param {object} state
   * @returns {{width: number, height: number, data: Uint8ClampedArray, part: number[], missing: string[], heap: number}}
   *   `data` as ImageData, of a module the whole picture, of a server its part [x, y, width, height]; the rest is
   *   transparent. `heap`: bytes of the module's memory, which never shrinks */
  draw(state) {
    this.#values = 0;
    const answer = this.#call('draw', state);
    const [width, height] = state.size;
    this.#values = 4 * width * height;
    return {...answer, width, height, ...this.#engine.picture(width, height, state.quality)};
  }

  /** The camera that draw() would take for a state. @returns {object} */
  fitted(state) { return this.#call('fit', state); }

  /** The latest picture of a module in linear RGBA, premultiplied. @returns {Float32Array} 4 * width * height values */
  floats() { return this.#engine.floats(this.#values); }

  /** The structure that the latest picture shows at picture coordinates; (0.5, 0.5) is the middle of the first pixel.
   * @returns {?{index: number, id: string, name: string, path: string, point: number[]}} point in LPS mm */
  pick(x, y) { return this.#call('pick', {at: [x, y]}); }

  /** Where the latest picture shows a structure or its descendants. @param {number} structure index
   * @returns {string[]} for every fourth row, with '1' or '0' for every fourth column */
  light(structure) { return this.#call('light', {structure}); }

  /** The slice number `index` across an axis of the storage grid, 0 to 2, row by row along the first of the others.
   * @returns {{labels: number[], greys: string}} runs [1 + index of a structure or 0, count, ...], and two hexadecimal
   *   digits a voxel */
  slice(axis, index) { return this.#call('slice', {axis, index}); }

  /** Names with leader lines on the latest picture, as on a printed page, for a canvas of its size.
   * @param {object} options glyphs: the width of each letter in em; dpi: names have 8.5 points; background: '#rrggbb';
   *   labels: names of structures, none for all but ghosts
   * @returns {object} lines [x0, y0, x1, y1, width, color, casing, casing color], dots [x, y, radius, color, casing,
   *   casing color] and texts [text, x, baseline, size, color], in pixels; unlabelled: their number without room */
  labels(options) { return this.#call('labels', options); }

  /** Calls the engine. @returns its answer */
  #call(name, values = {}, bytes = new Uint8Array()) {
    const [status, text] = this.#engine.call(JSON.stringify({call: name, ...values}), bytes);
    if (status !== 0) throw new SplatlasError(kCodes[status - 1], text);
    return JSON.parse(text);
  }
}

Splatlas.Error = SplatlasError;
globalThis.Splatlas = Splatlas;
})();
