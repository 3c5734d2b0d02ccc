// node browse.js PAGE FOLDER NAME PLAYER ATLAS: drives a page of `splatlas-player export --html` in Chromium, from
// file://, and the page that PLAYER serves for ATLAS.
//
// FOLDER/site has its site, which a server with ranges and one without give to the browser, too.
// Loads it, drags, searches for NAME, chooses, picks, cuts, undoes, and steps through the scenes, at the sizes of a
// desk and of a phone. Console messages, requests and dialogs are failures. Writes screenshots into FOLDER.
// The page must have scenes. Installs puppeteer-core and axe-core in FOLDER. SPLATLAS_BROWSER may name another Chromium, or Firefox.
// Exit status 77: these, the browser or the page (without the module, none is exported) are missing.
'use strict';
const assert = require('node:assert');
const {execFileSync, spawn} = require('node:child_process');
const {once} = require('node:events');
const fs = require('node:fs');
const path = require('node:path');
const {createRequire} = require('node:module');
const {pathToFileURL} = require('node:url');
const {serve} = require('./serve.js');

const kBrowser = process.env.SPLATLAS_BROWSER ?? '/usr/bin/chromium';
const kIsFirefox = kBrowser.includes('firefox');
const kDesk = {width: 1280, height: 800};
const kPhone = {width: 390, height: 844, ...(kIsFirefox ? {} : {isMobile: true, hasTouch: true})};
const kPatience = 60000;  // ms

const kDragMoves = 60;
const kFrameMs = 30;
const kMinDraftRate = 3;  // a second; slow machines run other tests meanwhile

const kPackages = ['puppeteer-core@24', 'axe-core@4'];

const [file, folder, name, player, atlas] = process.argv.slice(2);

/** The library that drives browsers; null where it or axe cannot be installed. */
function puppeteer() {
  const load = createRequire(path.resolve(folder, 'package.json'));
  try {
    if (!fs.existsSync(path.join(folder, 'node_modules', 'axe-core'))) {
      fs.writeFileSync(path.join(folder, 'package.json'), '{}');
      execFileSync('npm', ['install', '--no-audit', '--no-fund', ...kPackages], {cwd: folder, stdio: 'ignore'});
    }
    return load('puppeteer-core');
  } catch {
    return null;
  }
}

const textOfCanvas = () => document.getElementById('canvas').toDataURL();

class Visit {
  /** @param {?string} site the only address that the page may fetch from; null: none */
  constructor(page, viewport, site = null) {
    this.page = page;
    this.viewport = viewport;
    this.messages = [];
    page.on('console', message => this.messages.push(message.text()));
    page.on('pageerror', error => this.messages.push(String(error)));
    page.on('dialog', dialog => {
      if (dialog.message() === this.agrees) return dialog.accept();
      this.messages.push(`dialog: ${dialog.message()}`);
      return dialog.dismiss();
    });
    page.on('request', request => {
      const isOwn = /^(file|data|blob):/.test(request.url()) || (site !== null && request.url().startsWith(site));
      if (!isOwn) this.messages.push(`request: ${request.url()}`);
    });
  }

  async open(url) {
    await this.page.setViewport(this.viewport);
    await this.page.goto(url, {waitUntil: 'load'});
    await this.refined();
  }

  /** Waits for the finished picture of the present state. */
  async refined() {
    await this.page.waitForFunction(() => document.body.dataset.quality === 'normal', {timeout: kPatience});
  }

  /** Acts, waits for the finished picture, and requires that it is another one. */
  async changes(what, act) {
    const before = await this.page.evaluate(textOfCanvas);
    await this.page.evaluate(() => { document.body.dataset.quality = ''; });
    await act();
    await this.refined();
    assert(await this.page.evaluate(textOfCanvas) !== before, `${what}: the picture is the same`);
  }

