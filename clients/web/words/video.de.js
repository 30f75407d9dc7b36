// SPDX-License-Identifier: GPL-3.0-or-later
// Words of plantcast-video, in German. The build makes a C header from it; a value takes the place of each {}.
export default `
starting: STARTET
not_let_in: NICHT ZUGELASSEN
no_view: DIESE ANSICHT GIBT ES NICHT
no_picture: KEIN BILD
too_slow: DER SERVER IST ZU LANGSAM
silent: DER SERVER SCHWEIGT
no_connection: KEINE VERBINDUNG ZUM SERVER
no_values: KEINE AKTUELLEN WERTE
since: seit {}
nothing_yet: noch ist kein Bild gekommen
token: der Server nimmt dieses Token nicht an: {}
tokens: der Server prüft eine Weile keine Tokens dieser Adresse mehr
answers: der Server antwortet {}: {}
views: eine Ansicht „{}“ gibt es nicht; es gibt: {}
none: keine
took: ein Bild dauerte {} s und darf {} s dauern; ein kleineres --size hilft
earlier: der Server sagt nicht, wie alt seine Werte sind: er ist von einer früheren Version
no_png: was der Server schickte, ist kein PNG von {}x{}
no_answer: er antwortet nicht
no_url: aus ihren Parametern wird keine URL
no_value: der Server ist da, aber kein gezeigter Sensor meldet einen Wert
said: {}
age_s: Werte bis zu {} s alt
age_min: Werte bis zu {} min alt
`;
