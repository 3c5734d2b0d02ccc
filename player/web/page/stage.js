// The picture with its pointer, keys, scale bar and directions. Part of the page's script.
'use strict';

const kMaxPixels = 8.4e6;  // 4K
const kClickPixels = 6;
const kClickMs = 500;
const kTurnDegrees = 10;   // of a key
const kMovePixels = 30;    // of a key
const kZoomStep = 1.25;    // of a key
const kWheelRate = 0.0015;

/** Shows pictures and turns input into cameras. Calls the handlers {camera, pick(u, v, purpose), hover, leave, resized};
 * the purpose of a pick is 'choose', 'focus' or 'menu'. */
class Stage {
  #handlers;
  #stage = document.getElementById('stage');
  #canvas = document.getElementById('canvas');
  #bar = document.getElementById('scale-bar');
  #pointers = new Map();  // positions of fingers and mouse, by id
  #press = null;          // where and when a click may have begun

  constructor(handlers) {
    this.#handlers = handlers;
    /** Set by start(). */
    this.camera = null;
    this.display = null;
  }

  start(camera, display) {
    this.camera = camera;
    this.display = display;
    const canvas = this.#canvas;
    canvas.addEventListener('pointerdown', event => this.#down(event));
    canvas.addEventListener('pointermove', event => this.#move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => this.#up(event));
    canvas.addEventListener('contextmenu', event => {
      event.preventDefault();
      this.#pick(this.#place(event), 'menu');
    });
    canvas.addEventListener('dblclick', event => this.#pick(this.#place(event), 'focus'));
    canvas.addEventListener('pointerleave', () => this.#handlers.leave());
    canvas.addEventListener('wheel', event => this.#wheel(event), {passive: false});
    canvas.addEventListener('keydown', event => this.#key(event));
    // An observer must not change what it observes
    new ResizeObserver(() => requestAnimationFrame(() => this.#handlers.resized())).observe(this.#stage);
    this.#mark(camera);
  }

  /** [width, height] in pixels of the page. */
  size() { return [Math.max(1, this.#stage.clientWidth), Math.max(1, this.#stage.clientHeight)]; }

  /** [width, height] of a picture for the screen. */
  pictureSize() {
    const [width, height] = this.size();
    const ratio = Math.min(devicePixelRatio, 2, Math.sqrt(kMaxPixels / (width * height)));
    return [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  }

  /** Puts a picture on the canvas, which the style stretches over the stage, with its scale and directions. */
  draw({width, height, data, part: [x, y, ...size], camera}) {
    this.#mark(camera);
    const canvas = this.#canvas;
    const context = canvas.getContext('2d');
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    context.clearRect(0, 0, width, height);
    context.putImageData(new ImageData(data, ...size), x, y);
  }

  /** Shows the scale and the directions of a camera. */
  #mark(camera) {
    const [width, height] = this.size();  // before any change, after which it takes a layout of the page
    const letters = Camera.letters(camera);
    for (const side of Object.keys(letters)) document.getElementById(`side-${side}`).textContent = letters[side];
    const mm = Camera.mmPerPixel(camera, [width, height], this.display);
    const room = 0.3 * width * mm;
    const power = 10 ** Math.floor(Math.log10(room));
    const length = [5, 2, 1].find(n => n * power <= room) * power;
    this.#bar.hidden = Camera.isPerspective(camera);  // the scale changes with the depth
    this.#bar.style.width = `${100 * length / mm / width}%`;
    this.#bar.textContent = length >= 10 ? `${length / 10} cm` : `${Number(length.toPrecision(3))} mm`;
    this.#stage.style.setProperty('--aspect', `${width} / ${height}`);
  }

  #set(camera) {
    this.camera = camera;
    this.#handlers.leave();
    this.#handlers.camera();
  }

  #pick([x, y], purpose) {
    const [width, height] = this.size();
    this.#handlers.pick(x / width, y / height, purpose);
  }

  #place(event) {
    const box = this.#canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #down(event) {
    this.#canvas.setPointerCapture(event.pointerId);
    this.#canvas.focus({preventScroll: true});
    this.#pointers.set(event.pointerId, this.#place(event));
    const isClick = this.#pointers.size === 1 && event.button === 0;
    this.#press = isClick ? {at: this.#place(event), time: event.timeStamp} : null;
  }

  #move(event) {
    const before = this.#pointers.get(event.pointerId);
    const at = this.#place(event);
    if (!before) return this.#handlers.hover(...at, this.size());
    if (this.#press && Math.hypot(at[0] - this.#press.at[0], at[1] - this.#press.at[1]) < kClickPixels) return undefined;
    this.#press = null;
    if (this.#pointers.size >= 2) {
      this.#pinch(event.pointerId, before, at);
    } else {
      const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
      const isPan = event.shiftKey || (event.buttons & 4) !== 0;
      this.#set(isPan ? Camera.movedByDrag(this.camera, dx, dy, this.size(), this.display) :
        Camera.turnedByDrag(this.camera, dx, dy, this.size()));
    }
    this.#pointers.set(event.pointerId, at);
    return undefined;
  }

  /** One of two fingers has moved: zooms by their distance, and moves by their middle. */
  #pinch(id, before, at) {
    const other = [...this.#pointers].find(([key]) => key !== id)[1];
    const distance = point => Math.max(10, Math.hypot(point[0] - other[0], point[1] - other[1]));
    const [x, y] = [(at[0] + other[0]) / 2, (at[1] + other[1]) / 2];
    const factor = distance(at) / distance(before);
    const zoomed = Camera.zoomedAt(this.camera, factor, x, y, this.size(), this.display);
    const [dx, dy] = [(at[0] - before[0]) / 2, (at[1] - before[1]) / 2];
    this.#set(Camera.movedByDrag(zoomed, dx, dy, this.size(), this.display));
  }

  #up(event) {
    const press = this.#press;
    this.#press = null;
    this.#pointers.delete(event.pointerId);
    if (event.type === 'pointerup' && press && event.timeStamp - press.time <= kClickMs) this.#pick(press.at, 'choose');
  }

  #wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    const [x, y] = this.#place(event);
    this.#set(Camera.zoomedAt(this.camera, Math.exp(-pixels * kWheelRate), x, y, this.size(), this.display));
  }

  /** Zooms about the middle. */
  zoom(factor) {
    const [width, height] = this.size();
    this.#set(Camera.zoomedAt(this.camera, factor, width / 2, height / 2, [width, height], this.display));
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    if (arrow && event.shiftKey) {
      const [dx, dy] = arrow.map(n => n * kMovePixels);
      this.#set(Camera.movedByDrag(this.camera, dx, dy, this.size(), this.display));
    } else if (arrow) {
      this.#set(Camera.turned(this.camera, -arrow[0] * kTurnDegrees, arrow[1] * kTurnDegrees));
    } else {
      return;
    }
    event.preventDefault();
  }
}
