// The page: connects picture, tree, controls and workers. Last part of the page's script.
'use strict';

const kViewKeys = ['1', '2', '3', '4', '5', '6'];
const kMaxLinkText = 20000;
const kMessageMs = 8000;
const kSlowMs = 1000;  // without a picture until the page says so
const kEmpty = 'The picture is empty';
const kMotionMs = 400;
const kMotionSteps = 6;  // pictures of a motion at least
const kFocusZoom = 0.8;

class Page {
  #opening = JSON.parse(block('opening'));
  #engine = new Engine({
    ready: info => this.#begin(info),
    picture: message => this.#takePicture(message),
    drawn: (drawn, colors) => this.#takeDrawn(drawn, colors),
    picked: (picked, {purpose, u, v}) => this.#takePick(picked, purpose, u, v),
    hovered: picked => this.#pointer.show(this.#isAsking() ? null : picked),
    labelled: layer => { if (layer && !this.#isAsking()) this.#takeNames(layer); },
    lit: lightUp, sliced: slices => this.#slices.take(slices),
    told: (text, of) => this.#tell(of === 'label' && /too small/.test(text) ? 'There is no room for names of this size.' : text),
    error: text => this.#takeError(text),
    stopped: reason => this.#stop(
      `The player has stopped: ${reason.replace(/\.$/, '')}. Load the page again, or export it anew.`),
    ended: () => this.#stop('The player has ended. Start splatlas-player again.'),
  });
  #stage = new Stage({
    camera: () => {
      this.#going = this.#motion = null;
      this.#show();
    },
    pick: (u, v, purpose) => this.#engine.pick({u, v, purpose}),
    hover: (x, y, size) => { if (!this.#motion) this.#pointer.move(x, y, size); }, leave: () => this.#pointer.hide(),
    resized: () => { if (!matchMedia('print').matches) this.#show(); },
  });
  #pointer = new PointerName((u, v) => this.#engine.ask('hover', {u, v}));
  #keys = new Map();  // what keys do
  #named = null;      // index of the structure whose name is on the picture
  #going = null;      // the latest goal of the camera, until its motion begins
  #motion = null;     // {from, to, begin, at}
  #pictures = {count: 0, valueOf() { return this.count; }};
  #model = null;
  #tree; #inspector; #scenes; #cuts; #slices; #menu; #lesson; #quiz; #names;  // with the model
  #lastGood = null;   // {state, camera, steps} of the latest that was drawn; of the opening picture before
  #typed = null;      // the text of "Show this selection" until its picture
  #told = '';         // what #takeNames() has told of
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
    this.#names = new Names(info.structures);
    const camera = () => this.#stage.camera;
    const changed = () => this.#changed();
    this.#stage.start(this.#opening.camera, info.display);
    this.#inspector = new Inspector(model, camera, changed);
    this.#tree = new Tree(model, {
      choose: index => this.#choose(index), toggle: index => this.#inspector.toggle(index),
    });
    this.#scenes = new Scenes(info.scenes, n => this.#showScene(n), () => this.#answer());
    this.#slices = new Slices(model, {
      ask: wanted => this.#engine.ask('slices', {wanted}), named: index => { if (!this.#quiz.takes(index)) this.#name(index); },
      moved: (mm, axis) => {
        this.#cuts.move(mm, axis, camera());
        changed();
      },
    });
    this.#cuts = new Cuts(model, camera, changed, mm => this.#slices.show(mm));
    byId('cutting').addEventListener('shown', () => this.#cuts.update());
    this.#lesson = new Lesson(model, {
      record: () => this.#recorded(), show: n => this.#showScene(n),
      list: () => {
        this.#scenes.list();
        this.#quiz.forget();
        this.#lastGood = {state: model.state, camera: this.#stage.camera, steps: model.steps()};
        this.#mark();
      },
      labelled: () => this.#labelPicture(), tell: text => this.#tell(text),
      save: (scenes, replaces) => this.#engine.save(scenes, replaces),
    });
    byId('save-atlas').hidden = !('served' in byId('atlas').dataset);
    this.#quiz = new Quiz(model, {
      state: () => this.#state(), restore: state => this.#restore(state), show: n => this.#showScene(n),
      light: index => {
        this.#edit(at => model.ghostOthers(index, at, []));
        this.#fitSelection();
      },
      changed: () => {
        this.#name(null);
        if (this.#model.state.isAsking && !this.#quiz.isAsking()) this.#answer();
        this.#labelPicture();
      },
    });
    this.#startViews(info.views);
    this.#startSearch();
    this.#startActions();
    this.#startKeys();
    Talk.start();
    document.querySelector('h1').replaceChildren(nameElement(document.title));
    this.#showCredits(info.provenance);
    window.addEventListener('hashchange', () => this.#followLink());
    const {select, scene} = this.#opening;
    model.state = {...model.state, ...(scene === null ? {base: select} : model.sceneState(scene))};
    this.#lastGood = {state: model.state, camera: this.#opening.camera, steps: 0};
    if (!this.#followLink()) this.#changed();
    model.forgetSteps(0);
    byId('undo').disabled = true;
    window.splatlas = {
      pictures: this.#pictures, state: () => this.#state(), show: state => this.#restore(state), idle: () => this.#idle(),
    };
    byId('canvas').hidden = false;
  }

  /** The selection or the cuts have changed. */
  #changed() {
    this.#mark();
    this.#show();
  }

  #mark() {
    const {scene, isAsking} = this.#model.state;
    this.#scenes.mark(scene, isAsking, this.#model.differsFromScene());
    this.#cuts.update();
    this.#lesson.update();
    for (const [id, can] of [['undo', this.#model.canUndo()], ['redo', this.#model.canRedo()]]) {
      if (!can && document.activeElement === byId(id)) byId('canvas').focus();
      byId(id).disabled = !can;
    }
    byId('selection-text').value = this.#model.selection();
  }

  #show() {
    const stage = this.#stage;
    if (stage.camera === null) return;
    byId('perspective').checked = Camera.isPerspective(stage.camera);
    this.#slowTimer ||= setTimeout(() => { byId('loading').hidden = false; }, kSlowMs);
    this.#engine.show(this.#drawing());
  }

  #drawing() {
    return {
      select: this.#model.selection(), cuts: this.#model.state.cuts, camera: this.#stage.camera,
      size: this.#stage.pictureSize(), depthCue: byId('depth-cue').checked, palette: byId('palette').value,
    };
  }

  /** Moves the camera to another one, which may have `fit`, picture by picture. */
  async #goTo(camera) {
    const goal = this.#going = {};
    this.#motion = null;
    const from = this.#stage.camera;
    const jumps = matchMedia('(prefers-reduced-motion: reduce)').matches || from.fit || this.#pictures.count === 0;
    let to = jumps ? null : camera;
    try {
      if (to?.fit) to = await this.#engine.fitted({...this.#drawing(), camera});
    } catch {
      to = null;  // the picture tells why
    }
    if (this.#going !== goal) return;
    this.#going = null;
    if (to) this.#motion = {from, to, begin: performance.now(), at: 0};
    else this.#stage.camera = camera;
    this.#step();
  }

  /** The camera at the end of the motion. */
  #goal() { return this.#motion?.to ?? this.#stage.camera; }

  /** The next picture of a motion. */
  #step() {
    const motion = this.#motion;
    if (motion) {
      const due = (performance.now() - motion.begin) / kMotionMs;
      motion.at = Math.min(Math.max(due, motion.at + 0.02), motion.at + 1 / kMotionSteps, 1);
      this.#stage.camera = Camera.between(motion.from, motion.to, motion.at, this.#model.info.display);
      if (motion.at >= 1) this.#motion = null;
    }
    this.#show();
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
    this.#model.change(this.#model.sceneState(n), this.#goal());
    const {azimuth, elevation, zoom, center} = scene;
    const projection = scene.projection ?? this.#stage.camera.projection;
    this.#name(null);
    this.#mark();
    this.#goTo({azimuth, elevation, zoom: 1, projection, fit: {structure: -1, zoom, center}});
  }

  /** True while names would give the answer away. */
  #isAsking() { return this.#quiz.isAsking() || this.#model.state.isAsking; }

  /** The picture stays. */
  #answer() {
    this.#model.change({isAsking: false}, this.#stage.camera);
    this.#mark();
    this.#labelPicture();
    this.#writeLink();
  }

  #fitSelection() { this.#turnTo({fit: {structure: -1, zoom: 1}}); }

  #focus(index) {
    if (index === null) return;
    if (this.#model.mode(index) === 'off') this.#model.setMode(index, 'surface', this.#stage.camera);
    this.#turnTo({fit: {structure: index, zoom: kFocusZoom}});
  }

  #takePicture(message) {
    if (message.isFitted && !message.isOld) {
      const {azimuth, elevation} = this.#stage.camera;
      this.#stage.camera = {...message.camera, azimuth, elevation};
    }
    this.#stage.draw(message);
    const {width, height, quality, ms} = message;
    Object.assign(this.#pictures, {count: this.#pictures.count + 1, width, height, quality, ms});
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
    this.#names.hide();
    if (this.#motion) this.#step();
    if (message.quality === 'draft') return;
    this.#labelPicture();
    this.#writeLink();
    if (!this.#model.differsFromScene()) this.#scenes.illustrate(byId('canvas'));
    if (message.data.some((value, n) => n % 4 === 3 && value > 0)) {
      if (byId('message').textContent.startsWith(kEmpty)) byId('message').hidden = true;
      return;
    }
    const isOff = this.#model.drawn.every(([mode]) => mode === 'off');
    this.#tell(`${kEmpty}: ${isOff ? 'nothing is selected' : 'the cuts or the view leave nothing'}.`);
  }

  #takeDrawn(drawn, colors) {
    this.#model.take(drawn, colors);
    this.#slices.draw();
    this.#tree.update();
    this.#inspector.update();
    if (this.#named !== null && this.#model.mode(this.#named) === 'off') this.#name(null);
  }

  /** Puts a structure's name on the picture. */
  #name(index) {
    this.#named = index;
    const path = index === null ? [] : this.#model.path(index);
    byId('picked').replaceChildren(...(index === null ? [] : [element('strong', {}, nameElement(path.at(-1))),
      element('small', {}, nameElement(path.slice(0, -1).join(' › ')))]));
  }

  #choose(index) {
    this.#inspector.choose(index);
    this.#name(this.#model.mode(index) === 'off' ? null : index);
    if (this.#named !== null) this.#engine.ask('light', {structure: index});
  }

  #takePick(picked, purpose, u, v) {
    if (this.#quiz.takes(picked?.index ?? null)) return;
    if (picked === null) return this.#name(null);
    this.#endSearch(picked.index);
    this.#choose(picked.index);
    this.#pointer.hide();
    if (purpose === 'focus') this.#focus(picked.index);
    const [width, height] = this.#stage.size();
    if (purpose === 'menu') this.#menu.open(picked.index, u * width, v * height);
  }

  /** Tells an error, and returns to what was drawn before. A text that was typed stays in its box. */
  #takeError(text) {
    this.#tell(text);
    this.#endWait();
    const model = this.#model;
    if (model === null) return;
    const good = this.#lastGood;
    if (model.state === good.state && this.#stage.camera === good.camera) return;
    this.#going = this.#motion = null;
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
    for (const part of ['canvas', 'views', 'scenes', 'structures', 'cutting', 'quiz-find', 'quiz-name', 'quiz-lesson',
      'quiz-next', 'display', 'record', 'scene-editor', 'undo', 'redo', 'show-all', 'hide-all', 'large'])
      byId(part).inert = true;
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
    add('Fit', 'Fit', '0', () => this.#fitSelection());
    for (const button of [...byId('views').children].slice(-3, -1)) button.classList.add('sign');
  }

  /** Puts names on the finished picture: those that the scene chooses, or all but ghosts. */
  #labelPicture() {
    const {scene} = this.#model.state;
    const labels = scene === null || this.#model.differsFromScene() ? [] : this.#model.info.scenes[scene].labels;
    const options = this.#names.options(labels, this.#pictures.width / this.#stage.size()[0]);
    this.#names.hide();
    if (options && document.body.dataset.quality !== 'draft' && !this.#isAsking()) this.#engine.label(options);
  }

  /** Shows names, and tells once of a selection and a size how many have no room. */
  #takeNames(layer) {
    this.#names.show(layer, this.#pictures.width, this.#pictures.height);
    const told = `${this.#names.size} ${this.#model.selection()}`;
    if (layer.unlabelled > 0 && told !== this.#told) this.#tell(`Names without room: ${layer.unlabelled}`);
    this.#told = told;
  }

  /** Changes parts of the camera: a step of undo. */
  #turnTo(camera) {
    const goal = this.#goal();
    this.#model.change({}, goal, null, true);
    this.#mark();
    this.#goTo({...goal, ...camera});
  }

  /** Shows the tree with a structure in place of what a search has found. */
  #endSearch(index) {
    byId('search').value = byId('found').textContent = '';
    this.#tree.show(null);
    this.#tree.reveal(index);
  }

  #startSearch() {
    byId('search').addEventListener('input', event => {
      const found = this.#model.search(event.target.value);
      this.#tree.show(found);
      byId('found').textContent = found === null ? '' : found.areNearest ? 'No structure has this name; the nearest are listed' :
        `Structures found: ${found.length}`;
    });
    byId('search').addEventListener('keydown', event => {
      if (event.key !== 'ArrowDown' && event.key !== 'Enter') return;
      event.preventDefault();
      const first = document.querySelector('#tree [role=treeitem]');
      first?.focus();
      if (event.key !== 'Enter' || !first) return;
      first.click();
      this.#endSearch(this.#inspector.index);
      document.querySelector('#tree [tabindex="0"]').focus();
    });
  }

  #startActions() {
    const model = this.#model;
    for (const step of ['undo', 'redo']) onClick(step, () => this.#undo(step));
    onClick('show-all', () => this.#edit(camera => model.showAll(camera)));
    onClick('hide-all', () => this.#edit(camera => model.hideAll(camera)));
    onClick('large', () => Talk.toggle('large'));
    onClick('save', () => this.#save());
    onClick('print', () => print());
    onClick('ghost-others', () => this.#ghostOthers(this.#inspector.index));
    onClick('focus-chosen', () => this.#focus(this.#inspector.index));
    this.#menu = new Menu([
      ['Only this', () => this.#inspector.isolate()],
      ['Ghost the others', index => this.#ghostOthers(index)],
      ['Colour …', () => byId('color').click()],
      ['Hide', index => this.#inspector.toggle(index)],
      ['Go there', index => this.#focus(index)],
    ]);
    onClick('apply-text', () => {
      this.#typed = byId('selection-text').value;
      this.#model.change({base: this.#typed, edits: []}, this.#stage.camera);
      this.#changed();
    });
    for (const setting of ['depth-cue', 'palette']) byId(setting).addEventListener('change', () => this.#show());
    byId('perspective').addEventListener('change', event => {
      this.#stage.camera = {...this.#stage.camera, projection: event.target.checked ? 'perspective' : 'parallel'};
      this.#show();
    });
    onClick('skip', event => {
      event.preventDefault();
      this.#openSearch();
    });
    onClick('copy-link', async () => {
      if (this.#stage.camera.fit) return this.#tell('The picture is under way. Copy its link when it is there.');
      if (!this.#writeLink()) return this.#tell('The selection is too long for a link. Copy its text, or a scene.');
      const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
      return this.#tell(copied ? 'The link is copied.' : 'The link is in the address bar.');
    });
  }

  /** The picture on the screen as a scene, with round numbers, which the screen then shows. */
  async #recorded() {
    await this.#idle();
    const {state} = this.#model;
    const {camera} = this.#stage;
    if (this.#model.drawn.every(([mode]) => mode === 'off')) return this.#tell('Show something first.');
    const {azimuth, elevation, zoom, center, projection = 'parallel'} = camera;
    const round = number => Number(number.toFixed(2));
    const placed = {azimuth: round(azimuth), elevation: round(elevation), projection,
      center: (center ?? this.#model.info.display.center_lps_mm).map(round)};
    const fit = {...placed, fit: {structure: -1, zoom: 1}};
    const fitted = await this.#engine.fitted({...this.#drawing(), camera: fit}).catch(error => this.#tell(error.message));
    if (!fitted || this.#model.state !== state || this.#stage.camera !== camera) return this.#show();
    const relative = Number((zoom / fitted.zoom).toPrecision(4));
    this.#model.change({}, camera);
    this.#stage.camera = {...placed, zoom: fitted.zoom * relative};
    this.#show();
    const cuts = this.#model.state.cuts.map(({normal, offset}) => ({normal, offset: round(offset)}));
    return {...placed, zoom: relative, select: this.#model.selection(), cuts};
  }

  #undo(direction) {
    this.#going = this.#motion = null;
    const camera = this.#model.step(direction, this.#stage.camera);
    if (camera) this.#stage.camera = camera;
    this.#name(null);
    this.#changed();
  }

  #edit(change) {
    change(this.#stage.camera);
    this.#changed();
  }

  #ghostOthers(index) { if (index !== null) this.#edit(camera => this.#model.ghostOthers(index, camera)); }

  #startDisplay() {
    byId('theme').addEventListener('change', event => {
      document.documentElement.dataset.theme = event.target.value;
      if (this.#model) this.#labelPicture();
    });
    byId('text-size').addEventListener('change', event => {
      document.documentElement.style.setProperty('--text', event.target.value);
      document.body.toggleAttribute('data-flows', Number(event.target.value) >= 1.5);
    });
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

  /** The keys of the page, and their list in the panel. */
  #startKeys() {
    const step = by => () => this.#scenes.step(by);
    const chosen = act => () => { if (this.#inspector.index !== null) act(this.#inspector.index); };
    const table = [
      ['Arrows', 'turn (in the picture)', []], ['Shift + arrows', 'move', []],
      ['+', 'zoom in', ['+', '='], () => this.#stage.zoom(kZoomStep)],
      ['−', 'zoom out', ['-'], () => this.#stage.zoom(1 / kZoomStep)],
      ['1 … 6', 'anterior, posterior, left, right, superior, inferior', kViewKeys, key => {
        const {azimuth, elevation} = this.#model.info.views[kViewKeys.indexOf(key)];
        this.#turnTo({azimuth, elevation});
      }],
      ['0', 'fit the picture to what is shown', ['0', 'Home'], () => this.#fitSelection()],
      ['Z', 'go to the chosen structure; also a double click', ['z'], chosen(index => this.#focus(index))],
      ['N, Page down', 'answer or next scene', ['n', 'PageDown'], step(1)],
      ['P, Page up', 'previous scene', ['p', 'PageUp'], step(-1)],
      ['/', 'search', ['/'], () => this.#openSearch()],
      ['I', 'show the chosen structure alone', ['i'], chosen(() => this.#inspector.isolate())],
      ['G', 'show the others as ghosts', ['g'], chosen(index => this.#ghostOthers(index))],
      ['H', 'hide or show it', ['h'], chosen(index => this.#inspector.toggle(index))],
      ['A', 'show all', ['a'], () => this.#edit(camera => this.#model.showAll(camera))],
      ['Shift + A', 'hide all', ['Shift+a'], () => this.#edit(camera => this.#model.hideAll(camera))],
      ['U, Ctrl + Z', 'undo', ['u', 'Ctrl+z'], () => this.#undo('undo')],
      ['R, Ctrl + Y', 'redo', ['r', 'Ctrl+y', 'Ctrl+Shift+z'], () => this.#undo('redo')],
      ['F, F5', 'picture and caption alone; Escape ends it', ['f', 'F5'], () => Talk.toggle('large')],
      ['T', 'names on the picture, in three sizes', ['t'], () => {
        this.#names.grow();
        this.#labelPicture();
      }],
      ['S', 'save the picture with its caption', ['s', 'Ctrl+s'], () => this.#save()],
      ['B', 'black screen', ['b'], () => Talk.toggle('black')],
      ['L', 'a dot for the pointer', ['l'], () => Talk.toggle('dot')],
      ['Escape', 'end the black screen, the large picture or the dot', ['Escape'], () => Talk.end()],
      ['?', 'this list', ['?'], () => byId('tab-about').click()],
      ['Arrows, Enter, blank', 'walk, choose, hide or show (in the tree)', []],
    ];
    for (const [names, does, keys, act] of table) {
      byId('keys').tBodies[0].append(element('tr', {}, element('th', {scope: 'row'}, names), element('td', {}, does)));
      for (const key of keys) this.#keys.set(key, act);
    }
    document.addEventListener('keydown', event => this.#key(event));
  }

  /** Keys of the whole page, except where a control takes text. Presenters' keys work everywhere. */
  #key(event) {
    if (document.body.dataset.stopped || event.altKey || event.metaKey) return;
    const isLetter = /^[a-z]$/i.test(event.key);
    const name = (event.ctrlKey ? 'Ctrl+' : '') + (event.shiftKey && isLetter ? 'Shift+' : '') +
      (isLetter ? event.key.toLowerCase() : event.key);
    const isText = event.target.closest('input:not([type=range]):not([type=checkbox]), textarea, select');
    const act = this.#keys.get(name);
    if (!act || (isText && !/^(Page|F5|Escape)/.test(name))) return;
    event.preventDefault();
    act(event.key);
  }

  async #save() {
    await this.#idle();
    const {scene} = this.#model.state;
    savePicture(scene === null ? 'picture' : this.#model.info.scenes[scene].name, byId('caption').textContent);
  }

  #openSearch() {
    byId('tab-structures').click();
    byId('search').select();
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
    const camera = {projection: link.get('projection') ?? 'parallel'};
    if (isView) {
      const [azimuth, elevation, zoom, ...center] = view;
      const kept = Math.min(Math.max(zoom, Camera.kMinZoom), Camera.kMaxZoom);
      Object.assign(camera, {azimuth, elevation, zoom: kept}, center.length === 3 ? {center} : {});
    }
    this.#restore({select: link.get('select'), scene, isAsking, cuts, camera: isView ? camera : null});
    return true;
  }

  /** What is shown, for restore(). */
  #state() {
    const {cuts, scene, isAsking} = this.#model.state;
    return {select: this.#model.selection(), cuts, scene, isAsking, camera: this.#stage.camera};
  }

  /** Shows a state: a selection, and what is given of cuts, scene, isAsking and camera; the picture is fitted without. */
  #restore({select, cuts = [], scene = null, isAsking = false, camera = null}) {
    this.#going = this.#motion = null;
    this.#model.change({base: select, edits: [], scene, isAsking, cuts}, this.#stage.camera, null, true);
    this.#stage.camera = camera ?? {...this.#stage.camera, fit: {structure: -1, zoom: 1}};
    this.#name(null);
    this.#changed();
  }

  /** Waits until nothing is drawn or waited for. */
  async #idle() {
    const isIdle = () => document.body.dataset.stopped || (!this.#going && !this.#motion && this.#engine.isRefined());
    while (!isIdle()) await new Promise(resolve => setTimeout(resolve, 20));
  }
}

new Page().start();
