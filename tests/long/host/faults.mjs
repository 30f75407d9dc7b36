// SPDX-License-Identifier: GPL-3.0-or-later
// The faults of a whole host's soak test. Each returns when its cause is gone, but the plant may need more time to recover.
import { readFileSync, writeFileSync } from 'node:fs';
import { sleep, until } from './site.mjs';

const RESTART_MS = 8000, CUT_MS = 8000, FROZEN_MS = 15000, FULL_MS = 10000, CLOCK_MS = 15000, CLOCK_S = 3600, DRAINED_S = 20;
const ENDED_MS = 30000, NOTICED_S = 60;

const ended = ({ program }) => program.child.exitCode !== null || program.child.signalCode !== null;
const isCore = (node) => Boolean(node.disk);
async function start(site, node) {
    site.mustGoOn();
    return isCore(node) ? site.two.start(node.name) : site.startRenderer(node);
}

// Sends the signal to a node (null: somebody else ends it), waits until it has ended, and starts it again after away_ms.
async function endAndStart(site, node, signal, away_ms = RESTART_MS) {
    node.isAway = true;
    node.program.stopped = true;
    if (signal)
        node.program.child.kill(signal);
    const { program } = node, hasEnded = await Promise.race([program.ended, sleep(ENDED_MS)]);
    program.child.kill('SIGKILL');
    await program.ended;
    await sleep(away_ms);
    try {
        await start(site, node);
    } finally {
        node.isAway = false;
    }
    if (!hasEnded)
        throw new Error(`${node.name} went on running for ${ENDED_MS / 1000} s`);
}
async function stopAndGoOn(node, ms) {
    node.program.child.kill('SIGSTOP');
    await sleep(ms);
    node.program.child.kill('SIGCONT');
}
async function cut(links, how, ms = CUT_MS) {
    for (const link of links)
        await link[how]();
    await sleep(ms);
    for (const link of links)
        await link.mend();
}
const restarted = async (site, node, signal = 'SIGTERM') => endAndStart(site, node, signal, 1000);

// Returns the renderer with the most operators, by the balancer's cookie.
function busiest({ operators, renderers }) {
    const count = ({ name }) => operators.filter(({ jar }) => jar.cookie?.endsWith(`=${name}`)).length;
    return renderers.reduce((most, one) => (count(one) > count(most) ? one : most));
}
const anyHow = (random) => (random() < 0.5 ? 'cut' : 'freeze');

// All faults. act({ site, leader, standby, random }) causes one. alerts: names of the Prometheus alerts that must fire, and
// stop once the plant has recovered.
export const FAULTS = [
    { name: 'leader killed', alerts: ['PlantcastDown'], act: ({ site, leader }) => endAndStart(site, leader, 'SIGKILL') },
    { name: 'standby killed', alerts: ['PlantcastDown'], act: ({ site, standby }) => endAndStart(site, standby, 'SIGKILL') },
    { name: 'renderer killed', alerts: ['PlantcastDown'],
        act: ({ site }) => endAndStart(site, busiest(site), 'SIGKILL') },
    { name: 'leader stopped', alerts: ['PlantcastDown'], act: ({ site, leader }) => { // the kernel ends it
        leader.program.child.kill('SIGSTOP');
        return endAndStart(site, leader, null);
    } },
    { name: 'standby stopped', alerts: ['PlantcastDown'], act: ({ standby }) => stopAndGoOn(standby, FROZEN_MS) },
    { name: 'renderer stopped', alerts: ['PlantcastDown'], act: ({ site }) => stopAndGoOn(busiest(site), FROZEN_MS) },
    { name: 'leader\'s disk full', alerts: ['PlantcastHistoryNotWritten'], act: ({ site, leader }) => fullDisk(site, leader) },
    { name: 'standby\'s disk full', alerts: ['PlantcastHistoryNotWritten'], act: ({ site, standby }) => fullDisk(site, standby) },
    { name: 'cores cut apart', alerts: [], act: ({ standby, random }) => cut([standby.toOther], anyHow(random)) },
    { name: 'leader cut off database', alerts: ['PlantcastLeaseDatabaseDown'],
        act: ({ leader, random }) => cut([leader.toDatabase], anyHow(random)) },
    { name: 'standby cut off database', alerts: ['PlantcastLeaseDatabaseDown'],
        act: ({ standby, random }) => cut([standby.toDatabase], anyHow(random)) },
    // isRepeated: alarms may be recorded twice. Those recorded by the old leader during the cut never reach the next leader,
    // which therefore detects and records them again.
    { name: 'leader cut off both', alerts: [], isRepeated: true, act: async ({ site, leader, standby, random }) => {
        const links = [leader.toDatabase, standby.toOther];
        await Promise.all([endAndStart(site, leader, null, CUT_MS), cut(links, anyHow(random))]);
    } },
    { name: 'renderer cut off cores', alerts: ['PlantcastCoreLost'],
        act: ({ site, random }) => cut(busiest(site).links, anyHow(random), FROZEN_MS) },
    { name: 'database killed', alerts: [], act: async ({ site }) => {
        await site.server.kill();
        await sleep(CUT_MS);
        await site.server.restart();
    } },
    { name: 'database stopped', alerts: ['PlantcastLeaseDatabaseDown'], act: async ({ site }) => {
        site.server.freeze();
        await sleep(FROZEN_MS);
        site.server.thaw();
    } },
    { name: 'leader\'s clock wrong', alerts: ['PlantcastClocksDiffer'], off_s: CLOCK_S,
        act: ({ leader, random }) => wrongClock(leader, random) },
    { name: 'standby\'s clock wrong', alerts: ['PlantcastClocksDiffer'], off_s: CLOCK_S,
        act: ({ standby, random }) => wrongClock(standby, random) },
    { name: 'certificates replaced', alerts: [], act: certificates },
    { name: 'plant file reloaded', alerts: [], act: reload },
    { name: 'nodes upgraded', alerts: [], act: upgrade },
    { name: 'balancer restarted', alerts: [], act: async ({ site }) => {
        await site.proxy.destroy();
        await sleep(1000);
        await site.balance();
    } },
];

