// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the fleet page, in English.
export default `
answer: {count} of {all} plants answer
only: Only what needs attention
stale: No update since {time}
none: No alarms
priority: Priority {priority}
since: No answer since {time}
never: No answer yet
first: First request sent
links: Data sources
down: {down} of {all} down
up: {all} up
version: Version
certificate: Certificate
disk: Free disk
backup: Last backup
unknown: unknown
off: none
recorded: Recording
broken: not writable
works: works
refused: the plant file has errors
configuration: Configuration
expired: expired
acknowledge: {count} unacknowledged
`;
