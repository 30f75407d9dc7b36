// SPDX-License-Identifier: GPL-3.0-or-later
// What the server refuses, in English; loaded when it first does.
export default `
refused: The server refused: {text}
other: {text}
too_fast: too much was asked for at once: it is done a little later
limit: the picture is larger than this server draws
not_allowed: that is not allowed here
core_lost: the core cannot be reached: what was asked for was not done, or nobody knows; look again once it is back
role: that takes the role {role}
no: this plant has no {kind} “{name}”
blocked: The server answers over HTTP, but {proxy} does not pass the WebSocket on. {needs}
blocked_proxy: a proxy in between
blocked_lines: It needs {lines} in its location block
blocked_page: INSTALL.md, section “Behind a reverse proxy”, says what it needs
link: This link does not fit: {why}. It may be of another plant, or from before the plant was changed.
unknown: “{name}” is not known here
uncut: Paper cannot be drawn truly where {group} has one sensor ({count} of {all} assets, the first {asset}).
  The plant file may say “singles: cut” at that group.
far_uncut: distances cannot be drawn truly where {group} has one sensor, as on {asset}.
  The plant file may say “singles: cut” at that group.
elsewhere: alarms are another system’s here
anew: the plant is being loaded anew; try again
quiet: there is nothing to acknowledge
latched: it is not latched, or still there, or not acknowledged
otherwise: its state is another one by now
shelf: an alarm can be shelved for a week at most
tolerance: the value is beyond the tolerance
reading: the reading is not good
failed: said to have failed
disk: not saved: the server cannot write to its disk
disk_full: not saved: the server’s disk is full
disk_locked: not saved: the server’s disk is read-only
unkept: In force, but lost if the server restarts ({text})
unaudited: Done, but missing in the audit trail ({text})
fixed: this view is in the plant file, and is changed there
viewless: somebody has removed this view
digits: no display shows these digits
guesses: too many wrong digits; try again in a minute
deviceless: somebody has revoked this display
devices: there are as many displays as there may be
views: there are as many views as there may be: remove one first
computed: {tag} is computed from other tags: prove those
far: {tag}: that place is too far from {asset}
groupless: {tag} belongs to no group: the tag list has to name one
busy: another list is being put in force
unmoved: no sensor has been moved
unread: the tag list could not be read when the plant was loaded
locked: the daemon may not write into the folder of the tag list ({file})
changed: {file} was changed by somebody else meanwhile
kept: {count} comparisons are kept already: remove one first
lines: a step of {step} makes more than {count} lines
numbers: at most {count} numbers, each larger than the one before
log: a logarithmic scale needs a range above 0
range: the range has to begin below its end
between: a number of {span} is expected
placeless: that sensor has no place in this quantity
narrow: the picture is too narrow for two halves
memory: the server is short of memory; the last picture stays
gone: session {session} is not connected any more
coreless: history is kept by the core, which cannot be reached; try again
history: nothing is recorded here, or it cannot be read

[role]
operator: operator
engineer: engineer

[kind]
group: quantity
asset: equipment
tag: tag
`;
