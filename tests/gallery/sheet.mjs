// SPDX-License-Identifier: GPL-3.0-or-later
// Renders the gallery's page into one picture, and each of its sections into another. usage: node tests/gallery/sheet.mjs
// FOLDER
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const { chromium } = createRequire(new URL('../e2e/package.json', import.meta.url))('playwright-core');
const folder = resolve(process.argv[2]);
const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu'] });
const page = await browser.newPage({ viewport: { width: 1920, height: 1080 } });
await page.goto(`file://${folder}/index.html`, { waitUntil: 'load' });
await page.screenshot({ path: `${folder}/sheet.png`, fullPage: true });
for (const section of await page.locator('section').all())
    await section.screenshot({ path: `${folder}/sheet_${await section.getAttribute('id')}.png` });
await browser.close();
