// Three slices beside the picture, linked with the cuts. Part of the page's script.
'use strict';

const kLabelShare = 0.4;  // of a structure's colour over the grey value

/** Slices across the axes of the storage grid, at the places of the sliders of Cuts: grey values in the colours of what is
 * shown. Calls the handlers ask([[axis, index], ...]), moved(mm, axis): to a point of the slice across `axis`, and
 * named(index). */
class Slices {
  #model; #handlers; #size; #bounds;
  #mm = [0, 0, 0];
  #slices = [null, null, null];  // {axis, index, labels: of the voxels, greys}
  #canvases;

  constructor(model, handlers) {
    this.#model = model;
    this.#handlers = handlers;
    this.#size = model.info.storage_grid.size;
    this.#bounds = boundsOf(model.info.storage_grid);
    const isOblique = model.info.storage_grid.direction_lps.some((value, n) => n % 4 !== 0 && Math.abs(value) > 1e-3);
    byId('slice-box').hidden = isOblique;  // cuts would not lie along the slices
    this.#canvases = ['Right and left', 'Front and back', 'Bottom and top'].map((name, axis) => {
      const canvas = element('canvas', {role: 'img', 'aria-label': `Slice between ${name.toLowerCase()}`});
      const [along, across] = this.#sides(axis);
      [canvas.width, canvas.height] = [this.#size[along], this.#size[across]];
      const mm = [along, across].map(side => this.#bounds[side][1] - this.#bounds[side][0]);
      canvas.style.aspectRatio = mm.join('/');
      canvas.addEventListener('click', event => this.#point(axis, event));
      canvas.addEventListener('wheel', event => {
        event.preventDefault();
        if (event.deltaY === 0) return;
        const step = (this.#bounds[axis][1] - this.#bounds[axis][0]) / this.#size[axis];
        this.#move(axis, {[axis]: this.#mm[axis] + Math.sign(event.deltaY) * step});
      }, {passive: false});
      byId('slices').append(canvas);
      return canvas;
    });
    for (const id of ['slice-level', 'slice-window']) byId(id).addEventListener('input', () => this.draw());
  }

  /** The axes of the columns and rows of a slice. */
  #sides(axis) { return [0, 1, 2].filter(other => other !== axis); }

  #index(axis) {
    const [first, last] = this.#bounds[axis];
    const index = Math.floor((this.#mm[axis] - first) / (last - first) * this.#size[axis]);
    return Math.min(Math.max(index, 0), this.#size[axis] - 1);
  }

  /** Shows the slices at a point, if they can be seen. */
  show(mm) {
    this.#mm = mm;
    if (byId('cutting').hidden) return;
    const wanted = [0, 1, 2].filter(axis => this.#slices[axis]?.index !== this.#index(axis));
    if (wanted.length > 0) this.#handlers.ask(wanted.map(axis => [axis, this.#index(axis)]));
    this.draw();
  }

  take(slices) {
    for (const {axis, index, labels, greys} of slices) {
      const numbers = new Uint16Array(greys.length / 2);
      for (let n = 0, at = 0; n < labels.length; n += 2) numbers.fill(labels[n], at, at += labels[n + 1]);
      this.#slices[axis] = {index, labels: numbers, greys: numbers.map((_, n) => parseInt(greys.substr(2 * n, 2), 16))};
    }
    this.show(this.#mm);
  }

  draw() {
    if (byId('cutting').hidden) return;
    const colors = this.#model.structures.map((_, index) => {
      const [mode, , color] = this.#model.drawn[index];
      return mode === 'off' || mode === 'ghost' ? null : [1, 3, 5].map(at => parseInt(color.substr(at, 2), 16));
    });
    const [level, width] = [Number(byId('slice-level').value), Number(byId('slice-window').value)];
    this.#slices.forEach((slice, axis) => { if (slice) this.#paint(axis, slice, colors, level - width / 2, width); });
  }

  /** Front is on the left, and above in slices between bottom and top; superior is above in others. */
  #paint(axis, {labels, greys}, colors, low, width) {
    const canvas = this.#canvases[axis];
    const context = canvas.getContext('2d');
    const image = context.createImageData(canvas.width, canvas.height);
    labels.forEach((label, n) => {
      const row = Math.floor(n / canvas.width);
      const at = 4 * ((axis === 2 ? row : canvas.height - 1 - row) * canvas.width + n % canvas.width);
      const grey = Math.min(Math.max((greys[n] - low) / width, 0), 1) * 255;
      const color = label > 0 ? colors[label - 1] : null;
      for (let c = 0; c < 3; ++c) image.data[at + c] = color ? grey + kLabelShare * (color[c] - grey) : grey;
      image.data[at + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    canvas.dataset.index = String(this.#index(axis));
    const [x, y] = this.#sides(axis).map(side => this.#index(side) + 0.5);
    context.fillStyle = '#ffe60080';
    context.fillRect(x - 0.5, 0, 1, canvas.height);
    context.fillRect(0, (axis === 2 ? y : canvas.height - y) - 0.5, canvas.width, 1);
  }

  /** A click: the other slices go there, and the picture is cut. */
  #point(axis, event) {
    const canvas = this.#canvases[axis];
    const [u, v] = [event.offsetX / canvas.clientWidth, event.offsetY / canvas.clientHeight];
    const [along, across] = this.#sides(axis);
    const at = (side, part) => this.#bounds[side][0] + part * (this.#bounds[side][1] - this.#bounds[side][0]);
    this.#move(axis, {[along]: at(along, u), [across]: at(across, axis === 2 ? v : 1 - v)});
    const slice = this.#slices[axis];
    const row = Math.min(Math.floor((axis === 2 ? v : 1 - v) * canvas.height), canvas.height - 1);
    const label = slice?.labels[row * canvas.width + Math.min(Math.floor(u * canvas.width), canvas.width - 1)] ?? 0;
    this.#handlers.named(label > 0 ? label - 1 : null);
  }

  #move(axis, places) {
    const mm = this.#mm.map((old, side) => Math.min(Math.max(places[side] ?? old, this.#bounds[side][0]), this.#bounds[side][1]));
    this.#handlers.moved(mm, axis);
  }
}
