// SPDX-License-Identifier: GPL-3.0-or-later
// What the page says at once, in German. [beginning] of keys, then key: text; {name} is put in, [X] is a key to press, (one) a plural.
export default `
none: keine
novalue: kein Wert
viewport: Anlage, 3D-Ansicht. Pfeiltasten drehen, Plus und Minus zoomen, W A S D verschieben, F passt ein, Fragezeichen hilft.
legend: Legende
card: Messstelle
place: Stelle
status: Status
timings: Messungen

[part]
failed: Dieser Teil der Seite konnte nicht geladen werden. Er kommt von selbst, sobald der Server da ist.

[age]
s: {n} s
min: {n} min
h: {n} h
d: {n} d

[bar]
equipment: Anlagenliste
quantity: Messgröße
display: Darstellung
colours: Farben
ramp: Stufen
lines: Linien
look: Optik
show: Zeigen
views: Ansichten, Schnitt und gezeigte Anlagenteile
picture: Bild: Vergleich, Licht, geteilte Ansicht
history: Verlauf
fit: Einpassen
home: Grundansicht
help: Hilfe
hold: Anhalten: Werte stehen still
go: Weiter: aktuelle Werte
unrecorded: Hier wird nichts aufgezeichnet: Werte können nicht angehalten werden
more: Mehr
measure: Abstand messen
snapshot: Bild speichern
share: Teilen
theme: Dunkel oder hell
engineer: Ingenieur: Messstellen und Feld
import: Anlage einlesen
account: Wer Sie sind

[show]
value: Werte
operator: Grenzwerte
distance: Abstand
difference: Differenz

[look]
default: Messtreu
glossy: Glänzend
flat: Flach
materials: Werkstoffe

[lines]
none: Keine
every: Alle {step}
chosen: Gewählte

[ramp]
smooth: Stufenlos
group: Eigene Bänder
limits: Grenzwerte
chosen: Gewählte Bänder

[quantity]
temperature: Temperatur
pressure: Druck
vibration: Schwingung
vibration velocity: Schwinggeschwindigkeit
flow: Durchfluss
level: Füllstand
gas: Gas

[picture]
title: Bild

[views]
title: Ansichten

[assets]
title: Anlagenteile
close: Anlagenliste schließen
search: Teile, Messstellen suchen
nothing: Nichts heißt so.
sensors(one): {count} Sensor
sensors(other): {count} Sensoren
loose: Messstellen ohne Anlagenteil
about: Über das gewählte Anlagenteil
worst: schlechteste Qualität: {quality}

[viewport]
waiting: Warten auf das erste Bild

[legend]
right: Legende der rechten Hälfte
colours: Farben von {min} bis {max}
distance: Abstand von {tag}
operator: Nach den Grenzwerten jeder Messstelle.
log: Logarithmische Skala.
unsafe: Diese Farben können täuschen.
glossy: Glänzend: Licht ändert die Farben. Keine Werte ablesen.
nolimits: Ohne Grenzwerte
nodata: Keine Daten
uncertain: Unsicher
drawn: Punkte: Fehler bis {off}.

[following]
own: Eigene Ansicht

[alarms]
title: Alarme
unheard: Alarme: noch nichts gehört
none: Keine aktiven Alarme
some(one): {count} aktiver Alarm
some(other): {count} aktive Alarme
zero: 0 aktiv
waiting: {waiting} zu quittieren
latched: {latched} zurückzusetzen
asof: Stand {time}: {alarms}
gone: Priorität {priority}, Ursache gegangen
now: Jetzt: {alarms}
value: ausgelöst bei {value}, jetzt {now} (Grenzwert {limit})
priority: Priorität {priority}

[kind]
HH: Hoch hoch
H: Hoch
L: Tief
LL: Tief tief
BAD: Messung gestört
ALM: Alarm
LINK: Gerät liefert keine Werte

[mode]
display: Hier nur gezeigt, quittiert wird im Leitsystem
mirror: Wie das Leitsystem sie hat
local: Eigene Alarme dieses Standorts

[trends]
title: Trend

[time]
title: Verlauf

[status]
clock: Anlagenzeit
then: Damals
unset: {clock}, nicht synchronisiert
unset.why: Nichts stellt die Uhr des Servers: Zeiten können falsch sein, Altersangaben nicht.
within: Die Uhr des Servers wird gestellt, auf {n} ms genau.
leap: Am Ende des Monats (UTC) kommt eine Schaltsekunde hinzu.
leap.less: Am Ende des Monats (UTC) entfällt eine Sekunde.
oldest: Ältester Messwert
frames: Bilder
rate: {count}/s
still: ruht
latency: Latenz
ms: {n} ms
config: Konfiguration
picture: Bild
retry: Jetzt versuchen

[health]
nothing: Damals wurden keine Daten aufgezeichnet
connecting: Verbinden
live: Live
partly: Live, teils simuliert
simulated: Simuliert
down: {live}, {down} von {all} Quellen gestört
unmeasured: Nicht in der Anlage gemessen: {sources}.
nodata: Keine Live-Daten
nosensor: Kein Sensor liefert Werte.
source: Quelle {source} antwortet nicht.
sources: Quellen {sources} antworten nicht.
past: Vergangenheit
returning: Zurück zu jetzt
playing: {instant}, Wiedergabe {speed}×
back: {instant}, Rücklauf {speed}×
noanswer: Keine Antwort
silent: Der Server schweigt seit {age}.
old: Dieses Bild ist {age} alt.
barred: Kein Zutritt
disconnected: Getrennt
because: {reason}.
retry: Nächster Versuch in {age}.
retrying: Neuer Versuch läuft.

[reason]
down: Der Server wurde beendet
version: Diese Seite und der Server haben verschiedene Versionen
forbidden: Nicht erlaubt
long: Eine Nachricht war zu lang
full: Der Server ist voll
slow: Diese Seite war zu langsam
unreachable: Der Server ist nicht erreichbar
unanswered: Der Server antwortet nicht
silent: Der Server ist verstummt
token_needed: Ein Token wird verlangt
bad_token: Dieses Token gilt nicht oder nicht mehr
locked: Eine Zeit lang war niemand an dieser Seite

[quality]
good: Gut
uncertain: Unsicher
bad: Schlecht
unknown: Unbekannt

[simulated]
all: Simuliert
partly: Teilweise simuliert

[proof]
none: Ungeprüft
assumed: Ort angenommen
`;
