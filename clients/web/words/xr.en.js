// SPDX-License-Identifier: GPL-3.0-or-later
// Texts shown on headsets, in English.
export default `
[xr]
enter: Enter VR
leave: Leave VR
back: −{n} min
live: Now
waiting: Waiting for the server’s picture
flat: Picture out of date
flat.why: The pictures have no depth, or it comes too late.
gone: The headset ended the session
failed: The headset does not show the plant: {why}
`;
