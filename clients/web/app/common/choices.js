// SPDX-License-Identifier: GPL-3.0-or-later
// Segmented buttons and selection lists for the toolbar and the panels.
import { make } from './dom.js';

// Fills a row of buttons of which one is pressed. They are radio buttons, so that the arrow keys move between them. choices:
// list of [value, text, title].
export function fillSegments(fieldset, name, choices, onChoose) {
    const row = make('div', { class: 'row' });
    for (const [value, text, title] of choices) {
        const input = make('input', { type: 'radio', name, value, onchange: () => onChoose(value) });
        row.append(make('label', { title }, input, make('span', {}, text)));
    }
    fieldset.replaceChildren(fieldset.querySelector('legend'), row);
}

export function markSegment(fieldset, value) {
    for (const input of fieldset.querySelectorAll('.row input[type="radio"]')) {
        input.checked = input.value === value;
        // in a panel, rows wrap instead of scrolling, and scrolling the panel would hide its first lines
        if (input.checked && !fieldset.closest('.panel'))
            input.parentNode.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    }
}

export function fillSelect(select, choices, value) {
    const wanted = JSON.stringify(choices);
    if (select.dataset.choices !== wanted) {
        select.dataset.choices = wanted;
        select.replaceChildren(...choices.map(([v, text]) => make('option', { value: v }, text)));
    }
    select.value = String(value);
}
