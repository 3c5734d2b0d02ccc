// Controls beside the picture: the chosen structure, scenes, cuts. Part of the page's script.
'use strict';

const byId = id => document.getElementById(id);
const onClick = (id, act) => byId(id).addEventListener('click', act);

/** Mode, opacity and colour of the chosen structure. Calls the handler changed() after it has changed the model. */
class Inspector {
  #model; #camera; #changed;

  /** @param {function} camera returns the camera, for undo */
  constructor(model, camera, changed) {
    this.#model = model;
    this.#camera = camera;
    this.#changed = changed;
    this.index = null;
    for (const button of document.querySelectorAll('[data-mode-button]'))
      button.addEventListener('click', () => this.setMode(button.dataset.modeButton));
    byId('opacity').addEventListener('input', event =>
      this.#edit(() => model.setAppearance(this.index, {opacity: Number(event.target.value) / 100}, camera())));
    byId('color').addEventListener('input', event =>
      this.#edit(() => model.setAppearance(this.index, {color: event.target.value}, camera())));
    for (const event of ['pointerup', 'blur']) byId('opacity').addEventListener(event, () => model.endGesture());
    byId('color').addEventListener('change', () => model.endGesture());
    onClick('isolate', () => this.isolate());
    this.update();
  }

  #edit(edit) {
    if (this.index === null) return;
    edit();
    this.#changed();
  }

  setMode(mode) { this.#edit(() => this.#model.setMode(this.index, mode, this.#camera())); }

  isolate() { this.#edit(() => this.#model.isolate(this.index, this.#camera())); }

  toggle(index) {
    this.#model.toggle(index, this.#camera());
    this.#changed();
  }

  choose(index) {
    this.index = index;
    this.update();
  }

  update() {
    const box = byId('inspector');
    box.hidden = this.index === null;
    if (this.index === null) return;
    const path = this.#model.path(this.index);
    byId('chosen-name').replaceChildren(nameElement(path.at(-1)));
    byId('chosen-path').replaceChildren(nameElement(path.slice(0, -1).join(' › ')));
    const mode = this.#model.mode(this.index);
    for (const button of document.querySelectorAll('[data-mode-button]'))
      button.setAttribute('aria-pressed', String(button.dataset.modeButton === mode));
    const {opacity, color} = this.#model.appearance(this.index);
    const isOff = mode === 'off';
    byId('opacity').disabled = byId('color').disabled = isOff;
    byId('opacity').value = String(Math.round(100 * (opacity ?? 1)));
    byId('opacity-text').textContent = isOff ? '' : `${byId('opacity').value} %`;
    byId('opacity').setAttribute('aria-valuetext', `${byId('opacity').value} %`);
    byId('color').value = color;
  }
}

/** The strip of scenes with question or caption. Calls the handlers show(n) and answer(). */
class Scenes {
  #scenes; #show; #answer; #buttons;
  #thumbnails = new Map();  // of the scenes that have been shown
  #current = null;
  #isAsking = false;

  constructor(scenes, show, answer) {
    this.#scenes = scenes;
    this.#show = show;
    this.#answer = answer;
    this.list();
    onClick('previous', () => this.step(-1));
    onClick('next', () => this.step(1));
    onClick('answer', () => answer());
  }

  list() {
    byId('scenes').hidden = this.#scenes.length === 0;
    this.#buttons = this.#scenes.map((scene, n) => {
      const button = element('button', {}, this.#thumbnails.get(scene) ?? '',
        element('span', {class: 'number', 'aria-hidden': 'true'}, String(n + 1)), nameElement(scene.name));
      button.addEventListener('click', () => this.#show(n));
      return button;
    });
    byId('strip').replaceChildren(...this.#buttons.map(button => element('li', {}, button)));
  }

  /** The finished picture of the present scene: its thumbnail, if it is the first. */
  illustrate(picture) {
    const scene = this.#scenes[this.#current];
    if (!scene || this.#thumbnails.has(scene)) return;
    const thumbnail = element('canvas', {width: '96', height: '64', 'aria-hidden': 'true'});
    const scale = Math.max(96 / picture.width, 64 / picture.height);
    const [width, height] = [picture.width * scale, picture.height * scale];
    thumbnail.getContext('2d').drawImage(picture, (96 - width) / 2, (64 - height) / 2, width, height);
    this.#thumbnails.set(scene, thumbnail);
    this.#buttons[this.#current].prepend(thumbnail);
  }

  /** Shows the scene after (1) or before (-1) the present one; first the answer to a question. */
  step(by) {
    if (this.#isAsking && by > 0) return this.#answer();
    const count = this.#scenes.length;
    if (count === 0) return undefined;
    return this.#show(this.#current === null ? 0 : (this.#current + by + count) % count);
  }

  /** Marks a scene as the present one, with its question or its caption; null: none. `isChanged`: another selection. */
  mark(n, isAsking, isChanged) {
    this.#current = n;
    this.#isAsking = isAsking;
    if (!isAsking && document.activeElement === byId('answer')) byId('next').focus();
    byId('answer').hidden = !isAsking;
    this.#buttons.forEach((button, each) => {
      if (each === n) button.setAttribute('aria-current', 'step');
      else button.removeAttribute('aria-current');
    });
    const text = n === null || (isChanged && !isAsking) ? '' : this.#scenes[n][isAsking ? 'question' : 'caption'];
    byId('caption').replaceChildren(nameElement(text));
    byId('place').textContent = n === null ? `${this.#scenes.length} scenes` :
      `${n + 1} of ${this.#scenes.length}${isChanged ? ', changed' : ''}`;
    const strip = byId('strip');
    if (n === null) return;
    const button = this.#buttons[n];
    strip.scrollTo({left: button.offsetLeft - strip.offsetLeft - (strip.clientWidth - button.offsetWidth) / 2});
  }
}

/** The mm, [first, last] of each axis of LPS, between which the voxels of a grid lie. */
function boundsOf({size, spacing_mm: spacing, origin_lps_mm: origin, direction_lps: direction}) {
  return [0, 1, 2].map(axis => {
    const ends = size.map((count, a) => [-0.5, count - 0.5].map(at => direction[3 * axis + a] * spacing[a] * at));
    const sum = choose => ends.reduce((total, each) => total + choose(...each), origin[axis]);
    return [sum(Math.min), sum(Math.max)];
  });
}

/** A slider for each axis. Calls the handlers changed() after it has changed the model, and placed(mm): of the sliders. */
class Cuts {
  #model; #placed; #rows;

  constructor(model, camera, changed, placed) {
    this.#model = model;
    this.#placed = placed;
    const bounds = boundsOf(model.info.storage_grid);
    const axes = [['Right to left', 'left', 'right'], ['Front to back', 'posterior', 'anterior'],
      ['Bottom to top', 'superior', 'inferior']];
    const step = Math.min(0.5, ...model.info.storage_grid.spacing_mm);
    this.#rows = axes.map(([name, high, low], axis) => {
      const [first, last] = [Math.floor(bounds[axis][0]), Math.ceil(bounds[axis][1])];
      const slider = element('input',
        {type: 'range', min: first, max: last, step, 'aria-label': `Cut, ${name}`});
      const side = element('select', {'aria-label': `Side to remove, ${name}`},
        element('option', {value: ''}, 'no cut'), element('option', {value: 'high'}, `remove ${high}`),
        element('option', {value: 'low'}, `remove ${low}`));
      const text = element('output', {});
      const read = gesture => {
        const cut = side.value === '' ? null : {offset: Number(slider.value), isFlipped: side.value === 'low'};
        model.setCutAcross(axis, cut, camera(), gesture);
        changed();
      };
      slider.value = String((first + last) / 2);
      slider.addEventListener('input', () => {
        if (side.value === '') side.value = 'high';
        read(`cut ${axis}`);
      });
      for (const event of ['pointerup', 'blur']) slider.addEventListener(event, () => model.endGesture());
      side.addEventListener('change', () => read(null));
      byId('cuts').append(
        element('div', {class: 'cut'}, element('span', {class: 'cut-name'}, name), side, slider, text));
      const place = offset => `${Math.abs(offset)} mm${offset === 0 ? '' : ` ${offset > 0 ? high : low}`}`;
      return {slider, side, text, place};
    });
    onClick('no-cuts', () => {
      model.change({cuts: []}, camera());
      changed();
    });
  }

  update() {
    const oblique = this.#model.state.cuts.filter(cut => [0, 1, 2].every(axis => !isAcross(cut, axis))).length;
    byId('oblique-cuts').textContent = oblique === 0 ? '' : `Oblique cuts: ${oblique}`;
    this.#rows.forEach(({slider, side, text, place}, axis) => {
      const cut = this.#model.cutAcross(axis);
      side.value = cut === null ? '' : cut.isFlipped ? 'low' : 'high';
      if (cut !== null) slider.value = String(cut.offset);
      text.textContent = cut === null ? '' : place(Number(slider.value));
      slider.setAttribute('aria-valuetext', place(Number(slider.value)));
    });
    this.#placed(this.#rows.map(({slider}) => Number(slider.value)));
  }

  /** Moves the sliders, and cuts across an axis if nothing is cut. */
  move(mm, axis, camera) {
    const {cuts} = this.#model.state;
    this.#rows.forEach(({slider}, n) => {
      slider.value = String(mm[n]);
      const cut = this.#model.cutAcross(n) ?? (cuts.length === 0 && n === axis ? {isFlipped: false} : null);
      if (cut) this.#model.setCutAcross(n, {...cut, offset: Number(slider.value)}, camera, 'slices');
    });
  }
}

/** Tabs of the panel, with the keys of a tab list. On phones the panel is a sheet: a tab opens it, and closes it again. */
function startTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const choose = chosen => {
    for (const tab of tabs) {
      tab.setAttribute('aria-selected', String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      byId(tab.getAttribute('aria-controls')).hidden = tab !== chosen;
    }
    byId(chosen.getAttribute('aria-controls')).dispatchEvent(new Event('shown'));
  };
  tabs.forEach((tab, n) => {
    tab.addEventListener('click', event => {
      const isShown = document.body.hasAttribute('data-sheet') && tab.getAttribute('aria-selected') === 'true';
      document.body.toggleAttribute('data-sheet', !isShown || !event.isTrusted);
      choose(tab);
    });
    tab.addEventListener('keydown', event => {
      const at = {ArrowRight: n + 1, ArrowLeft: n - 1, Home: 0, End: -1}[event.key];
      if (at === undefined) return;
      const next = tabs[(at + tabs.length) % tabs.length];
      choose(next);
      next.focus();
      event.preventDefault();
      event.stopPropagation();
    });
  });
}
