// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of parts of the page that are loaded on first use, in English.
export default `
accept: Accept assumed locations
close: Close
cancel: Cancel
sun: from {wind}, {height}° elevation

[distance]
metres: {metres} m
geodesic: Geodesic
geodesic.why: Distance along the surface: heat does not jump across gaps
euclidean: Euclidean
euclidean.why: Straight-line distance through space
heat: Heat method
heat.why: As in Kim & Suh 2025, on sampled points of the surface, for comparison: 0.5 % off, and passes through thin
  walls

[interpolation]
shepard: Shepard
shepard.why: Inverse distance weighting: equals the reading at each sensor
paper: Kim & Suh
paper.why: Algorithm 1 of Kim & Suh 2025: smoother, but differs from the readings at the sensors
harmonic: Conduction
harmonic.why: Steady heat conduction along the wall between sensors. Not valid where a fluid or air carries heat away,
  nor for pressure or flow
fin: Conduction, heat loss
fin.why: As conduction, but the wall loses heat to the air; no value where sensors contribute less than a tenth. Not
  valid for insulated or heated walls
gp: Most probable
gp.why: Gaussian process: the most probable field, with its uncertainty. Not valid where unrelated parts touch

[bar]
distance: Distance
interpolation: Interpolation

[neighbours]
say: Neighbours suggest
above: {predicted}; reads {by} higher
below: {predicted}; reads {by} lower
title: Largest deviations from neighbours
why: Compares each reading with what the other sensors of the equipment suggest. Not valid where a sensor is meant to
  differ, as at an inlet.

[drift]
week: Drift over a week
found: {by}: drifts
none: {by}: no drift detected
unknown: {by}: cannot be determined
why: Change of the reading against its neighbours, from hourly means. Not valid if the process itself changed the
  differences.

[coverage]
since: since {when}
title: Sensor coverage
none: Off
uncertainty: Uncertainty
uncertainty.note: Standard deviation, computed from the sensors that are good now.
uncertainty.why: Possible error of the field, if values vary over the surface as the Gaussian process assumes. Not
  reliable where the range of its kernel is a guess.
blind: Blind spots
blind.of: Detectable hot spot: {name}
blind.note: Weakest hot spot of {size} m that moves the nearest sensor by 5 % of the range.
blind.why: How hot a small spot must get before any sensor shows it. Not valid for other shapes, nor where heat takes
  other paths.

[picture]
from: Distance from
tag: Tag
difference: Difference from
kept: Saved readings
now: Current readings
name: Name for current readings
keep: Save readings
scale: Scale
fill: Areas without data
light: Light: sun {where}
turn: Azimuth
turn.why: Azimuth of the sun, degrees from north
height: Elevation
height.why: Elevation of the sun, degrees
around: Backdrop
around.why: Backdrop

[arrows]
title: Directions
arrows: Arrows
arrows.why: The length shows the value. Interpolated from sensors: not valid between surfaces, and not a computed flow.
strokes: Streaks
strokes.why: Animated streaks: faster where the value is larger. Interpolated from sensors: they are not the paths of a
  fluid.
none: None
none.why: Directions are not drawn; colours show the value alone.
unknown: Direction unknown

[scale]
linear: Linear
log: Logarithmic

[fill]
none: Hatched
none.why: No value is shown where no good sensor reaches
neighbours: From neighbours
neighbours.why: Filled with values from the surroundings, and dotted

[split]
right: What the right half shows
end: End split view

[environment]
sky: Sky

[wind]
N: N
NE: NE
E: E
SE: SE
S: S
SW: SW
W: W
NW: NW

[walls]
untrended: Waiting for the values of {tags}
untagged: no such tag
failed: Error: this pane is out of date
unknown: The plant file has no wall '{id}'. Its walls: {known}
display: Wall '{id}' has {count} displays, but no display {n}
lost: No connection to the plant since {time}
never: No connection to the plant
self: Display {display} of {wall}, waiting since {time}
denied: This display needs its own token
digits: To pair this display, an engineer enters this code under Views
asks: Requesting a pairing code from the server
left: Code expires in {time}
place: Display {display} of {wall}
crowded: Too many displays are waiting to pair; retrying
nowhere: The plant file has no display {display} on wall '{wall}'
token: Token
enter: Enter
held: held by {who} since {time}
sent: sent by {who}, {time}
age: data {age} old
since: since {time}
many(one): {worst}, {count} alarm
many(other): {worst}, {count} alarms
more(one): and {count} more
more(other): and {count} more
counts: {active} active, {waiting} unacknowledged
flood: Alarm flood: {active} active, {waiting} unacknowledged
late: The connection to this display is too slow; not updated since {time}
missing: Display {displays} not connected

[others]
gone: No picture from {name} since {time}
waiting: Waiting for its server
unreachable: Its server does not answer
tls: Its server's certificate is not trusted
token: The token file for its server cannot be read
refused: Its server rejects the token
busy: Its server is overloaded
slow: Its server answers too slowly
large: Its server sends too much data
no_picture: Its server sends no picture
unheard: No information from this plant's server

[notes]
legend: Notes
text: Shift note
at: Attach to
until: Visible until
save: Add note
place: this location
ends: until {time}
handover: Shift handover
plant: The whole plant
edit: Change
end: End
change: Save change

[until]
shift: 8 hours
day: 1 day
week: 1 week
ever: until removed

[remote]
legend: Wall
pane: Wall pane
desk: Desk name
where: {wall} {display}: {area}
send: Send this view
hold: Hold
back: Release
point: Show my pointer on the wall
there: connected
gone: this display is not connected
sent: {title}, sent by {who}, {time}
held: held by {who}, {time}
unread: Walls could not be read: {why}

[devices]
legend: Displays
digits: Pairing code
pair: Pair
revoke: Revoke
is: Display {display} of {wall}, address {from}, paired by {who}, {time}
unread: Displays could not be read: {why}

[handover]
title: Shift handover, {plant}
last: Last
hours: {n} hours
print: Print or save as PDF
notes: Notes
standing: Active or unacknowledged
active: Active now
waiting: Unacknowledged now
about: Description
value: Value (limit)
asides: Shelved or suppressed now
raised: Alarms raised
acknowledged: Acknowledged
shelved: Shelved or out of service
time: Time
where: Where
what: Note
who: Who
until: Until
alarm: Alarm
priority: Priority
state: State
count: Count
newest: Latest
reason: Reason
ended: removed by {who}, {time}
cut: List shortened: there were more alarms
unread: could not be read: {why}
gives: Handed over by
takes: Taken over by
denied: The handover is for operators: sign in or enter a token, then open it from the page

[named]
legend: Saved views
title: Name this view
save: Save
unknown: There is no view '{id}'
wrong: This view cannot be shown: {why}
more: More about {title}
by: {who}, {time}
update: Update to current view
up: Up
down: Down
remove: Remove
look: Show
back: Undo

[views]
from: View from
extremes: Go to a reading
projection: Projection
cut: Section
where: Section position
turn: Flip
equipment: Equipment: {what}
select: Select equipment first
all: Show all
stays: Keep {axis} {sign} {at} m
part: {percent} % of {what}
plant: the plant

[extreme]
highest: Highest
lowest: Lowest

[side]
top: Top
front: Front
right: Right
back: Back
left: Left
iso: Corner

[projection]
perspective: Perspective
parallel: Parallel

[cut]
off: Off
box: Box
move: Move the section: {axis}
whole: Move the box: arrow keys along X and Y, Page Up/Down along Z
oblique: oblique

[shown]
hide: Hide
ghost: Transparent
only: Only this
hidden: {hidden} of {all} hidden
ghosts(one): {count} transparent
ghosts(other): {count} transparent

[assets]
description: Description
area: Area
missing: Missing
size: Size
place: Centre
sensors.name: Sensors

[wall]
far: Text on this screen is readable from up to {metres} m, not {wanted} m.

[callout]
count: {count} alarms
worst: highest

[card]
novalue: No value
quality: Quality
age: Age
on: Equipment
trend: Trend
add: Add to trend
HH: above the high-high limit
H: above the high limit
L: below the low limit
LL: below the low-low limit
BAD: bad quality
ALM: alarm

[place]
measured: Measured here
between: Between sensors
no data: No data: nearest sensor is bad or out of range
context: No sensor for this quantity
equipment: One sensor represents all of it: its location is assumed
inside: Interior (cut surface)
uncertain: {state}, uncertain
drawn: Computed for this point. The picture around it may be off by up to {value}

[following]
title: Following the view of {who}
gone: The session of {who} has ended: this is its last view
awaited: Waiting for the view that this page follows
someone: another user

[outside]
title: Outside the first view, up to {far} away: {names}
more: {names} and {count} more
all: Show everything
close: Close this notice

[alarms]
more: and {count} more

[state]
active: Active
unacknowledged: Unacknowledged
acknowledged: Acknowledged
returned: Returned, unacknowledged
latched: Latched
shelved: Shelved
suppressed: Suppressed by design
out_of_service: Out of service

[trends]
time: Time
csv: Export CSV
close: Close trends
hour: 1 h
hour.why: Last hour
shift: Shift
shift.why: Last 8 hours
day: Day
day.why: Last 24 hours
week: Week
week.why: Last 7 days
month: 30 days
month.why: Last 30 days
range: Time range
range.why: Type a range, such as: last 8 h, yesterday 22:00 to 06:00, 2026-11-20 to 2026-11-21
last: last {span}
between: {from} to {to}
example.minutes: last 15 min
example.hours: last 8 h
example.today: today
example.yesterday: yesterday
example.night: yesterday 22:00 to 06:00
unread: “{text}” is not a time range in the past. Type for example: {example}
earlier: Earlier
later: Later
in: Zoom in
out: Zoom out
back: Previous range
add: Add a tag
none: No tag matches “{text}”
full: At most {count} tags: remove one first
unknown: Not in this plant: {tags}
undrawn: Not drawn, because a trend has at most {count} tags: {tags}
tag: Tag
at: Crosshair
now: Now
then: Time shown
min: Min
mean: Mean
max: Max
known: Valid
focus: Emphasise this curve and show its limits
which: Chart
chart: Charts. Arrow keys move the crosshair, plus and minus zoom, Page keys move the range, Enter shows that instant.
table: Values and statistics
raised: {alarm}, raised {time}
remove: Remove {tag}
gaps: Hatched: no value of {tags}
cut: Too many alarms to mark all of {tags}: the earliest are missing
failed: No trend: {why}
unsaved: Not exported: {why}
uncharted: this server was built without charts (npm was missing)

[compare]
title: Compare two times
why: Show a second half at another time, with the same camera
right: This half shows
ago: Time of this half
at: Go to a time in this half
chosen: chosen time
earlier: {span} earlier
end: End the comparison

[time]
before: Previous alarm
after: Next alarm
goto: Go to
first: No earlier alarm was recorded
last: No later alarm was recorded
unread: Alarms could not be read: {why}
unmarked: Marks may be missing or old: {why}
play: Play
pause: Pause
speed: Playback speed
span: Time range
slider: Time shown
live: Back to live
now: Now
ago: {instant} · {age} ago
lost: {source}: no connection
uncounted: Too many alarms to count
unrecorded: not recorded
raised(one): {count} alarm raised
raised(other): {count} alarms raised

[quality]
because: {quality}: {detail}

[detail]
CommunicationError: communication error
ConfigurationError: configuration error
DeviceFailure: device failure
NoCommunication: no communication
NoMatch: no value at its address
TooManyMatches: several values at its address
OutOfService: out of service
SensorFailure: sensor failure
WaitingForInitialData: waiting for initial data
EngineeringUnitsExceeded: engineering units exceeded
LastUsableValue: last usable value
NoCommunicationLastUsableValue: no communication last usable value
SensorNotAccurate: sensor not accurate

[timings]
ms: Milliseconds
half: median
most: 95 %
input: Input to picture
sensor: Reading to picture
wait: waiting
field: field calculation
render: drawing
encode: encoding
network: network
decode: decoding
rate: {pictures} pictures/s, {kbit} kbit/s
follow: Anyone who opens {link} sees this view.

[account]
title: Account
viewer: (viewer)
operator: (operator)
engineer: (engineer)
open: (view only)
nobody: Not signed in.
person: Signed in through the identity provider.
token: Signed in with a token.
here: You are on the server’s own machine: no sign-in is required.
in: Sign in: {provider}
out: Sign out

[token]
title: Token
needed: Sign-in required.
bad: The token is invalid or expired.
locked: Locked after inactivity. Please sign in again.
go: Continue
note: The server’s administrator creates tokens: {command}. The token is kept until this tab is closed.

[help]
title: Moving around
close: Close help
mouse: Mouse
touch: Touch
keys: Keys
turn: Turn
turn.mouse: Left drag
turn.touch: One finger
move: Move
move.mouse: Right, middle or [Shift] drag
move.touch: Two fingers
look: Look around
look.mouse: [Ctrl] drag
look.touch: Three fingers
zoom: Zoom
zoom.mouse: Wheel
zoom.touch: Pinch
fit: Fit
fit.mouse: Double click
fit.touch: Double tap
home: Home
back: Back to previous view
from: View from
from.keys: [T] top, [I] corner, [O] parallel, [V] all views, [P] picture
what: Identify
what.mouse: Click
what.touch: Tap
selected: Selected
selected.keys: [X] hide, [G] transparent, [L] only this, [U] show all
quantity.keys: [1] to [9]
equipment.keys: [B], search [/]
history.keys: [Y], back to live [N]
markers: Markers
mark.good: good reading
mark.uncertain: uncertain reading
mark.bad: bad: no value
mark.behind: hidden behind something
mark.alarm: alarm; its colour is the priority
mark.acknowledged: acknowledged alarm
mark.returned: returned to normal, or latched
crowd: Crowded markers are thinned out; zoom in to see all. Alarms are never left out.

[measure]
first: Click the first point
second: Click the second point
done: Click to measure again
missed: Nothing here: click on the plant
end: Done
parts: horizontal {level} m, vertical {rise} m

[snapshot]
failed: No picture: {why}
unnamed: a comparison needs readings saved under a name
shown: Save what is on the screen
shown.note: Pixel for pixel, with the readings that it shows; without legend, markers and clock.
again: Save with legend and markers
again.note: Redrawn by the server. Both are signed: “plantcast verify” detects any change.
late: no signed picture was received

[share]
title: Share
what: What the link opens
view: This view
view.why: Opens this view: camera, quantity, colours, instant.
tag: This tag
tag.why: Opens at the tag. Print it and attach it to the equipment.
asset: This equipment
asset.why: Opens at the equipment. Print it and attach it there.
follow: Follow me
follow.why: Anyone who opens it sees what you see, while this page is open.
link: Link
copy: Copy
copied: Copied
code: The link as a QR code
nocode: This server was built without QR codes (npm was missing).
local: Works on this machine only: its address is a local one.
people: Followers
alone: Nobody is following you.
followers(one): {count} person is following you.
followers(other): {count} people are following you.
lead: Hand over to {who}
viewer: Viewer

[factor]
range: Colour range
min: From
max: To
own: Group default
title: Field calculation
strength: Strength
decay: Decay
power: Power
radius_m: Radius (m), 0 = automatic
reach_m: Reach (m), empty = no limit
of: For {tag} only
choose: For one sensor: select it first
reset(one): As configured ({count} sensor)
reset(other): As configured ({count} sensors)

[proof]
fail: Loop check failed
changed: Loop check outdated: the tag was changed since
pass: Loop check passed

[eng]
title: Engineering
close: Close engineering panel
place: Place
prove: Loop check
method: Field settings
what: Task
find: Find a tag
nowhere: not placed
on: on {asset}
choose: Choose a tag, then click on the surface; or drag its marker.
click: {tag}: click on the surface, or drag its marker.
missed: There is no surface here.
moves: Draft (only you see it)
nomoves: Nothing moved. Only you see your changes until you save.
off: {metres} m off the surface
left: not on {asset}, where it is listed
waiting: straight-line distances now; distances along the surface follow
straight: straight-line distances only
ready: distances along the surface
undo: Undo
back: Discard all
gaps: Coverage gaps
save: Save …
gaps.of: Coverage gaps: {quantity}
gap: Largest distance to the nearest sensor: {metres} m. {far} % of the surface is more than {limit} m away; {lost} %
  has no data now.
gap.assumed: The locations of its sensors are assumed, so their distances are unknown.
gap.next: Most isolated sensor: {a}, {metres} m from {b}.
gap.off: {tag} is {metres} m off the surface of {asset} (at most {limit} m)
gap.none: No sensor is off its surface.
diff: Save {file}?
diff.before: before
diff.after: after
diff.line: line {n}
diff.note: The current list is kept as a backup. The new one applies to everyone within seconds.
diff.conflict: Someone else changed {file}, and it is not loaded yet. Nothing was saved; their changes:
diff.left: {tag} was on {left} and is now on {asset}: is that intended?
diff.more: … and {count} more lines
confirm: Save and apply
saving: Preparing; everyone still sees the previous plant.
saved: Applied. The previous list is kept as {kept}.
unsaved: Not saved: {text}
device: Device
proven: {done} of {count} passed
expected: Expected
tolerance: Tolerance ±
watch: Watch for changes
watching: Force the transmitter now.
still: No reading has changed yet.
moved: {tag} changed most: by {by}.
swapped: {tag} changed, not {wanted}: are they swapped?
compare: Compare
fails: Fail
csv: Values from CSV …
csv.note: {count} expected values were read.
csv.bad: Columns Tag Name, Expected, Tolerance are required.
export: Export results
remark: Remark
passed: {tag} passed: {value}.
failed: {tag} failed: {why}.
now: now {value}

[accept]
asset: Equipment
all: all ({count})
tags: Tags
pattern: Name or description; * and ? in names
within: Maximum distance from surface (m)
confidence: Minimum confidence (0 to 1)
count(one): {count} location would be accepted. It is ringed blue in the picture.
count(other): {count} locations would be accepted. They are ringed blue in the picture.
none: No location would be accepted.
nowhere: {count} left out: no node and no position in the list
missing: {count} left out: the equipment has no model
far: {count} left out: farther from the surface
unsure: {count} left out: confidence lower or unknown
go: Accept {count}
saved(one): {count} location accepted. The previous list is kept as {kept}.
saved(other): {count} locations accepted. The previous list is kept as {kept}.
undo: Undo: back to {kept} …
changed: Nothing was accepted: the list has changed. Check the count and accept again.
undone: Undone. {kept} applies again.

[unrecorded]
title: Not recorded: {what}
why: The server cannot use some of its files; the server's log says why.
readings: readings
alarms: alarm changes
actions: audit trail
lists: views, notes and other lists

[standby]
plant: plant file
tags: tag list
models: models
none: No standby is connected.
denied: No standby is connected. This server refuses the connection of {node}: {why}
getting: The standby {node} does not yet have the new {files}.
behind: The standby {node} has not got the {files}: {why}
refused: The standby {node} cannot take over: {why}
warned: The standby {node} can take over, but differs: {why}
`;
