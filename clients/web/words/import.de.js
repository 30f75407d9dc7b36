// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of the import panel, in German.
export default `
[import]
drop: Modell und Messstellenliste hierher ziehen oder Dateien wählen
more: Weitere Dateien hierher ziehen oder wählen
formats: Modelle: RVM (mit ATT oder TXT), STEP, IGES, IFC, glTF, FBX, COLLADA, OBJ, STL, PLY, 3DS. Messstellen: CSV, XLSX, JSON
bytes: {mb} MB
files(one): {count} Datei
files(other): {count} Dateien
kind.model: Modell
kind.beside: Gehört zu einem Modell
kind.tags: Messstellenliste
remove: Diese Datei entfernen
uploading: {name} wird übertragen …
phase.reading: Modelle werden gelesen …
phase.matching: Messstellen werden zugeordnet …
phase.preparing: Die Anlage wird vorbereitet …
phase.loading: Die Anlage wird gezeichnet …
done: Die Anlage ist aktiv
again: Noch einmal lesen
details: Bericht
size: Größe
metres: {wide} × {deep} × {high} m
encoding: Zeichensatz von Namen und Einheiten
encoding.found: wie in den Dateien angegeben oder erkannt
encoding.read: {file}: gelesen als {name}
encoding.unsure: {file}: gelesen als {name}, vielleicht {other}
outside: Weit entfernt vom Rest und nicht in der ersten Ansicht: {triangles} Dreiecke, bis {away_m} m entfernt.
report.lost(one): {count} Element ist unvollständig (Dreiecke fehlen)
report.lost(other): {count} Elemente sind unvollständig (Dreiecke fehlen)
report.errors(one): {count} Fehler beim Lesen
report.errors(other): {count} Fehler beim Lesen
report.left(one): {count} Teil eines Modells wurde weggelassen
report.left(other): {count} Teile von Modellen wurden weggelassen
unit.ask: {file} nennt keine Einheit. Mit der Einheit {unit} ist das Modell {length} m lang. Welche Einheit stimmt?
unit.all: Die Antwort gilt für alle diese Dateien.
unit.length: {length} m lang
units: Einheit des Modells
units.said: wie in der Datei
units.m: Meter
units.mm: Millimeter
units.cm: Zentimeter
units.in: Zoll
units.ft: Fuß
up: Achse nach oben
up.said: wie in der Datei
up.y: Y
up.z: Z
apply: Anwenden
person: Eine Person von 1,8 m daneben zeigen
person.label: 1,8 m
units.note: Anwenden liest die Modelle noch einmal und schreibt plant.yaml und tags.csv neu; die vorigen bleiben als .1, .2, …,
  Entscheidungen über Messstellen bleiben erhalten.
source: Messwerte
source.none: noch keine
source.host: Modbus-TCP-Gerät
source.port: Port
source.unit: Unit-ID
source.order: Bytefolge
source.unstated: nicht angegeben
source.base: Nummer des ersten Registers
source.connect: Verbinden
source.live: {good} von {count} Messstellen haben Werte
source.bad: {count} × {why}
source.note: Die Adressen stehen in der Messstellenliste. Die Quelle wird in plant.yaml eingetragen.
tags: Messstellen
filter: Zeigen
filter.all: Alle
filter.sure: Zugeordnet
filter.likely: Fraglich
filter.none: Nicht zugeordnet
filter.unplaced: Ohne Ort
sign.sure: ✓
sign.likely: ?
sign.none: –
sign.unplaced: ◎
find: Messstellen, Anlagenteile, Gründe suchen
keys: ↑ ↓ durchgehen · 1–8 Vorschlag wählen · Enter annehmen · A alle ähnlichen · N keiner · P platzieren
byhand: von Hand
decided(one): {count} Entscheidung
decided(other): {count} Entscheidungen
undo: Verwerfen
selected: Am gewählten Anlagenteil: {asset}
alike: Alle {count} passend zu {pattern} annehmen
off: An keinem Anlagenteil
place: Von Hand platzieren
choose: Das Anlagenteil im Bild anklicken, dann hier bestätigen.
`;
