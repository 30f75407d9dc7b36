// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP files for tests.
import { deflateRawSync } from 'node:zlib';
import { crc } from './png_chunks.mjs';

// Returns a ZIP file with these files by name. packed: false stores them uncompressed; flags: flags of each file, 1 for a
// password.
export function zip(files, { packed = true, flags = 0 } = {}) {
    const parts = [], central = [];
    let at = 0;
    for (const [name, content] of Object.entries(files)) {
        const bytes = Buffer.from(content), data = packed ? deflateRawSync(bytes, { level: 9 }) : bytes, title = Buffer.from(name);
        const fields = Buffer.alloc(26), tail = Buffer.alloc(14);
        fields.writeUInt16LE(20, 0);
        fields.writeUInt16LE(flags, 2);
        fields.writeUInt16LE(packed ? 8 : 0, 4);
        fields.writeUInt32LE(crc(bytes), 10);
        fields.writeUInt32LE(data.length, 14);
        fields.writeUInt32LE(bytes.length, 18);
        fields.writeUInt16LE(title.length, 22);
        tail.writeUInt32LE(at, 10);
        parts.push(Buffer.from('PK\x03\x04'), fields, title, data);
        central.push(Buffer.from('PK\x01\x02\x14\0'), fields, tail, title);
        at += 30 + title.length + data.length;
    }
    const list = Buffer.concat(central), end = Buffer.alloc(22), count = Object.keys(files).length;
    end.write('PK\x05\x06', 'latin1');
    end.writeUInt16LE(count, 8);
    end.writeUInt16LE(count, 10);
    end.writeUInt32LE(list.length, 12);
    end.writeUInt32LE(at, 16);
    return Buffer.concat([...parts, list, end]);
}
