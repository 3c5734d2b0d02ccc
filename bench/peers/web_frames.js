// node web_frames.js MODULE ATLAS SCENES: draws scenes, lists of states as a JSON file, by the WebAssembly module, twice.
// Prints the times of the second turn as JSON: [scene][state] of [wall, CPU] in ms.
'use strict';
const fs = require('node:fs');
require('../../player/web/splatlas.js');

Splatlas.load(fs.readFileSync(process.argv[2])).then(splatlas => {
  splatlas.open(fs.readFileSync(process.argv[3]));
  const draw = state => {
    const [cpu, begin] = [process.cpuUsage(), performance.now()];
    splatlas.draw(state);
    const [wall, {user, system}] = [performance.now() - begin, process.cpuUsage(cpu)];
    return [wall, (user + system) / 1000];
  };
  const times = JSON.parse(fs.readFileSync(process.argv[4])).map(states => [states.map(draw), states.map(draw)][1]);
  console.log(JSON.stringify(times));
});
