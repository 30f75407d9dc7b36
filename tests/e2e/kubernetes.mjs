// SPDX-License-Identifier: GPL-3.0-or-later
// The manifests for Kubernetes against the schema of its API; what they say of the daemon against the daemon itself.
import assert from 'node:assert/strict';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { missing, runProgram } from './support/tiny_plant.mjs';

const HERE = import.meta.dirname, FOLDER = join(HERE, '../../deploy/kubernetes'), MODELS = join(HERE, 'node_modules/kubernetes-models');
const skip = existsSync(MODELS) && existsSync(join(HERE, 'node_modules/yaml')) ? false : 'no npm package kubernetes-models or yaml';
const FILES = ['core.yaml', 'network.yaml', 'renderers.yaml'];
const OPEN = ['labels', 'matchLabels', 'selector', 'requests', 'limits']; // whose members are names of ours

async function read() {
    const { parseAllDocuments } = await import('yaml');
    return FILES.flatMap((file) => parseAllDocuments(readFileSync(join(FOLDER, file), 'utf8'), { version: '1.1' }).map((document) => {
        assert.deepEqual(document.errors, [], file);
        return document.toJS();
    }));
}
const one = (all, kind, name) => all.find((object) => object.kind === kind && object.metadata.name === name);
const podOf = (object) => object.spec.template.spec;
const bothPods = (all) => [one(all, 'StatefulSet', 'plantcast-core'), one(all, 'Deployment', 'plantcast-renderer')].map(podOf);

async function problem(object) {
    const models = await import(`kubernetes-models/${object.apiVersion}`);
    try {
        new models[object.kind](object).validate();
    } catch (error) {
        return error.message;
    }
    return unknownKey(object);
}

// The schema lets any further key pass: one that is no key anywhere in the API is a slip of the pen.
let keys;
function unknownKey(value, path = '') {
    keys ??= new Set([MODELS, join(dirname(MODELS), '@kubernetes-models/apimachinery')]
        .flatMap((folder) => readdirSync(folder, { recursive: true }).filter((file) => file.endsWith('.d.ts'))
            .flatMap((file) => [...readFileSync(join(folder, file), 'utf8').matchAll(/"(\w+)"\??:/g)].map(([, key]) => key))));
    for (const [key, inner] of Object.entries(value && typeof value === 'object' ? value : {})) {
        if (!Array.isArray(value) && !keys.has(key) && !['apiVersion', 'kind'].includes(key))
            return `${path}/${key}: no such key`;
        const found = OPEN.includes(key) && !inner?.matchLabels ? null : unknownKey(inner, `${path}/${key}`);
        if (found)
            return found;
    }
    return null;
}

test('each object is one of the API', { skip }, async () => {
    assert.deepEqual(readdirSync(FOLDER).filter((file) => file.endsWith('.yaml')).sort(), FILES);
    const all = await read();
    assert.deepEqual(all.map(({ kind }) => kind).sort(), ['Deployment', 'NetworkPolicy', 'NetworkPolicy', 'PodDisruptionBudget', 'Service',
        'Service', 'StatefulSet']);
    for (const object of all)
        assert.equal(await problem(object), null, `${object.kind} ${object.metadata.name}`);
    const core = one(all, 'StatefulSet', 'plantcast-core');
    assert.match(await problem({ ...core, spec: { ...core.spec, replicas: 'one' } }), /replicas/);
    assert.match(await problem({ ...core, spec: { ...core.spec, replica: 1 } }), /no such key/);
});

test('one core, and never two; its volume is one pod\'s', { skip }, async () => {
    const { spec } = one(await read(), 'StatefulSet', 'plantcast-core');
    assert.equal(spec.replicas, 1);
    assert.deepEqual(spec.volumeClaimTemplates[0].spec.accessModes, ['ReadWriteOncePod']);
});

test('services, policies and budgets mean the pods; volumes and ports are there', { skip }, async () => {
    const all = await read();
    const labels = [one(all, 'StatefulSet', 'plantcast-core'), one(all, 'Deployment', 'plantcast-renderer')].map((object) => {
        assert.deepEqual(object.spec.selector.matchLabels, object.spec.template.metadata.labels);
        return JSON.stringify(object.spec.template.metadata.labels);
    });
    for (const { kind, spec } of all) {
        const selector = { Service: spec.selector, NetworkPolicy: spec.podSelector?.matchLabels,
            PodDisruptionBudget: spec.selector?.matchLabels }[kind];
        assert.ok(!selector || labels.includes(JSON.stringify(selector)), kind);
    }
    for (const [i, pod] of bothPods(all).entries()) {
        const claims = i === 0 ? ['data'] : [];
        const volumes = [...pod.volumes.map(({ name }) => name), ...claims].sort();
        for (const container of [...pod.initContainers, ...pod.containers]) {
            assert.deepEqual(container.volumeMounts.map(({ name }) => name).sort(), volumes);
            assert.equal(container.securityContext.readOnlyRootFilesystem, true);
            assert.deepEqual(container.securityContext.capabilities.drop, ['ALL']);
        }
    }
});

const unbuilt = skip || (missing().length > 0 && `not built: ${missing().join(', ')}`);
test('every option of the manifests is one that the daemon has, and they go together', { skip: unbuilt }, async () => {
    const help = runProgram('plantcastd', ['--help']).out;
    const [core, renderer] = bothPods(await read()).map(({ containers }) => containers[0]);
    for (const { args } of [core, renderer])
        for (const option of args.slice(1))
            assert.ok(help.includes(`${option.split('=')[0]} `), option);
    // Options are looked at before any file: what is wrong then is that this machine has no such plant.
    for (const { args } of [core, renderer])
        assert.match(runProgram('plantcastd', args.map((arg) => arg.replace('$(NODE)', 'r1'))).err, /plant\.yaml/);
    assert.match(core.args.join(' '), /--role=core /);
    const [, port] = renderer.args.join(' ').match(/--core=wss:\/\/plantcast-core:(\d+)/);
    assert.equal(Number(port), core.ports[0].containerPort);
});
