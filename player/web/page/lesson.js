// Scenes made in class: recorded from the screen, edited, and saved as a file. Part of the page's script.
'use strict';

const kSceneTexts = ['name', 'question', 'caption'];

/** The editor of the present scene. Calls the handlers {record(): Promise<?object>, list() and labelled(): the scenes
 * or their labels are others, show(n), save(scenes, replaces): Promise<[what, text]>, tell(text)}. */
class Lesson {
  #model; #handlers;
  #isUnsaved = false;

  constructor(model, handlers) {
    this.#model = model;
    this.#handlers = handlers;
    for (const field of kSceneTexts) {
      byId(`scene-${field}`).addEventListener('input', event => {
        this.#isUnsaved = true;
        this.#scene()[field] = event.target.value;
        handlers.list();
      });
    }
    byId('scene-labels').addEventListener('input', event => {
      this.#isUnsaved = true;
      this.#scene().labels = event.target.value.split(',').map(label => label.trim()).filter(label => label !== '');
    });
    byId('scene-labels').addEventListener('change', () => handlers.labelled());
    window.addEventListener('beforeunload', event => { if (this.#isUnsaved) event.preventDefault(); });
    onClick('record', () => this.#record());
    onClick('renew', () => this.#renew());
    onClick('earlier', () => this.#move(-1));
    onClick('later', () => this.#move(1));
    onClick('remove', () => this.#remove());
    onClick('save-lesson', () => this.#save());
    onClick('save-atlas', () => this.#saveIntoAtlas());
  }

  #scene() { return this.#model.info.scenes[this.#model.state.scene]; }

  /** Adds the picture on the screen behind the present scene. */
  async #record() {
    const recorded = await this.#handlers.record();
    if (!recorded) return;
    const {scenes} = this.#model.info;
    const at = (this.#model.state.scene ?? scenes.length - 1) + 1;
    let n = scenes.length + 1;
    while (scenes.some(({name}) => name.toLowerCase() === `scene ${n}`)) ++n;
    const scene = {name: `Scene ${n}`, question: '', caption: '', labels: [], ...recorded};
    this.#change(() => scenes.splice(at, 0, scene), scene);
    byId('scene-name').select();
  }

  /** Gives the present scene the picture on the screen. */
  async #renew() {
    const scene = this.#scene();
    const recorded = await this.#handlers.record();
    if (recorded) this.#change(() => Object.assign(scene, recorded), scene);
  }

  #move(by) {
    const {scenes} = this.#model.info;
    const from = this.#model.state.scene;
    const to = Math.min(Math.max(from + by, 0), scenes.length - 1);
    this.#change(() => scenes.splice(to, 0, ...scenes.splice(from, 1)));
  }

  #remove() {
    const {scenes} = this.#model.info;
    const {scene} = this.#model.state;
    if (!confirm(`Remove the scene "${scenes[scene].name}"?`)) return;
    this.#change(() => scenes.splice(scene, 1));
    if (scenes.length > 0) this.#handlers.show(Math.min(scene, scenes.length - 1));
  }

  /** The scenes to save; null if a name stands twice or not at all. */
  #named() {
    const scenes = this.#model.info.scenes.map(Lesson.stored);
    const names = scenes.map(({name}) => name.toLowerCase());
    const bad = names.findIndex((name, n) => name === '' || names.indexOf(name) < n);
    if (bad < 0) return scenes;
    this.#handlers.tell(`Scene ${bad + 1} needs a name of its own.`);
    return null;
  }

  #save() {
    const scenes = this.#named();
    if (!scenes) return;
    this.#isUnsaved = false;
    download('lesson.toml', new Blob([Lesson.toml(scenes)], {type: 'text/plain'}));
  }

  /** The program that serves the page saves. It asks before it replaces what this page has not saved. */
  async #saveIntoAtlas() {
    const scenes = this.#named();
    if (!scenes) return;
    const wasUnsaved = this.#isUnsaved;
    this.#isUnsaved = false;
    let [what, text] = await this.#handlers.save(scenes, false);
    if (what === 'asks' && confirm(text)) [what, text] = await this.#handlers.save(scenes, true);
    if (what !== 'saved') this.#isUnsaved ||= wasUnsaved;
    if (what !== 'asks') this.#handlers.tell(what === 'saved' ? text : `The lesson is not saved: ${text}. Save it as a file.`);
  }

  /** Changes the list of scenes; `recorded`: the one that has the picture on the screen. */
  #change(edit, recorded = null) {
    const {scenes} = this.#model.info;
    const before = [...scenes];
    edit();
    this.#isUnsaved = true;
    this.#model.renumber(before);
    if (recorded) this.#model.state = {...this.#model.sceneState(scenes.indexOf(recorded)), isAsking: false};
    this.#handlers.list();
  }

  update() {
    const scene = this.#scene();
    byId('scene-editor').disabled = !scene;
    for (const field of kSceneTexts) {
      const box = byId(`scene-${field}`);
      const text = scene?.[field] ?? '';
      if (box.value !== text) box.value = text;
    }
    byId('scene-labels').value = scene?.labels.join(', ') ?? '';
  }

  /** A scene with the keys of a lesson's file. */
  static stored({name, select, question, caption, azimuth, elevation, zoom, projection, center, cuts, labels}) {
    return {
      name: name.trim(), select, question: question.trim().replace(/\s+/g, ' '), caption: caption.trim(),
      azimuth, elevation, zoom, projection, ...(center ? {center: center.join()} : {}),
      cuts: cuts.map(({normal, offset}) => [...normal, offset].join()), labels,
    };
  }

  /** Stored scenes as a file for `splatlas-preprocess lesson --scene`. Texts, numbers and lists of JSON are those of TOML. */
  static toml(scenes) {
    return scenes.map(scene => `[[scene]]\n${Object.entries(scene).map(([key, value]) =>
      `${key} = ${JSON.stringify(value)}\n`).join('')}`).join('\n');
  }
}
