// The state of the page: structures, selection, cuts and undo. Part of the page's script.
'use strict';

const kMaxCuts = 6;
const kOpacities = {surface: 1, ghost: 0.7, volume: 0.3, both: 0.3};  // where the selection gives none

const isAcross = ({normal}, axis) => normal.every((component, a) => (component !== 0) === (a === axis));

/** What the page shows. The selection is a text, from a scene or a link, and edits of single subtrees behind it. */
class Model {
  #undo = [];
  #redo = [];
  #forgotten = 0;  // steps before those in #undo
  #children;

  /** @param {object} info the document of `splatlas-player info --json` */
  constructor(info) {
    this.info = info;
    this.structures = info.structures;
    const indices = new Map(this.structures.map((structure, index) => [structure.id, index]));
    this.#children = this.structures.map(() => []);
    this.roots = [];
    this.structures.forEach((structure, index) => {
      if (structure.parents.length === 0) this.roots.push(index);
      for (const parent of structure.parents) this.#children[indices.get(parent)].push(index);
    });
    this.parents = this.structures.map(structure => structure.parents.map(id => indices.get(id)));
    /** Mode, opacity and colour of every structure, as the module has drawn it; see Splatlas.draw(). */
    this.drawn = this.structures.map(() => ['off']);
    /** Cuts as the module takes them; whether the scene shows its question. */
    this.state = {base: '*', edits: [], cuts: [], scene: null, isAsking: false};
  }

  /** Takes what is drawn, and colours of the structures in place of the atlas's. */
  take(drawn, colors) {
    this.drawn = drawn;
    this.structures = this.info.structures.map((structure, n) => (colors ? {...structure, color: colors[n]} : structure));
  }

