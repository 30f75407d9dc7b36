// SPDX-License-Identifier: GPL-3.0-or-later
// Panels under the toolbar that a button opens.

// A press of its button opens it; one elsewhere, but for the plant, or Escape closes it. Whoever comes by the keyboard
// is led into it, and back to the button. { set(open), toggle(event of the press) }.
export function collapsiblePanel(panel, button, onChange) {
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
