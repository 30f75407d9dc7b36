/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings a plant in, one order after the other: the loop takes orders and says how far they are, the reload thread carries them out. */
#ifndef IMPORTING_PLANT_IMPORT_H
#define IMPORTING_PLANT_IMPORT_H
#include <stdbool.h>
#include <stddef.h>

#include "importing/import_source.h"

enum { IMPORT_CHOICE_BYTES = 4, IMPORT_ENCODING_BYTES = 24 };

struct import_order {
    bool models;                     /* models are read anew, and tags matched; else only that */
    bool anew;                       /* plant file and tag list are made anew, not brought up to date */
    bool decides;                    /* without models: the decisions that were uploaded are taken */
    char units[IMPORT_CHOICE_BYTES]; /* of models that do not say theirs: m, mm, cm, in, ft; "": what the reader takes them for */
    char up[IMPORT_CHOICE_BYTES];    /* likewise: y or z */
    char mesh_units[IMPORT_CHOICE_BYTES]; /* as units, of OBJ, STL, PLY and 3DS alone */
    char encoding[IMPORT_ENCODING_BYTES]; /* of tag list and models, by its name; "": the one that they state or look like */
    struct import_source source;     /* of the tags; without a host: as it is */
};

enum import_phase {
    IMPORT_IDLE,
    IMPORT_READING,   /* plantcast import */
    IMPORT_MATCHING,  /* plantcast match */
    IMPORT_PREPARING, /* plantcast-prep */
    IMPORT_LOADING    /* the plant is put in force */
};

struct plant_import;
/* plant_path: of the plant file. Makes the folder of exports beside it if need be. Returns NULL with errno if it cannot. */
struct plant_import *plant_import_create(const char *plant_path);
void plant_import_destroy(struct plant_import **import); /* &NULL is fine; leaves NULL */

/* --- for the loop */

/* Returns the folder of exports, which lives as long as it does. */
const char *plant_import_exports(const struct plant_import *import);
/* Returns the path of matches.csv, which plantcast match writes; likewise. */
const char *plant_import_matches(const struct plant_import *import);
/* Returns the path of the report that plantcast import writes; the file may be absent. Lives as long as `import`. */
const char *plant_import_report(const struct plant_import *import);
/* Returns the name, in the folder of exports, of the decisions that an order without models takes; static. */
const char *plant_import_decisions(void);
/* Takes an order. Returns false while another is carried out. */
bool plant_import_order(struct plant_import *import, const struct import_order *order);
/* Has the order under way end; what it changed is undone. */
void plant_import_cancel(struct plant_import *import);
bool plant_import_busy(struct plant_import *import);
/* Returns how far it is, with units and axis that the models in force were read with, and the plant's source, as JSON; mem_free. */
char *plant_import_text(struct plant_import *import, const struct import_source *source);
/* Returns whether units, axis and source of an order are among those that there are. */
bool import_order_good(const struct import_order *order);

/* --- for the reload thread */

/* Returns whether there is an order to be carried out, and copies it. */
bool plant_import_next(struct plant_import *import, struct import_order *order);
void plant_import_set_phase(struct plant_import *import, enum import_phase phase);
/* Appends what a program printed, which is told to engineers. */
void plant_import_say(struct plant_import *import, const char *text);
bool plant_import_cancelled(struct plant_import *import);
/* Ends the order. in_force: the plant that it made is. why: one line of what went wrong; NULL: nothing. */
void plant_import_end(struct plant_import *import, bool in_force, const char *why);

#endif
