// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the server draws over pictures, in English. The build makes a C header from this file; {} is replaced by a value.
export default `
no_limits: no limits
no_data: no data
uncertain: uncertain
drawn_error: uncertain: drawn with
drawn_error_2: up to {} of error
unproven: not loop-checked
place_assumed: location assumed
direction_unknown: direction unknown
priority_1: alarm, priority 1
priority_2: alarm, priority 2
priority_3: alarm, priority 3
priority_4: alarm, priority 4
by_limits: by each tag's limits
logarithmic: logarithmic scale
deviation: standard deviation
misread: can be misread
glossy: glossy: light alters
glossy_2: the colours
bad: BAD
held_since: held since {}
unknown_then: unknown at that time
from: Distance from {}
hot_spot: Detectable hot spot: {}
hot_spot_size: of {} m, seen as {} % of the range
since: since {}
alarms: {} alarms
worst: highest {}
no_values: no values
old_s: {} s old
old_min: {} min old
old_h: {} h old
configuration: configuration {}
clock_unset: CLOCK NOT SYNCHRONISED
simulated: SIMULATED
no_live_data: NO LIVE DATA
history: HISTORY
no_data_then: NO DATA
unseen_one: {} alarm out of sight
unseen: {} alarms out of sight
unseen_such_as: {} alarms out of sight, such as
look_default: True colours
look_glossy: Glossy look
look_flat: Unshaded
look_materials: Materials
interpolation_shepard: Shepard
interpolation_paper: Kim & Suh, Algorithm 1
interpolation_harmonic: Conduction along the wall
interpolation_fin: Conduction and loss to the air
interpolation_gp: Most probable field
distance_geodesic: Geodesic distance
distance_euclidean: Euclidean distance
distance_heat: Geodesic, heat method
power: Power {}
strength: Strength {}
decay: Decay {}
radius: Radius {} m
radius_automatic: Radius automatic
reach: Reach {} m
reach_unlimited: Reach without limit
not_filled: Not filled
filled: Filled by neighbours
weighted: Sensors weighted by hand: {}
as_configured: Sensors as configured
`;
