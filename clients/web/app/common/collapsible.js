// SPDX-License-Identifier: GPL-3.0-or-later
// Panels below the toolbar, each opened by a button.

// Connects a panel with its button. The panel closes on another press of the button, on Escape, and on a press outside the
// panel, except on the plant. For keyboard users, focus moves into the panel and back to the button. Returns { set(open),
// toggle(event) }.
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
