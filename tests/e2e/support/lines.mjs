// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';

// Returns the complete lines of a file. The last line may be incomplete while a program writes it.
export const linesOf = (path) => readFileSync(path, 'utf8').split('\n').slice(0, -1);
