// node browse.js PAGE FOLDER: drives a page of `splatlas-player export --html` in Chromium, from file://.
//
// Loads it, drags, searches, chooses, picks, cuts, undoes, and steps through the scenes, at the sizes of a desk and of
// a phone. Every console message is a failure. Writes screenshots into FOLDER. The page must have scenes.
// Exit status 77: puppeteer-core or Chromium is missing (`npm install puppeteer-core` in FOLDER, Debian's chromium).
'use strict';
const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');
const {createRequire} = require('node:module');
const {pathToFileURL} = require('node:url');

const kChromium = process.env.SPLATLAS_CHROMIUM ?? '/usr/bin/chromium';
const kDesk = {width: 1280, height: 800};
const kPhone = {width: 390, height: 844, isMobile: true, hasTouch: true};
const kPatience = 60000;  // ms

const [file, folder] = process.argv.slice(2);

function puppeteer() {
  try {
    return createRequire(path.resolve(folder, 'x.js'))('puppeteer-core');
  } catch {
    return null;
  }
}

/** The canvas as a number: a hash of its pixels. */
const hashOfCanvas = () => {
  const canvas = document.getElementById('canvas');
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let hash = 0;
  for (let n = 0; n < data.length; ++n) hash = (Math.imul(hash, 31) + data[n]) | 0;
  return hash;
};

class Visit {
  constructor(page, viewport) {
    this.page = page;
    this.viewport = viewport;
    this.messages = [];
    page.on('console', message => this.messages.push(message.text()));
    page.on('pageerror', error => this.messages.push(String(error)));
    page.on('requestfailed', request => this.messages.push(`request: ${request.url()}`));
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
    const before = await this.page.evaluate(hashOfCanvas);
    await this.page.evaluate(() => { document.body.dataset.quality = ''; });
    await act();
    await this.refined();
    assert.notStrictEqual(await this.page.evaluate(hashOfCanvas), before, `${what}: the picture is the same`);
  }

  async text(selector) {
    return this.page.$eval(selector, each => each.textContent);
  }

  async picture(name) {
    await this.page.screenshot({path: path.join(folder, `${name}.png`)});
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

async function drag(visit) {
  const {mouse} = visit.page;
  const [x, y] = await middleOf(visit);
  await mouse.move(x, y);
  await mouse.down();
  for (let n = 1; n <= 20; ++n) await mouse.move(x + 5 * n, y + n);
  await mouse.up();
}

async function search(visit) {
  const {page} = visit;
  await page.click('#search');
  await page.type('#search', 'thalamus');
  const rows = await page.$$eval('#tree [role=treeitem]', items => items.map(item => item.textContent));
  assert(rows.length > 0 && rows.every(row => /thalamus/i.test(row)), `found: ${rows}`);
  await visit.picture('search');
  await page.click('#tree [role=treeitem]');
  assert.match(await visit.text('#chosen-name'), /thalamus/i);
  await page.$eval('#search', input => {
    input.value = '';
    input.dispatchEvent(new Event('input'));
  });
}

async function onDesk(visit, url) {
  const {page} = visit;
  await visit.open(url);
  await visit.picture('desk');
  assert.strictEqual(await page.evaluate(() => crossOriginIsolated), false);
  await visit.changes('scene', () => page.keyboard.press('n'));
  assert.match(await visit.text('#place'), /^2 of/);
  await visit.picture('desk_scene');
  await visit.changes('drag', () => drag(visit));
  await visit.changes('wheel', () => page.mouse.wheel({deltaY: -200}));
  await search(visit);
  await visit.changes('mode', () => page.click('[data-mode-button=off]'));
  await visit.changes('isolate', () => page.click('#isolate'));
  await visit.changes('undo', () => page.click('#undo'));
  await visit.changes('undo', () => page.click('#undo'));
  const [x, y] = await middleOf(visit);
  await page.mouse.click(x, y);
  await page.waitForSelector('#picked strong', {timeout: kPatience});
  await visit.picture('desk_pick');
  await page.click('#tab-cutting');
  await visit.changes('cut', () => page.select('#cuts select', 'high'));
  await visit.picture('desk_cut');
  await page.click('#tab-display');
  await page.select('#theme', 'dark');
  await visit.picture('desk_dark');
  await page.select('#theme', 'contrast');
  await page.select('#text-size', '1.25');
  await visit.picture('desk_contrast');
  await page.select('#text-size', '1');
  await page.select('#theme', 'light');
  await page.click('#tab-about');
  await visit.picture('desk_about');
  await visit.hasNoOverflow();
  await page.pdf({path: path.join(folder, 'print.pdf'), format: 'A4', printBackground: true});
  return page.url();
}

async function onPhone(visit, url) {
  await visit.open(url);
  await visit.picture('phone');
  await visit.hasNoOverflow();
  await visit.changes('scene', () => visit.page.tap('#next'));
  await visit.picture('phone_scene');
  await visit.changes('view', () => visit.page.tap('#views button:nth-child(5)'));
  await visit.page.tap('#tab-cutting');
  await visit.picture('phone_cuts');
}

/** Opens a link of the page: the same state. */
async function byLink(visit, link) {
  await visit.open(link);
  assert.strictEqual(visit.page.url(), link);
  await visit.open(`${link.split('#')[0]}#select=no+such+thing&view=1,2,x`);
  assert.notStrictEqual(await visit.text('#message'), '');
}

async function main() {
  const library = puppeteer();
  if (!library || !fs.existsSync(kChromium)) return 77;
  const browser = await library.launch({executablePath: kChromium, args: ['--no-sandbox', '--no-first-run']});
  try {
    const url = pathToFileURL(path.resolve(file)).href;
    let link = '';
    for (const [viewport, run] of [[kDesk, async (visit, at) => { link = await onDesk(visit, at); }],
      [kPhone, onPhone], [kDesk, visit => byLink(visit, link)]]) {
      const visit = new Visit(await (await browser.createBrowserContext()).newPage(), viewport);
      await run(visit, url);
      assert.deepStrictEqual(visit.messages, []);
      await visit.page.close();
    }
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
