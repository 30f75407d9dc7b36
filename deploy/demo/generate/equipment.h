/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The families of equipment. Each call builds one asset in its place and names its nozzles; z = 0 is the slab.
   Concrete under it goes to the civil asset, platforms, ladders and supports to the access asset: what a sensor's field covers is
   the thing that the tag names. */
#ifndef GENERATE_EQUIPMENT_H
#define GENERATE_EQUIPMENT_H
#include "model.h"

struct site {
    struct model model;
    struct item civil, access;
};

void civil_plinth(struct site *site, struct frame at, double x0, double x1, double y0, double y1, double height);

struct exchanger_spec { /* shell and tube; the axis runs along x, channel at -x */
    double r, length;   /* outside of the insulation; between the girth flanges */
    double axis_z, base_z; /* centre line; what the saddles stand on: a plinth on the slab, or a floor (then > 1 m: no plinth) */
    double tube_nozzle_r, shell_nozzle_r;
    int sides, studs;
    double step;
    enum material shell;
};
/* Nozzles: N1 tube side bottom, N2 tube side top (channel), N3 shell top (rear), N4 shell bottom (front). */
void exchanger_build(struct site *site, const char *name, struct frame at, const struct exchanger_spec *spec);
/* A kettle reboiler, channel at -x. N1 steam (top), N2 condensate (bottom), N3 vapour (top of shell), N4 feed (bottom), N5 bottoms. */
void kettle_build(struct site *site, const char *name, struct frame at);

struct column_spec {
    double r, skirt, height; /* height: upper tangent line above the slab */
};
/* Nozzles: N1 overhead, N2 reflux, N3 feed, N4 reboiler return, N5 bottoms (inside the skirt). */
void column_build(struct site *site, const char *name, struct frame at, const struct column_spec *spec);

/* Horizontal drum with boot, axis along x, saddles on base_z. N1 inlet (top), N2 liquid (bottom), N3 vapour (top), N4 water (boot). */
void drum_build(struct site *site, const char *name, struct frame at, double r, double length, double base_z);
/* Vertical knock-out drum on a skirt. N1 inlet (side), N2 vapour (top), N3 drain (bottom). */
void knockout_build(struct site *site, const char *name, struct frame at, double r, double length);

struct tank_spec {
    double r, height;
    double stair_from_deg; /* foot of the spiral stair */
};
/* Cone-roof tank. N1 outlet (low, towards +x), N2 inlet (top of the shell, towards -y), N3 vent. */
void tank_build(struct site *site, const char *name, struct frame at, const struct tank_spec *spec);

/* Centrifugal pump and motor on a baseplate, shaft along x, pump end at -x. N1 suction (end), N2 discharge (top). */
void pump_build(struct site *site, const char *name, struct frame at);
/* Plinth of a pump that model_add_instance repeats. */
void pump_plinth(struct site *site, struct frame at);

/* Centrifugal compressor, gear and motor on a skid, shaft along x. N1 suction (top), N2 discharge (top). */
void compressor_build(struct site *site, const char *name, struct frame at);

/* Two bays of a forced-draught air cooler; tubes along y, legs on base z = 0. N1, N2 inlets (south), N3, N4 outlets (north). */
void air_cooler_build(struct site *site, const char *name, struct frame at, double bay_width, double tube_length);

#endif
