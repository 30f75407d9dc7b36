// SPDX-License-Identifier: GPL-3.0-or-later
// A plant of two boxes whose only source is an MQTT broker or an OPC UA server, and functions that read its tags.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { TinyPlant } from './tiny_plant.mjs';
import { until } from './until.mjs';

const HEAD = 'Tag Name,Address,Data Type,Eng Units,Group,Asset,X,Y,Z,Stale s,Scaling,Raw Low,Raw High,Scaled Low,Scaled High';

export class PublishedPlant {
    static async create(broker) {
        const published = new PublishedPlant();
        published.broker = broker;
        published.plant = await TinyPlant.create();
        return published;
    }

    get file() { return this.plant.file; }
    get folder() { return this.plant.folder; }
    get daemon() { return this.plant.daemon; }

    // Writes the plant file with the source's settings `keys`, and the tag list with these rows. more: further columns of the
    // tag list's header line.
    write(keys, rows, more = '') {
        writeFileSync(this.file, `plant: { name: Two boxes }
assets:
  - { id: E-101, model: box.gltf }
  - { id: P-101A, model: box.gltf, placement: { translate: [3, 0, 0] } }
groups:
  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }
  - { id: pressure, quantity: Pressure, unit: bar, min: 0, max: 10, distance: euclidean }
sources:
  - ${this.broker.source(keys)}
tags: tags.csv
`);
        writeFileSync(join(this.folder, 'tags.csv'), `${[HEAD + more, ...rows].join('\n')}\n`);
    }

    // Writes and prepares the plant and starts its daemon with these options, without waiting for a connection to the broker or
    // server.
    async start(keys, rows, ...flags) {
        this.write(keys, rows);
        this.plant.prepare();
        await this.plant.startDaemon(...flags);
    }

    // Waits until the daemon's log matches.
    said(pattern, ms = 120000) {
        return this.daemon.line(pattern, ms);
    }

    // Writes and prepares the plant, starts its daemon, and waits until the daemon has subscribed to its values.
    async run(keys, rows, more = '') {
        this.write(keys, rows, more);
        const prepared = this.plant.prepare();
        assert.equal(prepared.code, 0, prepared.err);
        await this.plant.startDaemon();
        await this.daemon.line(/source (broker|plc): .*: reading/);
    }

    // Reloads the plant, and waits until the daemon has subscribed to its values again.
    async reload() {
        const from = this.daemon.said.length;
        const answer = await fetch(`http://127.0.0.1:${this.plant.port}/api/v1/reload`, { method: 'POST' });
        assert.equal(answer.status, 200, await answer.text());
        await until('the source reading again', () => /source (broker|plc): .*: reading/.test(this.daemon.said.slice(from)));
    }

    async get(path) {
        return (await fetch(`http://127.0.0.1:${this.plant.port}${path}`)).json();
    }

    // Returns at most 5,000 tags, by name.
    async tags() {
        return Object.fromEntries((await this.get('/api/v1/tags?count=5000')).tags.map((tag) => [tag.name, tag]));
    }

    // Waits until the tag has the properties `wanted`, and returns the tag. seconds: maximum wait; the test fails afterwards.
    async until(name, wanted, seconds = 90) {
        for (const end = performance.now() + seconds * 1000; ; await sleep(20)) {
            const tag = (await this.tags())[name];
            if (Object.entries(wanted).every(([key, value]) => tag[key] === value))
                return tag;
            assert.ok(performance.now() < end, `${name} is ${JSON.stringify(tag)} instead of ${JSON.stringify(wanted)}`);
        }
    }

    // Returns the value of the metric plantcast_source_NAME.
    metric(name) { return this.plant.metric(`plantcast_source_${name}`); }

    destroy() {
        return this.plant.destroy();
    }
}
