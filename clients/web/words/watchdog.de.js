// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the warning over a page whose main thread hangs, in German.
export default `
hangs: Diese Seite reagiert nicht
hangs.reload: Das Bild steht seit {n} s still. Bitte neu laden.
hangs.reloads: Das Bild steht seit {n} s still. Sie wird neu geladen.
`;
