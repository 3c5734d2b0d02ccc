// The page: connects picture, tree, controls and workers. Last part of the page's script.
'use strict';

const kViewKeys = ['1', '2', '3', '4', '5', '6'];
const kMaxLinkText = 20000;
const kMessageMs = 8000;
const kSlowMs = 1000;  // without a picture until the page says so
const kKeys = [
  ['Arrows', 'turn (in the picture)'], ['Shift + arrows', 'move'], ['+ −', 'zoom'],
  ['1 … 6', 'anterior, posterior, left, right, superior, inferior'], ['F', 'fit the picture to what is shown'],
  ['N, P', 'answer or next scene, and previous scene; also Page down, Page up'], ['/', 'search'],
  ['I', 'isolate the chosen structure'], ['H', 'hide or show it'], ['A', 'show all'], ['U', 'undo; also Ctrl + Z'],
  ['Arrows, Enter, blank', 'walk, choose, hide or show (in the tree)'],
];

class Page {
  #opening = JSON.parse(block('opening'));
  #engine = new Engine({
    ready: info => this.#begin(info),
    picture: message => this.#takePicture(message),
    drawn: drawn => this.#takeDrawn(drawn),
    picked: picked => this.#takePick(picked),
    measured: zoom => this.#copyScene(zoom),
    told: text => this.#tell(text),
    error: text => this.#takeError(text),
    stopped: text => this.#stopFor(text),
  });
  #stage = new Stage({
    camera: () => this.#show(),
    pick: (u, v) => this.#engine.pick(u, v),
    resized: () => { if (!matchMedia('print').matches) this.#show(); },
  });
  #model = null;
  #tree = null;
  #inspector = null;
  #scenes = null;
  #cuts = null;
  #lastGood = null;   // {state, camera, steps} of the latest that was drawn; of the opening picture before
  #typed = null;      // the text of "Show this selection" until its picture
  #messageTimer = 0;
  #slowTimer = 0;     // runs until the next picture

  async start() {
    window.addEventListener('error', event => this.#tell(`Something has failed in this page: ${event.message}`));
    startTabs();
    this.#startDisplay();
    byId('opening-picture').hidden = byId('opening-picture').src.endsWith(',');
    try {
      await this.#engine.start();
    } catch (error) {
      const failed = error instanceof LoadError ? 'The atlas cannot be loaded' : 'This browser cannot run the player';
      this.#stop(`${failed}: ${error.message}. The picture is the opening one.`);
    }
  }

  #begin(info) {
    const model = this.#model = new Model(info);
    const camera = () => this.#stage.camera;
    const changed = () => this.#changed();
    this.#stage.start(this.#opening.camera, info.display);
    this.#inspector = new Inspector(model, camera, changed);
    this.#tree = new Tree(model, {
      choose: index => this.#inspector.choose(index),
      toggle: index => this.#inspector.toggle(index),
    });
    this.#scenes = new Scenes(info.scenes, n => this.#showScene(n), () => this.#answer());
    this.#cuts = new Cuts(model, camera, changed);
    this.#startViews(info.views);
    this.#startSearch();
    this.#startActions();
    this.#showCredits(info.provenance);
    document.addEventListener('keydown', event => this.#key(event));
    window.addEventListener('hashchange', () => this.#followLink());
    const {select, scene} = this.#opening;
    model.state = {...model.state, ...(scene === null ? {base: select} : model.sceneState(scene))};
    this.#lastGood = {state: model.state, camera: this.#opening.camera, steps: 0};
    if (!this.#followLink()) this.#changed();
    model.forgetSteps(0);
    byId('undo').disabled = true;
    byId('canvas').hidden = false;
  }

  /** The selection or the cuts have changed. */
  #changed() {
    const {scene, isAsking} = this.#model.state;
    this.#scenes.mark(scene, isAsking, this.#model.differsFromScene());
    this.#cuts.update();
    const isFirst = !this.#model.canUndo();
    if (isFirst && document.activeElement === byId('undo')) byId('canvas').focus();
    byId('undo').disabled = isFirst;
    byId('selection-text').value = this.#model.selection();
    this.#show();
  }

  /** Draws the present state. */
  #show() {
    const stage = this.#stage;
    if (stage.camera === null) return;
    byId('perspective').checked = Camera.isPerspective(stage.camera);
    this.#slowTimer ||= setTimeout(() => { byId('loading').hidden = false; }, kSlowMs);
    this.#engine.show({
      select: this.#model.selection(), cuts: this.#model.state.cuts, camera: stage.camera,
      size: stage.pictureSize(), depthCue: byId('depth-cue').checked,
    });
  }

  /** A picture or an error has come. */
  #endWait() {
    clearTimeout(this.#slowTimer);
    this.#slowTimer = 0;
    byId('loading').hidden = true;
    byId('loading').textContent = 'Drawing …';
  }

  #showScene(n) {
    const scene = this.#model.info.scenes[n];
    this.#model.change(this.#model.sceneState(n), this.#stage.camera);
    const {azimuth, elevation, zoom, center} = scene;
    const {projection} = this.#stage.camera;
    this.#stage.camera = {azimuth, elevation, zoom: 1, projection, fit: {structure: -1, zoom, center}};
    byId('picked').replaceChildren();
    this.#changed();
  }

  #answer() {
    this.#model.change({isAsking: false}, this.#stage.camera);
    this.#changed();
  }

  #fitSelection() {
    this.#turnTo({fit: {structure: -1, zoom: 1}});
  }

  #takePicture(message) {
    if (message.isFitted && !message.isOld && this.#stage.camera.fit) {
      const {azimuth, elevation} = this.#stage.camera;
      this.#stage.camera = {...message.camera, azimuth, elevation};
    }
    this.#stage.draw(message);
    byId('opening-picture').hidden = true;
    this.#endWait();
    // Only of texts that were typed: the page's own edits hide earlier terms
    const isTyped = this.#model.state.edits.length === 0 && this.#model.differsFromScene();
    const [note] = [...message.missing, ...(isTyped ? message.warnings : [])];
    if (note) this.#tell(note);
    if (message.isOld) return;
    this.#typed = null;
    this.#lastGood = {state: this.#model.state, camera: this.#stage.camera, steps: this.#model.steps()};
    document.body.dataset.quality = message.quality;
    if (message.quality === 'draft') return;
    this.#writeLink();
    if (message.data.some((value, n) => n % 4 === 3 && value > 0)) return;
    const isOff = this.#model.drawn.every(([mode]) => mode === 'off');
    this.#tell(`The picture is empty: ${isOff ? 'nothing is selected' : 'the cuts or the view leave nothing'}.`);
  }

  #takeDrawn(drawn) {
    this.#model.drawn = drawn;
    this.#tree.update();
    this.#inspector.update();
  }

  #takePick(picked) {
    const box = byId('picked');
    if (picked === null) return box.replaceChildren();
    const path = picked.path.split('/').slice(0, -1).join(' › ');
    box.replaceChildren(element('strong', {}, nameElement(picked.name)), element('small', {}, nameElement(path)));
    byId('search').value = '';
    this.#tree.show(null);
    this.#tree.reveal(picked.index);
    this.#inspector.choose(picked.index);
    return undefined;
  }

  /** Tells an error, and returns to what was drawn before. A text that was typed stays in its box. */
  #takeError(text) {
    this.#tell(text);
    this.#endWait();
    const model = this.#model;
    if (model === null) return;
    const good = this.#lastGood;
    if (model.state === good.state && this.#stage.camera === good.camera) return;
    [model.state, this.#stage.camera] = [good.state, good.camera];
    model.forgetSteps(good.steps);
    this.#changed();
    if (this.#typed !== null) byId('selection-text').value = this.#typed;
    this.#typed = null;
  }

  #tell(text) {
    const box = byId('message');
    box.textContent = text;
    box.hidden = false;
    clearTimeout(this.#messageTimer);
    this.#messageTimer = setTimeout(() => { box.hidden = true; }, kMessageMs);
  }

  /** Nothing more will be drawn: tells why, and leaves what is there. */
  #stop(text) {
    this.#tell(text);
    clearTimeout(this.#messageTimer);
    this.#endWait();
    document.body.dataset.stopped = 'true';
    for (const part of ['canvas', 'views', 'scenes', 'panel', 'undo', 'show-all']) byId(part).inert = true;
  }

  #stopFor(reason) {
    this.#stop(`The player has stopped: ${reason.replace(/\.$/, '')}. Load the page again, or export it anew.`);
  }

  #startViews(views) {
    const add = (name, short, key, act) => {
      const button = element('button', {'aria-keyshortcuts': key, title: `${name} (${key})`, 'aria-label': name},
        element('span', {class: 'wide'}, name), element('span', {class: 'narrow', 'aria-hidden': 'true'}, short));
      button.addEventListener('click', act);
      byId('views').append(button);
    };
    views.forEach(({name, azimuth, elevation}, n) => {
      const title = name[0].toUpperCase() + name.slice(1);
      add(title, title[0], kViewKeys[n], () => this.#turnTo({azimuth, elevation}));
    });
    add('Zoom in', '+', '+', () => this.#stage.zoom(kZoomStep));
    add('Zoom out', '−', '-', () => this.#stage.zoom(1 / kZoomStep));
    add('Fit', 'Fit', 'F', () => this.#fitSelection());
    for (const button of [...byId('views').children].slice(-3, -1)) button.classList.add('sign');
  }

  /** Changes parts of the camera. */
  #turnTo(camera) {
    this.#stage.camera = {...this.#stage.camera, ...camera};
    this.#show();
  }

  #startSearch() {
    byId('search').addEventListener('input', event => {
      const found = this.#model.search(event.target.value);
      this.#tree.show(found);
      byId('found').textContent = found === null ? '' : `Structures found: ${found.length}`;
    });
    byId('search').addEventListener('keydown', event => {
      if (event.key !== 'ArrowDown' && event.key !== 'Enter') return;
      event.preventDefault();
      const first = document.querySelector('#tree [role=treeitem]');
      first?.focus();
      if (event.key === 'Enter') first?.click();
    });
  }

  #startActions() {
    byId('undo').addEventListener('click', () => this.#undo());
    byId('show-all').addEventListener('click', () => this.#showAll());
    byId('apply-text').addEventListener('click', () => {
      this.#typed = byId('selection-text').value;
      this.#model.change({base: this.#typed, edits: []}, this.#stage.camera);
      this.#changed();
    });
    byId('depth-cue').addEventListener('change', () => this.#show());
    byId('perspective').addEventListener('change',
      event => this.#turnTo({projection: event.target.checked ? 'perspective' : 'parallel'}));
    byId('print').addEventListener('click', () => print());
    byId('skip').addEventListener('click', event => {
      event.preventDefault();
      this.#openSearch();
    });
    byId('copy-link').addEventListener('click', async () => {
      if (this.#stage.camera.fit) return this.#tell('The picture is under way. Copy its link when it is there.');
      if (!this.#writeLink()) return this.#tell('The selection is too long for a link. Copy its text, or a scene.');
      return this.#copy(location.href, 'The link is copied.', 'The link is in the address bar.');
    });
    byId('copy-scene').addEventListener('click', () => this.#engine.measure());
  }

  /** Puts a text into the clipboard, and tells so. @returns {boolean} false where the browser does not let it */
  async #copy(text, done, otherwise) {
    try {
      await navigator.clipboard.writeText(text);
      this.#tell(done);
      return true;
    } catch {
      this.#tell(otherwise);
      return false;
    }
  }

  /** Copies the present state as a table of `splatlas-preprocess build --scene`. */
  async #copyScene(fittedZoom) {
    const {azimuth, elevation, zoom, center} = this.#stage.camera;
    const round = number => Number(number.toFixed(2));
    const lines = ['[[scene]]', 'name = "New scene"', `select = ${JSON.stringify(this.#model.selection())}`,
      'question = ""', 'caption = ""', `azimuth = ${round(azimuth)}`, `elevation = ${round(elevation)}`,
      `zoom = ${Number((zoom / fittedZoom).toPrecision(4))}`];
    if (center) lines.push(`center = "${center.map(round)}"`);
    const cuts = this.#model.state.cuts.map(({normal, offset}) => `"${[...normal, round(offset)]}"`);
    if (cuts.length > 0) lines.push(`cuts = [${cuts.join(', ')}]`);
    const text = `${lines.join('\n')}\n`;
    const parallel = Camera.isPerspective(this.#stage.camera) ? ' Scenes have no perspective.' : '';
    if (await this.#copy(text, `The scene is copied. Paste it into the file of build --scene.${parallel}`,
      `This browser does not let the page copy. The scene is in the box of the selection.${parallel}`)) return;
    byId('selection-text').value = text;
    byId('selection-text').select();
  }

  #undo() {
    const camera = this.#model.undo();
    if (camera) this.#stage.camera = camera;
    this.#changed();
  }

  #showAll() {
    this.#model.showAll(this.#stage.camera);
    this.#changed();
  }

  #startDisplay() {
    byId('theme').addEventListener('change', event => {
      document.documentElement.dataset.theme = event.target.value;
    });
    byId('text-size').addEventListener('change', event => {
      document.documentElement.style.setProperty('--text', event.target.value);
      document.documentElement.toggleAttribute('data-large', event.target.value !== '1');
    });
    for (const [key, does] of kKeys)
      byId('keys').tBodies[0].append(element('tr', {}, element('th', {scope: 'row'}, key), element('td', {}, does)));
  }

  #showCredits({title, citation, licence}) {
    const entries = [['Atlas', title], ['Citation', citation], ['Licence', licence],
      ['Structures', String(this.#model.structures.length)]];
    for (const [name, text] of entries) {
      if (text === '') continue;
      byId('credits').append(element('dt', {}, name), element('dd', {}, nameElement(text)));
    }
    byId('print-credits').replaceChildren(nameElement([citation, licence].filter(text => text !== '').join(' · ')));
  }

  /** Keys of the whole page, except where a control takes text. */
  #key(event) {
    if (document.body.dataset.stopped) return;
    const isUndo = event.key.toLowerCase() === 'z' && (event.ctrlKey || event.metaKey);
    if (event.target.closest('input:not([type=range]):not([type=checkbox]), textarea, select')) return;
    if (!isUndo && (event.ctrlKey || event.metaKey || event.altKey)) return;
    const view = this.#model.info.views[kViewKeys.indexOf(event.key)];
    const keys = {
      n: () => this.#scenes.step(1), p: () => this.#scenes.step(-1),
      PageDown: () => this.#scenes.step(1), PageUp: () => this.#scenes.step(-1),
      f: () => this.#fitSelection(), u: () => this.#undo(), a: () => this.#showAll(),
      '+': () => this.#stage.zoom(kZoomStep), '=': () => this.#stage.zoom(kZoomStep),
      '-': () => this.#stage.zoom(1 / kZoomStep),
      i: () => this.#inspector.isolate(), h: () => this.#inspector.toggle(this.#inspector.index),
      '/': () => this.#openSearch(),
    };
    const act = isUndo ? keys.u : view ? () => this.#turnTo({azimuth: view.azimuth, elevation: view.elevation}) :
      keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    const scrolls = event.target.closest('input, #cutting, #display, #about');
    if (!act || (event.key.startsWith('Page') && scrolls)) return;
    event.preventDefault();
    act();
  }

  #openSearch() {
    byId('tab-structures').click();
    byId('search').focus();
  }

  /** Puts the state into the address: selection, camera and cuts. @returns {boolean} false if it is too long */
  #writeLink() {
    const {azimuth, elevation, zoom, center} = this.#stage.camera;
    const round = number => String(Number(number.toFixed(3)));
    const link = new URLSearchParams({select: this.#model.selection()});
    if (Camera.isPerspective(this.#stage.camera)) link.set('projection', 'perspective');
    link.set('view', [azimuth, elevation, zoom, ...(center ?? [])].map(round).join(','));
    const {cuts, scene, isAsking} = this.#model.state;
    if (cuts.length > 0) link.set('cuts', cuts.map(({normal, offset}) => [...normal, offset].map(round)).join(';'));
    if (scene !== null) link.set('scene', String(scene));
    if (isAsking) link.set('asks', '1');
    const text = `#${link}`;
    if (text.length >= kMaxLinkText) return false;
    if (text !== location.hash) history.replaceState(null, '', text);
    return true;
  }

  /** Shows what the address says. @returns {boolean} false if it says nothing */
  #followLink() {
    const link = new URLSearchParams(location.hash.slice(1));
    if (!link.has('select')) return false;
    const view = (link.get('view') ?? '').split(',').map(Number);
    const isView = [3, 6].includes(view.length) && view.every(Number.isFinite) && view[2] > 0;
    const cuts = (link.get('cuts') ?? '').split(';').map(text => text.split(',').map(Number))
      .filter(numbers => numbers.length === 4 && numbers.every(Number.isFinite) && numbers.slice(0, 3).some(n => n !== 0))
      .map(([x, y, z, offset]) => ({normal: [x, y, z], offset})).slice(0, kMaxCuts);
    const {scenes} = this.#model.info;
    const n = link.get('scene') ?? '';
    const scene = /^\d+$/.test(n) && Number(n) < scenes.length ? Number(n) : null;
    const isAsking = scene !== null && link.has('asks') && scenes[scene].question !== '';
    this.#model.change({base: link.get('select'), edits: [], scene, isAsking, cuts}, this.#stage.camera);
    if (isView) {
      const [azimuth, elevation, zoom, ...center] = view;
      const kept = Math.min(Math.max(zoom, Camera.kMinZoom), Camera.kMaxZoom);
      const projection = link.get('projection') === 'perspective' ? 'perspective' : 'parallel';
      this.#stage.camera = {azimuth, elevation, zoom: kept, projection, ...(center.length === 3 ? {center} : {})};
    } else {
      this.#stage.camera = {...this.#stage.camera, fit: {structure: -1, zoom: 1}};
    }
    this.#changed();
    return true;
  }
}

new Page().start();
