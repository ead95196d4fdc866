// SPDX-License-Identifier: GPL-3.0-or-later
// As much of Flamenco Manager as a job type meets: compiles a job, prints its tasks as JSON.
//   node flamenco_manager.js JOB_TYPE.js '{"settings": {...}}'
const fs = require("fs");
const vm = require("vm");

class Task {
    constructor(name, type) { Object.assign(this, { name, type, commands: [], dependencies: [] }); }
    addCommand(command) { this.commands.push(command); }
    addDependency(task) { this.dependencies.push(task.name); }
}

/** "1-4, 7" in chunks of n: as the manager's own, "1-3" "4,7". */
function frameChunker(range, size) {
    const frames = [];
    for (const part of range.split(",")) {
        const [first, last] = part.trim().split("-").map(Number);
        for (let frame = first; frame <= (last || first); frame++) frames.push(frame);
    }
    const chunks = [];
    for (let at = 0; at < frames.length; at += size) {
        const chunk = frames.slice(at, at + size), ranges = [];
        for (const frame of chunk) {
            const open = ranges[ranges.length - 1];
            if (open && open[1] + 1 === frame) open[1] = frame;
            else ranges.push([frame, frame]);
        }
        chunks.push(ranges.map(([a, b]) => (a === b ? `${a}` : `${a}-${b}`)).join(","));
    }
    return chunks;
}

const [, , file, text] = process.argv;
const author = {
    Task: (name, type) => new Task(name, type),
    Command: (name, parameters) => ({ name, parameters }),
};
const sandbox = { author, frameChunker, print: () => {} };
vm.runInNewContext(fs.readFileSync(file, "utf8") + "\nthis.type = JOB_TYPE; this.compile = compileJob;", sandbox);
const tasks = [];
const job = Object.assign({ addTask: (task) => tasks.push(task) }, JSON.parse(text));
sandbox.compile(job);
console.log(JSON.stringify({ type: sandbox.type, tasks }));
