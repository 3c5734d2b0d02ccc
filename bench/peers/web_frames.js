// node web_frames.js MODULE ATLAS FRAMES: draws frames by the WebAssembly module, twice. Prints the times of the
// second turn as JSON: [scene][frame] of [wall, CPU] in ms. FRAMES is a JSON file; see web_bench.cpp.
'use strict';
const fs = require('node:fs');
require('../../player/web/splatlas.js');

async function main([module, atlas, frames]) {
  const splatlas = await Splatlas.load(fs.readFileSync(module));
  splatlas.open(fs.readFileSync(atlas));
  const {size, scenes} = JSON.parse(fs.readFileSync(frames));
  const times = scenes.map(({select, quality, cameras}) => {
    splatlas.select(select);
    const draw = camera => {
      splatlas.view(camera);
      const [cpu, begin] = [process.cpuUsage(), performance.now()];
      splatlas.render(...size, quality);
      const [wall, {user, system}] = [performance.now() - begin, process.cpuUsage(cpu)];
      return [wall, (user + system) / 1000];
    };
    cameras.forEach(draw);
    return cameras.map(draw);
  });
  console.log(JSON.stringify(times));
}

main(process.argv.slice(2));
