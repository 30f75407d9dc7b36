// SPDX-License-Identifier: GPL-3.0-or-later
// The tiny plant with the wall `wide`: two displays, side by side, show one picture. seam.mjs and faults.mjs each start one.
import { appendFileSync } from 'node:fs';
import { TinyPlant } from '../support/tiny_plant.mjs';

const WALLS = `
views:
- { id: all, title: All, view: "group=temperature&camera=3.5,-7,1,1.5,0,0,0,0,1,30" }
walls:
- { id: wide, tile: { columns: 2, rows: 1, views: all } }
`;

// own: the function that setUp() passes.
export async function startWide(own) {
    const plant = own(await TinyPlant.create());
    plant.keepFresh();
    appendFileSync(plant.file, WALLS);
    await plant.start();
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'PI-1': 5 });
    return plant;
}
