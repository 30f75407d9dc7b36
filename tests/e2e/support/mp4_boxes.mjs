// SPDX-License-Identifier: GPL-3.0-or-later
// Alters boxes of a signed video (MP4 with one track). Each alteration makes players show the video wrongly, so `plantcast
// verify` must refuse it.

// by type of MP4 box: number of bytes before its inner boxes
const HEADS = { moov: 8, trak: 8, edts: 8, mdia: 8, minf: 8, stbl: 8, stsd: 16, avc1: 86, udta: 8 };
const typeOf = (bytes, at) => bytes.toString('latin1', at + 4, at + 8);

// Rewrites a list of boxes. `change` gets each box and its path ("moov/trak"), and returns the boxes that replace it.
function rewrite(bytes, change, place = '') {
    const out = [];
    for (let at = 0; at < bytes.length;) {
        const length = bytes.readUInt32BE(at), type = typeOf(bytes, at), path = place ? `${place}/${type}` : type, head = HEADS[type];
        let box = Buffer.from(bytes.subarray(at, at + length));
        if (head)
            box = sized(Buffer.concat([box.subarray(0, head), rewrite(box.subarray(head), change, path)]));
        out.push(...(change(box, path) ?? [box]));
        at += length;
    }
    return Buffer.concat(out);
}

function sized(box) {
    box.writeUInt32BE(box.length, 0);
    return box;
}

function box(type, hex) {
    const content = Buffer.from(hex, 'hex');
    return sized(Buffer.concat([Buffer.alloc(4), Buffer.from(type, 'latin1'), content]));
}

// Appends a box inside the box at `path`.
const into = (path, extra) => (one, at) => (at === path ? [sized(Buffer.concat([one, extra]))] : null);
const beside = (path, extra) => (one, at) => (at === path ? [one, extra] : null);
const without = (path) => (one, at) => (at === path ? [] : null);
function patched(path, at, hex) {
    return (one, where) => {
        if (where === path)
            Buffer.from(hex, 'hex').copy(one, at);
        return null;
    };
}

const TRAK = 'moov/trak', STBL = `${TRAK}/mdia/minf/stbl`, AVC1 = `${STBL}/stsd/avc1`;
const else_ = (type) => `box ${type} has contents that`, none = (type) => `unexpected MP4 box ${type}`;

// Returns [description, bytes of the video, expected reason for the refusal] for each alteration. The offsets of the frames are
// not adjusted to the changed boxes, because `plantcast verify` refuses the boxes before it reads frames.
export function alteredFilms(film) {
    const alter = (change) => rewrite(film, change);
    return [
        ['primaries of BT.601', alter(patched(`${AVC1}/colr`, 12, '0006')), else_('colr')],
        ['transfer of PQ', alter(patched(`${AVC1}/colr`, 14, '0010')), else_('colr')],
        ['matrix of BT.709', alter(patched(`${AVC1}/colr`, 16, '0001')), else_('colr')],
        ['limited range', alter(patched(`${AVC1}/colr`, 18, '00')), else_('colr')],
        ['an ICC profile', alter(patched(`${AVC1}/colr`, 8, '70726f66')), else_('colr')],
        ['no colours', alter(without(`${AVC1}/colr`)), 'box colr is missing'],
        ['colours twice', alter(beside(`${AVC1}/colr`, box('colr', '6e636c780009001000090080'))), 'box colr occurs twice'],
        ['long pixels', alter(into(AVC1, box('pasp', '0000000200000001'))), else_('pasp')],
        ['a clean aperture', alter(into(AVC1, box('clap', '00'.repeat(32)))), none('clap')],
        ['another gamma', alter(into(AVC1, box('gama', '00010000'))), none('gama')],
        ['mastering display', alter(into(AVC1, box('mdcv', '00'.repeat(24)))), none('mdcv')],
        ['a sphere', alter(into(AVC1, box('sv3d', ''))), none('sv3d')],
        ['stereo', alter(into(AVC1, box('st3d', '0000000001'))), none('st3d')],
        ['turned', alter(patched(`${TRAK}/tkhd`, 48, 'ffff0000')), else_('tkhd')],
        ['the whole film turned', alter(patched('moov/mvhd', 44, 'ffff0000')), else_('mvhd')],
        ['wider', alter(patched(`${TRAK}/tkhd`, 84, '0282')), else_('tkhd')],
        ['another size of samples', alter((one, at) => { // changes the width consistently in both boxes that contain it
            if (at === AVC1)
                one.writeUInt16BE(one.readUInt16BE(32) + 16, 32);
            if (at === `${TRAK}/tkhd`)
                one.writeUInt16BE(one.readUInt16BE(84) + 16, 84);
            return null;
        }), 'MP4 box avc1 states '],
        ['a hidden track', alter(patched(`${TRAK}/tkhd`, 11, '00')), else_('tkhd')],
        ['played faster', alter(patched('moov/mvhd', 28, '00020000')), else_('mvhd')],
        ['blended', alter(patched(`${TRAK}/mdia/minf/vmhd`, 12, '0024ffff')), else_('vmhd')],
        ['two edits', alter((one, at) => (at === `${TRAK}/edts/elst`
            ? [box('elst', `0000000000000002${one.toString('hex', 16, 28)}${one.toString('hex', 16, 28)}`)] : null)), else_('elst')],
        ['a picture that stands still', alter(patched(`${TRAK}/edts/elst`, 24, '00000000')), else_('elst')],
        ['another track', alter((one, at) => (at === TRAK ? [one, one] : null)), 'box trak occurs twice'],
        ['samples of another file', alter((one, at) => (at === `${TRAK}/mdia/minf/dinf`
            ? [box('dinf', '0000001c6472656600000000000000010000000c75726c2000000000')] : null)), else_('dref')],
        ['two kinds of samples', alter(patched(`${STBL}/stsd`, 12, '00000002')), else_('stsd')],
        ['a user box', alter(into('moov', box('uuid', '00'.repeat(16)))), none('uuid')],
        ['a picture of the cover', alter(into('moov/udta', box('covr', '00'))), none('covr')],
        ['pieces', alter(into('moov', box('mvex', ''))), none('mvex')],
        ['a piece behind', Buffer.concat([film, box('moof', '')]), none('moof')],
        ['bytes behind', Buffer.concat([film, Buffer.from('more')]), 'bytes follow the last one'],
        ['a film within free space', alter((one, at) => (at === 'free' ? [box('free', '00')] : null)), else_('free')],
    ];
}
