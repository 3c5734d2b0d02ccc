// node check_page.js PLAYER MODULE ATLASES FOLDER: pages of `splatlas-player export --html`, written into FOLDER.
//
// A page has a content security policy with the right hashes, decodes to the bytes of atlas and module, and refers to
// nothing outside. Markup in texts of an atlas is inert. Wrong usage and damage end with a message and no file.
// Without MODULE, the program must tell what is missing; exit status 77.
'use strict';
const assert = require('node:assert');
const {spawnSync} = require('node:child_process');
const crypto = require('node:crypto');
const fs = require('node:fs');
const path = require('node:path');
const zlib = require('node:zlib');

const [player, wasm, atlases, folder] = process.argv.slice(2);
const lesson = path.join(atlases, 'lesson.atlas');

/** Exports a page. @returns {{status: number, message: string, html: ?string}} */
function exported(name, atlas, ...options) {
  const file = path.join(folder, name);
  fs.rmSync(file, {force: true});
  const {status, stderr} = spawnSync(player, ['export', atlas, '--html', file, ...options], {encoding: 'utf8'});
  return {status, message: stderr, html: fs.existsSync(file) ? fs.readFileSync(file, 'utf8') : null};
}

/** The text of the page's only element that starts with this tag. */
function textOf(html, tag, end) {
  const begin = html.indexOf(tag) + tag.length;
  assert(begin >= tag.length && html.indexOf(tag, begin) < 0, `${tag} must be there once`);
  return html.slice(begin, html.indexOf(end, begin));
}

const dataOf = (html, id, url = '') =>
  textOf(html, `<script type="text/plain" id="${id}"${id === 'atlas' ? ` data-url="${url}"` : ''}>`, '</script>');

function checkPolicy(html) {
  const policy = textOf(html, '<meta http-equiv="Content-Security-Policy" content="', '">');
  const sourceOf = text => `'sha256-${crypto.createHash('sha256').update(text).digest('base64')}'`;
  const script = sourceOf(textOf(html, '<script>', '</script>'));
  const style = sourceOf(textOf(html, '<style>', '</style>'));
  assert.strictEqual(policy, `default-src 'none'; script-src ${script} 'wasm-unsafe-eval'; worker-src blob:; ` +
    `style-src ${style}; img-src data:; base-uri 'none'; form-action 'none'`);
  assert(html.indexOf('Content-Security-Policy') < html.indexOf('<style>'));
}

function checkContents(html) {
  assert(Buffer.from(dataOf(html, 'atlas'), 'base64').equals(fs.readFileSync(lesson)), 'another atlas');
  const unpacked = zlib.gunzipSync(Buffer.from(dataOf(html, 'module'), 'base64'));
  assert(unpacked.equals(fs.readFileSync(wasm)), 'another module');
  const picture = textOf(html, 'src="data:image/webp;base64,', '"');
  assert.strictEqual(Buffer.from(picture, 'base64').subarray(8, 12).toString(), 'WEBP');
}

