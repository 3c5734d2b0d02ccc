// What helps in a talk: the name at the pointer, the menu at a structure, the large picture. Part of the page's script.
'use strict';

const kRestMs = 60;  // of the pointer, before its name is asked for

/** A text beside the pointer, with what is under it. Calls ask(u, v) when the pointer rests. */
class PointerName {
  #box = document.getElementById('hover');
  #timer = 0;
  #ask;

  constructor(ask) {
    this.#ask = ask;
  }

  /** The pointer is at (x, y) of a picture of this size. */
  move(x, y, [width, height]) {
    clearTimeout(this.#timer);
    this.#box.style.left = `${Math.min(x + 14, width - 150)}px`;
    this.#box.style.top = `${Math.min(y + 18, height - 40)}px`;
    this.#timer = setTimeout(() => this.#ask(x / width, y / height), kRestMs);
  }

  hide() {
    clearTimeout(this.#timer);
    this.#box.replaceChildren();
  }

  show(picked) {
    this.#box.replaceChildren(...(picked ? [nameElement(picked.name)] : []));
  }
}

/** A menu at a structure. */
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
    event.stopPropagation();
    if (event.key === 'Escape') this.close();
    const by = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (!by) return;
    event.preventDefault();
    const items = [...this.#box.children];
    items[(items.indexOf(document.activeElement) + by + items.length) % items.length].focus();
  }
}

/** The picture alone with its caption, the black screen, and a dot for the pointer. */
const Talk = {
  toggle(what) {
    const {dataset} = document.body;
    if (dataset[what]) delete dataset[what];
    else dataset[what] = 'true';
    if (what !== 'large') return;
    if (dataset.large) document.documentElement.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement) document.exitFullscreen();
  },

  /** Ends the black screen or the large picture. @returns {boolean} whether there was one */
  end() {
    const what = ['black', 'large'].find(each => document.body.dataset[each]);
    if (what) Talk.toggle(what);
    return Boolean(what);
  },

  start() {
    const dot = document.getElementById('dot');
    document.addEventListener('pointermove', event => {
      dot.style.transform = `translate(${event.clientX}px, ${event.clientY}px)`;
    });
    document.addEventListener('fullscreenchange', () => {
      if (!document.fullscreenElement) delete document.body.dataset.large;
    });
    document.addEventListener('pointerdown', () => { delete document.body.dataset.black; });
  },
};
