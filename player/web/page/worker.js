// A worker of the page: draws and picks by an engine. Follows splatlas.js in one script.
//
// From the page:  {type: 'start', server, or module with atlas or size}, 'given' and 'withheld' pieces of an atlas on a
//                 server, and then {type: 'draw'}, 'pick', 'hover', 'label', 'light', 'slices' and 'fit'; see engine.js.
// To the page:    'wanted' pieces, 'ready', 'picture', 'picked', 'hovered', 'labelled', 'lit', 'sliced', 'fitted', 'cancelled', 'error'
//                 (the worker goes on) and 'fatal' (it does not).
'use strict';

(() => {
const kMinScale = 0.25;
const kScaleStep = 1 / 16;
const kMaxGrowth = 1.25;
const kHastyScale = 0.5;  // of the sides of a hasty draft, relative to others
/** What answers each request, in the order of work; 'hover', 'label' and 'light' of the latest picture alone. */
const kTasks = {
  draw: drawPicture,
  pick: answerPick,
  hover: ({serial, u, v}) =>
    ({type: 'hovered', hovered: isLatest(serial) ? splatlas.pick(u * latest.width, v * latest.height) : null}),
  fit: ({state: {select, palette, cuts, size, camera}}) =>
    ({type: 'fitted', camera: splatlas.fitted({select, palette, cuts, size, camera})}),
  label: ({serial, options}) => ({type: 'labelled', layer: isLatest(serial) ? splatlas.labels(options) : null}),
  light: ({serial, structure}) => ({type: 'lit', rows: isLatest(serial) ? splatlas.light(structure) : []}),
  slices: ({wanted}) =>
    ({type: 'sliced', slices: wanted.map(([axis, index]) => ({axis, index, ...splatlas.slice(axis, index)}))}),
};
const isLatest = serial => latest?.serial === serial;

let opening = null;    // the module until its atlas is open
let splatlas = null;
let scale = 1;         // size of drafts, relative to the size asked for
let latest = null;     // {serial, width, height} of the latest picture
let requests = {};     // the newest of each type
let waiting = {};      // those that wait for pieces
let isAwake = false;
let size = null;       // of an atlas on a server

// A message to oneself, behind all messages that wait: only the newest request is drawn.
const channel = new MessageChannel();
channel.port1.onmessage = work;

self.onmessage = ({data}) => {
  if (data.type === 'start') return start(data);
  if (data.type === 'given') return take(data.pieces);
  if (data.type === 'withheld') return waiting = {};
  requests[data.type] = data;
  wake();
};

function wake() {
  if (isAwake || splatlas === null) return;
  isAwake = true;
  channel.port2.postMessage(null);
}

async function start({server, module, atlas, size: bytes}) {
  size = bytes ?? null;
  try {
    opening = server ? Splatlas.connect(server) : await Splatlas.load(module);
    if (atlas) opening.open(atlas);
  } catch (error) { return fail(error, 0, true); }
  return startDrawing();
}

/** Gets ready once the atlas is open. */
function startDrawing() {
  try {
    const isOpen = size === null || opening.openRemote(size);
    if (!isOpen && want(opening)) return;
    if (!isOpen) throw new Error('the atlas cannot be opened');
    [splatlas, opening] = [opening, null];
    self.postMessage({type: 'ready', info: splatlas.info()});
    wake();
  } catch (error) { fail(error, 0, true); }
}

/** Asks the page for the pieces that the latest calls have missed. @returns {boolean} false if there are none */
function want(module) {
  const ranges = size === null ? [] : module.wanted();
  if (ranges.length > 0) self.postMessage({type: 'wanted', ranges});
  return ranges.length > 0;
}

/** Calls the module. @returns {?object} null if it has missed pieces, which the page is asked for */
function complete(call) {
  let [answer, error] = [null, null];
  try {
    answer = call();
  } catch (caught) {
    if (!(caught instanceof Splatlas.Error)) throw caught;
    error = caught;
  }
  if (want(splatlas)) return null;
  if (error) throw error;
  return answer;
}

/** Takes pieces, and goes on with what has waited for them. */
function take(pieces) {
  for (const {offset, bytes} of pieces) (splatlas ?? opening).give(offset, bytes);
  if (opening) return startDrawing();
  [requests, waiting] = [{...waiting, ...requests}, {}];
  return wake();
}

function work() {
  isAwake = false;
  const asked = requests;
  requests = {};
  for (const [type, task] of Object.entries(kTasks)) if (asked[type]) attempt(task, asked[type]);
}

/** Posts what task(request) returns. Tells the page about errors; after a trap this worker is of no use. */
function attempt(task, request) {
  const {type, serial} = request;
  try {
    const answer = complete(() => task(request));
    if (answer) return self.postMessage({serial, ...answer}, answer.data ? [answer.data.buffer] : []);
    waiting[type] = request;
    latest = null;
    return undefined;
  } catch (error) { return fail(error, serial, !(error instanceof Splatlas.Error), type); }
}

/** `of`: the type of the request; only one to draw leaves the page without a picture. A server ends a refinement when
 * its page asks for a newer picture. */
function fail(error, serial, isFatal, of = '') {
  if (error.code === 'cancelled') return self.postMessage({type: 'cancelled', serial});
  return self.postMessage({type: isFatal ? 'fatal' : 'error', of, serial, message: String(error.message ?? error)});
}

function drawPicture(request) {
  const begin = performance.now();
  const isDraft = request.quality === 'draft';
  const shrink = request.isHasty ? Math.max(kMinScale, kHastyScale * scale) : isDraft ? scale : 1;
  const isHasty = isDraft && shrink < scale;
  const picture = renderWithinMemory(request, shrink);
  if (isDraft && !isHasty && !picture.drawn) adapt(performance.now() - begin, request.budget);
  return {type: 'picture', quality: request.quality, isHasty, isFitted: Boolean(request.camera.fit), ...picture};
}

/** Many translucent surfaces may take more than the engine's memory: then a draft of full size. */
function renderWithinMemory(request, shrink) {
  try {
    return render(request, shrink);
  } catch (error) {
    if (error.code !== 'limit' || request.quality === 'draft') throw error;
    return render({...request, quality: 'draft', budget: 0}, 1);
  }
}

function render({serial, select, palette, cuts, depthCue, budget, camera, size, quality}, shrink) {
  latest = null;
  const [width, height] = size.map(side => Math.max(1, Math.round(side * shrink)));
  const placed = camera.fit ? {...camera, fit: {...camera.fit, size}} : camera;
  const picture = splatlas.draw({
    select, palette, cuts, camera: placed, size: [width, height], quality,
    depthCue: depthCue && quality !== 'draft', draftBudget: budget,
  });
  latest = {serial, width, height};
  return picture;
}

/** Chooses the size of the next draft by the time of the latest. */
function adapt(ms, budget) {
  const wanted = Math.min(scale * Math.sqrt(budget / ms), scale * kMaxGrowth, 1);
  scale = Math.max(kMinScale, Math.round(wanted / kScaleStep) * kScaleStep);
}

/** Picks in the page's newest state. The latest picture is of another one only after an error. */
function answerPick({serial, state, pick}) {
  if (!isLatest(serial)) render({...state, serial, budget: 0, quality: 'draft'}, 1);
  return {type: 'picked', pick, picked: splatlas.pick(pick.u * latest.width, pick.v * latest.height)};
}
})();
