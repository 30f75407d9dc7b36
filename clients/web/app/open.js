// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the page's modules one after the other. Three <script> elements would do the same, but WebKit (Safari, WebKitGTK) then
// runs a module before the top-level await of an imported module has ended, so that the page stays empty.
await import('../core/words.js');
await import('./startup.js');
await import('./main.js');
