// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the alarm list, the alarm journal and the replay of the time around an alarm, in English.
export default `
[alarms]
close: Close alarms
then: The picture shows the past; this list shows current alarms.
quiet: No active alarms.
aside: Shelved or suppressed ({count})
until: until {time}
by: by {who}
edge: Drag to change the width
held: bad measurement: last state held
heldfrom: bad measurement: state held since {time}
fly: Fly to {tag}
stale: Out of date: as of {time}, when the connection was lost.
which: Alarms to show
search: Filter
unfilter: Clear the filter: {count} of {all} shown, {what}
filtered(one): The only alarm does not match the filter.
filtered(other): No match among {count} alarms.
choose: Select {tag}
chooseall: Select all
acknowledge: Acknowledge {count}
also: also {what}
priorities: All priorities
areas: All areas
chosen(one): {count} selected
chosen(other): {count} selected
count(one): {count} alarm
count(other): {count} alarms
shelve: Shelve {count}…
unchoose: Deselect

[which]
all: All
waiting: Unacknowledged
active: Active
gone: Returned to normal

[action]
acknowledge: Acknowledge
shelve: Shelve…
reset: Reset
unshelve: Unshelve
in_service: Return to service

[shelve]
title: Shelve {what}
for: Duration
quarter: 15 minutes
hour: 1 hour
reason: Reason
do: Shelve

[short]
returned: Returned
suppressed: Suppressed

[column]
state: State
priority: Prio
tag: Tag
kind: Alarm
area: Area
about: Description
us: Time
raised: Raised at
then: Value then
now: Now
limit: Limit
since: Age
do: Actions
order: Order
sort: Sort by {what}

[journal]
title: Journal
csv: CSV
which: Changes to show
span: Time range
all: All changes
raised: Raised
cleared: Cleared
acknowledged: Acknowledged
shelved: Shelved, suppressed
shift: Last 8 hours
day: Last 24 hours
today: Today
yesterday: Yesterday
week: Last 7 days
chosen: From – to…
from: From
to: To
count(one): {count} change
count(other): {count} changes
cut: {count} of the newest {all} changes, back to {time}
older: Load older changes
nounit: unit unknown

[change]
raise: Raised
clear: Cleared
acknowledge: Acknowledged
reset: Reset
shelve: Shelved
unshelve: Unshelved
suppress: Suppressed
unsuppress: Unsuppressed
out_of_service: Out of service
in_service: In service
carry: Covered by device alarm
call: Raised again

[moment]
show: Show 30 s before the alarm
raised: raised {time}
early: {s} s before
late: {s} s after
now: at the time of the alarm
before: 30 s before
at: Go to the alarm
`;
