// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals, in English. Keys before the first [section] are codes of the server, with the arguments of PROTOCOL.md.
export default `
role_operator: this needs the role operator
role_engineer: this needs the role engineer
no_group: this plant has no quantity “{name}”
no_asset: this plant has no equipment “{name}”
no_tag: this plant has no tag “{name}”
no_device: this plant has no device “{name}”
no_view: this plant has no view “{name}”
unknown: “{name}” is unknown here
uncut: “paper” cannot be drawn accurately where {group} has one sensor ({count} of {all} assets, the first {asset}). The plant file
  may say “singles: cut” at that group.
far_uncut: distances cannot be drawn accurately where {group} has one sensor, as on {asset}.
  The plant file may say “singles: cut” at that group.
assumed: the location of this sensor on {asset} is not given, so it has no distances
elsewhere: alarms are managed by another system
anew: the plant is reloading; try again
quiet: there is nothing to acknowledge
latched: it is not latched, still active, or not acknowledged
otherwise: its state has changed meanwhile
shelf: an alarm can be shelved for at most a week
tolerance: the value is beyond the tolerance
reading: the reading is not good
failed: you reported it as failed
disk: not saved: the server cannot write to its disk
disk_full: not saved: the server’s disk is full
disk_locked: not saved: the server’s disk is read-only
disk_slow: not saved: the server’s disk does not answer
kept_unread: not saved: the server cannot read the file with the earlier entries; its log says why
not_utf8: not saved: the text is not UTF-8
fixed: this view comes from the plant file: change it there
viewless: this view was removed by someone else
digits: no display shows this code
guesses: too many wrong codes; try again in a minute
deviceless: no display of this name is paired any more
devices: the limit of displays is reached
views: the limit of views is reached: remove one first
notes: the limit of notes is reached: remove one first
note_ended: the end of the note is already past
noteless: this note was removed by someone else, or has expired
note_others: only its author can change this note
computed: {tag} is computed from other tags: loop-check those
far: {tag}: this location is too far from {asset}
groupless: {tag} belongs to no group; name one in the tag list
twice: {tag} is moved twice
busy: another list is being applied
unmoved: no sensor has been moved
unread: the tag list could not be read when the plant was loaded
unread_file: {file} cannot be read: {error}
unwritten: {file} cannot be written: {error}
no_tag_column: the tag list has no column “Tag Name”
unlisted: {tag} is not in the tag list
folder_locked: the daemon may not write into the folder of the tag list ({file})
changed: {file} was changed by someone else meanwhile
kept: {count} comparisons are saved already: remove one first
lines: a step of {step} makes more than {count} lines
numbers: at most {count} numbers, each larger than the one before
log: a logarithmic scale needs a range above 0
range: the range must begin below its end
between: a number from {low} to {high} is expected
placeless: this sensor has no location in this quantity
narrow: the picture is too narrow to split
memory: the server is short of memory; the last picture stays
gone: this user is no longer connected
linkless: this short link is unknown or no longer stored: ask for a new one
coreless: history is unavailable: the core cannot be reached; try again
unrecorded: no history is recorded (history: record: no)
unreadable: history cannot be read; the server’s log says why

[class]
too_fast: too many requests: yours is delayed
limit: the picture is larger than this server draws
not_allowed: not allowed here
core_lost: the core cannot be reached: the action may not have been carried out; check once it is back

[page]
refused: The server refused: {text}
other: {text}
blocked: The server answers over HTTP, but {proxy} does not pass the WebSocket on. {needs}
blocked_proxy: a proxy in between
blocked_lines: It needs {lines} in its location block
blocked_page: PROXY.md, section “WebSocket”, says what it needs
link: This link does not fit: {why}. It may be for another plant, or older than a change of the plant.
unkept: Applied, but lost if the server restarts ({text})
unaudited: Done, but missing in the audit trail ({text})
`;
