// SPDX-License-Identifier: GPL-3.0-or-later
// Generates tag lists like those of a control system from the names of a plant's equipment. Tags are built from
// ANSI/ISA-5.1-2009 (letters of table 4.1, loop numbers, suffixes) or from the equipment's name, as OPC servers and control
// systems do, with spelling mistakes, repeated rows and tags of other plants. The true equipment of each tag is returned
// separately. To be independent, this file uses none of the matching code.
const VARIABLES = [['T', 'temperature', '°C', [0, 150]], ['P', 'pressure', 'bar(g)', [0, 16]], ['F', 'flow', 'm3/h', [0, 400]],
    ['L', 'level', '%', [0, 100]], ['V', 'vibration', 'mm/s rms', [0, 20]], ['PD', 'differential pressure', 'mbar', [0, 500]],
    ['A', 'analysis', 'ppm', [0, 50]], ['S', 'speed', 'rpm', [0, 3000]]];
const FUNCTIONS = ['T', 'T', 'T', 'I', 'E', 'IC', 'IT', 'SH', 'AH', 'SHH'];
const ENDS = ['inlet', 'outlet', 'top', 'bottom', 'shell side', 'discharge', 'suction', 'bearing DE', 'bearing NDE', ''];
const ATTRIBUTES = ['.PV', '.PV', '.DACA.PV', '.SP', '.OP', '.Value', '/PV.CV'];

