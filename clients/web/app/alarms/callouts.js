// SPDX-License-Identifier: GPL-3.0-or-later
// Call-outs: two-line labels next to alarm rings (circles around the markers of tags in alarm). Rings that are close together share one
// call-out. In a low picture, call-outs are few; on phones and tablets, they then have one line. Also makes the labels of alarms whose
// reading is bad.
import { graver } from '../../core/alarms.js';
import { placeRings } from '../../core/callouts.js';
import { say } from '../../core/words.js';
import { heldSince } from './alarm_bar.js';
import { INK, INK_2, LABEL_HEIGHT } from '../viewport/overlay.js';

const LINE = 16; // line height, in units
// Maximum number of alarm labels in a low picture: one for each ROOM square units, but at least LEAST_LOW. The maximum of all pictures,
// 24, is one for each ROOM of 1280 x 720 units.
const ROOM = 38400, LEAST_LOW = 6;

const byGravity = (a, b) => graver(a.alarm, b.alarm) || a.tag.index - b.tag.index;

export class Callouts {
    constructor({ overlay, session, refresh }) {
        const most = () => Math.max(LEAST_LOW, Math.floor((overlay.wide * overlay.high) / ROOM));
        const place = (items, options) => placeRings(items, { ...options, ...(overlay.isLow ? { most: most() } : {}) });
        Object.assign(this, { overlay, session, place });
        overlay.callouts = this;
        refresh();
    }

    // Returns the label of an alarm whose reading is bad, so that the alarm keeps the state that it had at the last usable value. Returns
    // null if the tag never had a value.
    held(tag, { kind }) {
        const since = heldSince(this.session, { tag, kind });
        return since && [[kind, 700, null], [say('alarms.since', { time: since }), 400, INK_2]];
    }

    // Returns the lines of a call-out for several alarms, in the format of the overlay's labels. The first line names the equipment with
    // the most alarms, if it has several, and the number of the others. The second line names the most urgent alarm. Short call-outs
    // (isShort in overlay.js) have only one line.
    lines(members) {
        const [worst] = [...members].sort(byGravity), { model } = this.session, counts = new Map();
        for (const { tag } of [...members].sort((a, b) => a.tag.index - b.tag.index))
            counts.set(tag.asset, (counts.get(tag.asset) ?? 0) + 1);
        const [[most, many]] = [...counts].sort((a, b) => b[1] - a[1]), others = counts.size > 1 ? ` +${counts.size - 1}` : '';
        const where = most && many > 1 ? `${model.asset(most)?.tag || most}${others}` : '';
        if (this.overlay.isShort) {
            const count = where ? `×\u2009${members.length}` : `+${members.length - 1}`;
            const first = [[where || worst.tag.name, 400, INK_2], [count, 650, INK], [worst.alarm.kind, 700, null]];
            return { alarm: worst.alarm, lines: [first] };
        }
        const count = say('callout.count', { count: members.length });
        const since = heldSince(this.session, { tag: worst.tag, kind: worst.alarm.kind });
        return {
            alarm: worst.alarm,
            lines: [[[`${where && `${where}, `}${count}`, 650, INK]],
                [[say('callout.worst'), 400, INK_2], [worst.alarm.kind, 700, null], [worst.tag.name, 650, INK],
                    ...(since ? [[say('alarms.since', { time: since }), 400, INK_2]] : [])]],
        };
    }

    measure(members) {
        const { lines } = this.lines(members), widths = lines.map((parts) => this.overlay.lineWidth(parts));
        return { width: Math.max(...widths), height: LABEL_HEIGHT + LINE * (lines.length - 1) };
    }

    draw(members, place) {
        const { lines, alarm } = this.lines(members), { left, top } = place;
        this.overlay.drawPlate(place, place);
        lines.forEach((parts, i) => this.overlay.drawParts(parts, { left, top: top + i * LINE }, alarm));
    }
}
