// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of the page say that are loaded when they are first used, in English.
export default `
accept: Accept assumed places
close: Close
sun: from {wind}, {height}° high

[distance]
metres: {metres} m
geodesic: Geodesic
geodesic.why: Distance along the surface: heat does not jump across a gap
euclidean: Euclidean
euclidean.why: Straight distance through space
heat: Heat on points
heat.why: Along the surface as the paper finds it, on sampled points, to compare: errs by half a percent, and goes through thin walls

[interpolation]
shepard: Shepard
shepard.why: Inverse distance: exactly the reading at each sensor
paper: Paper
paper.why: Algorithm 1 of Kim & Suh 2025: smoother, does not reach the readings
harmonic: Conduction
harmonic.why: Steady heat conduction along the wall between sensors. Not where fluid or air takes the heat away, nor for pressure or flow
fin: Conduction and loss
fin.why: As conduction, but the wall loses heat to the air; unknown where sensors say under a tenth. Not for insulated or heated walls
gp: Most probable
gp.why: Gaussian process: most probable field, with its uncertainty. Not where parts that touch have nothing to do with each other

[bar]
distance: Distance
interpolation: Interpolation

[neighbours]
say: Others say
above: {predicted}; reads {by} more
below: {predicted}; reads {by} less
title: Sensors that disagree most
why: What each reads, and what the others on its asset say without it. Not where a sensor is meant to differ, as at an inlet.

[drift]
week: Drift in a week
found: {by}: drifts
none: {by}: no drift seen
unknown: {by}: cannot be told
why: Away from what the others say, by hourly means. Not where the plant itself changed how places differ.

[coverage]
since: since {when}
title: What sensors cover
none: Off
uncertainty: Uncertainty
uncertainty.note: Standard deviation, by the sensors that are good now.
uncertainty.why: How far the field may err, if the surface behaves as the kernel of gp expects. Not where its range is a guess.
blind: Blind places
blind.of: Hot spot seen: {name}
blind.note: Smallest hot spot of {size} m of which the nearest sensor reads 5 % of the range.
blind.why: How hot a small spot must get before any sensor shows it. Not for other shapes, nor where heat takes other ways.

[picture]
from: Distance from
tag: Tag
difference: Difference from
kept: Readings kept
now: Now
name: Name for the readings of now
keep: Keep
scale: Scale
fill: Places without data
light: Light: sun {where}
turn: Side
turn.why: Side of the sun, degrees from north
height: Height
height.why: Height of the sun, degrees
around: Around
around.why: Surroundings
split: Split view
right: Right half

[arrows]
title: Directions
arrows: Arrows
arrows.why: As long as the value. Not between surfaces, nor as a flow that was computed: they interpolate what sensors say.
strokes: Strokes
strokes.why: Where to; they run faster where the value is larger. Not as paths of a fluid: they interpolate what sensors say now.
none: None
none.why: Directions are not drawn; colours show the value alone.
unknown: Direction unknown

[scale]
linear: Linear
log: Logarithmic

[fill]
none: Hatched
none.why: Where no good sensor reaches nothing is shown
neighbours: By neighbours
neighbours.why: Filled and dotted

[split]
one: One picture
two: Two halves

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
unknown: There is no wall '{id}' in the plant file. There are: {known}
display: Wall '{id}' has {count} displays, and no display {n}
lost: No connection to the plant since {time}
never: No connection to the plant
self: Display {display} of {wall}, waiting since {time}
denied: This display needs a token of its own
digits: To let this display in, an engineer enters these digits on the page, in Views
asks: This display asks the server for the digits that it is let in by
left: These digits are good for another {time}
place: Display {display} of {wall}
crowded: Too many displays wait to be let in; this one asks again
nowhere: The plant file has no display {display} of a wall '{wall}'
token: Token
enter: Enter
held: held by {who} since {time}
sent: sent by {who}, {time}
age: data {age} old
since: since {time}
many: {count} alarms, worst {worst}
more(one): and {count} more
more(other): and {count} more
counts: {active} active, {waiting} to be acknowledged
flood: Flood of alarms: {active} active, {waiting} to be acknowledged
late: The link to this display is too slow; left out since {time}
missing: Not shown: display {displays}

[others]
gone: No picture of {name} since {time}
waiting: Waiting for its server
unreachable: Its server does not answer
tls: Its server's certificate is not trusted
token: The file with the token for it cannot be read
refused: Its server does not accept the token
busy: Its server has too much to do
slow: Its server answers too slowly
large: What its server sends is too large
no_picture: Its server sends no picture
unheard: This plant's server says nothing of it

[notes]
legend: Notes
text: Note for the crew
at: At what
until: Until when
save: Note
place: this place
choose: Choose equipment or a tag
ends: until {time}
handover: Handover of the shift

[until]
shift: 8 hours
day: a day
week: a week
ever: until removed

[remote]
legend: Wall
pane: Pane of a wall
desk: Name of this desk
where: {wall} {display}: {area}
send: Send what is seen
hold: Hold
back: Give back
point: Point with the mouse
there: connected
gone: this display is not connected
sent: {title}, sent by {who}, {time}
held: held by {who}, {time}

[devices]
legend: Displays
digits: Six digits of a display
pair: Let in
revoke: Revoke
is: Display {display} of {wall}, from {from}, let in by {who}, {time}

[handover]
title: Handover of the shift, {plant}
last: The last
hours: {n} hours
print: Print, or keep as PDF
notes: Notes
standing: Standing now
raised: Alarms raised
acknowledged: Acknowledged
shelved: Shelved, or out of service
time: Time
where: Where
what: Note
who: Who
until: Until
alarm: Alarm
priority: Priority
state: State
count: Times
newest: Newest
reason: Reason
ended: removed by {who}, {time}
cut: There were more alarms than stand here
gives: Handed over by
takes: Taken over by
denied: The handover is for operators: open it from the page, signed in or with a token

[named]
legend: Views with names
title: Name for what is seen
save: Save
unknown: There is no view '{id}' here
wrong: This view cannot be shown: {why}
more: More about {title}
by: {who}, {time}
update: Save what is seen here
up: Up
down: Down
remove: Remove
look: Show
back: Take back

[views]
from: Look from
projection: Projection
cut: Cut away
where: Where to cut
turn: Other side
equipment: Equipment: {what}
select: select some first
all: Show all
stays: {axis} {sign} {at} m stays
part: {percent} % of {what}
plant: the plant

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
move: Move the cut: {axis}
whole: Move the box: arrow keys along X and Y, page keys along Z
oblique: oblique

[shown]
hide: Hide
ghost: Ghost
only: Only this
hidden: {hidden} of {all} hidden
ghosts(one): {count} see-through
ghosts(other): {count} see-through

[assets]
description: Description
area: Area
missing: Missing
size: Size
place: Middle at
sensors.name: Sensors

[wall]
far: On this screen letters are large enough up to {metres} m, not {wanted} m.

[callout]
held: held since {time}
count: {count} alarms
worst: worst

[card]
novalue: No value
quality: Quality
age: Age
on: On
trend: Trend
add: Add to trend
HH: above the highest limit
H: above the high limit
L: below the low limit
LL: below the lowest limit
BAD: bad measurement
ALM: alarm

[place]
measured: Measured here
between: Between sensors
no data: No data: its nearest sensor is bad, or none reaches
context: No sensor of this quantity on it
equipment: One sensor stands for all of it: its place is assumed
inside: Inside of what is cut open
uncertain: {state}, uncertain
drawn: Computed for this point. The picture around it may be off by up to {value}
hide: Hide
ghost: Ghost
only: Only

[following]
title: This is the view of session {session}
gone: Session {session} has gone: this is its last view
awaited: Session {session} is not there: waiting for it

[outside]
title: Not in the first view, up to {far} away: {names}
more: {names} and {count} more
all: Show everything
close: Close this notice

[alarms]
close: Close alarms
then: The plant is shown as it was. These alarms are those of now.
quiet: No active alarms.
aside: Set aside ({count})
more: and {count} more
since: since {time}, {age}
until: until {time}
by: by {who}
held: measurement bad: as it last was
fly: Fly to {tag}
stale: Not of now: as of {time}, when the connection was lost.
which: Which alarms
search: Filter
filtered: None of {count} passes the filter.
choose: Choose {tag}
chooseall: All of these
acknowledge: Acknowledge {count}
also: also {what}

[which]
all: All
waiting: To be acknowledged
active: Active
gone: Cause has gone

[state]
active: Active
unacknowledged: Unacknowledged
acknowledged: Acknowledged
returned: Returned, unacknowledged
latched: Latched
shelved: Shelved
suppressed: Suppressed by design
out_of_service: Out of service

[action]
acknowledge: Acknowledge
shelve: Shelve…
reset: Reset
unshelve: Unshelve
in_service: Put in service

[shelve]
title: Shelve {what}
for: For
quarter: 15 minutes
hour: 1 hour
shift: 8 hours
day: 1 day
reason: Reason
cancel: Cancel
do: Shelve

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
remove: Remove {tag}
gaps: Hatched: no value of {tags}
failed: No trend: {why}
unsaved: Not exported: {why}
uncharted: this server was built without its charts (npm was not there)

[time]
before: Alarm before
after: Next alarm
goto: Go to
first: No earlier alarm was recorded
last: No later alarm was recorded
play: Play
pause: Pause
speed: Speed of play
span: Time that the slider spans
slider: Instant that is shown
live: Back to live
now: Now
ago: {instant} · {age} ago
lost: {source}: lost
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
half: half
most: 95 %
input: Input to picture
sensor: Reading to picture
wait: waiting
field: field
render: drawing
encode: encoding
network: network
decode: decoding
rate: {pictures} pictures/s, {kbit} kbit/s
follow: Session {session}. Who opens {link} sees this view.

[account]
title: Who you are
viewer: may look
operator: is an operator
engineer: is an engineer
open: may look at the picture
nobody: Nobody knows you here.
person: You signed in at the identity provider.
token: You are here by a token.
here: You are at the server’s own machine, where nobody is asked.
in: Sign in: {provider}
out: Sign out

[token]
title: Token
needed: This server asks who you are.
bad: This token is not valid, or no longer.
locked: Nobody was at this page for some time. Say again who you are.
go: Continue
note: Whoever runs this server makes tokens: {command}. It is kept until this tab is closed.

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
back: Back to where one flew from
from: Look from
from.keys: [T] top, [I] corner, [O] parallel, [V] all views, [P] picture
what: What is there
what.mouse: Click
what.touch: Tap
selected: Selected
selected.keys: [X] hide, [G] ghost, [L] alone, [U] all
quantity.keys: [1] to [9]
equipment.keys: [B], search [/]
history.keys: [Y], back to live [N]
markers: Markers
mark.good: good reading
mark.uncertain: uncertain reading
mark.bad: bad: no value
mark.behind: behind something
mark.alarm: alarm; its colour is the priority
mark.acknowledged: acknowledged alarm
mark.returned: returned or latched
crowd: Where markers crowd, some are left out; nearer by all are there. Alarms are never left out.

[measure]
first: Click the first place
second: Click the second place
done: Click to measure again
missed: Nothing is there: click on the plant
end: Done
parts: level {level} m, rise {rise} m

[snapshot]
failed: No picture: {why}
unnamed: a comparison needs readings that were kept under a name
shown: Save what is on the screen
shown.note: Pixel for pixel, with the readings that it shows; without legend, markers and clock.
again: Save with legend and markers
again.note: Drawn once more by the server. Both are signed: “plantcast verify” finds whatever is changed in them.
late: no signed picture came

[share]
title: Share
what: What to open
view: This view
view.why: Opens this view: camera, quantity, colours, instant.
tag: This tag
tag.why: Opens at the tag. To be printed and put at the equipment.
asset: This equipment
asset.why: Opens at the equipment. To be printed and put there.
follow: Follow me
follow.why: Whoever opens it sees what you see, while you look.
link: Link
copy: Copy
copied: Copied
code: The link as a code to scan
nocode: This server was built without codes to scan (npm was not there).
local: Opens on this machine only: its address here is a local one.
people: Who looks along
alone: Nobody follows this view, of session {session}.
followers(one): {count} follows this view, of session {session}.
followers(other): {count} follow this view, of session {session}.
lead: Let session {session} lead

[factor]
range: Range of the colours
min: From
max: To
own: The group’s own
title: How the field is computed
strength: Strength
decay: Decay
power: Power
radius_m: Radius m, 0: by itself
reach_m: Reach m, empty: no limit
of: Of {tag} alone
choose: Of one sensor: select it first
reset(one): As configured ({count} sensor)
reset(other): As configured ({count} sensors)

[proof]
fail: Unproven: failed
changed: Unproven: changed since
pass: Proven

[eng]
title: Engineer
close: Close the engineer’s panel
place: Place
prove: Prove
method: Field
what: What to do
find: Find a tag
nowhere: stands nowhere yet
on: on {asset}
choose: Choose a tag, then click on the surface; or drag its marker.
click: {tag}: click on the surface, or drag its marker.
missed: There is no surface at that place.
moves: Tried out, for you alone
nomoves: Nothing is moved. What you try out only you can see, until it is saved.
off: {metres} m off the surface
left: not on {asset}, as the tag list has it
waiting: straight distances, those along the surface follow
straight: straight distances only
ready: along the surface
undo: Undo
back: Take all back
gaps: Gaps
save: Save …
gaps.of: Gaps: {quantity}
gap: Farthest from any sensor: {metres} m. {far} % of the surface is more than {limit} m away; {lost} % has no data now.
gap.next: Farthest apart: {a} to {b}, {metres} m.
gap.off: {tag} is {metres} m off the surface of {asset} (at most {limit} m)
gap.none: No sensor is off its surface.
diff: Save {file}?
diff.before: before
diff.after: after
diff.line: line {n}
diff.note: The list as it is stays beside it. It is then in force for everybody; that takes some seconds.
diff.conflict: {file} was changed by somebody else and is not loaded yet. Nothing was saved; this is what they changed:
diff.left: {tag} was on {left}, and is on {asset} now: is that meant?
diff.more: … and {count} more lines
cancel: Cancel
confirm: Save and put in force
saving: Being prepared; everybody is still shown the plant as it was.
saved: In force. The list before it is {kept}.
unsaved: Not saved: {text}
device: Device
proven: {done} of {count} proven
expected: Expected
tolerance: Tolerance ±
watch: Watch
watching: Force the transmitter now.
still: Nothing has moved yet.
moved: {tag} moved most: by {by}.
swapped: {tag} moved, not {wanted}: are they swapped?
compare: Compare
fails: Fails
csv: Values from CSV …
csv.note: {count} expected values were read.
csv.bad: Columns Tag Name, Expected, Tolerance are needed.
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
within: Distance from surface, at most (m)
confidence: Confidence, at least (0 to 1)
count(one): {count} place would be accepted. It is ringed blue in the picture.
count(other): {count} places would be accepted. They are ringed blue in the picture.
none: No place would be accepted.
nowhere: {count} left out: no node and no position in the list
missing: {count} left out: the equipment has no model
far: {count} left out: farther from the surface
unsure: {count} left out: lower confidence, or none known
go: Accept {count}
saved(one): {count} place accepted. The previous list is kept as {kept}.
saved(other): {count} places accepted. The previous list is kept as {kept}.
undo: Undo: back to {kept} …
changed: Nothing was accepted: the list has changed. Check the count and accept again.
undone: Undone. {kept} is in force again.
`;
