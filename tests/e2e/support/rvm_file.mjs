// SPDX-License-Identifier: GPL-3.0-or-later
// An RVM model as a tree of groups, which a test can rename, move, copy, remove and write again.

const HEADER = 24;

function texts(body, at, count) {
    const found = [];
    for (let i = 0; i < count; i++) {
        const bytes = 4 * body.readUInt32BE(at);
        found.push(body.subarray(at + 4, at + 4 + bytes).toString('latin1').replace(/\0.*$/s, ''));
        at += 4 + bytes;
    }
    return { found, at };
}

// Splits an RVM file. Returns { before: chunks before the first group, groups, after: chunks after the last one }. A chunk is
// [id, body]; a group is { name, rest, items }, and its items are groups and chunks.
export function readRvm(bytes) {
    const root = { items: [] }, stack = [root], after = [];
    for (let at = 0; at < bytes.length;) {
        const id = [0, 1, 2, 3].map((i) => String.fromCharCode(bytes[at + 4 * i + 3])).join('');
        if (id === 'END:') {
            after.push(bytes.subarray(at));
            break;
        }
        const next = bytes.readUInt32BE(at + 16), body = bytes.subarray(at + HEADER, next), top = stack.at(-1);
        if (id === 'CNTB') {
            const { found: [name], at: end } = texts(body, 4, 1), group = { name, rest: body.subarray(end), items: [] };
            top.items.push(group);
            stack.push(group);
        } else if (id === 'CNTE') {
            stack.pop();
        } else {
            top.items.push([id, body]);
        }
        at = next;
    }
    return { items: root.items, after };
}

export function writeRvm({ items, after }) {
    const parts = [];
    let at = 0;
    const chunk = (id, ...bodies) => {
        const head = Buffer.alloc(HEADER);
        [...id].forEach((letter, i) => { head[4 * i + 3] = letter.charCodeAt(0); });
        at += HEADER + bodies.reduce((sum, body) => sum + body.length, 0);
        head.writeUInt32BE(at, 16);
        head.writeUInt32BE(1, 20);
        parts.push(head, ...bodies);
    };
    const word = (value) => {
        const out = Buffer.alloc(4);
        out.writeUInt32BE(value);
        return out;
    };
    const write = (item) => {
        if (Array.isArray(item)) {
            chunk(...item);
            return;
        }
        const name = Buffer.from(item.name, 'latin1'), words = Math.ceil((name.length + 1) / 4), padded = Buffer.alloc(4 * words);
        name.copy(padded);
        chunk('CNTB', word(2), word(words), padded, item.rest);
        item.items.forEach(write);
        chunk('CNTE', word(2));
    };
    items.forEach(write);
    return Buffer.concat([...parts, ...after]);
}

const isGroup = (item) => !Array.isArray(item);

// Returns the first group with this name, and its parent group.
export function findGroup(above, name) {
    for (const item of above.items.filter(isGroup)) {
        const found = item.name === name ? { group: item, above } : findGroup(item, name);
        if (found)
            return found;
    }
    return undefined;
}

// Returns a copy of a group and its descendants, moved by `by` metres, with changed names.
export function copyGroup(group, by = [0, 0, 0], rename = (name) => name) {
    return { name: rename(group.name), rest: group.rest, items: group.items.map((item) => {
        if (isGroup(item))
            return copyGroup(item, by, rename);
        const [id, body] = item;
        if (!['PRIM', 'OBST', 'INSU'].includes(id))
            return item;
        const moved = Buffer.from(body);
        by.forEach((distance, axis) => moved.writeFloatBE(body.readFloatBE(8 + 4 * (9 + axis)) + distance, 8 + 4 * (9 + axis)));
        return [id, moved];
    }) };
}
