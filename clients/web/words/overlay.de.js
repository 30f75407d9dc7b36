// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that the server draws over pictures, in German. The build makes a C header from this file; {} is replaced by a value.
export default `
no_limits: ohne Grenzwerte
no_data: keine Daten
uncertain: unsicher
drawn_error: unsicher: gezeichnet
drawn_error_2: mit bis zu {} Fehler
unproven: ohne Loop-Check
place_assumed: Ort angenommen
direction_unknown: Richtung unbekannt
priority_1: Alarm, Priorität 1
priority_2: Alarm, Priorität 2
priority_3: Alarm, Priorität 3
priority_4: Alarm, Priorität 4
by_limits: nach Grenzwerten der Messstelle
logarithmic: logarithmische Skala
deviation: Standardabweichung
misread: kann täuschen
glossy: glänzend: Licht ändert
glossy_2: die Farben
bad: SCHLECHT
held_since: gehalten seit {}
unknown_then: damals unbekannt
from: Abstand von {}
hot_spot: Erkennbarer Hotspot: {}
hot_spot_size: {} m groß, sichtbar mit {} % des Bereichs
since: seit {}
alarms: {} Alarme
worst: höchster {}
no_values: keine Werte
old_s: {} s alt
old_min: {} min alt
old_h: {} h alt
configuration: Konfiguration {}
clock_unset: UHR NICHT SYNCHRONISIERT
simulated: SIMULIERT
no_live_data: KEINE LIVE-DATEN
history: VERGANGENHEIT
no_data_then: KEINE DATEN
unseen_one: {} nicht sichtbarer Alarm
unseen: {} nicht sichtbare Alarme
unseen_such_as: {} nicht sichtbare Alarme, wie
look_default: Farbtreu
look_glossy: Glänzend
look_flat: Unschattiert
look_materials: Materialien
interpolation_shepard: Shepard
interpolation_paper: Kim & Suh, Algorithmus 1
interpolation_harmonic: Wärmeleitung in der Wand
interpolation_fin: Wärmeleitung und Verlust an die Luft
interpolation_gp: Wahrscheinlichstes Feld
distance_geodesic: Abstand entlang der Oberfläche
distance_euclidean: Luftlinie
distance_heat: Abstand nach der Wärmemethode
power: Exponent {}
strength: Stärke {}
decay: Abfall {}
radius: Radius {} m
radius_automatic: Radius automatisch
reach: Reichweite {} m
reach_unlimited: Reichweite unbegrenzt
not_filled: Nicht gefüllt
filled: Aus der Umgebung gefüllt
weighted: Von Hand gewichtete Sensoren: {}
as_configured: Sensoren wie konfiguriert
`;
