// A worker of the page: draws and picks with the module. Follows splatlas.js in one script.
//
// From the page:  {type: 'start', module, atlas}, then {type: 'draw', ...} and {type: 'pick', ...}; see engine.js.
// To the page:    'ready', 'picture', 'picked', 'error' (the worker goes on) and 'fatal' (it does not).
'use strict';

(() => {
const kMinScale = 0.25;
const kScaleStep = 1 / 16;
const kMaxGrowth = 1.25;

let splatlas = null;
let selected = null;   // text of the module's selection
let scale = 1;         // size of drafts, relative to the size asked for
let drawRequest = null;
let pickRequest = null;
let isAwake = false;

// A message to oneself, behind all messages that wait: only the newest request is drawn.
const channel = new MessageChannel();
channel.port1.onmessage = work;

self.onmessage = ({data}) => {
  if (data.type === 'start') return start(data);
  if (data.type === 'draw') drawRequest = data;
  if (data.type === 'pick') pickRequest = data;
  wake();
};

function wake() {
  if (isAwake || splatlas === null) return;
  isAwake = true;
  channel.port2.postMessage(null);
}

async function start({module, atlas}) {
  try {
    splatlas = await Splatlas.load(module);
    splatlas.open(atlas);
    self.postMessage({type: 'ready', info: splatlas.info()});
    wake();
  } catch (error) {
    fail(error, 0, true);
  }
}

function work() {
  isAwake = false;
  const [draw, pick] = [drawRequest, pickRequest];
  drawRequest = pickRequest = null;
  if (draw) attempt(drawPicture, draw);
  if (pick) attempt(answerPick, pick);
}

/** Calls task(request). Tells the page about errors; after a trap this worker is of no use. */
function attempt(task, request) {
  try {
    task(request);
  } catch (error) {
    fail(error, request.serial, !(error instanceof Splatlas.Error));
  }
}

function fail(error, serial, isFatal) {
  self.postMessage({type: isFatal ? 'fatal' : 'error', serial, message: String(error.message ?? error)});
}

function drawPicture(request) {
  const isNew = request.select !== selected;
  let warnings = [];
  if (isNew) {
    selected = null;
    warnings = splatlas.select(request.select);
    selected = request.select;
  }
  const isDraft = request.quality === 'draft';
  splatlas.cut(request.cuts);
  splatlas.options({depthCue: request.depthCue && !isDraft, draftBudget: request.budget});
  splatlas.camera = request.camera;
  const [width, height] = request.size;
  if (request.fit) {
    const camera = splatlas.fit(width, height, request.fit.structure);
    splatlas.view({zoom: camera.zoom * request.fit.zoom});
  }
  const shrink = isDraft && request.budget > 0 ? scale : 1;
  const begin = performance.now();
  const picture = splatlas.render(Math.max(1, Math.round(width * shrink)), Math.max(1, Math.round(height * shrink)),
    request.quality);
  if (shrink === scale && isDraft && !isNew) adapt(performance.now() - begin, request.budget);
  self.postMessage({
    type: 'picture', serial: request.serial, quality: request.quality, camera: splatlas.camera, warnings,
    ms: performance.now() - begin, drawn: isNew ? splatlas.drawn() : null, isFitted: Boolean(request.fit), ...picture,
  }, [picture.data.buffer]);
}

/** Chooses the size of the next draft by the time of the latest. */
function adapt(ms, budget) {
  if (budget <= 0) return;
  const wanted = Math.min(scale * Math.sqrt(budget / ms), scale * kMaxGrowth, 1);
  scale = Math.max(kMinScale, Math.round(wanted / kScaleStep) * kScaleStep);
}

/** Picks in a small picture of the page's newest state, which need not be the latest picture. */
function answerPick({serial, state, u, v}) {
  drawPicture({...state, serial, quality: 'draft', budget: 0});
  const [width, height] = state.size;
  self.postMessage({type: 'picked', serial, picked: splatlas.pick(u * width, v * height)});
}
})();
