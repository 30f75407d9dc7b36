// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of buttons and lists to choose from, as the toolbar and the panels have them.
import { make } from './dom.js';

// A row of buttons of which one is pressed; radio buttons underneath, so the keyboard works as everywhere. choices: [value, text, title].
export function fillSegments(fieldset, name, choices, onChoose) {
    const row = make('div', { class: 'row' });
    for (const [value, text, title] of choices) {
        const input = make('input', { type: 'radio', name, value, onchange: () => onChoose(value) });
        row.append(make('label', { title }, input, make('span', {}, text)));
    }
    fieldset.replaceChildren(fieldset.querySelector('legend'), row);
}

export function markSegment(fieldset, value) {
    for (const input of fieldset.querySelectorAll('.row input[type="radio"]'))
        input.checked = input.value === value;
}

export function fillSelect(select, choices, value) {
    const wanted = JSON.stringify(choices);
    if (select.dataset.choices !== wanted) {
        select.dataset.choices = wanted;
        select.replaceChildren(...choices.map(([v, text]) => make('option', { value: v }, text)));
    }
    select.value = String(value);
}

// A panel under the toolbar that its button opens; a press elsewhere, but for the plant, or Escape closes it. Whoever comes by the keyboard
// is led into it, and back to the button. { set(open), toggle(event of the press) }.
export function foldPanel(panel, button, onChange) {
    const set = (open) => {
        panel.classList.toggle('open', open);
        button.setAttribute('aria-expanded', open);
        onChange();
    };
    const toggle = (event) => {
        set(!panel.classList.contains('open'));
        if (event?.detail === 0 && panel.classList.contains('open'))
            [...panel.querySelectorAll('button, input, select')].find((one) => one.checkVisibility() && !one.matches(':disabled'))?.focus();
    };
    panel.addEventListener('keydown', (event) => {
        if (event.key !== 'Escape')
            return;
        event.stopPropagation();
        set(false);
        button.focus();
    });
    document.addEventListener('pointerdown', (event) => {
        if (!panel.contains(event.target) && !button.contains(event.target) && !event.target.closest('#viewport'))
            set(false);
    });
    return { set, toggle };
}
