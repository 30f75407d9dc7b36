// SPDX-License-Identifier: GPL-3.0-or-later
// Refusals, in English. The first part is the server's too: by code, with the arguments of PROTOCOL.md.
export default `
role_operator: that takes the role operator
role_engineer: that takes the role engineer
no_group: this plant has no quantity “{name}”
no_asset: this plant has no equipment “{name}”
no_tag: this plant has no tag “{name}”
no_device: this plant has no device “{name}”
unknown: “{name}” is not known here
uncut: Paper cannot be drawn truly where {group} has one sensor ({count} of {all} assets, the first {asset}).
  The plant file may say “singles: cut” at that group.
far_uncut: distances cannot be drawn truly where {group} has one sensor, as on {asset}.
  The plant file may say “singles: cut” at that group.
assumed: nobody has said where on {asset} this sensor is: it has no distances
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
disk_slow: not saved: the server’s disk does not answer
kept_unread: not saved: the server cannot read the file with the earlier entries; its log says why
not_utf8: not saved: the text is not UTF-8
fixed: this view is in the plant file, and is changed there
viewless: somebody has removed this view
digits: no display shows these digits
guesses: too many wrong digits; try again in a minute
deviceless: somebody has revoked this display
devices: there are as many displays as there may be
views: there are as many views as there may be: remove one first
notes: there are as many notes as there may be: remove one first
note_ended: the note would have ended already
noteless: somebody has removed this note
computed: {tag} is computed from other tags: prove those
far: {tag}: that place is too far from {asset}
groupless: {tag} belongs to no group: the tag list has to name one
twice: {tag} is moved twice
busy: another list is being put in force
unmoved: no sensor has been moved
unread: the tag list could not be read when the plant was loaded
unread_file: {file} cannot be read: {error}
unwritten: {file} cannot be written: {error}
no_tag_column: the tag list has no column “Tag Name”
unlisted: {tag} is not in the tag list
folder_locked: the daemon may not write into the folder of the tag list ({file})
changed: {file} was changed by somebody else meanwhile
kept: {count} comparisons are kept already: remove one first
lines: a step of {step} makes more than {count} lines
numbers: at most {count} numbers, each larger than the one before
log: a logarithmic scale needs a range above 0
range: the range has to begin below its end
between: a number from {low} to {high} is expected
placeless: that sensor has no place in this quantity
narrow: the picture is too narrow for two halves
memory: the server is short of memory; the last picture stays
gone: session {session} is not connected any more
coreless: history is kept by the core, which cannot be reached; try again
unrecorded: nothing is recorded here (history: record: no)
unreadable: history cannot be read; the server’s log says why

[class]
too_fast: too much was asked for at once: it is done a little later
limit: the picture is larger than this server draws
not_allowed: that is not allowed here
core_lost: the core cannot be reached: what was asked for was not done, or nobody knows; look again once it is back

[page]
refused: The server refused: {text}
other: {text}
blocked: The server answers over HTTP, but {proxy} does not pass the WebSocket on. {needs}
blocked_proxy: a proxy in between
blocked_lines: It needs {lines} in its location block
blocked_page: INSTALL.md, section “Behind a reverse proxy”, says what it needs
link: This link does not fit: {why}. It may be of another plant, or from before the plant was changed.
unkept: In force, but lost if the server restarts ({text})
unaudited: Done, but missing in the audit trail ({text})
`;