  children(index) { return this.#children[index]; }

  subtree(index) {
    const found = new Set([index]);
    for (const structure of found) this.#children[structure].forEach(child => found.add(child));
    return [...found];
  }

  leaves(index) { return this.subtree(index).filter(structure => this.#children[structure].length === 0); }

  /** The groups above a structure, the smallest first. */
  groups(index) {
    const isAbove = group => group !== index && this.subtree(group).includes(index);
    return [...this.structures.keys()].filter(isAbove).sort((a, b) => this.leaves(a).length - this.leaves(b).length);
  }

  /** Names from a root to the structure, along its first parents. */
  path(index) {
    const names = [];
    for (let at = index; at !== undefined; at = this.parents[at][0]) names.unshift(this.structures[at].name);
    return names;
  }

  /** The mode of a subtree: 'off', 'surface', 'ghost', 'volume', 'both' or 'mixed'. */
  mode(index) {
    const modes = new Set(this.leaves(index).map(leaf => this.drawn[leaf][0]));
    return modes.size === 1 ? modes.values().next().value : 'mixed';
  }

  /** Opacity and colour of the first drawn structure of a subtree; of the structure itself when all are off. */
  appearance(index) {
    const leaf = this.leaves(index).find(structure => this.drawn[structure][0] !== 'off');
    if (leaf === undefined) return {opacity: null, color: this.structures[index].color};
    const [mode, opacity, color] = this.drawn[leaf];
    return {opacity: opacity ?? kOpacities[mode], color};
  }

  /** The selection as text of `splatlas-player render --select`. */
  selection() {
    let text = this.state.base;
    for (const edit of this.state.edits) text += this.#textOf(edit, text.trim() === '');
    return text.trim();
  }

  #textOf({index, mode, opacity, color}, isFirst) {
    const name = `"${this.structures[index].id}"`;
    const removal = isFirst ? '' : ` - ${name}`;
    if (mode === 'off') return removal;
    const isGhost = mode === 'ghost';
    const options = [isGhost ? 'ghost' : '', opacity === null ? '' : `opacity=${opacity}`, color === null ? '' : `color=${color}`];
    const listed = options.filter(option => option !== '').join(',');
    return `${removal} ${isFirst ? '' : '+ '}${name}:${isGhost ? 'surface' : mode}${listed === '' ? '' : `(${listed})`}`;
  }

  /** The cut across an axis of LPS, {offset, isFlipped}; null: none. */
  cutAcross(axis) {
    const plane = this.state.cuts.find(cut => isAcross(cut, axis));
    return plane ? {offset: plane.offset / plane.normal[axis], isFlipped: plane.normal[axis] < 0} : null;
  }

  setCutAcross(axis, cut, camera, gesture) {
    const others = this.state.cuts.filter(plane => !isAcross(plane, axis));
    const sign = cut?.isFlipped ? -1 : 1;
    const planes = cut ? [{normal: [0, 1, 2].map(a => (a === axis ? sign : 0)), offset: sign * cut.offset}] : [];
    this.change({cuts: [...planes, ...others].slice(0, kMaxCuts)}, camera, gesture);
  }

  sceneState(n) {
    const {select, cuts, question} = this.info.scenes[n];
    return {base: select, edits: [], cuts, scene: n, isAsking: question !== ''};
  }

  /** Changes the state. Steps with the same gesture in succession are one step of undo. `moves`: the camera, too. */
  change(state, camera, gesture = null, moves = false) {
    const latest = this.#undo.at(-1);
    if (gesture === null || latest?.gesture !== gesture) this.#undo.push({state: this.state, camera, gesture, moves});
    this.#redo = [];
    if (this.#undo.length > 200) {
      this.#undo.shift();
      ++this.#forgotten;
    }
    this.state = {...this.state, ...state};
  }

  /** The next change is a step of its own. */
  endGesture() { if (this.#undo.length > 0) this.#undo.at(-1).gesture = null; }

  canUndo() { return this.#undo.length > 0; }

  canRedo() { return this.#redo.length > 0; }

  steps() { return this.#forgotten + this.#undo.length; }

  forgetSteps(steps) {
    this.#undo.length = Math.min(this.#undo.length, Math.max(steps - this.#forgotten, 0));
  }

  /** The scenes were `before`: the state and all steps take their new numbers. */
  renumber(before) {
    for (const each of [this, ...this.#undo, ...this.#redo]) {
      const scene = this.info.scenes.indexOf(before[each.state.scene]);
      each.state = {...each.state, ...(scene < 0 ? {scene: null, isAsking: false} : {scene})};
    }
  }

  /** True if the selection is not that of the present scene, or if there is no scene. */
  differsFromScene() {
    const {scene, base, edits} = this.state;
    return scene === null || edits.length > 0 || base.trim() !== this.info.scenes[scene].select.trim();
  }

  /** Goes one step back ('undo') or forth ('redo').
   * @returns {?object} the camera of that state if the step was a move or to another scene */
  step(direction, camera) {
    const [from, to] = direction === 'undo' ? [this.#undo, this.#redo] : [this.#redo, this.#undo];
    const step = from.pop();
    if (!step) return null;
    const moves = step.moves || step.state.scene !== this.state.scene;
    to.push({state: this.state, camera, gesture: null, moves});
    this.state = step.state;
    return moves ? step.camera : null;
  }

  /** The edits with new ones, which replace earlier ones in their subtrees. */
  #edited(added) {
    const replaced = new Set(added.flatMap(edit => this.subtree(edit.index)));
    return [...this.state.edits.filter(edit => !replaced.has(edit.index)), ...added];
  }

  /** The colour of a structure, also while it is hidden or a ghost, which has a colour of its own. */
  #own(index) {
    const isLeaf = this.#children[index].length === 0;
    if (isLeaf && !['off', 'ghost'].includes(this.mode(index))) return this.appearance(index).color;
    return this.state.edits.find(edit => edit.index === index)?.own ?? this.structures[index].color;
  }

  /** Sets the mode of a subtree. A structure keeps its colour. */
  setMode(index, mode, camera) {
    const own = this.#own(index);
    const keeps = this.#children[index].length === 0 && this.mode(index) === mode;
    const edit = {
      index, mode, own, opacity: keeps ? this.appearance(index).opacity : null,
      color: mode !== 'ghost' && own !== this.structures[index].color ? own : null,
    };
    this.change({edits: this.#edited([edit])}, camera);
  }

  /** Hides a subtree, or shows it again as it was. */
  toggle(index, camera) {
    const {edits} = this.state;
    const within = new Set(this.subtree(index));
    const latest = edits.findLast(edit => within.has(edit.index));
    if (latest?.index === index && latest.replaced)
      return this.change({edits: [...edits.filter(edit => edit !== latest), ...latest.replaced]}, camera);
    if (this.mode(index) === 'off') return this.setMode(index, 'surface', camera);
    const hidden = {index, mode: 'off', own: this.#own(index), replaced: edits.filter(edit => within.has(edit.index))};
    return this.change({edits: this.#edited([hidden])}, camera);
  }

  /** Sets opacity or colour of what is drawn in a subtree. */
  setAppearance(index, change, camera) {
    const parts = this.#uniformParts(index);
    const edits = parts.map(part => {
      const {opacity, color} = this.appearance(part);
      const isGroup = this.#children[part].length > 0;
      const mode = this.mode(part);
      const isOwnColor = mode !== 'ghost' && (isGroup || color === this.structures[part].color);
      const own = change.color ?? this.#own(part);
      return {index: part, mode, own, opacity, color: isOwnColor ? null : color, ...change};
    });
    if (edits.length > 0) this.change({edits: this.#edited(edits)}, camera, `${index} ${Object.keys(change)}`);
  }

  /** The largest subtrees of one mode in a subtree, without those that are off. */
  #uniformParts(index) {
    const mode = this.mode(index);
    if (mode === 'off') return [];
    const colors = new Set(this.leaves(index).map(leaf =>
      mode === 'ghost' || this.drawn[leaf][2] === this.structures[leaf].color));
    const isUniform = mode !== 'mixed' && (colors.size === 1 && colors.has(true) || this.#children[index].length === 0);
    return isUniform ? [index] : this.#children[index].flatMap(child => this.#uniformParts(child));
  }

  /** Shows a subtree alone, as it is drawn, or as surface if it is off. */
  isolate(index, camera) {
    const parts = this.#uniformParts(index);
    const edits = parts.map(part => {
      const {opacity, color} = this.appearance(part);
      const mode = this.mode(part);
      if (mode === 'ghost') return {index: part, mode: 'surface', opacity: null, color: null};
      return {
        index: part, mode, opacity: mode === 'surface' ? 1 : opacity,
        color: color !== this.structures[part].color && this.#children[part].length === 0 ? color : null,
      };
    });
    const shown = edits.length > 0 ? edits : [{index, mode: 'surface', opacity: null, color: null}];
    this.change({base: '', edits: shown}, camera);
  }

  showAll(camera) { this.change({base: '*:surface', edits: []}, camera); }

  hideAll(camera) { this.change({base: '', edits: []}, camera); }

  /** The structures with this name, id or path, or one that begins as a text with `*`; without any, those with this term. */
  named(text) {
    const [first, rest] = text.toLowerCase().split('*');
    const fits = value => (rest === undefined ? value === first : value.startsWith(first));
    const having = texts => [...this.structures.keys()].filter(index => texts(this.structures[index], index).some(value => fits(value.toLowerCase())));
    const found = having(({name, id}, index) => [name, id, this.path(index).slice(-2).join('/')]);
    return found.length > 0 ? found : having(({terms = []}) => terms.map(({value}) => value));
  }

  /** Shows a subtree within the hulls of all others. */
  ghostOthers(index, camera, cuts = this.state.cuts) {
    const mode = this.mode(index);
    const own = ['surface', 'volume', 'both'].includes(mode) ? mode : 'surface';
    this.change({base: `"${this.structures[index].id}":${own} + rest(ghost)`, edits: [], cuts}, camera);
  }

  /**
   * Indices of the structures with every word of the text in their names, ids and terms, best first; null for a blank
   * text. Single letters are words, or begin some. Where none fits, endings do not count, then not one wrong letter in
   * a word. Without any, `areNearest` is true.
   */
  search(text) {
    const phrase = Model.folded(text).trim();
    if (phrase === '') return null;
    const words = phrase.split(' ');
    this.#index ??= this.structures.map(({name, id, terms = []}) =>
      [name, id, ...terms.map(term => term.value)].map(value => `\n ${Model.folded(value).trim()} \n`).join(''));
    const sorted = (indices, rank) => {
      const ranks = new Map(indices.map(index => [index, rank(this.#index[index])]));
      return indices.sort((a, b) => ranks.get(a) - ranks.get(b));
    };
    const all = [...this.structures.keys()];
    for (const fits of [Model.#holdsLetters, Model.#holds, Model.#holdsStem, Model.#holdsNearly]) {
      const found = all.filter(index => words.every(word => fits(this.#index[index], word)));
      if (found.length > 0) return sorted(found, names => [
        names.includes(`\n ${phrase} \n`), words.every(word => names.includes(` ${word} `)),
        words.every(word => fits(names, ` ${word}`)), true,
      ].indexOf(true));
    }
    const errors = names => words.reduce((sum, word) => sum + Model.#errors(names, word), 0);
    return Object.assign(sorted(all, errors).slice(0, 5), {areNearest: true});
  }
  #index = null;

  static #holdsLetters = (names, word) => names.includes(word.length > 1 ? word : ` ${word} `);
  static #holds = (names, word) => names.includes(word.length > 1 ? word : ` ${word}`);
  static #holdsStem = (names, word) => Model.#holds(names, Model.#stem(word));
  static #holdsNearly = (names, word) => (word.length < 5 ? Model.#holdsStem(names, word) :
    Model.#errors(names, Model.#stem(word).length < 4 ? word : Model.#stem(word)) <= 1);

  /** A word without its Latin or English ending. */
  static #stem(word) { return word.replace(/^(.{3,}?)(?:ic(?:al|es)?|us|um|is|a[elr]|e[is]|[aeis])$/, '$1'); }

  /** The fewest letters to replace, insert or delete that turn the word into a part of the text. */
  static #errors(text, word) {
    let row = [...word, ''].map((_, n) => n);
    let fewest = word.length;
    for (const letter of text) {
      const next = [0];
      for (let n = 0; n < word.length; ++n)
        next.push(Math.min(row[n] + (word[n] === letter ? 0 : 1), row[n + 1] + 1, next[n] + 1));
      row = next;
      fewest = Math.min(fewest, row[word.length]);
    }
    return fewest;
  }

  /** Text without case, accents and punctuation, for comparison. */
  static folded(text) {
    return text.normalize('NFD').replace(/[\p{M}'’]/gu, '').replace(/[^\p{L}\p{N}]+/gu, ' ').toLowerCase();
  }
}
