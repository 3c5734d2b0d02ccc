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

// Names that students use.
const sides = {
  'hippocampus': 'hippocampus', 'hippocampal formation': 'hippocampus', 'precentral gyrus': 'precentral gyrus',
  'postcentral gyrus': 'postcentral gyrus', 'superior temporal gyrus': 'superior temporal gyrus',
  'primary motor cortex': 'precentral gyrus', 'caudate nucleus': 'caudate nucleus', 'putamen': 'putamen',
  'globus pallidus': 'globus pallidus', 'thalamus': 'thalamus', 'amygdala': 'amygdala',
  'anterior cingulate cortex': 'anterior cingulate gyrus', 'parahippocampal gyrus': 'parahippocampal gyrus',
  'fusiform gyrus': 'fusiform gyrus', 'lingual gyrus': 'lingual gyrus', 'precuneus': 'precuneus',
  'calcarine sulcus': 'calcarine cortex', 'visual cortex': 'calcarine cortex', 'supramarginal gyrus': 'supramarginal gyrus',
  'paracentral lobule': 'paracentral lobule', 'supplementary motor area': 'supplementary motor area',
  'olfactory cortex': 'olfactory cortex',
};
for (const [text, name] of Object.entries(sides)) finds(text, `Left ${name}`, 2);
finds('left hippocampus', 'Left hippocampus', 1);
finds('right thalamus', 'Right thalamus', 1);
finds('gyrus', 'Left precentral gyrus', 56);
finds('inferior frontal gyrus', 'Left inferior frontal gyrus, opercular part', 6);
finds('middle frontal gyrus', 'Left middle frontal gyrus', 4);
finds('cingulate gyrus', 'Left anterior cingulate gyrus', 6);
finds('Broca', 'Left inferior frontal gyrus, opercular part', 2);
finds('Wernicke', 'Left superior temporal gyrus', 1);
finds('temporal pole', 'Left temporal pole, superior part', 4);
finds('orbitofrontal cortex', 'Left superior frontal gyrus, orbital part', 8);
finds('insula', 'Insula', 3);
finds('occipital lobe', 'Occipital lobe', 1);
finds('cerebellum', 'Cerebellum', 1);
finds('cerebellar vermis', 'Cerebellar vermis, lobules I and II', 8);

// Exact hits first: not the precuneus, not the triangular part.
finds('cuneus', 'Left cuneus', 4);
finds('angular gyrus', 'Left angular gyrus', 4);
finds('Hippocampus_R', 'Right hippocampus', 2);

// Order, accents, endings and a wrong letter.
finds('thalamus right', 'Right thalamus', 1);
finds('area Bróca’s', 'Left inferior frontal gyrus, opercular part', 2);
finds('hippocampal', 'Left hippocampus', 4);
finds('thalami', 'Left thalamus', 2);
finds('occipital lobes', 'Occipital lobe', 1);
finds('hipocampus', 'Left hippocampus', 4);
finds('girus', 'Left precentral gyrus', 56);

// Names of a quiz: wildcards, and terms after names.
for (const text of ['left THALAM*', 'Thalamus_L'])
  assert.deepStrictEqual(model.named(text).map(index => model.structures[index].name), ['Left thalamus']);
assert.deepStrictEqual(model.named('(Left thalamus'), []);

// The nearest where nothing fits: AAL has no brain stem.
finds('brain stem', 'Rest of brain', 5, true);
finds('corpus callosum', 'Left amygdala', 5, true);
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
