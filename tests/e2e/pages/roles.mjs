// SPDX-License-Identifier: GPL-3.0-or-later
// Actions on alarms by user role and by the plant's alarm mode: the page offers exactly the allowed actions, and the server
// refuses the others. The page is opened over plain http with a host name.
import assert from 'node:assert/strict';
import { appendFileSync, chmodSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { openPage, PHONE, settle, shoot, TABLET, waitForHealth, waitForPicture } from '../support/browser.mjs';
import { setUp } from '../support/set_up.mjs';
import { missing, runProgram, TinyPlant } from '../support/tiny_plant.mjs';
import { becomes } from '../support/until.mjs';

const absent = missing(), chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : !existsSync(chromium) ? 'chromium is not installed' : false;
const options = { skip, timeout: 200000 };
const SCREENS = { viewer: PHONE, operator: { ...TABLET, viewport: { width: 768, height: 1024 } }, engineer: TABLET };
// actions that each role may take on a new alarm in the mode `local`; the other modes allow none
const DOES = { viewer: [], operator: ['acknowledge', 'shelve'], engineer: ['acknowledge', 'shelve'] };
const pages = {};
let plant, browsers, flags;

const setMode = (mode) => writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace(/^alarms: \w+$/m, `alarms: ${mode}`));

setUp(skip, async () => {
    plant = await TinyPlant.create();
    appendFileSync(plant.file, 'alarms: local\nviews: [{ id: strong, title: Strong, view: "group=temperature&strength=2&power=3" }]\n');
    plant.keepFresh(); // prevents readings from becoming stale, so that no alarm exists except the one that the test raises
    const tags = join(plant.folder, 'tags.csv');
    writeFileSync(tags, readFileSync(tags, 'utf8').split('\n').map((line, i) => line && line + (i === 0 ? ',H' : ',60')).join('\n'));
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    const file = join(plant.folder, 'tokens'), make = (role) =>
        runProgram('plantcast', ['token', 'add', file, '--role', role, '--name', `${role}-1`]).out.trim();
    const tokens = Object.fromEntries(Object.keys(SCREENS).map((role) => [role, make(role)]));
    chmodSync(file, 0o600);
    // values before the daemon's first read: only TI-1 is above its limit, so there is exactly one alarm
    for (const [tag, value] of [['TI-1', 80], ['TI-2', 20], ['PI-1', 5]])
        await plant.tell(`set ${tag} ${value}`);
    flags = ['--behind-proxy', '--host', 'plant.example', '--tokens', file];
    await plant.startDaemon(...flags);
    browsers = await Promise.all(Object.entries(SCREENS).map(async ([role, screen]) => {
        const browser = await openPage(`http://plant.example:${plant.port}/`, screen);
        pages[role] = browser.page;
        const dialog = browser.page.locator('#token[open]'), enter = async (token) => {
            await browser.page.locator('#token-text').fill(token);
            await browser.page.locator('#token-form button').tap();
        };
        await dialog.waitFor();
        if (role === 'viewer') {
            for (let i = 0; i < 3; i++)
                // Escape does not close the token dialog, because without a token the page has nothing else to show
                await browser.page.keyboard.press('Escape');
            await dialog.waitFor();
            await enter('pc_wrong');
            await browser.page.locator('#token-why', { hasText: 'invalid' }).waitFor();
            await shoot(browser.page, 'token');
        }
        await enter(tokens[role]);
        await waitForPicture(browser.page);
        assert.equal(await dialog.count(), 0);
        assert.ok(!browser.page.url().includes('pc_'));
        return browser;
    }));
});
after(async () => {
    for (const { close } of browsers ?? [])
        await close();
    await plant?.destroy();
});

const everyRole = async (f) => {
    for (const [role, page] of Object.entries(pages))
        await f(page, role);
};
const waitForState = (page, states) => page.waitForFunction((any) =>
    any.includes(globalThis.plantcast.session.model.alarms.list()[0]?.state ?? 'none'), states);
const waitForMode = (page, mode) => page.waitForFunction((is) => globalThis.plantcast.session.welcomed &&
    globalThis.plantcast.session.model.alarms.known && globalThis.plantcast.session.model.alarms.mode === is, mode);
