// SPDX-License-Identifier: GPL-3.0-or-later
// A node-opcua server in its own process, which tests can kill. Commands are lines of JSON on its standard input: `serve`
// restarts serving with the given settings (OpcuaServer in opcua.mjs); `set` sets a node. It counts requests that clients must
// not make.
import certificateManager from 'node-opcua-certificate-manager';
import dateTime from 'node-opcua-date-time';
import opcua from 'node-opcua-server';
import statusCode from 'node-opcua-status-code';
import variant from 'node-opcua-variant';
import { createInterface } from 'node:readline';
import { setTimeout as sleep } from 'node:timers/promises';

const { StatusCodes, coerceStatusCode } = statusCode;
const { DataType, Variant, VariantArrayType } = variant;
const PUBLISHING_MS = opcua.Subscription.minimumPublishingInterval;
const COUNTED = { _on_WriteRequest: 'write', _on_CallRequest: 'call' };
let server, told, nodes, counts;
// node-opcua computes its time from the clock, which it reads only rarely. The test may have set the clock, so this interval
// (ms) makes it read the clock often.
const { periodicClockAdjustment: looks } = dateTime;
looks.interval = 50;
dateTime.installPeriodicClockAdjustment();

async function serve(settings) {
    await server?.shutdown(0);
    for (const before = looks.adjustmentCount; looks.adjustmentCount === before;)
        await sleep(10);
    told = settings;
    opcua.Subscription.minimumPublishingInterval = told.publishing_ms ?? PUBLISHING_MS;
    const managers = ['pki', 'users'].map((name) => new certificateManager.OPCUACertificateManager({
        rootFolder: `${told.folder}/${name}`, automaticallyAcceptUnknownCertificate: told.trustsAll !== false }));
    for (const manager of managers)
        await manager.initialize();
    server = new opcua.OPCUAServer({
        port: told.port, hostname: 'localhost', alternateHostname: ['127.0.0.1'],
        allowAnonymous: told.anonymous !== false, disableDiscovery: false, maxConnectionsPerEndpoint: told.connections ?? 20,
        certificateFile: `${told.folder}/${told.certificate ?? 'server'}.crt`,
        privateKeyFile: `${told.folder}/${told.certificate ?? 'server'}.key`,
        serverCertificateManager: managers[0], userCertificateManager: managers[1],
        userManager: { isValidUser: (name, password) => name === 'reader' && password === 'said & done' },
        serverInfo: { applicationUri: 'urn:test:server' },
        serverCapabilities: { maxSessions: told.sessions ?? 10, operationLimits: {
            maxMonitoredItemsPerCall: told.itemsPerCall ?? 200, maxNodesPerRead: told.readsPerCall ?? 0 } },
    });
    await server.initialize();
    addNodes();
    counts = { write: 0, call: 0 };
    for (const [service, name] of Object.entries(COUNTED)) {
        const before = server[service];
        server[service] = function (...args) { counts[name]++; return before.apply(this, args); };
    }
    await server.start();
}

function addNodes() {
    const space = server.engine.addressSpace;
    for (let i = 0; i < (told.shifted ?? 0); i++)
        space.registerNamespace(`urn:test:other:${i}`);
    const own = space.registerNamespace('urn:test:plant;1');
    const folder = own.addFolder(space.rootFolder.objects, { browseName: 'Plant' });
    nodes = {};
    const add = (name, dataType, value, more = {}) => {
        const { arrayType, ...others } = more;
        const node = own.addVariable({ componentOf: folder, browseName: name, nodeId: `s=${name}`, dataType, minimumSamplingInterval: 50,
            ...others, value: { dataType, arrayType, value } });
        nodes[name] = { dataType, arrayType, first: value, node };
    };
    add('TI-1', 'Double', 20);
    add('TI-2', 'Float', 21.5);
    add('PI-1', 'UInt16', 13824);
    add('XS-1', 'Boolean', true);
    add('Row[3]', 'Int32', 7);
    add('Text', 'String', 'warm');
    add('Temps', 'Double', new Float64Array([1, 2, 3]), { arrayType: VariantArrayType.Array, valueRank: 1, arrayDimensions: [3] });
    const bounded = own.addAnalogDataItem({ componentOf: folder, browseName: 'Bounded', nodeId: 's=Bounded', dataType: 'Double',
        engineeringUnitsRange: { low: 0, high: 100 }, description: 'of 0 to 100 °C', minimumSamplingInterval: 50 });
    bounded.setValueFromSource(new Variant({ dataType: DataType.Double, value: 50 }));
    nodes.Bounded = { dataType: 'Double', first: 50, node: bounded };
    for (let i = 0; i < (told.many ?? 0); i++)
        add(`N${i}`, 'Double', i);
}

function set({ name, value, status = 0, at }) {
    const { node, dataType, arrayType } = nodes[name];
    const list = Array.isArray(value) ? new Float64Array(value) : value;
    node.setValueFromSource(new Variant({ dataType: DataType[dataType], arrayType, value: list }),
        status ? coerceStatusCode(status) : StatusCodes.Good, at ? new Date(at) : undefined);
}

// Adds a namespace and a node in it while clients are connected.
function addLate() {
    const space = server.engine.addressSpace, late = space.registerNamespace('urn:test:late');
    late.addVariable({ organizedBy: space.rootFolder.objects, browseName: 'Late', nodeId: 's=Late', dataType: 'Double',
        minimumSamplingInterval: 50, value: { dataType: 'Double', value: 7 } });
}

// Loses the next notification of a subscription: skips its sequence number, which the client must notice.
function lose() {
    const { prototype } = opcua.Subscription, send = prototype._publish_pending_notifications;
    prototype._publish_pending_notifications = function () {
        prototype._publish_pending_notifications = send;
        this._popNotificationToSend();
        this._get_next_sequence_number();
    };
}

for await (const line of createInterface({ input: process.stdin })) {
    const order = JSON.parse(line);
    if (order.serve)
        await serve(order.serve);
    else if (order.each !== undefined)
        for (let i = 0; i < told.many; i++)
            set({ name: `N${i}`, value: order.each + i });
    else if (order.lose)
        lose();
    else if (order.addLate)
        addLate();
    else if (order.set)
        set(order.set);
    else if (order.reset) {
        for (const [name, { first }] of Object.entries(nodes))
            set({ name, value: first });
        counts.write = counts.call = 0;
    }
    console.log(JSON.stringify({ done: true, sessions: server.currentSessionCount, ...counts }));
}
