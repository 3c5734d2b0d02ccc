// The workers: one drafts and picks, one refines. Part of the page's script.
'use strict';

const kDraftBudget = 33;   // ms
const kRefineDelay = 120;  // ms of rest before a refinement
const kMaxRestarts = 3;
const kLargeHeap = 320 << 20, kRestDelay = 5000;  // bytes, ms: a larger refining worker ends so long after its picture
const kFirstPiece = 65536;  // bytes: header and directory of most atlases

/** The text of a data block of the page. */
function block(id) { return document.getElementById(id).textContent.trim(); }

/** The bytes of a data block of the page, which is removed: a page needs its atlas once. */
function takeBytes(id) {
  const text = block(id);
  document.getElementById(id).textContent = '';
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let n = 0; n < bytes.length; ++n) bytes[n] = characters.charCodeAt(n);
  return bytes;
}

/** The atlas could not be loaded from its server. */
class LoadError extends Error {}

/** A file beside the page, on a server that may answer with ranges. Fetches each piece once. */
class RemoteFile {
  #url;
  #first = null;         // bytes from the begin
  #pieces = new Map();   // promises of bytes, by range

  constructor(url) {
    this.#url = url;
    /** Of the file, in bytes; set by start(). */
    this.size = undefined;
  }

  /** Fetches the begin. @returns {?Uint8Array} the whole file, from servers without ranges; else null */
  async start() {
    const [response, bytes] = await this.#request(0, kFirstPiece);
    if (response.status === 200) return bytes;
    this.size = Number(response.headers.get('Content-Range')?.split('/')[1]);
    if (!Number.isInteger(this.size)) throw new LoadError(`${this.#url}: the server does not tell its size`);
    this.#first = bytes;
    return null;
  }

  piece(offset, bytes) {
    if (offset + bytes <= this.#first.length) return this.#first.slice(offset, offset + bytes);
    const range = `${offset} ${bytes}`;
    if (!this.#pieces.has(range)) {
      const piece = this.#fetch(offset, bytes);
      this.#pieces.set(range, piece);
      piece.catch(() => this.#pieces.delete(range));
    }
    return this.#pieces.get(range);
  }

  async #fetch(offset, bytes) {
    const [response, piece] = await this.#request(offset, bytes);
    if (response.status !== 206 || piece.length !== bytes)
      throw new LoadError(`${this.#url}: another answer than ${bytes} bytes`);
    return piece;
  }

  async #request(offset, bytes) {
    try {
      const response = await fetch(this.#url, {headers: {Range: `bytes=${offset}-${offset + bytes - 1}`}});
      if (!response.ok) throw new LoadError(`${this.#url}: the server answers ${response.status}`);
      return [response, new Uint8Array(await response.arrayBuffer())];
    } catch (error) {
      if (error instanceof LoadError) throw error;
      throw new LoadError(`${this.#url}: no answer; the page must come from a web server`);
    }
  }
}

/** Draws the newest state by workers. Calls the handlers {ready, picture, drawn, picked, hovered, labelled, lit, sliced, told,
 * error, stopped, ended}: `ended` when the program has, `told` is an error beside the picture, `error` one in its place. */
class Engine {
  #handlers;
  #module = null;
  #atlas = null;    // bytes; null: on a server
  #server = null;   // address of the native engine, up to the worker's number
  #lessons = '';   // address that saves lessons
  #remote = null;
  #source;
  #workers = [];  // drafts and picks, and refines (null: ended); the same one on a single core
  #serial = 0;
  #state = null;
  #asked = 0;     // serial number of the latest refinement that a worker was asked for
  #refined = 0;   // and of the latest that has come
  #timer = 0;     // to refine, or to end the refining worker
  #isLarge = false;  // the refining worker
  #fit = null;    // {resolve, reject} of the latest fit
  #restarts = [0, 0];  // of each worker, since its latest picture
  #isReady = false;

