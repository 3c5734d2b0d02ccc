// node check_model.js SOURCE: the model of the page: its search over the names of the Colin 27 brain, and its steps. SOURCE
// is the project's folder.
'use strict';
const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');

const read = file => fs.readFileSync(path.join(process.argv[2], file), 'utf8');
const Model = new Function(`${read('player/web/page/model.js')}; return Model;`)();

const rows = read('preprocess/trees/colin27_aal.tsv').split('\n').slice(2, -1).map(row => row.split('\t'));
const groups = ['Brain', 'Vermis', 'Frontal lobe', 'Insula', 'Occipital lobe', 'Cerebellum', 'Rest of brain'];
const structures = [
  ...groups.map(name => ({name, id: name, parents: []})),
  ...rows.map(([, , name, code, latin = '', synonyms = '']) =>
    ({name, id: name, parents: [], terms: [code, latin, ...synonyms.split('; ')].map(value => ({value}))})),
];
const model = new Model({structures});

/** A text finds so many structures, this one first. */
function finds(text, first, count, areNearest = undefined) {
  const found = model.search(text);
  const names = found.map(index => structures[index].name);
  assert.deepStrictEqual([names[0], names.length, found.areNearest], [first, count, areNearest], `${text}: ${names}`);
}

// Names that students use, with other order, accents, endings and a wrong letter; the last have the nearest alone: AAL
// has no brain stem. Exact hits are first: for cuneus not the precuneus, for angular gyrus not the triangular part.
for (const row of JSON.parse(read('tests/player/web/names_of_students.json'))) finds(...row);

// Names of a quiz: wildcards, and terms after names.
for (const text of ['left THALAM*', 'Thalamus_L'])
  assert.deepStrictEqual(model.named(text).map(index => model.structures[index].name), ['Left thalamus']);
assert.deepStrictEqual(model.named('(Left thalamus'), []);

assert.deepStrictEqual(new Model({structures: [['H'], ['L'], ['a', 'H', 'L'], ['b', 'H'], ['c', 'L'], ['d', 'H']].map(([id, ...parents]) => ({id, parents}))})
  .groups(2), [1, 0]);
assert.strictEqual(model.search(' - '), null);

// Steps: what comes back, and with which camera.
const lesson = new Model({structures, scenes: [
  {select: 'Brain', cuts: [], question: ''}, {select: 'Vermis ', cuts: [{normal: [1, 0, 0], offset: 2}], question: 'Which?'}]});
const texts = () => [lesson.selection(), lesson.state.cuts.length, lesson.state.scene, lesson.differsFromScene()];
lesson.change(lesson.sceneState(0), 'opening');
lesson.change(lesson.sceneState(1), 'first');
assert.deepStrictEqual(texts(), ['Vermis', 1, 1, false]);
assert.strictEqual(lesson.state.isAsking, true);
lesson.ghostOthers(0, 'second');
assert.deepStrictEqual(texts(), ['"Brain":surface + rest(ghost)', 1, 1, true]);
lesson.change({}, 'turned', null, true);
assert.strictEqual(lesson.step('undo', 'now'), 'turned');
assert.strictEqual(lesson.step('undo', 'now'), null);
assert.deepStrictEqual(texts(), ['Vermis', 1, 1, false]);
assert.strictEqual(lesson.step('undo', 'now'), 'first');
assert.deepStrictEqual(texts(), ['Brain', 0, 0, false]);
assert.strictEqual(lesson.step('redo', 'here'), 'now');
lesson.step('redo', 'here');
assert.strictEqual(lesson.step('redo', 'here'), 'now');
assert.deepStrictEqual([...texts(), lesson.canRedo()], ['"Brain":surface + rest(ghost)', 1, 1, true, false]);
lesson.step('undo', 'here');
lesson.hideAll('here');
assert.deepStrictEqual([lesson.selection(), lesson.canRedo(), lesson.canUndo()], ['', false, true]);

// Steps follow the scenes to their new numbers; those of a removed scene have none.
const ordered = new Model({structures, scenes: [...lesson.info.scenes]});
ordered.change(ordered.sceneState(0), 'opening');
ordered.change(ordered.sceneState(1), 'first');
ordered.renumber(ordered.info.scenes.splice(0, 2, ...[...lesson.info.scenes].reverse()));
assert.deepStrictEqual([ordered.state.scene, ordered.step('undo', 'second'), ordered.state.scene], [0, 'first', 1]);
ordered.renumber([ordered.info.scenes.shift(), ...ordered.info.scenes]);
assert.deepStrictEqual([ordered.state.scene, ordered.step('redo', 'first'), ordered.state.scene], [0, 'second', null]);

// A draft that comes late ends the refinement of its state, which is asked for again, whatever comes first.
async function refinesAgain() {
  const [workers, asked] = [[], []];
  let due = null;
  class Worker {
    constructor() { workers.push(this); }
    postMessage({type, quality, isHasty, camera}) {
      if (type === 'draw') asked.push((isHasty ? 'hasty' : quality) + (camera.fit ? ' fitted' : ''));
    }
    terminate() { asked.push('ended'); }
  }
  const world = {
    Worker, document: {getElementById: () => ({dataset: {served: ''}, textContent: ''})}, location: {}, history: {replaceState() {}},
    EventSource: class { constructor() { setImmediate(() => this.onopen()); } }, navigator: {}, crypto: {randomUUID() {}},
    URL: {createObjectURL() {}}, setTimeout: call => { due = call; }, clearTimeout: () => { due = null; }};
  const Engine = new Function(...Object.keys(world), `${read('player/web/page/engine.js')}; return Engine;`)(...Object.values(world));
  const engine = new Engine(new Proxy({}, {get: () => () => undefined}));
  await engine.start();
  const [drafts, refiner] = workers;
  drafts.onmessage({data: {type: 'ready', info: {}}});
  engine.show({select: 'Brain', camera: {}});
  due();
  refiner.onmessage({data: {type: 'cancelled', serial: 1}});
  drafts.onmessage({data: {type: 'picture', serial: 1, quality: 'draft'}});
  due();
  assert.deepStrictEqual(asked, ['draft', 'normal', 'normal']);

  // A draft in the middle of a refinement is a small one, and another one follows it
  engine.show({select: 'Brain', camera: {}});
  drafts.onmessage({data: {type: 'picture', serial: 2, quality: 'draft', isHasty: true}});
  drafts.onmessage({data: {type: 'picture', serial: 2, quality: 'draft'}});
  due();
  assert.deepStrictEqual(asked.slice(3), ['hasty', 'draft', 'normal']);

  // A large refining worker ends once it rests; another one decodes the next state at once
  refiner.onmessage({data: {type: 'picture', serial: 2, quality: 'normal', heap: 1e9}});
  due();
  engine.show({select: 'Brain', camera: {fit: {}}});
  assert.deepStrictEqual([workers.length, asked.slice(6)], [3, ['ended', 'draft fitted', 'normal fitted']]);

  // A finished picture is fitted, too: drafts may fit coarse surfaces
  workers[2].onmessage({data: {type: 'cancelled', serial: 3}});
  drafts.onmessage({data: {type: 'picture', serial: 3, quality: 'draft', isFitted: true, camera: {}}});
  due();
  assert.deepStrictEqual(asked.slice(9), ['normal fitted']);
}
refinesAgain();
