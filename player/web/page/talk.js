// What helps in a talk: names on the picture and at the pointer, the menu at a structure, the large picture, the saved
// picture. Part of the page's script.
'use strict';

const kNameSizes = [0, 13, 18, 26];  // pixels of the page
const kNamePoints = 8.5;              // of print
const kRestMs = 60;  // of the pointer, before its name is asked for

/** A text beside the pointer, with what is under it. Calls ask(u, v) when the pointer rests. */
class PointerName {
  #box = document.getElementById('hover');
  #timer = 0;
  #isOver = false;  // the picture
  #ask;

  constructor(ask) { this.#ask = ask; }

  /** The pointer is at (x, y) of a picture of this size. */
  move(x, y, [width, height]) {
    clearTimeout(this.#timer);
    this.#isOver = true;
    this.#box.style.left = `${Math.min(x + 14, width - 150)}px`;
    this.#box.style.top = `${Math.min(y + 18, height - 40)}px`;
    this.#timer = setTimeout(() => this.#ask(x / width, y / height), kRestMs);
  }

  hide() {
    clearTimeout(this.#timer);
    this.#isOver = false;
    this.#box.replaceChildren();
  }

  show(picked) { this.#box.replaceChildren(...(picked && this.#isOver ? [nameElement(picked.name)] : [])); }
}

class Menu {
  #box = document.getElementById('menu');

  /** @param {[string, function][]} items what each does with the structure */
  constructor(items) {
    for (const [name, act] of items) {
      const item = element('button', {role: 'menuitem'}, name);
      item.addEventListener('click', () => {
        const index = this.index;
        this.close();
        act(index);
      });
      this.#box.append(item);
    }
    this.#box.addEventListener('keydown', event => this.#key(event));
    document.addEventListener('pointerdown', event => {
      if (!this.#box.contains(event.target)) this.#box.hidden = true;
    });
  }

  open(index, x, y) {
    this.index = index;
    this.#box.hidden = false;
    const {offsetParent: room, offsetWidth: width, offsetHeight: height} = this.#box;
    this.#box.style.left = `${Math.max(0, Math.min(x, room.clientWidth - width))}px`;
    this.#box.style.top = `${Math.max(0, Math.min(y, room.clientHeight - height))}px`;
    this.#box.firstElementChild.focus();
  }

  close() {
    this.#box.hidden = true;
    document.getElementById('canvas').focus();
  }

  #key(event) {
    if (!/^(F5|Page)/.test(event.key)) event.stopPropagation();
    if (event.key === 'Escape') this.close();
    const by = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (!by) return;
    event.preventDefault();
    const items = [...this.#box.children];
    items[(items.indexOf(document.activeElement) + by + items.length) % items.length].focus();
  }
}

/** Fades all for a moment but where the rows have a 1, as of Splatlas.light(). */
function lightUp(rows) {
  if (!rows.some(row => row.includes('1')) || matchMedia('(prefers-reduced-motion: reduce)').matches) return;
  const canvas = document.getElementById('light');
  [canvas.width, canvas.height] = [rows[0].length, rows.length];
  const context = canvas.getContext('2d');
  context.fillStyle = stageColor();
  rows.forEach((row, y) => [...row].forEach((digit, x) => { if (digit === '0') context.fillRect(x, y, 1, 1); }));
  canvas.animate([{opacity: 0.85}, {opacity: 0.85, offset: 0.4}, {opacity: 0}], 600);
}

/** The colour behind the picture, as #rrggbb. */
function stageColor() {
  const [, ...parts] = /(\d+), (\d+), (\d+)/.exec(getComputedStyle(document.querySelector('main')).backgroundColor);
  return `#${parts.map(part => Number(part).toString(16).padStart(2, '0')).join('')}`;
}

/** Names with lines to their structures, in three sizes. */
class Names {
  #canvas = document.getElementById('names');
  #font = getComputedStyle(document.body).fontFamily;
  #glyphs = {};
  size = 0;  // index into kNameSizes

  constructor(structures) {
    const context = this.#canvas.getContext('2d');
    context.font = `100px ${this.#font}`;
    for (const {name} of structures) {
      for (const letter of name) this.#glyphs[letter] ??= context.measureText(letter).width / 100;
    }
  }

  /** The next size, or none after the largest. */
  grow() { this.size = (this.size + 1) % kNameSizes.length; }

  /** What the engine needs to place them; null: no names are wanted. A scene that chooses labels has them anyway. */
  options(labels, pixelRatio) {
    const size = kNameSizes[this.size || Number(labels.length > 0)];
    if (size === 0) return null;
    return {glyphs: this.#glyphs, dpi: size * pixelRatio * 72 / kNamePoints, background: stageColor(), labels};
  }

  hide() { this.#canvas.hidden = true; }

  show({lines, dots, texts}, width, height) {
    const context = this.#canvas.getContext('2d');
    this.#canvas.width = width;
    this.#canvas.height = height;
    this.#canvas.hidden = false;
    const stroke = ([x0, y0, x1, y1], color, lineWidth) => {
      context.strokeStyle = color;
      context.lineWidth = lineWidth;
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
    };
    const disc = ([x, y], color, radius) => {
      context.fillStyle = color;
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
    };
    context.globalAlpha = 0.7;
    for (const line of lines) stroke(line, line[7], line[6]);
    for (const dot of dots) disc(dot, dot[5], dot[2] + dot[4]);
    context.globalAlpha = 1;
    for (const line of lines) stroke(line, line[5], line[4]);
    for (const dot of dots) disc(dot, dot[3], dot[2]);
    for (const [text, x, y, size, color] of texts) {
      context.font = `${size}px ${this.#font}`;
      context.fillStyle = color;
      context.fillText(text, x, y);
    }
  }
}

/** Saves what is on the screen: the picture with names, scale bar and caption. */
function savePicture(name, caption) {
  const [picture, names, bar] = ['canvas', 'names', 'scale-bar'].map(id => document.getElementById(id));
  const ratio = picture.width / picture.clientWidth;
  const made = document.createElement('canvas');
  const context = made.getContext('2d');
  const font = `${16 * ratio}px ${getComputedStyle(document.body).fontFamily}`;
  context.font = font;
  const lines = caption.split('\n').flatMap(paragraph => {
    const broken = [''];
    for (const word of paragraph.split(/\s+/)) {
      const longer = `${broken.at(-1)} ${word}`.trim();
      if (context.measureText(longer).width < picture.width - 32 * ratio) broken[broken.length - 1] = longer;
      else broken.push(word);
    }
    return broken;
  });
  [made.width, made.height] = [picture.width, picture.height + (caption ? (24 * lines.length + 16) * ratio : 0)];
  context.fillStyle = stageColor();
  context.fillRect(0, 0, made.width, made.height);
  context.drawImage(picture, 0, 0);
  if (!names.hidden) context.drawImage(names, 0, 0);
  [context.font, context.fillStyle] = [font, getComputedStyle(document.body).color];
  lines.forEach((line, n) => context.fillText(line, 16 * ratio, picture.height + (24 * n + 16) * ratio));
  if (!bar.hidden) {
    const [x, y, width] = [bar.offsetLeft, bar.offsetTop + bar.offsetHeight, bar.offsetWidth].map(side => side * ratio);
    context.fillRect(x, y, width, 2 * ratio);
    context.fillText(bar.textContent, x, y - 4 * ratio);
  }
  made.toBlob(blob => download(`${name}.png`, blob));
}

function download(name, blob) {
  const link = element('a', {download: name, href: URL.createObjectURL(blob)});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** The picture alone with its caption, the black screen, and a dot for the pointer. */
const Talk = {
  toggle(what) {
    const {dataset} = document.body;
    if (dataset[what]) delete dataset[what];
    else dataset[what] = 'true';
    if (what !== 'large') return;
    document.getElementById('canvas').focus({preventScroll: true});
    if (dataset.large) document.documentElement.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement) document.exitFullscreen();
  },

  /** Ends the black screen, the large picture or the dot. */
  end() {
    const what = ['black', 'large', 'dot'].find(each => document.body.dataset[each]);
    if (what) Talk.toggle(what);
  },

  start() {
    const dot = document.getElementById('dot');
    document.addEventListener('pointermove', event => {
      dot.style.transform = `translate(${event.clientX}px, ${event.clientY}px)`;
    });
    document.addEventListener('fullscreenchange', () => {  // browsers take the Escape that ends it
      if (!document.fullscreenElement) for (const what of ['black', 'large']) delete document.body.dataset[what];
    });
    document.addEventListener('pointerdown', () => { delete document.body.dataset.black; });
  },
};