// Waits until the page offers exactly the actions `wanted` for the first alarm of the list; list: the active alarms, or those
// that were shelved.
const offers = async (page, wanted, role, list = '#alarms-list') => {
    await page.locator(`${list} tr`).first().waitFor();
    const actions = page.locator(`${list} tr`).first().locator('[data-action]');
    await becomes(() => actions.evaluateAll((all) => all.map((button) => button.dataset.action)), wanted, role);
};
// Sends an alarm action that the page offers no button for. Returns the server's refusal or error code, or "done".
const ask = (page, action) => page.evaluate(async (what) => {
    const { actOnAlarm } = await import('/core/requests.js'), { session } = globalThis.plantcast;
    return new Promise((done) => {
        session.on('alarmed', ({ refused }) => done(refused.map(([, , why]) => why?.code ?? why).join() || 'done'));
        session.on('error', ({ code }) => done(code));
        actOnAlarm(session, what, [['TI-1', 'H']], what === 'shelve' ? { reason: 'because', for_s: 900 } : {});
    });
}, action);

test('on plain http with a host name the page is live, with a codec that needs no secure context',
    options, () => everyRole(async (page, role) => {
    await waitForHealth(page, 'live');
    assert.deepEqual(await page.evaluate(() => [isSecureContext, globalThis.plantcast.session.codec, globalThis.plantcast.session.role]),
        [false, 'jpeg', role]);
}));

test('with alarms managed by Plantcast, operators and engineers act on them; viewers only look', options, async () => {
    await everyRole(async (page, role) => {
        await waitForState(page, ['unacknowledged']);
        await page.locator('#alarm-strip').tap();
        await offers(page, DOES[role], role);
        await settle(page);
        await shoot(page, `roles-${role}`);
    });
    assert.equal(await ask(pages.viewer, 'acknowledge'), 'not_allowed');
    assert.equal(await ask(pages.viewer, 'shelve'), 'not_allowed');
    await waitForState(pages.viewer, ['unacknowledged']); // the action had no effect
    await pages.operator.locator('[data-action="shelve"]').tap();
    await pages.operator.locator('#shelve-reason').fill('calibration');
    await pages.operator.locator('#shelve button[type="submit"]').tap();
    await everyRole(async (page, role) => {
        await offers(page, role === 'viewer' ? [] : ['unshelve'], role, '#alarms-aside');
        // every role sees who shelved the alarm, and why
        await page.locator('#alarms-aside tr', { hasText: /by operator-1, calibration/ }).waitFor();
    });
    await pages.engineer.locator('[data-action="unshelve"]').tap();
    await everyRole((page) => waitForState(page, ['unacknowledged']));
    await pages.operator.locator('[data-action="acknowledge"]').tap();
    await everyRole(async (page, role) => {
        await waitForState(page, ['acknowledged']);
        await page.locator('#alarms-list .acknowledged').waitFor();
        await offers(page, role === 'viewer' ? [] : ['shelve'], role);
    });
});

