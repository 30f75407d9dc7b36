// SPDX-License-Identifier: GPL-3.0-or-later
// A fake OPC UA server for testing the client: it sends hand-made wrong messages, or relays a real server's messages with
// altered numbers.
import { connect, createServer } from 'node:net';

const u32 = (number) => { const bytes = Buffer.alloc(4); bytes.writeUInt32LE(number >>> 0); return bytes; };
// Builds an OPC UA message: a type of three letters, "F", the message's size, and the body. size: the size to state, if it
// shall be wrong.
const message = (type, body, size = 8 + body.length) => Buffer.concat([Buffer.from(`${type}F`), u32(size), body]);
const ACK = message('ACK', Buffer.concat([0, 65536, 65536, 0, 0].map(u32)));
const POLICY = Buffer.from('http://opcfoundation.org/UA/SecurityPolicy#None');
const OPN = Buffer.concat([u32(1), u32(POLICY.length), POLICY, u32(-1), u32(-1), u32(1), u32(1)]);

const TOO_LARGE = [0x7fffffff, 0xffffffff, 0x00ffffff, 0x80000000];

// Wrong answers to the first message of a client, by description; each is a list of buffers that are sent one after another.
export const LIES = {
    'no protocol at all': [Buffer.from('HTTP/1.1 400 Bad Request\r\n\r\n')],
    'sizes of nothing': [message('ACK', Buffer.concat([0, 0, 0, 0, 0].map(u32)))],
    'a message longer than the memory': [ACK, message('MSG', Buffer.alloc(100), 0xfffffff0)],
    'a message shorter than its head': [ACK, message('OPN', Buffer.alloc(100), 3)],
    'a text of 2 GB in an error': [message('ERR', Buffer.concat([u32(0x80010000), u32(0x7fffffff)]))],
    'a policy of 2 GB': [ACK, message('OPN', Buffer.concat([u32(1), u32(0x7fffffff), Buffer.alloc(50)]))],
    'an answer that is none': [ACK, message('OPN', Buffer.concat([OPN, Buffer.alloc(200, 0xff)]))],
    'chunks without an end': [ACK, ...Array(2000).fill(Buffer.concat([Buffer.from('MSGC'), u32(8192), Buffer.alloc(8184, 1)]))],
};

const end = (listener, sockets) => new Promise((done) => { sockets.forEach((socket) => socket.destroy()); listener.close(done); });

// Listens on the port, and answers the first data of each connection with the buffers `lies`. Returns { stop, left(): number of
// connections that sent data and that the client has closed }.
export async function tellLies(port, lies) {
    let left = 0;
    const sockets = new Set();
    const listener = createServer((socket) => {
        sockets.add(socket);
        socket.on('error', () => {});
        socket.once('data', () => {
            socket.on('close', () => left++);
            lies.forEach((bytes) => socket.write(bytes));
        });
    });
    await new Promise((done) => listener.listen(port, '127.0.0.1', done));
    return { left: () => left, stop: () => end(listener, sockets) };
}

// Relays connections to the server at port `to`. Passes on the server's first `spared` bytes unchanged, and then puts a far too
// large number into each of its messages.
export async function distort(port, to, spared) {
    let distorted = 0;
    const sockets = new Set();
    const listener = createServer((socket) => {
        const server = connect(to, '127.0.0.1');
        let passed = 0;
        for (const one of [socket, server]) {
            sockets.add(one);
            one.on('error', () => {});
        }
        socket.pipe(server);
        server.on('data', (bytes) => {
            passed += bytes.length;
            if (passed > spared && bytes.length > 40) {
                const at = 24 + (distorted * 7) % (bytes.length - 32);
                bytes.writeUInt32LE(TOO_LARGE[distorted++ % TOO_LARGE.length], at);
            }
            socket.write(bytes);
        });
        socket.on('close', () => server.destroy());
        server.on('close', () => socket.destroy());
    });
    await new Promise((done) => listener.listen(port, '127.0.0.1', done));
    return { seen: () => distorted, stop: () => end(listener, sockets) };
}