/** The page without its data and scripts has the elements of the template alone, and no text of the atlas as markup. */
function checkMarkup(html) {
  const blocks = html.match(/<script[^>]*>/g);
  assert.strictEqual(blocks.length, 5, `${blocks}`);
  const markup = html.replace(/(<script[^>]*>)[^]*?<\/script>/g, '$1').replace(/<style>[^]*?<\/style>/, '');
  for (const bad of ['<i>', '<b>', '<svg', '<iframe', 'src=x', '{{']) {
    const isShown = markup.replaceAll('{{script}}', '').replaceAll('{{atlas}}', '').includes(bad);
    assert(!isShown, `${bad} is in the page`);
  }
  assert.strictEqual(markup.match(/<img/g).length, 1);
  assert(markup.includes('&lt;/title&gt;&lt;script&gt;alert(3)&lt;/script&gt; &amp; &quot;{{atlas}}&quot;'));
  assert(!/\s(src|href)="(?!data:|#)/.test(markup), 'a reference to another file');
}

function checkOpening() {
  const opening = (...options) => {
    const {status, message, html} = exported('opening.html', lesson, ...options);
    assert.strictEqual(status, 0, message);
    return JSON.parse(textOf(html, '<script type="application/json" id="opening">', '</script>'));
  };
  assert.strictEqual(opening().scene, 0);
  const third = opening('--scene', 'third');
  assert.strictEqual(third.select, '*:volume');
  assert.deepStrictEqual(third.camera.center, opening('--select', 'Sphere_2:volume').camera.center);
  const {select, scene, camera} = opening('--select', 'Sphere_2:surface', '--view', 'left');
  assert.deepStrictEqual([select, scene, camera.azimuth, camera.elevation], ['Sphere_2:surface', null, 90, 0]);
}

/** Sites of one atlas and of two: pages beside the atlases, which they alone fetch. */
function checkSites() {
  const atSite = (name, ...args) => {
    const {status, stderr} = spawnSync(player, ['export', ...args, '--site', path.join(folder, name)], {encoding: 'utf8'});
    return {status, message: stderr};
  };
  const read = file => fs.readFileSync(path.join(folder, file), 'utf8');
  for (const name of ['site', 'library', 'none']) fs.rmSync(path.join(folder, name), {recursive: true, force: true});
  const phantom = path.join(folder, 'Two balls.atlas');
  fs.copyFileSync(path.join(atlases, 'phantom.atlas'), phantom);
  assert.deepStrictEqual(atSite('site', lesson), {status: 0, message: ''});
  assert.deepStrictEqual(fs.readdirSync(path.join(folder, 'site')).sort(), ['index.html', 'lesson.atlas']);
  assert.strictEqual(dataOf(read('site/index.html'), 'atlas', 'lesson.atlas'), '');
  assert(read('site/index.html').includes("connect-src 'self'; "));
  assert(fs.readFileSync(path.join(folder, 'site', 'lesson.atlas')).equals(fs.readFileSync(lesson)));

  assert.deepStrictEqual(atSite('library', lesson, phantom), {status: 0, message: ''});
  assert.deepStrictEqual(fs.readdirSync(path.join(folder, 'library')).sort(),
    ['Two balls.atlas', 'Two balls.html', 'index.html', 'lesson.atlas', 'lesson.html']);
  const catalogue = read('library/index.html');
  assert.deepStrictEqual(catalogue.match(/href="[^"]*html"/g), ['href="lesson.html"', 'href="Two%20balls.html"']);
  assert(catalogue.includes('&lt;/title&gt;&lt;script&gt;alert(3)&lt;/script&gt;') && !catalogue.includes('<script'));
  assert.strictEqual(dataOf(read('library/Two balls.html'), 'atlas', 'Two%20balls.atlas'), '');

  for (const [status, words, ...args] of [[1, /library/, lesson, phantom], [2, /"lesson"/, lesson, lesson],
    [2, /--scene/, lesson, phantom, '--scene', 'Second']]) {
    const {status: got, message} = atSite(status === 1 ? 'library' : 'none', ...args);
    assert.strictEqual(got, status, message);
    assert.match(message, words);
  }
  assert(!fs.existsSync(path.join(folder, 'none')));
  assert.strictEqual(fs.readdirSync(path.join(folder, 'library')).length, 5);
}

function checkErrors() {
  const refuses = (status, words, ...args) => {
    const result = exported('bad.html', ...args);
    assert.strictEqual(result.status, status, result.message);
    assert.match(result.message, words);
    assert.strictEqual(result.html, null);
  };
  const damaged = path.join(folder, 'damaged.atlas');
  const bytes = fs.readFileSync(lesson);
  bytes[bytes.length >> 1] ^= 1;
  fs.writeFileSync(damaged, bytes);
  refuses(3, /damaged\.atlas/, damaged);
  refuses(4, /--scene "Fourth".*"Second"/, lesson, '--scene', 'Fourth');
  refuses(4, /Sphere_3/, lesson, '--select', 'Sphere_3');
  refuses(2, /selection/, lesson, '--select', 'Sphere_1:solid');
  refuses(2, /--view/, lesson, '--view', 'top');
  refuses(2, /--scene/, lesson, '--scene', 'Third', '--select', '*');
  const copy = path.join(folder, 'copy.atlas');
  fs.copyFileSync(lesson, copy);
  const {status} = spawnSync(player, ['export', copy, '--html', copy]);
  assert.strictEqual(status, 2);
  assert(fs.readFileSync(copy).equals(fs.readFileSync(lesson)), 'the input has changed');
}

function main() {
  fs.mkdirSync(folder, {recursive: true});
  const {status, message, html} = exported('lesson.html', lesson);
  if (wasm === '') {
    assert.strictEqual(status, 1);
    assert.match(message, /without splatlas\.wasm.*cmake --preset web.*docs\/web\.md/);
    return 77;
  }
  assert.strictEqual(status, 0, message);
  checkPolicy(html);
  checkContents(html);
  checkMarkup(html);
  checkOpening();
  checkSites();
  checkErrors();
  return 0;
}

process.exit(main());
