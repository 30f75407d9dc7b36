// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { BIN, runProgram } from './tiny_plant.mjs';

// Writes a copy of the daemon with another version number into a folder. Returns { program, version, other }: its path, the
// real version, and the copy's version.
export function otherVersion(folder) {
    const { out } = runProgram('plantcastd', ['--version']), [, version] = /^plantcastd (\d\S*)/.exec(out);
    const program = join(folder, 'plantcastd'), other = version.replace(/\d$/, (digit) => String((Number(digit) + 5) % 10));
    const text = readFileSync(join(BIN, 'plantcastd'), 'latin1').replaceAll(`plantcastd ${version}`, `plantcastd ${other}`)
        .replaceAll(`version="${version}"`, `version="${other}"`);
    writeFileSync(program, text.replaceAll(`\0${version}\0`, `\0${other}\0`), { encoding: 'latin1', mode: 0o755 });
    return { program, version, other };
}