// Fills the core's disk for FULL_MS after the first failed write. Before that, SQLite still writes into space that its
// write-ahead log already occupies.
async function fullDisk(site, core) {
    site.fillDisk(core);
    const notGood = /^plantcast_(history|alarm_journal)_good(\{.*\})? 0$/m;
    const cannotWrite = async () => notGood.test(await (await core.node.fetch('/metrics')).text());
    try {
        await until('a write that fails', cannotWrite, NOTICED_S);
        await sleep(FULL_MS);
    } finally {
        site.freeDisk(core);
    }
}
async function wrongClock(core, random) {
    core.clock.set(random() < 0.5 ? CLOCK_S : -CLOCK_S);
    await sleep(CLOCK_MS);
    core.clock.set(0);
}
async function certificates({ site }) {
    for (const renderer of site.renderers) {
        const before = await site.serial(renderer);
        site.certify(renderer.name);
        await until('the new certificate', async () => await site.serial(renderer) !== before, 30);
    }
}
// Changes the plant file and reloads the cores one after the other, then the renderers, in the order of
// deploy/pages/STANDBY.md.
async function reload({ site, leader, standby }) {
    const text = readFileSync(site.two.file, 'utf8'), [was, is] = /description: warm/.test(text) ? ['warm', 'cold'] : ['cold', 'warm'];
    writeFileSync(site.two.file, text.replace(`description: ${was}`, `description: ${is}`));
    for (const node of [leader, standby, ...site.renderers]) {
        const { code, said } = await site.plantcast('reload', String(node.program.child.pid), '--runtime', node.runtime, '--timeout', '30');
        if (code !== 0)
            throw new Error(`reload of ${node.name}: ${said}`);
    }
}
// Restarts the nodes in the order in which deploy/pages/STANDBY.md upgrades them, with programs of the same version.
async function upgrade({ site, leader, standby }) {
    const maintain = async (how, value) => {
        const { code, said } = await site.plantcast('standby', how, leader.disk);
        if (code !== 0)
            throw new Error(said);
        await until(how, async () => await leader.node.metric('plantcast_core_standby_maintenance', leader.node.token) === value, 30);
    };
    await maintain('maintenance', 1);
    await restarted(site, standby);
    await maintain('normal', 0);
    await site.two.followed(leader);
    await drained(site, site.renderers[0]);
    await restarted(site, leader);
    await drained(site, site.renderers[1]);
}
async function drained(site, renderer) {
    renderer.program.child.kill('SIGUSR1');
    const isEmpty = async () => (await site.proxy.servers())[renderer.name].sessions === 0;
    await until('its sessions elsewhere', isEmpty, DRAINED_S).catch(() => {});
    await restarted(site, renderer);
    await until('the balancer', async () => /^UP/.test((await site.proxy.servers())[renderer.name].status), 30);
}

// Until the site ends: restarts each node that ends unexpectedly 2 s later, as a service manager does. ends: receives each
// one's name and last lines of output.
export function supervise(site, ends) {
    const revive = async (node) => {
        node.isAway = true;
        node.program.stopped = true;
        ends.push(`${node.name} ended: ${node.program.said.trim().split('\n').slice(-2).join(' / ')}`);
        await sleep(2000);
        await start(site, node).catch(({ message }) => ends.push(message));
        node.isAway = false;
    };
    const timer = setInterval(() => {
        if (site.isOver)
            clearInterval(timer);
        else
            [...Object.values(site.two.cores), ...site.renderers].filter((one) => !one.isAway && ended(one)).forEach(revive);
    }, 500);
}
