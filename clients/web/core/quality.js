// SPDX-License-Identifier: GPL-3.0-or-later
// Writes OPC UA status codes as text.
import { qualityText } from './format.js';
import { say, sayIfKnown } from './words.js';

// Turns "bad", "Bad_SensorFailure" into "Bad: sensor failure". Codes without a translation are spelt out.
export function statusText(quality, name = '') {
    const code = String(name ?? '').replace(/^(good|uncertain|bad)[_ :]*/i, '');
    const spelt = code.replace(/_/g, ' ').replace(/([a-z])([A-Z])/g, '$1 $2').trim().toLowerCase(), word = qualityText(quality);
    return spelt ? say('quality.because', { quality: word, detail: sayIfKnown(`detail.${code}`, spelt) }) : word;
}
