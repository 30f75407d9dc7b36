// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the warning over a page whose main thread hangs, in English.
export default `
hangs: This page does not respond
hangs.reload: The picture stopped {n} s ago. Reload it.
hangs.reloads: The picture stopped {n} s ago. It is being reloaded.
`;
