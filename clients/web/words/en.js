// SPDX-License-Identifier: GPL-3.0-or-later
// What the page says at once, in English. [beginning] of keys, then key: text; {name} is put in, [X] is a key to press, (one) a plural.
export default `
none: none
novalue: no value
viewport: Plant, 3D view. Arrow keys turn, plus and minus zoom, W A S D move, F fits, question mark helps.
legend: Legend
card: Tag
place: Place
status: Status
timings: Measurements

[part]
failed: This part of the page could not be loaded. It comes by itself once the server is there.

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
ramp: Ramp
lines: Lines
look: Look
show: Show
views: Views, cut and equipment shown
picture: Picture: comparison, light, split view
history: History
fit: Fit to picture
home: Home view
help: Help
hold: Stop here: values stand still
go: Go on: live values
unrecorded: Nothing is recorded here: values cannot be stopped
more: More
measure: Measure a distance
snapshot: Save a picture
share: Share
theme: Dark or light
engineer: Engineer: sensors and field
import: Bring a plant in
account: Who you are

[show]
value: Values
operator: Limits
distance: Distance
difference: Difference

[look]
default: Measured
glossy: Glossy
flat: Flat
materials: Materials

[lines]
none: None
every: Every {step}
chosen: Chosen

[ramp]
smooth: Smooth
group: Own bands
limits: Limits
chosen: Chosen bands

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
nothing: Nothing has that name.
sensors(one): {count} sensor
sensors(other): {count} sensors
loose: Tags without equipment
about: About the selected equipment
worst: worst quality: {quality}

[viewport]
waiting: Waiting for the first picture

[legend]
right: Legend of the right half
colours: Colours from {min} to {max}
distance: Distance from {tag}
operator: By each tag’s own limits.
log: Logarithmic scale.
unsafe: These colours may be misread.
glossy: Glossy look: light changes the colours. Do not read values.
nolimits: No limits
nodata: No data
uncertain: Uncertain
drawn: Dots: error up to {off}.

[following]
own: Own view

[alarms]
title: Alarms
unheard: Alarms: nothing heard yet
none: No active alarms
some(one): {count} active alarm
some(other): {count} active alarms
zero: 0 active
waiting: {waiting} to be acknowledged
latched: {latched} to be reset
asof: As of {time}: {alarms}
gone: Priority {priority}, its cause has gone
now: Now: {alarms}
value: raised at {value}, now {now} (limit {limit})
priority: Priority {priority}

[kind]
HH: High high
H: High
L: Low
LL: Low low
BAD: Bad measurement
ALM: Alarm
LINK: Device gives no readings

[mode]
display: Shown here, acknowledged in the control system
mirror: As the control system has them
local: Local alarms of this site

[trends]
title: Trend

[time]
title: History

[status]
clock: Plant time
then: Then
unset: {clock}, unsynchronised
unset.why: Nothing keeps the server’s clock right: times may be wrong. Ages are not.
within: The server’s clock is kept right, within {n} ms.
leap: A leap second is added at the end of the month (UTC).
leap.less: A second is left out at the end of the month (UTC).
oldest: Oldest reading
frames: Frames
rate: {count}/s
still: still
latency: Latency
ms: {n} ms
config: Configuration
picture: Picture
retry: Try now

[health]
nothing: No data was recorded then
connecting: Connecting
live: Live
partly: Live, partly simulated
simulated: Simulated
down: {live}, {down} of {all} sources down
unmeasured: Not measured in the plant: {sources}.
nodata: No live data
nosensor: No sensor delivers values.
source: Source {source} does not answer.
sources: Sources {sources} do not answer.
past: History
returning: Returning to now
playing: {instant}, playing {speed}×
back: {instant}, playing back {speed}×
noanswer: No answer
silent: The server has been silent for {age}.
old: This picture is {age} old.
barred: Not let in
disconnected: Disconnected
because: {reason}.
retry: Trying again in {age}.
retrying: Trying again now.

[reason]
down: The server went down
version: This page and the server speak different versions
forbidden: Not allowed
long: A message was too long
full: The server is full
slow: This page was too slow
unreachable: The server cannot be reached
unanswered: The server does not answer
silent: The server fell silent
token_needed: A token is needed
bad_token: This token is not valid, or no longer
locked: Nobody was at this page for some time

[quality]
good: Good
uncertain: Uncertain
bad: Bad
unknown: Unknown

[simulated]
all: Simulated
partly: Partly simulated

[proof]
none: Unproven
assumed: Place assumed
`;
