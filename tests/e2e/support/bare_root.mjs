// SPDX-License-Identifier: GPL-3.0-or-later
// A root folder of its own, like a host that has only the programs: read-only /usr of this machine and the build, and an empty
// /etc and /var.
import { spawnSync } from 'node:child_process';
import { chmodSync, cpSync, existsSync, mkdirSync, mkdtempSync, symlinkSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { BIN } from './tiny_plant.mjs';

const TOP = resolve('.'), NEEDED = ['unshare', 'chroot', 'setpriv'];

// Returns why a bare root is impossible on this machine, or null.
export function missingBareRoot() {
    if (process.getuid() !== 0)
        return 'a bare root needs root';
    const { status } = spawnSync('unshare', ['--mount', '--pid', '--fork', 'mount', '-t', 'tmpfs', 'none', '/mnt']);
    const absent = NEEDED.find((program) => spawnSync('which', [program]).status !== 0);
    return absent ? `no ${absent}` : status === 0 ? null : 'no mount namespaces here';
}

export class BareRoot {
    constructor(folder) {
        this.folder = mkdtempSync(join(folder, 'root-'));
        chmodSync(this.folder, 0o755);
        for (const path of ['usr', 'etc', 'var/lib', 'var/tmp', 'var/backups', 'tmp', 'proc', 'dev', 'run', 'root/.ssh', TOP, BIN])
            mkdirSync(join(this.folder, path), { recursive: true });
        for (const name of ['bin', 'sbin', 'lib', 'lib64'])
            symlinkSync(`usr/${name}`, join(this.folder, name));
        for (const name of ['fonts', 'ssl', 'alternatives', 'ld.so.cache', 'ld.so.conf', 'ld.so.conf.d'])
            if (existsSync(join('/etc', name)))
                cpSync(join('/etc', name), join(this.folder, 'etc', name), { recursive: true, verbatimSymlinks: true });
        this.write('/etc/passwd', 'root:x:0:0:root:/root:/bin/sh\n');
        this.write('/etc/group', 'root:x:0:\n');
        this.write('/etc/nsswitch.conf', 'passwd: files\ngroup: files\nhosts: files\n');
        this.write('/etc/hosts', '127.0.0.1 localhost\n');
    }

    path(name) { return join(this.folder, name); }

    write(name, text, mode = 0o644) {
        mkdirSync(dirname(this.path(name)), { recursive: true });
        writeFileSync(this.path(name), text, { mode });
    }

    // Returns [program, arguments] that run a shell command as root within this root folder. When that command ends, all
    // programs that it started are killed.
    line(command) {
        const binds = [['/usr', 'usr'], [TOP, TOP], [BIN, BIN], ['/dev', 'dev'], ['/proc', 'proc']]
            .map(([from, to]) => `mount --rbind ${from} ${join(this.folder, to)}`).join(' && ');
        return ['unshare', ['--mount', '--pid', '--fork', '--kill-child', 'sh', '-c',
            `${binds} && mount -t proc proc ${this.path('proc')} && cd / && exec chroot ${this.folder} /usr/bin/env -i ` +
            `PATH=${BIN}:/usr/sbin:/usr/bin HOME=/root LC_ALL=C.UTF-8 /bin/sh -euc "$1"`, 'sh', command]];
    }

    // Runs a shell command within this root folder. Returns { code, out, err }.
    run(command, timeout = 120000) {
        const [program, args] = this.line(command);
        const { status, stdout, stderr } = spawnSync(program, args, { encoding: 'utf8', timeout });
        return { code: status, out: stdout, err: stderr };
    }
}