  /** Presses keys and clicks what selectors name; each gives another picture. */
  async changesBy(...acts) {
    for (const act of acts)
      await this.changes(act, () => (/^[#[]/.test(act) ? this.page.click(act) : this.page.keyboard.press(act)));
  }

  async text(selector) { return this.page.$eval(selector, each => each.textContent); }

  /** A screenshot of a state that axe finds no fault in. */
  async picture(name) {
    await this.page.screenshot({path: path.join(folder, `${name}.png`)});
    await this.page.evaluate(fs.readFileSync(path.join(folder, 'node_modules', 'axe-core', 'axe.min.js'), 'utf8'));
    const faults = await this.page.evaluate(async () => (await window.axe.run()).violations.map(
      ({id, nodes}) => `${id}: ${nodes.map(({target}) => target).join(', ')}`));
    assert.deepStrictEqual(faults, [], name);
  }

  async hasNoOverflow() {
    const [width, room] = await this.page.evaluate(
      () => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
    assert(width <= room, `the page is ${width - room} pixels wider than the window`);
  }
}

/** Middle of the picture. */
async function middleOf(visit) {
  const box = await (await visit.page.$('#canvas')).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/** Turns the picture. Requires drafts while it turns. */
async function drag(visit) {
  const {mouse} = visit.page;
  await visit.page.evaluate(() => {
    const put = CanvasRenderingContext2D.prototype.putImageData;
    window.drafts = 0;
    CanvasRenderingContext2D.prototype.putImageData = function count(...picture) {
      ++window.drafts;
      put.apply(this, picture);
    };
  });
  const begin = performance.now();
  const [x, y] = await middleOf(visit);
  await mouse.move(x, y);
  await mouse.down();
  for (let n = 1; n <= kDragMoves; ++n) {
    await mouse.move(x + 200 * n / kDragMoves, y + 40 * n / kDragMoves);
    await new Promise(resolve => setTimeout(resolve, kFrameMs));
  }
  const seconds = (performance.now() - begin) / 1000;
  const rate = await visit.page.evaluate(() => window.drafts) / seconds;
  await mouse.up();
  console.log(`${rate.toFixed(1)} drafts a second in a drag`);
  assert(rate > kMinDraftRate);
}

async function search(visit) {
  const {page} = visit;
  const isNamed = text => text.toLowerCase().includes(name.toLowerCase());
  await page.click('#search');
  await page.type('#search', name);
  const rows = await page.$$eval('#tree .label > bdi', names => names.map(each => each.textContent));
  assert(rows.length > 0 && rows.every(isNamed), `found: ${rows}`);
  await visit.picture('search');
  await page.keyboard.press('Enter');
  assert(isNamed(await visit.text('#picked strong')));
  assert(await page.$eval('#search', input => input.value === '' && document.activeElement.ariaSelected === 'true'));
}

/** Shows the found structure alone, changes it, and picks it. */
async function edit(visit) {
  const {page} = visit;
  await visit.changesBy('#isolate', '0');
  const [x, y] = await middleOf(visit);
  await page.mouse.click(x, y);
  await page.waitForSelector('#picked strong', {timeout: kPatience});
  assert.strictEqual(await visit.text('#picked strong'), await visit.text('#chosen-name'));
  assert.strictEqual(await page.$eval('#search', input => input.value), '');
  await visit.picture('desk_pick');
  await visit.changesBy('[data-mode-button=volume]');
  await visit.changes('colour', () => page.$eval('#color', input => {
    input.value = '#20c040';
    input.dispatchEvent(new Event('input'));
  }));
  await visit.changesBy('#undo', 'u', 'u', '0');
}

/** What the pointer does: a name at rest, a focus, a menu. */
async function point(visit) {
  const {page} = visit;
  const [x, y] = await middleOf(visit);
  await page.mouse.move(x + 3, y + 3);
  await page.waitForFunction(() => document.getElementById('hover').textContent !== '', {timeout: kPatience});
  assert.strictEqual(await visit.text('#hover'), await visit.text('#chosen-name'));
  await visit.changes('focus', () => page.mouse.click(x, y, {count: 2}));
  await page.mouse.click(x, y, {button: 'right'});
  await page.waitForSelector('#menu:not([hidden])', {timeout: kPatience});
  await visit.picture('desk_menu');
  assert(await page.evaluate(() => new Promise(resolve => {
    document.getElementById('color').addEventListener('click', event => resolve(event.preventDefault() ?? true), {once: true});
    document.querySelector('#menu button:nth-child(3)').click();
  })));
  await visit.changesBy('g');
  await visit.changesBy('#hide-all', 'u', '#redo', 'u');
}

/** Names without room are counted. */
async function names({page}) {
  await page.evaluate(async () => {
    const press = () => document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 't', bubbles: true}));
    const before = splatlas.state();
    splatlas.show({select: '*:surface', camera: {azimuth: 0, elevation: 0, zoom: 1, fit: {structure: 2, zoom: 9}}});
    await splatlas.idle();
    press();
    while (document.getElementById('message').textContent !== 'Names without room: 1') await new Promise(resolve => { setTimeout(resolve, 20); });
    for (let n = 0; n < 3; ++n) press();
    splatlas.show(before);
    await splatlas.idle();
  });
}

/** The large picture, the black screen, and the list of keys. */
async function talk(visit) {
  const {page} = visit;
  const hidden = selector => page.$eval(selector, each => getComputedStyle(each).display === 'none');
  await visit.changesBy('f');
  assert(await hidden('#panel') && await hidden('header button') && !(await hidden('#caption')));
  await visit.picture('desk_large');
  await visit.changesBy('Escape');
  assert(!(await hidden('#panel')));
  await page.keyboard.press('b');
  assert.strictEqual(await page.evaluate(() => document.body.dataset.black), 'true');
  await page.keyboard.press('Escape');
  assert.strictEqual(await page.evaluate(() => document.body.dataset.black), undefined);
  await page.keyboard.press('?');
  assert(!(await hidden('#keys')));
}

/** The state comes back by window.splatlas. */
async function restore(visit) {
  const {page} = visit;
  const before = await page.evaluate(async () => {
    await splatlas.idle();
    return {state: splatlas.state(), picture: document.getElementById('canvas').toDataURL()};
  });
  const after = await page.evaluate(async state => {
    const {count} = splatlas.pictures;
    splatlas.show({select: '*:volume'});
    await splatlas.idle();
    splatlas.show(state);
    await splatlas.idle();
    return {more: splatlas.pictures - count, ms: splatlas.pictures.ms, picture: document.getElementById('canvas').toDataURL()};
  }, before.state);
  assert.strictEqual(after.picture, before.picture);
  assert(after.more >= 2 && after.ms > 0, `${after.more} pictures, ${after.ms} ms`);
}

/** Every button of the page lies on the screen. */
async function buttonsAreInside(visit, sizes) {
  for (const [width, height] of sizes) {
    await visit.page.setViewport({...visit.viewport, width, height});
    await visit.hasNoOverflow();
    const outside = await visit.page.$$eval('header button, #views button, #lesson button, #tabs button, #inspector button',
      buttons => buttons.filter(button => button.checkVisibility()).filter(button => {
        const {left, top, right, bottom} = button.getBoundingClientRect();
        return left < 0 || top < 0 || right > innerWidth + 1e-3 || bottom > innerHeight + 1e-3;
      }).map(button => button.id || button.textContent));
    assert.deepStrictEqual(outside, [], `${width} x ${height}`);
  }
  await visit.page.setViewport(visit.viewport);
}

/** The colours, text sizes and tabs of the panel. */
async function display(visit) {
  const {page} = visit;
  await page.click('#tab-display');
  await page.select('#theme', 'dark');
  await visit.picture('desk_dark');
  await page.select('#theme', 'contrast');
  await visit.changes('text size', () => page.select('#text-size', '1.25'));
  await visit.picture('desk_contrast');
  await page.select('#theme', 'light');
  await visit.changes('text size', () => page.select('#text-size', '1'));
  await visit.changesBy('#perspective');
  assert(await page.$eval('#scale-bar', bar => bar.hidden));
  await visit.picture('desk_perspective');
  assert.deepStrictEqual(await page.evaluate(() => {
    const name = document.querySelector('h1').appendChild(nameElement('the Opercularis'));
    const [{content}, {innerHTML, textContent}] = [getComputedStyle(name.querySelector('i'), '::before'), name];
    name.remove();
    return [innerHTML, textContent, content];
  }), ['the Oper<i></i>cu<i></i>la<i></i>ris', 'the Opercularis', '"\u00ad"']);
  await page.click('#tab-about');
  await visit.picture('desk_about');
  await visit.hasNoOverflow();
  await page.pdf({path: path.join(folder, 'print.pdf'), format: 'A4', printBackground: true});
}

/** The third scene asks, has cuts, and answers at the next key. */
async function ask(visit) {
  const {page} = visit;
  await visit.changesBy('n');
  assert.strictEqual(await visit.text('#caption'), 'Which <b>ball</b> is it?');
  await visit.picture('desk_question');
  await page.keyboard.press('n');
  assert.strictEqual(await visit.text('#caption'), 'The <b>first</b> one.');
}

/** A click in a slice names what is there and cuts the picture; the wheel moves the cut. */
async function slices(visit) {
  const {page} = visit;
  await page.click('#tab-cutting');
  const slice = await page.waitForSelector('#slices canvas:last-child[data-index]', {timeout: kPatience});
  await page.click('#no-cuts');
  await visit.changes('cut', () => slice.click());
  assert.notStrictEqual(await visit.text('#picked'), '');
  const [cut] = await page.evaluate(() => window.splatlas.state().cuts);
  assert.deepStrictEqual(cut.normal, [0, 0, 1]);
  await slice.hover();  // Firefox scrolls where the mouse has moved to
  await visit.changes('scroll', () => page.mouse.wheel({deltaY: 100}));
  assert.ok((await page.evaluate(() => window.splatlas.state().cuts))[0].offset > cut.offset);
  await visit.picture('desk_slices');
}

/** Names the structure that is asked for, looks for one, and has the picture of before at the end. */
async function quiz(visit) {
  const {page} = visit;
  const shown = () => page.evaluate(() => window.splatlas.state().select);
  const task = start => page.waitForFunction(
    text => document.getElementById('quiz-task').textContent.startsWith(text), {timeout: kPatience}, start);
  const before = await shown();
  await page.click('#tab-quiz');
  await visit.changesBy('#quiz-name');
  await visit.picture('desk_quiz');
  const asked = (await shown()).match(/^"([^"]*)"/)[1];
  const names = await page.$$eval('#quiz-names button', buttons => buttons.map(button => button.textContent));
  assert.ok(names.includes(asked) && new Set(names).size === names.length, names.join());
  await page.click(`#quiz-names button:nth-child(${names.indexOf(asked) + 1})`);
  await task(`Right: ${asked}.`);
  await visit.changesBy('#quiz-find');
  await task('Click: ');
  await page.mouse.click(...await middleOf(visit));
  await page.waitForFunction(() => document.getElementById('quiz-score').textContent.endsWith('of 2 right'), {timeout: kPatience});
  await page.click('#quiz-end');
  await page.evaluate(() => window.splatlas.idle());
  assert.strictEqual(await shown(), before);
}

/** A scene is recorded, and shows what was on the screen; the file has all that a lesson needs. */
async function record(visit) {
  const {page} = visit;
  const idle = () => page.evaluate(() => splatlas.idle());
  await page.click('#tab-recording');
  await visit.changesBy('+');
  await page.click('#record');
  await page.waitForFunction(() => document.activeElement.id === 'scene-name', {timeout: kPatience});
  await page.type('#scene-name', 'Recorded');
  await page.type('#scene-question', 'Which?');
  await page.type('#scene-caption', 'One\n"Two"');
  await page.type('#scene-labels', 'Sphere_2');
  await idle();
  const screen = await page.evaluate(textOfCanvas);
  await visit.picture('desk_lesson');
  for (const move of ['#earlier', '#later']) await page.click(move);
  assert.strictEqual(await page.$eval('#undo', button => button.disabled), false);
  await page.click('#tab-structures');
  await visit.changesBy('p');
  await visit.changes('scene', async () => {
    await page.keyboard.press('n');
    await page.keyboard.press('n');  // the answer, and the next
  });
  await idle();
  assert.strictEqual(await page.evaluate(textOfCanvas), screen);
  await page.evaluate(() => new Promise(resolve => { setTimeout(resolve, 300); }));
  assert(await page.$eval('#names', names => names.hidden));  // they are the answer
  await page.keyboard.press('n');
  await page.waitForSelector('#names:not([hidden])', {timeout: kPatience});
  await visit.picture('desk_names');
  const saved = await page.evaluate(async () => {
    const make = URL.createObjectURL;
    const blob = new Promise(resolve => { URL.createObjectURL = each => resolve(each) ?? make(each); });
    HTMLAnchorElement.prototype.click = () => {};
    document.getElementById('save-lesson').click();
    return (await blob).text();
  });
  fs.writeFileSync(path.join(folder, 'lesson.toml'), saved);
  assert.strictEqual(saved.match(/\[\[scene\]\]/g).length, 4);
  assert.match(saved, /name = "Recorded"\nselect = "\*:volume"\nquestion = "Which\?"\ncaption = "One\\n\\"Two\\""\n/);
  assert.match(saved, /cuts = \["0,-1,0,-15","0.5,0,0.5,20"\]\nlabels = \["Sphere_2"\]\n$/);
  await page.click('#tab-recording');
  await saveIntoAtlas(visit, 4, 'Replace the lesson in native.atlas?');
  const asked = page.evaluate(() => new Promise(resolve => { window.confirm = text => { resolve(text); return true; }; }));
  await visit.changesBy('#remove');
  assert.strictEqual(await asked, 'Remove the scene "Recorded"?');
  await saveIntoAtlas(visit, 3);
  await page.click('#tab-structures');
}

/** The lesson goes into the atlas that the player serves, here with a question. Exported pages only write files. */
async function saveIntoAtlas(visit, scenes, question) {
  assert.strictEqual(await visit.page.$eval('#save-atlas', button => button.hidden), !visit.atlas);
  if (!visit.atlas) return;
  visit.agrees = question;
  await visit.page.evaluate(() => { document.getElementById('message').textContent = ''; });
  await visit.page.click('#save-atlas');
  await visit.page.waitForFunction(() => document.getElementById('message').textContent ===
    'The lesson is saved in native.atlas.', {timeout: kPatience});
  const {scenes: stored} = JSON.parse(execFileSync(player, ['info', visit.atlas, '--json']));
  assert.strictEqual(stored.length, scenes);
  if (question) return;
  fs.utimesSync(visit.atlas, 1, 1);
  await visit.page.click('#save-atlas');
  await visit.page.waitForFunction(() => document.getElementById('message').textContent.startsWith(
    'The lesson is not saved: native.atlas has changed on the disk'), {timeout: kPatience});
}

/** With texts of 300 %, every control can be scrolled to, whole or above all of the window, and nothing covers it. */
async function largeText(visit) {
  for (const tab of ['structures', 'cutting', 'recording', 'quiz', 'display']) {
    await visit.page.select('#text-size', '3');
    await visit.page.$eval(`#tab-${tab}`, button => button.click());
    await visit.page.evaluate(() => new Promise(resolve => { setTimeout(resolve, 300); }));
    await visit.hasNoOverflow();
    const faults = await visit.page.$$eval('button, input, select, textarea', all => all.filter(each => {
      if (!each.checkVisibility()) return false;
      each.scrollIntoView({block: 'center'});
      const {left, top, right, bottom} = each.getBoundingClientRect();
      const found = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
      return left < 0 || right > innerWidth || top < 0 || bottom > innerHeight || !(found === each || each.contains(found));
    }).map(each => each.id || each.textContent || each.ariaLabel));
    assert.deepStrictEqual(faults, [], tab);
  }
  await visit.picture(`text_${visit.viewport.width}`);
  await visit.page.select('#text-size', '1');
}

async function onDesk(visit, url) {
  const {page} = visit;
  await visit.open(url);
  await visit.picture('desk');
  assert.strictEqual(await page.evaluate(() => crossOriginIsolated), false);
  await visit.changesBy('n');
  assert.match(await visit.text('#place'), /^2 of/);
  await visit.picture('desk_scene');
  for (const part of [ask, quiz, record]) await part(visit);
  await visit.changesBy('p');
  await visit.changes('drag', () => drag(visit));
  await visit.changes('wheel', () => page.mouse.wheel({deltaY: -200}));
  for (const part of [search, edit, point, restore, names, slices]) await part(visit);
  await buttonsAreInside(visit, [[1280, 720], [1920, 1080], [3840, 2160]]);
  await goBack(visit);
  await page.click('#tab-cutting');
  await visit.changes('cut', () => page.select('#cuts select', 'high'));
  for (const part of [display, largeText, talk]) await part(visit);
  return page.url();
}

async function onPhone(visit, url) {
  await visit.open(url);
  await visit.picture('phone');
  await visit.hasNoOverflow();
  await visit.changes('scene', () => visit.page.tap('#next'));
  await visit.picture('phone_scene');
  await buttonsAreInside(visit, [[390, 844]]);
  await visit.changes('view', () => visit.page.tap('#views button:nth-child(5)'));
  const {height} = await (await visit.page.$('#canvas')).boundingBox();
  assert.ok(height >= 0.6 * kPhone.height, `picture of ${height} pixels`);
  if (!kIsFirefox) {  // it has no touch here
    await visit.changesBy('f');
    assert.strictEqual(await visit.page.$$eval('#strip canvas', all => all.filter(each => each.checkVisibility()).length), 2);
    await visit.picture('phone_large');
    await visit.page.setViewport({...kPhone, width: 300});
    assert(await visit.page.$$eval('#strip li', all => all.every(each => each.offsetWidth >= each.firstChild.offsetWidth)));
    await visit.page.setViewport(kPhone);
    await visit.changesBy('Escape');
  }
  await visit.page.tap('#tab-cutting');
  await visit.picture('phone_cuts');
  await visit.page.tap('#tab-cutting');
  await visit.page.waitForSelector('#cutting', {hidden: true, timeout: kPatience});
  await largeText(visit);
}

/** Opens a link of the page: the same state. Bad links give a message, and the opening picture or what was there. */
async function byLink(visit, link) {
  const {page} = visit;
  await visit.open(link);
  assert.strictEqual(page.url(), link);
  for (const bad of ['select=no+such+thing&view=1,2,x', 'select=*:surface&view=0,0,1,1e300,0,0',
    'select=*:surface&cuts=1e300,0,0,1']) {
    await page.goto('about:blank');
    await visit.open(`${link.split('#')[0]}#${bad}`);
    assert.notStrictEqual(await visit.text('#message'), '', bad);
    assert.strictEqual(await page.$eval('#undo', button => button.disabled), true, bad);
  }
  for (const odd of ['length', 'at', '1.5', '-1', '99']) {
    await page.goto('about:blank');
    await visit.open(`${link.split('#')[0]}#select=*:surface&scene=${odd}`);
    assert.strictEqual(await visit.text('#message'), '', odd);
  }
}

/** Steps back give what was there: after scenes in a hurry, after hiding, and after a text that is wrong. */
async function goBack(visit) {
  const {page} = visit;
  const picture = () => page.evaluate(textOfCanvas);
  await page.keyboard.press('p');
  await visit.changesBy('p');
  const scene = await picture();
  await visit.changes('scene', async () => {
    await page.keyboard.press('n');
    await page.keyboard.press('n');
  });
  await page.keyboard.press('u');
  await visit.changesBy('u');
  assert.strictEqual(await picture(), scene);

  await page.click('#tab-structures');
  await visit.changesBy('#tree .eye');
  assert.match(await visit.text('#place'), /changed/);
  await visit.changesBy('#tree .eye');
  assert.strictEqual(await picture(), scene);

  await page.click('#tab-display');
  await page.$eval('#selection-text', box => { box.value = 'no such thing'; });
  await page.click('#apply-text');
  await page.waitForFunction(() => !document.getElementById('message').hidden, {timeout: kPatience});
  assert.strictEqual(await page.$eval('#selection-text', box => box.value), 'no such thing');
  await page.evaluate(() => window.splatlas.idle());
  assert.strictEqual(await picture(), scene);
}

/** A page whose atlas is cut short tells so, and keeps its opening picture. */
async function onDamage(visit) {
  const html = fs.readFileSync(file, 'utf8');
  const tag = 'id="atlas" data-url="">';
  const begin = html.indexOf(tag) + tag.length;
  const half = 4 * Math.floor((html.indexOf('</script>', begin) - begin) / 8);
  const damaged = path.resolve(folder, 'damaged.html');
  fs.writeFileSync(damaged, html.slice(0, begin + half) + html.slice(html.indexOf('</script>', begin)));
  await visit.page.setViewport(visit.viewport);
  await visit.page.goto(pathToFileURL(damaged).href);
  await visit.page.waitForFunction(() => document.body.dataset.stopped === 'true', {timeout: kPatience});
  assert.match(await visit.text('#message'), /atlas/);
  assert.strictEqual(await visit.page.$eval('#opening-picture', image => image.hidden), false);
  await visit.picture('damaged');
}

/** Plays the site from a server. */
async function onServer(newPage, ranges) {
  const server = await serve(path.join(folder, 'site'), {ranges});
  const visit = new Visit(await newPage(), kDesk, server.url);
  await visit.open(server.url);
  await visit.changesBy('n');
  await visit.changesBy('#show-all');
  await visit.picture(ranges ? 'site' : 'site_whole');
  assert.deepStrictEqual(visit.messages, []);
  await visit.page.close();
  server.close();
}

/** A click while pieces are under way waits for them, and the new scene stays. */
async function onSlowServer(newPage) {
  const server = await serve(path.join(folder, 'site'), {ranges: true, delay: 300});
  const visit = new Visit(await newPage(), kDesk, server.url);
  const {page} = visit;
  await visit.open(server.url);
  const [x, y] = await middleOf(visit);
  await visit.changes('scene', async () => {
    await page.keyboard.press('n');
    await page.mouse.click(x, y);
  });
  await page.waitForFunction(() => document.querySelector('#picked strong'), {timeout: kPatience});
  assert.match(await visit.text('#place'), /^2 of/);
  assert.doesNotMatch(await visit.text('#message'), /not loaded/);
  assert.deepStrictEqual(visit.messages, []);
  await page.close();
  server.close();
}

/** The page of the program that has the engine, which ends with its page. */
async function onNative(browser) {
  const copy = path.join(folder, 'native.atlas');
  fs.copyFileSync(atlas, copy);
  const program = spawn(player, [copy, '--no-browser'], {stdio: ['ignore', 'pipe', 'inherit']});
  const ended = once(program, 'exit');
  const [line] = await once(program.stdout, 'data');
  const [address] = String(line).split('\n');
  const site = new URL('/', address).href;
  const context = await browser.createBrowserContext();
  let link = '';
  for (const [viewport, run] of [[kDesk, async visit => { link = await onDesk(visit, address); }],
    [kPhone, visit => onPhone(visit, site)], [kDesk, visit => byLink(visit, link)]]) {
    const visit = Object.assign(new Visit(await context.newPage(), viewport, site), {atlas: copy});
    await run(visit);
    assert.deepStrictEqual(visit.messages, []);
    assert(!visit.page.url().includes('token'));
    await visit.page.close();
  }
  const [status] = await ended;
  assert.strictEqual(status, 0);
}

async function main() {
  const library = puppeteer();
  if (!library || !fs.existsSync(kBrowser) || !fs.existsSync(file)) return 77;
  const browser = await library.launch(kIsFirefox ? {browser: 'firefox', executablePath: kBrowser} :
    {executablePath: kBrowser, args: ['--no-sandbox', '--no-first-run']});
  try {
    const newPage = async () => (await browser.createBrowserContext()).newPage();
    const url = pathToFileURL(path.resolve(file)).href;
    let link = '';
    for (const [viewport, run] of [[kDesk, async (visit, at) => { link = await onDesk(visit, at); }],
      [kPhone, onPhone], [kDesk, visit => byLink(visit, link)], [kDesk, onDamage]]) {
      const visit = new Visit(await newPage(), viewport);
      await run(visit, url);
      assert.deepStrictEqual(visit.messages, []);
      await visit.page.close();
    }
    await onServer(newPage, true);
    await onServer(newPage, false);
    await onSlowServer(newPage);
    await onNative(browser);
  } finally {
    await browser.close();
  }
  return 0;
}

main().then(
  status => process.exit(status),
  error => {
    console.error(error);
    process.exit(1);
  });