test('operators change and end their own notes, engineers end all; a changed note keeps its end', options, async () => {
    const post = (page, text, more) => page.evaluate(([words, rest]) => {
        const { session } = globalThis.plantcast;
        session.post({ type: 'note', seq: 1, text: words, ...rest });
    }, [text, more]);
    const untilUs = (Date.now() + 5 * 3600e3) * 1000;
    await post(pages.operator, 'of the operator', { until_us: untilUs });
    await post(pages.engineer, 'of the engineer', {});
    const buttons = { viewer: [[], []], operator: [['edit', 'end'], []], engineer: [['end'], ['edit', 'end']] };
    await everyRole(async (page, role) => {
        await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 2);
        await page.locator('#views-toggle').tap();
        for (const [i, text] of ['of the operator', 'of the engineer'].entries()) {
            const row = page.locator('#notes-list li', { hasText: text });
            await row.waitFor();
            for (const action of ['edit', 'end'])
                await row.locator(`.${action}`).waitFor({ state: buttons[role][i].includes(action) ? 'visible' : 'detached' });
        }
    });
    const { operator, engineer } = pages;
    // sends the removal of the engineer's note directly, because the page offers operators no button for it
    const refused = await operator.evaluate(() => new Promise((done) => {
        const { session } = globalThis.plantcast;
        session.on('noted', ({ refusal }) => done(refusal));
        session.post({ type: 'remove_note', seq: 2, id: session.notes.find(({ text }) => text === 'of the engineer').id });
    }));
    assert.deepEqual(refused, { code: 'note_not_own', args: { author: 'engineer-1' } });
    await operator.locator('#toast').getByText('engineer-1').waitFor();
    await operator.locator('#notes-list .edit').tap();
    await operator.locator('#note-text').fill('of the operator, changed');
    await operator.locator('#note-form button[type="submit"]').tap();
    await engineer.waitForFunction((us) => globalThis.plantcast.session.notes.some(({ text, until_us: until }) =>
        text === 'of the operator, changed' && until === us), untilUs);
    for (const text of ['of the operator', 'of the engineer'])
        await engineer.locator('#notes-list li', { hasText: text }).locator('.end').tap();
    await everyRole(async (page) => {
        await page.waitForFunction(() => globalThis.plantcast.session.notes.length === 0);
        await page.locator('#views-toggle').tap();
    });
});

for (const mode of ['display', 'mirror']) {
    test(`with alarms managed by the control system (${mode}), nobody can act on them here`, options, async () => {
        setMode(mode);
        plant.daemon.child.kill('SIGHUP');
        await everyRole(async (page, role) => {
            await waitForMode(page, mode);
            await page.waitForFunction((words) => document.getElementById('alarm-mode').textContent === words,
                mode === 'display' ? 'View only: acknowledge in the control system' : 'Mirrored from the control system');
            // in `display` mode TI-1's limit still raises an alarm; in `mirror` mode the list is empty, because only the
            // control system's alarms appear
            if (mode === 'display')
                await offers(page, [], role);
            await becomes(() => page.locator('#alarms [data-action]').count(), 0, role);
        });
        await shoot(pages.operator, `roles-${mode}`);
        assert.notEqual(await ask(pages.operator, 'acknowledge'), 'done');
        assert.notEqual(await ask(pages.engineer, 'shelve'), 'done');
        for (const { errors } of browsers)
            assert.deepEqual(errors, []);
    });
}

// Only engineers may send the field parameters that the saved view contains. A viewer's page therefore sends only the view's
// name, and the server looks up the parameters.
test('a viewer keeps a saved view after a reload of the page and a restart of the daemon', options, async () => {
    const { viewer } = pages, isStrong = () => viewer.waitForFunction(() => {
        const { confirmed, params, welcomed } = globalThis.plantcast?.session ?? {};
        return welcomed && params === confirmed && params.strength === 2 && params.power === 3 && params.look === 'flat';
    });
    await viewer.evaluate(async () => (await globalThis.plantcast.modules.get('views')).openNamed('strong', false));
    await viewer.waitForFunction(() => globalThis.plantcast.session.confirmed.strength === 2);
    // the viewer changes the look in addition to the saved view; both must be restored
    await viewer.evaluate(() => globalThis.plantcast.session.setParams({ look: 'flat' }));
    await viewer.waitForFunction(() => /named=strong/.test(location.hash) && /look=flat/.test(location.hash));
    await viewer.reload();
    await isStrong();
    // the resume secret shows when the page is connected to the restarted daemon, because each start of the daemon issues a new
    // one
    const resume = await viewer.evaluate(() => globalThis.plantcast.session.resume);
    await plant.daemon.stop();
    await plant.startDaemon(...flags, '--port', String(plant.port));
    await viewer.waitForFunction((old) => globalThis.plantcast.session.welcomed && globalThis.plantcast.session.resume !== old, resume);
    await isStrong();
    await viewer.evaluate(() => globalThis.plantcast.session.setParams({ group: 'pressure' }));
    await viewer.waitForFunction(() => /group=pressure/.test(location.hash) && !/named=/.test(location.hash));
    assert.deepEqual(browsers[0].errors.filter((text) => !/ERR_CONNECTION|WebSocket/.test(text)), []);
});