function randomOf(seed) { // the mulberry32 generator
    let state = seed >>> 0;
    return () => {
        state = (state + 0x6d2b79f5) >>> 0;
        let t = Math.imul(state ^ (state >>> 15), state | 1);
        t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}

// Returns the name that operators would use for a piece of equipment: its name without punctuation at the ends. For a component
// of a building model ("M_..."), the name's first words and its number.
function spoken(id) {
    const family = id.match(/^M_([A-Z][a-z]+(?: [A-Z][a-z]+)*).*:(\d+)$/);
    return family ? `${family[1].replaceAll(' ', '_')}-${family[2]}` : id.replace(/^[^\p{L}\d]+|[^\p{L}\d]+$/gu, '');
}

// Returns the number that the loops (measuring points) of this equipment contain: the longest run of digits in its name, and of
// several equally long ones the last.
function numberOf(id) {
    return (id.match(/\d+/g) ?? []).reduce((best, run) => (run.length >= best.length ? run : best), '');
}

export function makeTagList(equipment, { seed, count = 5000, foreign = 0.15, repeated = 0.06, noise = 0.06 }) {
    const random = randomOf(seed), pick = (list) => list[Math.floor(random() * list.length)], chance = (p) => random() < p;
    const numbers = new Set(equipment.flatMap((id) => id.match(/\d+/g) ?? []).map((n) => n.replace(/^0+/, '')));
    const tags = [], used = new Set();
    const separator = () => pick(['-', '-', '_', '.', '']);
    const numbered = equipment.filter((id) => numberOf(id).length > 2);
    const otherNumber = () => {
        for (;;) {
            const number = String(100 + Math.floor(random() * 9900));
            if (![0, 1, 2].some((cut) => number.length - cut >= 3 && numbers.has(number.slice(0, number.length - cut))))
                return number;
        }
    };
    const slips = (name) => {
        if (chance(0.15))
            name = name.toLowerCase();
        if (!chance(noise))
            return chance(0.1) ? name.replace(/[-_/]/g, pick(['_', '-', '.', ' '])) : name;
        const at = [...name.matchAll(/[A-Za-z]{3,}|\d{3,}/g)], run = at.length > 0 ? pick(at) : null;
        if (!run)
            return name;
        const i = run.index + 1 + Math.floor(random() * (run[0].length - 2)), letter = name[i];
        const digit = /\d/.test(letter), kind = random();
        if (digit && kind < 0.25)
            return name.slice(0, i) + pick(['7', '3', '9']) + name.slice(i + 1);   // a wrong digit
        if (digit)
            return name.slice(0, i) + (letter === '0' ? 'O' : letter === '1' ? 'I' : letter) + name.slice(i + 1);
        if (kind < 0.35)
            return name.slice(0, i) + letter + name.slice(i);                       // a doubled letter
        if (kind < 0.7)
            return name.slice(0, i) + name[i + 1] + letter + name.slice(i + 2);     // two letters swapped
        return name.slice(0, i) + name.slice(i + 1);                                // a letter left out
    };
    const add = (name, equipmentId, about) => {
        if (used.has(name.trim().toLowerCase()))
            return;
        used.add(name.trim().toLowerCase());
        const [, quantity, unit, [low, high]] = about.variable;
        const words = [about.named && spoken(about.named), about.end, quantity].filter(Boolean).join(' ');
        tags.push({ name, truth: equipmentId, unit, low, high, address: String(400001 + tags.length * 2), path: about.path ?? '',
            description: chance(0.05) ? '' : words.charAt(0).toUpperCase() + words.slice(1) });
    };
    const one = (id) => {
        const variable = pick(VARIABLES), letters = variable[0] + pick(FUNCTIONS), end = pick(ENDS), style = random();
        const sequence = String(1 + Math.floor(random() * 12)).padStart(2, '0'), suffix = chance(0.3) ? pick(['A', 'B', 'C']) : '';
        const attribute = chance(0.12) ? pick(ATTRIBUTES) : '', name = spoken(id), number = numberOf(id);
        if (style < 0.45)        // the tag's name is the equipment, then the instrument's letters
            return [`${slips(name)}${pick(['_', '-', '.', '/'])}${letters}${separator()}${sequence}${attribute}`,
                { variable, end, named: chance(0.6) ? id : null }];
        if (style < 0.6)         // the tag's name is the instrument's letters, then the equipment
            return [`${letters}${pick(['_', '-'])}${slips(name)}${attribute}`, { variable, end, named: chance(0.5) ? id : null }];
        if (style < 0.8 && number.length > 1) // letters and the equipment's number; the description may name the equipment
            return [`${letters}${separator()}${number}${suffix}${attribute}`, { variable, end, named: chance(0.85) ? id : null }];
        if (style < 0.9)         // letters and a number unrelated to the equipment; only the description names the equipment
            return [`${letters}-${otherNumber()}${suffix}${attribute}`, { variable, end, named: id }];
        return [`${letters}${separator()}${sequence}${suffix}`,
            { variable, end, named: chance(0.5) ? id : null, path: `Site/${slips(name)}` }];
    };
    for (let tries = 0; tags.length < count * (1 - foreign) && tries < count * 20; tries++) {
        const id = pick(equipment), [name, about] = one(id);
        add(about.path ? `${about.path}/${name}` : name, id, about);
    }
    for (let tries = 0; tags.length < count && tries < count * 20; tries++) {
        const variable = pick(VARIABLES), letters = variable[0] + pick(FUNCTIONS), number = otherNumber(), kind = random();
        const id = spoken(pick(numbered)), other = id.replace(numberOf(id), number);
        const name = kind < 0.4 ? `${letters}${separator()}${number}` : kind < 0.7 ? `${other}_${letters}01`
            : kind < 0.85 ? `${pick(['P', 'E', 'V', 'K', 'TK'])}-${number}.${pick(['RUN', 'FAULT', 'SPEED', 'PV'])}`
                : `${pick(['_System', 'PLC1', 'GW2', '$Sys'])}.${pick(['Heartbeat', 'CpuLoad', 'Time_Second', 'ErrorCount'])}${number}`;
        add(name, null, { variable, end: pick(ENDS), named: null });
    }
    const rows = [...tags];
    for (let i = 0; i < count * repeated; i++)
        rows.push(chance(0.85) ? pick(tags) : { ...pick(tags), address: String(300001 + i) });
    for (let i = rows.length - 1; i > 0; i--) {
        const k = Math.floor(random() * (i + 1));
        [rows[i], rows[k]] = [rows[k], rows[i]];
    }
    return { rows, truth: new Map(tags.map(({ name, truth }) => [name.trim().replace(/\s+/g, ' '), truth])) };
}

const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;

export const formats = {
    kepware: (rows) => ['Tag Name,Address,Data Type,Respect Data Type,Client Access,Scan Rate,Scaling,Raw Low,Raw High,Scaled Low,' +
        'Scaled High,Scaled Data Type,Clamp Low,Clamp High,Eng Units,Description,Negate Value', ...rows.map((t) =>
        [t.name, t.address, 'Float', 1, 'R/O', 100, 'Linear', 0, 27648, t.low, t.high, 'Float', 0, 0, t.unit, t.description, 0]
            .map(quoted).join(','))].join('\r\n'),
    intouch: (rows) => [':mode=ask', ':IOAccess,Application,Topic,AdviseActive,DDEProtocol', '"PLC1","DASMBTCP","PLC1",Yes,No',
        ':IOReal,Group,Comment,Logged,EngUnits,InitialValue,MinEU,MaxEU,MinRaw,MaxRaw,Conversion,AccessName,ItemUseTagname,' +
            'ItemName,ReadOnly',
        ...rows.map((t) => [t.name, '$System', t.description, 'No', t.unit, 0, t.low, t.high, 0, 27648, 'Linear', 'PLC1', 'No', t.address,
            'Yes'].map(quoted).join(','))].join('\n'),
    honeywell: (rows) => ['Point ID;Description;EUDESC;PVEULO;PVEUHI;PV Source Address',
        ...rows.map((t) => [t.name, t.description, t.unit, t.low, t.high, t.address].map(quoted).join(';'))].join('\n'),
    ignition: (rows) => JSON.stringify({ name: '', tagType: 'Provider', tags: rows.map((t) => ({ name: t.name, tagType: 'AtomicTag',
        valueSource: 'opc', dataType: 'Float4', opcItemPath: `ns=1;s=[plc]${t.address}`, engUnit: t.unit, engLow: t.low, engHigh: t.high,
        documentation: t.description })) }),
};
