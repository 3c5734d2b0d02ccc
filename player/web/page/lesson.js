// Scenes made in class: recorded from the screen, edited, and saved as a file. Part of the page's script.
'use strict';

const kSceneTexts = ['name', 'question', 'caption'];

/** The editor of the present scene. Calls the handlers {record(): Promise<?object>, list() and labelled(): the scenes
 * or their labels are others, show(n), tell(text)}. */
class Lesson {
  #model;
  #handlers;
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
    const act = (id, does) => byId(id).addEventListener('click', does);
    act('record', () => this.#record());
    act('renew', () => this.#renew());
    act('earlier', () => this.#move(-1));
    act('later', () => this.#move(1));
    act('remove', () => this.#remove());
    act('save-lesson', () => this.#save());
  }

  #scene() {
    return this.#model.info.scenes[this.#model.state.scene];
  }

  /** Adds the picture on the screen behind the present scene. */
  async #record() {
    const recorded = await this.#handlers.record();
    if (!recorded) return;
    const {scenes} = this.#model.info;
    const at = (this.#model.state.scene ?? scenes.length - 1) + 1;
    let n = scenes.length + 1;
    while (scenes.some(({name}) => name.toLowerCase() === `scene ${n}`)) ++n;
    scenes.splice(at, 0, {name: `Scene ${n}`, question: '', caption: '', labels: [], ...recorded});
    this.#reorder(at);
    byId('scene-name').select();
  }

  /** Gives the present scene the picture on the screen. */
  async #renew() {
    const scene = this.#scene();
    const recorded = await this.#handlers.record();
    if (!recorded) return;
    Object.assign(scene, recorded);
    this.#reorder(this.#model.state.scene);
  }

  #move(by) {
    const {scenes} = this.#model.info;
    const from = this.#model.state.scene;
    const to = Math.min(Math.max(from + by, 0), scenes.length - 1);
    scenes.splice(to, 0, ...scenes.splice(from, 1));
    this.#reorder(to);
  }

  #remove() {
    const {scenes} = this.#model.info;
    const {scene} = this.#model.state;
    scenes.splice(scene, 1);
    this.#reorder(scenes.length === 0 ? null : Math.min(scene, scenes.length - 1));
    if (scenes.length > 0) this.#handlers.show(this.#model.state.scene);
  }

  /** A name that stands twice or not at all would stop `splatlas-preprocess lesson`. */
  #save() {
    const names = this.#model.info.scenes.map(({name}) => name.trim().toLowerCase());
    const bad = names.findIndex((name, n) => name === '' || names.indexOf(name) < n);
    if (bad >= 0) return this.#handlers.tell(`Scene ${bad + 1} needs a name of its own.`);
    this.#isUnsaved = false;
    return download('lesson.toml', new Blob([Lesson.toml(this.#model.info.scenes)], {type: 'text/plain'}));
  }

  /** Earlier steps know the scenes by other numbers. */
  #reorder(scene) {
    this.#isUnsaved = true;
    this.#model.forgetAll();
    if (scene === null) this.#model.state = {...this.#model.state, scene, isAsking: false};
    else this.#model.state = {...this.#model.sceneState(scene), isAsking: false};
    this.#handlers.list();
    this.update();
  }

  /** Shows the texts of the present scene. */
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

  /** Scenes as a file for `splatlas-preprocess lesson --scene`. A string of JSON is one of TOML. */
  static toml(scenes) {
    const text = JSON.stringify;
    return scenes.map(scene => {
      const lines = ['[[scene]]', ...['name', 'select', 'question', 'caption'].map(key => `${key} = ${text(scene[key])}`),
        ...['azimuth', 'elevation', 'zoom'].map(key => `${key} = ${scene[key]}`), `projection = ${text(scene.projection)}`];
      if (scene.center) lines.push(`center = ${text(scene.center.join())}`);
      if (scene.cuts.length > 0)
        lines.push(`cuts = [${scene.cuts.map(({normal, offset}) => text([...normal, offset].join())).join(', ')}]`);
      if (scene.labels.length > 0) lines.push(`labels = [${scene.labels.map(label => text(label)).join(', ')}]`);
      return `${lines.join('\n')}\n`;
    }).join('\n');
  }
}