  constructor(handlers) { this.#handlers = handlers; }

  /** Finds an engine and starts the workers. Rejects where the browser lacks something. */
  async start() {
    const {url, served} = document.getElementById('atlas').dataset;
    await (served === undefined ? this.#load(url) : this.#connect());
    this.#source = URL.createObjectURL(new Blob([block('worker')], {type: 'text/javascript'}));
    const count = navigator.hardwareConcurrency === 1 && this.#server === null ? 1 : 2;
    for (let n = 0; n < count; ++n) this.#workers.push(this.#begin(n));
  }

  /** The program that serves the page has the engine. It plays as long as the page holds a connection to it. */
  async #connect() {
    const page = crypto.randomUUID();
    const alive = new EventSource(`alive?page=${page}`);
    await new Promise((resolve, reject) => {
      alive.onopen = resolve;
      alive.onerror = () => reject(new LoadError('the player does not answer'));
    });
    alive.onerror = () => {
      alive.close();
      for (const worker of this.#workers) worker.terminate();
      this.#handlers.ended();
    };
    this.#server = `${location.origin}/call?page=${page}&worker=`;
    this.#lessons = `/lesson?page=${page}`;
    history.replaceState(null, '', `/${location.hash}`);  // without the token
  }

  /** The page or its server has the WebAssembly module and the atlas. */
  async #load(url) {
    const packed = new Blob([takeBytes('module')]);
    const unpacked = new Response(packed.stream().pipeThrough(new DecompressionStream('gzip')));
    this.#module = await WebAssembly.compile(await unpacked.arrayBuffer());
    if (url) {
      this.#remote = new RemoteFile(url);
      this.#atlas = await this.#remote.start();
    } else {
      this.#atlas = takeBytes('atlas');
    }
  }

  /** Saves scenes into the atlas. @returns {[string, string]} 'saved', 'refused' or 'asks', and a line of text */
  save(scenes, replaces) {
    return fetch(`${this.#lessons}${replaces ? '&replaces=1' : ''}`, {method: 'POST', body: JSON.stringify(scenes)}).then(
      answer => answer.json()).catch(() => ['refused', 'the player does not answer']);
  }

  /** Whether the finished picture of the latest state has come. */
  isRefined() { return this.#refined === this.#serial; }

  /** Draws a state: {select, palette, cuts, camera, size, depthCue}. A draft at once, and a finished picture after it. A camera
   * with `fit`, {structure, zoom, center}, is fitted first. */
  show(state) {
    const isNew = state.select !== this.#state?.select;
    const isHasty = this.#asked === this.#serial && !this.isRefined();
    this.#state = state;
    ++this.#serial;
    clearTimeout(this.#timer);
    this.#draft(isHasty);
    if (this.#workers.at(-1) === null) this.#refine();
    else if (isNew && this.#workers.length > 1) this.#refineSoon();  // decoding takes longer than drawing
  }

  /** Asks for the structure at {u, v}, from 0 to 1 in the picture. The answer has the whole pick. */
  pick(pick) { this.#workers[0].postMessage({type: 'pick', serial: this.#serial, state: this.#state, pick}); }

  /** Asks for the name at {u, v} of the latest picture ('hover'), where a {structure} is in it ('light'), or for slices,
   * {wanted: [[axis, index], ...]} ('slices'). */
  ask(type, request) { this.#workers[0].postMessage({type, serial: this.#serial, ...request}); }

  /** Asks for names on the finished picture. */
  label(options) {
    if (this.#workers.at(-1) === null) return this.#refine();  // its picture is labelled
    if (this.isRefined()) this.#restLater();
    return this.#workers.at(-1).postMessage({type: 'label', serial: this.#serial, options});
  }

  /** The camera of a state with `fit`. No picture comes before the next show(). @returns {Promise<?object>} null once a
   * later fit is asked for */
  fitted(state) {
    clearTimeout(this.#timer);
    this.#fit?.resolve(null);
    const serial = ++this.#serial;
    return new Promise((resolve, reject) => {
      this.#fit = {serial, resolve, reject};
      this.#workers[0].postMessage({type: 'fit', serial, state});
    });
  }

  #begin(n) {
    const worker = new Worker(this.#source);
    worker.onmessage = ({data}) => this.#receive(n, data);
    worker.onerror = event => {
      event.preventDefault();
      this.#receive(n, {type: 'fatal', message: event.message || 'a worker has stopped'});
    };
    const engine = this.#server ? {server: this.#server + n} :
      {module: this.#module, atlas: this.#atlas, size: this.#remote?.size};
    worker.postMessage({type: 'start', ...engine});
    return worker;
  }

  #receive(n, message) {
    if (message.type === 'wanted') return this.#fetch(n, message.ranges);
    if (message.type === 'fatal') return this.#restart(n, message.message);
    if (message.type === 'ready') {
      if (n > 0) return;
      if (this.#isReady) return this.show(this.#state);
      this.#isReady = true;
      return this.#handlers.ready(message.info);
    }
    if (n === 0 && message.drawn) this.#handlers.drawn(message.drawn, message.colors);
    if (message.type === 'picked') return this.#handlers.picked(message.picked, message.pick);
    if (message.type === 'hovered') return this.#handlers.hovered(message.hovered);
    if (message.type === 'labelled') return message.serial === this.#serial && this.#handlers.labelled(message.layer);
    if (message.type === 'sliced') return this.#handlers.sliced(message.slices);
    if (message.type === 'lit') return message.serial === this.#serial && this.#handlers.lit(message.rows);
    if (message.type === 'fitted' || message.of === 'fit') {
      if (message.serial !== this.#fit?.serial) return undefined;
      return message.type === 'fitted' ? this.#fit.resolve(message.camera) : this.#fit.reject(new Error(message.message));
    }
    if (message.type === 'cancelled' && message.serial === this.#serial) this.#asked = 0;  // a draft has ended it
    if (message.type === 'cancelled') return message.serial === this.#serial && this.#refineSoon();
    if (message.type === 'error' && message.of !== 'draw') return this.#handlers.told(message.message, message.of);
    if (message.serial !== this.#serial) {
      // Drafts of a drag are shown although a newer one is asked for; old refinements are not
      if (message.type === 'picture' && message.quality === 'draft') this.#handlers.picture({...message, isOld: true});
      return undefined;
    }
    if (message.type === 'error') return this.#handlers.error(message.message);
    this.#restarts[n] = 0;
    const isDraft = message.quality === 'draft';
    if (message.isFitted && !isDraft) this.#state = {...this.#state, camera: message.camera};  // drafts may fit coarse surfaces
    if (!isDraft) [this.#refined, this.#isLarge] = [this.#serial, n > 0 && message.heap > kLargeHeap];
    if (!isDraft || this.#refined !== this.#serial) this.#handlers.picture(message);
    if (message.isHasty) this.#draft(false);
    else if (isDraft) this.#refineSoon();
    else this.#restLater();
    return undefined;
  }

  /** Fetches ranges of an atlas on a server, and gives them to a worker. */
  async #fetch(n, ranges) {
    const worker = this.#workers[n];
    try {
      const pieces = await Promise.all(ranges.map(async ([offset, bytes]) =>
        ({offset, bytes: await this.#remote.piece(offset, bytes)})));
      worker.postMessage({type: 'given', pieces});
    } catch (error) {
      worker.postMessage({type: 'withheld'});
      this.#handlers.error(`The atlas could not be loaded: ${error.message}. Choose again to try again.`);
    }
  }

  /** `isHasty`: in the middle of a refinement. A smaller draft comes first. */
  #draft(isHasty) {
    this.#workers[0].postMessage(
      {...this.#state, type: 'draw', serial: this.#serial, quality: 'draft', budget: kDraftBudget, isHasty});
  }

  #refineSoon() {
    if (this.#asked === this.#serial) return;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#refine(), kRefineDelay);
  }

  #refine() {
    this.#asked = this.#serial;
    const last = this.#workers.length - 1;
    this.#workers[last] ??= this.#begin(last);
    this.#workers[last].postMessage({...this.#state, type: 'draw', serial: this.#serial, quality: 'normal', budget: 0});
  }

  /** Gives the memory of a large refining worker back, which a module's heap cannot. The next state begins another one
   * at once: it decodes beside the drafts. */
  #restLater() {
    clearTimeout(this.#timer);
    if (!this.#isLarge) return;
    this.#timer = setTimeout(() => {
      this.#workers.at(-1).terminate();
      this.#workers[this.#workers.length - 1] = null;
    }, kRestDelay);
  }

  /** Replaces a worker whose module has failed. */
  #restart(n, reason) {
    this.#workers[n].terminate();
    this.#fit?.reject(new Error(reason));
    if (++this.#restarts[n] > kMaxRestarts) return this.#handlers.stopped(reason);
    this.#handlers.error(reason);
    this.#workers[n] = this.#begin(n);
    return undefined;
  }
}
