// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an RVM model that contains many copies of a real plant side by side, each with names of its own. usage:
// repeat_plant.mjs MODEL.rvm COPIES OUT.rvm. If MODEL.att exists, its attributes are copied to OUT.att as well.
import { closeSync, existsSync, openSync, readFileSync, writeFileSync, writeSync } from 'node:fs';
import { copyGroup, readRvm, writeRvm } from '../e2e/support/rvm_file.mjs';

const [model, copies, out] = process.argv.slice(2), rvm = readRvm(readFileSync(model)), count = Number(copies);
const side = Math.ceil(Math.sqrt(count)), groups = rvm.items.filter((item) => !Array.isArray(item));
const renamed = (i) => (name) => name.replaceAll('/', `/${100 + i}`);
const items = rvm.items.filter((item) => Array.isArray(item));
for (let i = 0; i < count; i++)
    for (const group of groups)
        items.push(copyGroup(group, [25 * (i % side), 25 * Math.floor(i / side), 0], renamed(i)));
writeFileSync(out, writeRvm({ items, after: rvm.after }));

const attributes = model.replace(/rvm$/, 'att');
if (existsSync(attributes)) {
    const text = readFileSync(attributes, 'latin1'), to = openSync(out.replace(/rvm$/, 'att'), 'w');
    const [head, ...rest] = text.split(/(?<=^END\r?\n)/m), body = rest.join('');
    writeSync(to, Buffer.from(head, 'latin1'));
    for (let i = 0; i < count; i++)
        writeSync(to, Buffer.from(body.replace(/^(\s*(?:NEW |Name:=|Owner:=).*)$/gm, renamed(i)), 'latin1'));
    closeSync(to);
}
