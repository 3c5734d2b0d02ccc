// A static web server for tests, with or without range requests.
'use strict';
const fs = require('node:fs');
const http = require('node:http');
const path = require('node:path');

const kTypes = {'.html': 'text/html', '.atlas': 'application/octet-stream'};

/** Serves the files of a folder on a free port of this machine. `delay`: ms until an answer.
 * @returns {Promise<{url: string, bytes: Map<string, number>, close: function}>} bytes: sent, by file name */
async function serve(folder, {ranges, delay = 0}) {
  const bytes = new Map();
  const server = http.createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url, 'http://here').pathname.slice(1)) || 'index.html';
    const file = path.join(folder, path.basename(name));
    if (!fs.existsSync(file)) return response.writeHead(404).end();
    const content = fs.readFileSync(file);
    const range = ranges && /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    const [begin, end] = range ? [Number(range[1]), Math.min(Number(range[2]) + 1, content.length)] : [0, content.length];
    const headers = {'Content-Type': kTypes[path.extname(file)] ?? 'application/octet-stream', 'Content-Length': end - begin};
    if (range) headers['Content-Range'] = `bytes ${begin}-${end - 1}/${content.length}`;
    bytes.set(name, (bytes.get(name) ?? 0) + end - begin);
    response.writeHead(range ? 206 : 200, headers);
    return setTimeout(() => response.end(content.subarray(begin, end)), delay);
  });
  await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
  return {url: `http://127.0.0.1:${server.address().port}/`, bytes, close: () => server.close()};
}

module.exports = {serve};
