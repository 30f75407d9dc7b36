/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant's palette. Immutable. */
#ifndef GENERATE_MATERIAL_H
#define GENERATE_MATERIAL_H

enum material {
    MATERIAL_CLADDING,      /* aluminium sheet over insulation */
    MATERIAL_STAINLESS,
    MATERIAL_GALVANISED,    /* gratings, ladders, cable trays, nuts and bolts of structures */
    MATERIAL_BOLTING,
    MATERIAL_VESSEL,        /* painted carbon steel, light */
    MATERIAL_TANK,
    MATERIAL_PIPE,
    MATERIAL_CHANNEL,       /* exchanger heads */
    MATERIAL_PUMP,
    MATERIAL_MOTOR,
    MATERIAL_STRUCTURE,
    MATERIAL_COOLING_WATER,
    MATERIAL_SAFETY_YELLOW,
    MATERIAL_HANDWHEEL,
    MATERIAL_ACTUATOR,
    MATERIAL_INSTRUMENT,
    MATERIAL_BLACK,         /* rubber, openings */
    MATERIAL_CONCRETE,
    MATERIAL_PLINTH,        /* newer, lighter concrete; fireproofing */
    MATERIAL_JOINT,
    MATERIAL_GRAVEL,
    MATERIAL_COUNT
};

struct material_look {
    const char *name;
    double srgb[3]; /* base colour as seen, 0..1 */
    double metallic, roughness;
};
extern const struct material_look material_looks[MATERIAL_COUNT];

#endif
