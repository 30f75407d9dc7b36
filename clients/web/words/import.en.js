// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the import panel, in English.
export default `
[import]
drop: Drop a model and a tag list here, or choose files
more: Drop or choose more files
formats: Models: RVM (with ATT or TXT), STEP, IGES, IFC, glTF, FBX, COLLADA, OBJ, STL, PLY, 3DS. Tags: CSV, XLSX, JSON
bytes: {mb} MB
files(one): {count} file
files(other): {count} files
kind.model: Model
kind.beside: Belongs to a model
kind.tags: Tag list
remove: Remove this file
uploading: {name}: uploading …
phase.reading: Reading models …
phase.matching: Matching tags …
phase.preparing: Preparing the plant …
phase.loading: Drawing the plant …
done: The plant is live
again: Read again
details: Report
size: Size
metres: {wide} × {deep} × {high} m
encoding: Character encoding of names and units
encoding.found: as the files state, or as detected
encoding.read: {file}: read as {name}
encoding.unsure: {file}: read as {name}, but it may be {other}
outside: Far away from the rest, not in the first view: {triangles} triangles, up to {away_m} m away.
report.lost(one): {count} element has missing triangles
report.lost(other): {count} elements have missing triangles
report.errors(one): {count} error while reading
report.errors(other): {count} errors while reading
report.left(one): {count} part of a model was left out
report.left(other): {count} parts of models were left out
unit.ask: {file} does not state its unit. If the unit is {unit}, the model is {length} m long. Which unit is right?
unit.all: The answer applies to all of these files.
unit.length: {length} m long
units: Unit of the model
units.said: as in the file
units.m: metres
units.mm: millimetres
units.cm: centimetres
units.in: inches
units.ft: feet
up: Up axis of the model
up.said: as in the file
up.y: Y
up.z: Z
apply: Apply
person: Show a person of 1.8 m next to it
person.label: 1.8 m
units.note: Applying reads the models again and rewrites plant.yaml and tags.csv; the previous files are kept as .1, .2, …, and so are
  decisions on tags.
source: Values
source.none: none yet
source.host: Modbus TCP device
source.port: Port
source.unit: Unit ID
source.order: Byte order
source.unstated: not stated
source.base: First register number
source.connect: Connect
source.live: {good} of {count} tags have values
source.bad: {count} × {why}
source.note: Addresses come from the tag list. The source is written into plant.yaml.
tags: Tags
filter: Show
filter.all: All
filter.sure: Matched
filter.likely: Doubtful
filter.none: Unmatched
filter.unplaced: Unplaced
sign.sure: ✓
sign.likely: ?
sign.none: –
sign.unplaced: ◎
find: Find tags, equipment, reasons
keys: ↑ ↓ go through · 1–8 choose a candidate · Enter accept · A all similar · N none · P place
byhand: by hand
decided(one): {count} decision
decided(other): {count} decisions
undo: Discard
selected: On the selected equipment: {asset}
alike: Accept all {count} matching {pattern}
off: Not on any equipment
place: Place by hand
choose: Click the equipment in the picture, then confirm here.
`;
