// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the page needs immediately, in English. [section] prefixes the keys below it, then key: text. {name} is replaced,
// [X] is a key to press, (one) is a plural form.
export default `
none: none
novalue: no value
viewport: Plant, 3D view. Arrow keys turn, plus and minus zoom, W A S D move, F fits the view, question mark opens help.
legend: Legend
card: Tag
place: Location
status: Status
timings: Performance

[part]
failed: This part of the page could not be loaded. It loads once the server responds.

[age]
s: {n} s
min: {n} min
h: {n} h
d: {n} d

[bar]
equipment: Equipment list
quantity: Quantity
display: Display settings
colours: Colours
ramp: Colour steps
lines: Contour lines
look: Shading
show: Show
views: Views, section, visible equipment
picture: Picture: comparison, light
split: Split view
history: History
fit: Fit to picture
home: Home view
help: Help
hold: Freeze values
go: Resume live values
unrecorded: No history is recorded, so values cannot be frozen
more: More
measure: Measure a distance
snapshot: Save a picture
share: Share
theme: Switch theme
engineer: Engineering: sensors and field
import: Import a plant
account: Account

[show]
value: Values
operator: Limits
distance: Distance
difference: Difference

[look]
default: True colours
glossy: Glossy
flat: Unshaded
materials: Materials

[lines]
none: None
every: Every {step}
chosen: Custom

[ramp]
smooth: Smooth
group: Default bands
limits: Group limits
chosen: Custom bands

[quantity]
temperature: Temperature
pressure: Pressure
vibration: Vibration
vibration velocity: Vibration velocity
flow: Flow
level: Level
gas: Gas

[picture]
title: Picture

[views]
title: Views

[assets]
title: Equipment
close: Close equipment list
search: Search equipment and tags
nothing: No match.
sensors(one): {count} sensor
sensors(other): {count} sensors
loose: Unassigned tags
about: About the selected equipment
worst: worst quality: {quality}

[viewport]
waiting: Waiting for the first picture

[legend]
right: Legend, right side
colours: Colours from {min} to {max}
distance: Distance from {tag}
operator: By each tag’s limits.
log: Logarithmic scale.
unsafe: This colour map can be misread.
glossy: Glossy: light alters the colours. Do not read values.
nolimits: No limits
nodata: No data
uncertain: Uncertain
drawn: Dots: error up to {off}.

[following]
own: Stop following

[alarms]
title: Alarms
unheard: Alarms: waiting for data
none: No active alarms
some(one): {count} active alarm
some(other): {count} active alarms
zero: 0 active
waiting: {waiting} unacknowledged
latched: {latched} to reset
asof: As of {time}: {alarms}
gone: Priority {priority}, returned to normal
now: Now: {alarms}
value: raised at {value}{now} (limit {limit})
present: now {now}
since: held since {time}
priority: Priority {priority}

[kind]
HH: High-high
H: High
L: Low
LL: Low-low
BAD: Bad quality
ALM: Alarm
LINK: No communication with device

[mode]
display: View only: acknowledge in the control system
mirror: Mirrored from the control system
local: Plantcast alarms

[trends]
title: Trend

[time]
title: History

[status]
clock: Plant time
then: Time shown
unset: {clock}, unsynchronised
unset.why: The server clock is not synchronised: times may be wrong; data ages are still correct.
within: Server clock synchronised to within {n} ms.
leap: A leap second is added at the end of the month (UTC).
leap.less: A leap second is removed at the end of the month (UTC).
oldest: Oldest reading
frames: Frames
rate: {count}/s
still: idle
latency: Latency
ms: {n} ms
behind: {n} s behind
config: Configuration
picture: Picture
retry: Try now

[health]
nothing: No data recorded at that time
connecting: Connecting
live: Live
partly: Live, partly simulated
simulated: Simulated
down: {live}, {down} of {all} sources down
unmeasured: Simulated values from: {sources}.
nodata: No live data
nosensor: No sensor delivers values.
source: Source {source} does not answer.
sources: Sources {sources} do not answer.
past: History
returning: Returning to live
playing: {instant}, playing {speed}×
back: {instant}, playing backwards {speed}×
noanswer: No answer
silent: No response from the server for {age}.
old: This picture is {age} old.
barred: Access denied
disconnected: Disconnected
because: {reason}.
retry: Trying again in {age}.
retrying: Trying again now.

[reason]
down: The server shut down
version: This page and the server have different versions
forbidden: Not allowed
long: A message was too long
full: The server has reached its limit
slow: This browser could not keep up
unreachable: The server cannot be reached
unanswered: The server does not answer
silent: The server stopped responding
token_needed: A token is required
bad_token: The token is invalid or expired
locked: Locked after inactivity

[quality]
good: Good
uncertain: Uncertain
bad: Bad
unknown: Unknown

[simulated]
all: Simulated
partly: Partly simulated

[proof]
none: Not loop-checked
assumed: Location assumed
`;
