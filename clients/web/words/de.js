// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the page needs immediately, in German. [section] prefixes the keys below it, then key: text. {name} is replaced,
// [X] is a key to press, (one) is a plural form.
export default `
none: keine
novalue: kein Wert
viewport: Anlage, 3D-Ansicht. Pfeile drehen, Plus und Minus zoomen, W A S D verschieben, F passt Ansicht ein, Fragezeichen öffnet Hilfe.
legend: Legende
card: Messstelle
place: Stelle
status: Status
timings: Antwortzeiten

[part]
failed: Dieser Teil der Seite konnte nicht geladen werden. Er wird geladen, sobald der Server antwortet.

[age]
s: {n} s
min: {n} min
h: {n} h
d: {n} d

[bar]
equipment: Anlagenliste
quantity: Messgröße
display: Darstellung
colours: Farbskala
ramp: Farbstufen
lines: Isolinien
look: Schattierung
show: Anzeige
views: Ansichten, Schnitt, sichtbare Anlagenteile
picture: Bild: Vergleich, Licht
split: Geteilte Ansicht
history: Verlauf
fit: Ins Bild einpassen
home: Grundansicht
help: Hilfe
hold: Werte einfrieren
go: Zurück zu Live-Werten
unrecorded: Ohne Aufzeichnung lassen sich Werte nicht einfrieren
more: Mehr
measure: Abstand messen
snapshot: Bild speichern
share: Teilen
theme: Hell/dunkel umschalten
engineer: Engineering: Messstellen und Feld
import: Anlage importieren
account: Konto

[show]
value: Werte
operator: Grenzwerte
distance: Abstand
difference: Differenz

[look]
default: Farbtreu
glossy: Glänzend
flat: Unschattiert
materials: Materialien

[lines]
none: Keine
every: Alle {step}
chosen: Eigene

[ramp]
smooth: Stufenlos
group: Standardstufen
limits: Gruppengrenzen
chosen: Eigene Stufen

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
nothing: Keine Treffer.
sensors(one): {count} Sensor
sensors(other): {count} Sensoren
loose: Nicht zugeordnete Messstellen
about: Über das gewählte Anlagenteil
worst: schlechteste Qualität: {quality}

[viewport]
waiting: Warten auf das erste Bild

[legend]
right: Legende, rechte Seite
colours: Farben von {min} bis {max}
distance: Abstand von {tag}
operator: Nach den Grenzwerten jeder Messstelle.
log: Logarithmische Skala.
unsafe: Diese Farbskala kann täuschen.
glossy: Glänzend: Licht ändert die Farben. Keine Werte ablesen.
nolimits: Ohne Grenzwerte
nodata: Keine Daten
uncertain: Unsicher
drawn: Punkte: Fehler bis {off}.

[following]
own: Nicht mehr folgen

[alarms]
title: Alarme
unheard: Alarme: warten auf Daten
none: Keine aktiven Alarme
some(one): {count} aktiver Alarm
some(other): {count} aktive Alarme
zero: 0 aktiv
waiting: {waiting} unquittiert
latched: {latched} zurückzusetzen
asof: Stand {time}: {alarms}
gone: Priorität {priority}, gegangen
now: Jetzt: {alarms}
value: gekommen bei {value}{now} (Grenzwert {limit})
present: jetzt {now}
since: gehalten seit {time}
priority: Priorität {priority}

[kind]
HH: Hoch-Hoch
H: Hoch
L: Tief
LL: Tief-Tief
BAD: Messung gestört
ALM: Alarm
LINK: Keine Verbindung zum Gerät

[mode]
display: Nur Anzeige: im Leitsystem quittieren
mirror: Aus dem Leitsystem übernommen
local: Alarme von Plantcast

[trends]
title: Trend

[time]
title: Verlauf

[status]
clock: Anlagenzeit
then: Gezeigte Zeit
unset: {clock}, nicht synchronisiert
unset.why: Die Serveruhr ist nicht synchronisiert: Zeiten können falsch sein, Altersangaben stimmen.
within: Serveruhr auf {n} ms genau synchronisiert.
leap: Am Ende des Monats (UTC) kommt eine Schaltsekunde hinzu.
leap.less: Am Ende des Monats (UTC) entfällt eine Schaltsekunde.
oldest: Ältester Messwert
frames: Bilder
rate: {count}/s
still: Leerlauf
latency: Latenz
ms: {n} ms
behind: {n} s Verzug
config: Konfiguration
picture: Bild
retry: Jetzt versuchen

[health]
nothing: Zu dieser Zeit wurden keine Daten aufgezeichnet
connecting: Verbindet …
live: Live
partly: Live, teils simuliert
simulated: Simuliert
down: {live}, {down} von {all} Quellen gestört
unmeasured: Simulierte Werte von: {sources}.
nodata: Keine Live-Daten
nosensor: Kein Sensor liefert Werte.
source: Quelle {source} antwortet nicht.
sources: Quellen {sources} antworten nicht.
past: Vergangenheit
returning: Zurück zu Live
playing: {instant}, Wiedergabe {speed}×
back: {instant}, Rücklauf {speed}×
noanswer: Keine Antwort
silent: Seit {age} keine Antwort vom Server.
old: Dieses Bild ist {age} alt.
barred: Zugriff verweigert
disconnected: Getrennt
because: {reason}.
retry: Nächster Versuch in {age}.
retrying: Neuer Versuch läuft.

[reason]
down: Der Server wurde beendet
version: Diese Seite und der Server haben verschiedene Versionen
forbidden: Nicht erlaubt
long: Eine Nachricht war zu lang
full: Der Server ist ausgelastet
slow: Dieser Browser ist zu langsam
unreachable: Der Server ist nicht erreichbar
unanswered: Der Server antwortet nicht
silent: Der Server antwortet nicht mehr
token_needed: Ein Token ist erforderlich
bad_token: Das Token ist ungültig oder abgelaufen
locked: Nach Inaktivität gesperrt

[quality]
good: Gut
uncertain: Unsicher
bad: Schlecht
unknown: Unbekannt

[simulated]
all: Simuliert
partly: Teilweise simuliert

[proof]
none: Ohne Loop-Check
assumed: Ort angenommen
`;
