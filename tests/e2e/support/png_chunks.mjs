// SPDX-License-Identifier: GPL-3.0-or-later
// PNG files as lists of chunks, so that a test can alter one and write it with the correct checksum.
import zlib, { deflateSync, inflateSync } from 'node:zlib';

const SIGNATURE = 8;

export function chunksOf(png) {
    const chunks = [];
    for (let at = SIGNATURE; at < png.length;) {
        const length = png.readUInt32BE(at);
        chunks.push({ type: png.toString('latin1', at + 4, at + 8), data: png.subarray(at + 8, at + 8 + length) });
        at += 12 + length;
    }
    return chunks;
}

export const crc = zlib.crc32 ?? ((bytes) => { // CRC-32; computed here if node lacks zlib.crc32, as in Debian 12
    let sum = ~0;
    for (const byte of bytes) {
        sum ^= byte;
        for (let i = 0; i < 8; i++)
            sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
    }
    return ~sum >>> 0;
});

export function pngOf(png, chunks) {
    const written = chunks.map(({ type, data }) => {
        const body = Buffer.concat([Buffer.from(type, 'latin1'), data]), around = Buffer.alloc(8);
        around.writeUInt32BE(data.length, 0);
        around.writeUInt32BE(crc(body), 4);
        return Buffer.concat([around.subarray(0, 4), body, around.subarray(4)]);
    });
    return Buffer.concat([png.subarray(0, SIGNATURE), ...written]);
}

const isText = (chunk, keyword) => chunk.type === 'zTXt' && chunk.data.toString('latin1', 0, keyword.length + 1) === `${keyword}\0`;

export function textOf(png, keyword) {
    const chunk = chunksOf(png).find((one) => isText(one, keyword));
    return inflateSync(chunk.data.subarray(keyword.length + 2)).toString();
}

export function withText(png, keyword, change) {
    return pngOf(png, chunksOf(png).map((chunk) => {
        if (!isText(chunk, keyword))
            return chunk;
        const text = change(inflateSync(chunk.data.subarray(keyword.length + 2)).toString());
        return { type: 'zTXt', data: Buffer.concat([chunk.data.subarray(0, keyword.length + 2), deflateSync(text)]) };
    }));
}

// Returns the PNG with changed rows. change() gets the bytes of all rows, each preceded by its filter type.
export function withRows(png, change) {
    const chunks = chunksOf(png), rows = inflateSync(Buffer.concat(chunks.filter(({ type }) => type === 'IDAT').map(({ data }) => data)));
    change(rows);
    const first = chunks.findIndex(({ type }) => type === 'IDAT');
    return pngOf(png, [...chunks.slice(0, first), { type: 'IDAT', data: deflateSync(rows) },
        ...chunks.slice(first).filter(({ type }) => type !== 'IDAT')]);
}
