// SPDX-License-Identifier: GPL-3.0-or-later
// 3-vectors as plain arrays, which are never changed in place.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const along = (a, direction, s) => [a[0] + direction[0] * s, a[1] + direction[1] * s, a[2] + direction[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scale(a, 1 / length(a));
export const middle = (a, b) => scale(add(a, b), 0.5);
export const mix = (a, b, t) => along(a, subtract(b, a), t);
export const finite = (a) => Array.isArray(a) && a.length === 3 && a.every(Number.isFinite);
