// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the number of device pixels per CSS pixel. It changes when the user zooms the page, or moves the window to another display.

const MARGIN = 0.001; // browsers round the ratio

// Calls f after each change of the ratio. A media query that names one ratio notices only one change, so a new query replaces it.
export function onPixelRatio(f) {
    const [least, most] = [-MARGIN, MARGIN].map((margin) => `${window.devicePixelRatio + margin}dppx`);
    window.matchMedia(`(min-resolution: ${least}) and (max-resolution: ${most})`).addEventListener('change', () => {
        onPixelRatio(f);
        f();
    }, { once: true });
}
