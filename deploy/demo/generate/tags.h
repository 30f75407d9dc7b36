/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is measured, where, and what it reads when the unit runs well.

   Sim Value is the reading in normal operation. Sim Loop says what the reading follows (which upsets a loop feels:
   plantcast-sim --help):
     charge      cold feed, tank to E-101             feed       its pressure behind the pumps
     preheat     feed behind E-101                    column     T-101 and its vapour
     reboiler    E-102, column bottom                 bottoms    cold half of E-101's shell, to E-104
     product     behind E-104                         overhead   pressure at the top
     fans        behind EA-101                        condenser  E-103's shell
     drum        V-101                                reflux     V-101 to T-101 and E-105
     distillate  behind E-105                         offgas     V-102 and the gas through K-101
     water       cooling water supply                 cooling    cooling water in channels and returns
     steam       supply and condensate                storage    tanks
     weather     what follows the air                 spare      machines that stand by
     P-101 P-102 P-103 K-101 EA-101                   machines that run

   Modbus map, plc1, unit 1, holding registers, first register 40001:
     40001..  temperatures, Float32 CDAB (two registers), windings Int16 0..2000 = 0..200 °C
     40401..  pressures, Int16 0..27648 = 0..16 bar
     40601..  vibration velocities, Float32 CDAB */
#ifndef GENERATE_TAGS_H
#define GENERATE_TAGS_H
#include <stdbool.h>
#include <stddef.h>

#include "vec.h"

enum tag_kind { TAG_TEMPERATURE, TAG_WINDING, TAG_PRESSURE, TAG_VIBRATION };

struct tag {
    char *name, *description;
    const char *asset, *part; /* the node `ASSET PART` carries the sensor */
    struct vec near;          /* asset's own frame: the sensor sits on the nearest point of that part */
    enum tag_kind kind;
    bool node;                /* bound by a node of that name, with an instrument to see; else by coordinates */
    double value, band;       /* band: L and H are that far from the value, LL and HH 1.6 times; 0: the group's limits */
    const char *loop;
    struct vec position;      /* plant frame, on the surface; by sensors_place */
    int address;
};

struct tags {
    struct tag *at;
    size_t count, capacity;
};

void tags_make(struct tags *tags);
void tags_finish(struct tags *tags);

#endif
