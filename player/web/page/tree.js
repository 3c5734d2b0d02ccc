// The tree of structures, or the list of those that a search finds. Part of the page's script.
'use strict';

const kModeTexts = {
  off: 'hidden', surface: 'surface', ghost: 'ghost', volume: 'volume', both: 'volume and surface', mixed: 'partly shown',
};
const kMaxFound = 200;
const kMaxText = 4000;
const kLongWord = /(\p{L}{10,})/u;
// Before the consonants of a vowel, three letters from both ends
const kBreak = /(?<=^.{3,})(?<![bcdfgkpstv](?=[hlr])|s(?=ch))(?=(?:sch|[bcdfgkpstv][hlr]|[b-df-hj-np-tv-xz])[aeiouyà-öø-ÿœ].)/iu;

/** Creates an element with attributes and children; texts among them are never markup. */
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** A text from the atlas, whose direction cannot reach beyond it. Longer ones would block the page. Long words have
 * soft hyphens, of the style: not every browser hyphenates, and texts stay as they are. */
function nameElement(name) {
  const text = name.length > kMaxText ? `${name.slice(0, kMaxText)}…` : name;
  const parts = text.split(kLongWord).map((part, n) => (n % 2 === 0 ? [part] : part.split(kBreak)));
  return element('bdi', {}, ...parts.flatMap(([first, ...rest]) => [first, ...rest.flatMap(part => [element('i'), part])]));
}

/** Calls the handlers {choose(index), toggle(index)}. */
class Tree {
  #model; #handlers;
  #list = document.getElementById('tree');
  #rows = [];           // {item, index} in the order of the page
  #open = new Set();    // paths of open groups: indices joined by '/'
  #found = null;        // indices that a search has found
  #current = null;      // index of the chosen structure
  #focused = '';        // path of the row that Tab reaches

  constructor(model, handlers) {
    this.#model = model;
    this.#handlers = handlers;
    for (const root of model.roots) this.#openDown(root, String(root), 2);
    this.#list.addEventListener('keydown', event => this.#key(event));
    this.#build();
  }

  #openDown(index, path, levels) {
    const children = this.#model.children(index);
    if (children.length === 0 || levels === 0) return;
    this.#open.add(path);
    if (children.length <= 3) children.forEach(child => this.#openDown(child, `${path}/${child}`, levels - 1));
  }

  /** Shows the structures that a search has found; null: the tree. */
  show(found) {
    this.#found = found;
    this.#build();
  }

  /** Chooses a structure: opens the tree down to it, and scrolls to its row. */
  reveal(index) {
    this.#current = index;
    const path = [];
    for (let at = index; at !== undefined; at = this.#model.parents[at][0]) path.unshift(at);
    for (let n = 1; n < path.length; ++n) this.#open.add(path.slice(0, n).join('/'));
    this.#build();
    const row = this.#rows.find(each => each.index === index);
    if (!row) return;
    this.#focus(row, false);
    row.item.scrollIntoView({block: 'nearest'});
  }

  /** Shows the modes and colours that are drawn. */
  update() {
    for (const {item, index} of this.#rows) {
      const mode = this.#model.mode(index);
      item.dataset.mode = mode;
      item.setAttribute('aria-selected', String(index === this.#current));
      item.querySelector('.mode-text').textContent = `, ${kModeTexts[mode]}`;
      item.querySelector('.swatch').style.backgroundColor = this.#model.appearance(index).color;
      item.querySelector('.eye').title = mode === 'off' ? 'Show' : 'Hide';
    }
  }

  #build() {
    this.#rows = [];
    const items = [];
    if (this.#found) {
      for (const index of this.#found.slice(0, kMaxFound)) items.push(this.#item(index, String(index), 1, true));
    } else {
      this.#addRows(this.#model.roots, '', 1, items);
    }
    this.#list.replaceChildren(...items);
    const tell = text => this.#list.append(element('li', {role: 'none', class: 'empty'}, text));
    if (this.#found?.length > kMaxFound) tell(`The first ${kMaxFound} of ${this.#found.length}.`);
    if (items.length === 0) tell('No structure has this name.');
    if (this.#found?.areNearest) tell('No structure has this name. These are the nearest.');
    const focused = this.#rows.find(({item}) => item.dataset.path === this.#focused) ?? this.#rows[0];
    if (focused) this.#focus(focused, false);
    this.update();
  }

  #addRows(indices, above, level, items) {
    for (const index of indices) {
      const path = above === '' ? String(index) : `${above}/${index}`;
      items.push(this.#item(index, path, level, false));
      if (this.#open.has(path)) this.#addRows(this.#model.children(index), path, level + 1, items);
    }
  }

  #item(index, path, level, isFound) {
    const isGroup = !isFound && this.#model.children(index).length > 0;
    const item = element('li', {role: 'treeitem', 'aria-level': level, tabindex: -1, 'data-path': path});
    const twisty = element('span', {class: 'twisty', 'aria-hidden': 'true'});
    if (isGroup) item.setAttribute('aria-expanded', String(this.#open.has(path)));
    const label = element('span', {class: 'label'}, nameElement(this.#model.structures[index].name));
    if (isFound) label.append(element('small', {}, nameElement(this.#model.path(index).slice(0, -1).join(' › '))));
    const eye = element('button', {class: 'eye', tabindex: -1, 'aria-hidden': 'true'});
    item.append(twisty, element('span', {class: 'swatch', 'aria-hidden': 'true'}), label,
      element('span', {class: 'mode-text hidden-text'}), eye);
    item.style.setProperty('--level', String(level - 1));
    twisty.addEventListener('click', event => {
      event.stopPropagation();
      if (isGroup) this.#reopen(path);
    });
    eye.addEventListener('click', event => {
      event.stopPropagation();
      this.#focus({item}, true);
      this.#handlers.toggle(index);
    });
    item.addEventListener('click', () => this.#choose({item, index}));
    this.#rows.push({item, index});
    return item;
  }

  #choose(row) {
    this.#current = row.index;
    this.#focus(row, true);
    this.update();
    this.#handlers.choose(row.index);
  }

  #focus({item}, takesFocus) {
    for (const row of this.#rows) row.item.tabIndex = -1;
    item.tabIndex = 0;
    this.#focused = item.dataset.path;
    if (takesFocus) item.focus({preventScroll: true});
  }

  /** Keys of a tree: arrows, Home, End, Enter to choose, blank to show or hide. */
  #key(event) {
    const at = this.#rows.findIndex(({item}) => item === document.activeElement);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const row = this.#rows[at];
    const {path} = row.item.dataset;
    const isOpen = row.item.getAttribute('aria-expanded');
    const go = n => this.#focus(this.#rows[Math.min(Math.max(n, 0), this.#rows.length - 1)], true);
    const keys = {
      ArrowDown: () => go(at + 1),
      ArrowUp: () => go(at - 1),
      Home: () => go(0),
      End: () => go(this.#rows.length - 1),
      Enter: () => this.#choose(row),
      ' ': () => this.#handlers.toggle(row.index),
      ArrowRight: () => (isOpen === 'false' ? this.#reopen(path) : go(at + 1)),
      ArrowLeft: () => {
        if (isOpen === 'true') return this.#reopen(path);
        const parent = this.#rows.findIndex(({item}) => item.dataset.path === path.split('/').slice(0, -1).join('/'));
        return parent < 0 ? undefined : go(parent);
      },
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    keys[event.key]();
  }

  #reopen(path) {
    if (!this.#open.delete(path)) this.#open.add(path);
    this.#build();
    this.#focus(this.#rows.find(({item}) => item.dataset.path === path), true);
  }
}
