// SPDX-License-Identifier: GPL-3.0-or-later
// Texts shown on headsets, in German.
export default `
[xr]
enter: VR starten
leave: VR verlassen
back: −{n} min
live: Jetzt
waiting: Warten auf das Bild des Servers
flat: Bild veraltet
flat.why: Die Bilder haben keine Tiefe, oder sie kommt zu spät.
gone: Das Headset hat die Sitzung beendet
failed: Das Headset zeigt die Anlage nicht: {why}
`;
