// SPDX-License-Identifier: GPL-3.0-or-later
// Texts for the server's refusals, in English. Keys before the first [section] are the server's refusal codes, with the
// arguments of PROTOCOL.md.
export default `
role_operator: this needs the role operator
role_engineer: this needs the role engineer
no_group: this plant has no quantity “{name}”
no_asset: this plant has no equipment “{name}”
no_tag: this plant has no tag “{name}”
no_device: this plant has no device “{name}”
no_view: this plant has no view “{name}”
unknown: “{name}” is unknown here
uncut: “paper” (Kim & Suh) cannot be drawn accurately where {group} has one sensor ({count} of {all} assets, the first
  {asset}). Set “singles: cut” for that group in the plant file.
far_uncut: distances cannot be drawn accurately where {group} has one sensor, as on {asset}. Set “singles: cut” for that
  group in the plant file.
assumed: the location of this sensor on {asset} is not given, so it has no distances
elsewhere: alarms are managed by another system
anew: the plant is reloading; try again
quiet: there is nothing to acknowledge
latched: only an acknowledged, latched alarm that is no longer active can be reset
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
note_others: only its author, {author}, can change this note
note_not_own: only its author, {author}, or an engineer can end this note
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
log: a logarithmic scale needs a range that begins at 1e-18 or above
range: the end of the range must exceed its beginning by 1e-18 or more, and by a millionth of the larger absolute value or more
between: a number from {low} to {high} is expected
placeless: this sensor has no location for this quantity
narrow: the picture is too narrow to split
memory: the server is short of memory; the last picture stays
gone: this user is no longer connected
linkless: this short link is unknown or no longer stored: ask for a new one
links_often: too many short links were made; try again in a minute
coreless: unavailable: the core cannot be reached; try again
unrecorded: no history is recorded (history: record: no)
core_checks: only the core records loop checks: open the page of the core
unreadable: history cannot be read; the server’s log says why
token_needed: a token is needed: sign in, or send Authorization: Bearer TOKEN
token_unknown: this token is unknown or has expired
token_ended: this token has expired or was revoked
signed_out: you are signed out
token_guesses: too many wrong tokens came from this address; try again in 5 s
token_node: this token belongs to a daemon (role renderer or standby), not to a user
token_views: “{name}” is not allowed: this token is for the views {views}
token_display: this token belongs to display {display} of wall {wall}
views_only: this token is valid only for pictures of some views
display_only: this device’s token is valid only for its display of a wall
pictures_only: without a user’s token, only pictures are available
foreign: the request comes from a page of another site
connections: this address has reached its limit of connections; try again later
locked: no input at this page for {minutes} min
pixels: all views together have reached this server’s limit of pixels; try later, or a smaller picture
pixels_address: the views of this address have reached its limit of pixels; try a smaller picture
pixels_view: this server draws at most {count} pixels for one view
movers: one more moving view would make all of them too slow; try later
late: readings are already drawn late; try later
tile_token: this needs the token of display {display} of wall {wall}, or the role engineer
tileless: display {display} of wall {wall} is not one of its tiles
display_token: a wall’s display needs a token
unpaired: displays need no token here
signed_token: signed frames contain readings: they need a token
signed_display: frames of displays, and frames for tokens that are valid for some views, are not signed
signed_key: this server has no key to sign with (plantcastd --signing-key)
unsigned: the server could not sign a frame
unsigned_trial: sensors are tried out at other places
unsigned_baseline: the baseline has no name
unsigned_long: the view has more arguments than fit
overrides: at most {count} sensors may be overridden at a time
breakless: the plant file has no “{key}” for {group}
name_expected: a name of 1 to {bytes} bytes is expected, without control characters, other than “now”
text_expected: a text of {least} to {bytes} bytes is expected, without control characters
pattern: at most four * are allowed, and no [
instants: the first instant must be before the second
importing: another import is running; wait for its end, or cancel it
import_values: units and mesh_units are m, mm, cm, in or ft; up is y or z; encoding is a name such as GB18030; what is tags,
  anew or absent
import_device: host is a name or an IPv4 address, port 1 to 65535, unit 0 to 255, order ABCD, CDAB, BADC or DCBA, base 0 or 1
fileless: no uploaded file has this name
file_name: this file name is not allowed: use at most 200 bytes, no slash, no control character and no dot in front
file_empty: the file is empty
file_length: the header Content-Length is missing
file_large: the file is larger than 2 GB
files: at most 64 files can be uploaded; remove some
files_large: all files together would be larger than 8 GB
uploads: four uploads are running; wait until one is complete
upload_slow: the upload is too slow: less than 10 kB/s
upload_cut: the upload ended before the file was complete

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
