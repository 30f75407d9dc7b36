/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports plants from the exports folder, one order of an engineer at a time. The event loop accepts orders and reports
   progress; the reload thread carries them out. */
#ifndef IMPORTING_PLANT_IMPORT_H
#define IMPORTING_PLANT_IMPORT_H
#include <stdbool.h>
#include <stddef.h>

#include "importing/import_source.h"

enum { IMPORT_CHOICE_BYTES = 4, IMPORT_ENCODING_BYTES = 24 };

struct import_order {
    /* true: read the models again, and match the tags to assets (equipment); false: only match the tags */
    bool models;
    bool anew; /* true: create the plant file and the tag list from scratch; false: update them */
    /* true: apply the uploaded decisions on which tag belongs to which asset; only valid if `models` is false */
    bool decides;
    /* length unit of models that do not state one: m, mm, cm, in, ft; empty: the default of `plantcast import` */
    char units[IMPORT_CHOICE_BYTES];
    /* upward axis of models that do not state one: y or z; empty: the default of `plantcast import` */
    char up[IMPORT_CHOICE_BYTES];
    /* like `units`, but only for models in OBJ, STL, PLY or 3DS; empty: the default of `plantcast import` */
    char mesh_units[IMPORT_CHOICE_BYTES];
    char encoding[IMPORT_ENCODING_BYTES]; /* character encoding of tag list and models; empty: as stated in the file, or detected */
    struct import_source source;          /* data source of the tags; without a host, the plant's data source stays unchanged */
};

enum import_phase {
    IMPORT_IDLE,
    IMPORT_READING,   /* `plantcast import` is running, which reads the models */
    IMPORT_MATCHING,  /* `plantcast match` is running, which assigns tags to assets */
    IMPORT_PREPARING, /* `plantcast-prep` is running, which makes asset files from the models */
    IMPORT_LOADING    /* the daemon is loading the new plant */
};

struct plant_import;
/* Creates the state of imports. plant_path: path of the plant file; the exports folder next to it is created if needed. Returns
   NULL with errno on failure. */
struct plant_import *plant_import_create(const char *plant_path);
/* Frees the state of imports and sets *import to NULL; accepts a pointer to NULL. */
void plant_import_destroy(struct plant_import **import);

/* --- functions that the event loop calls */

/* Returns the path of the exports folder, valid as long as `import`. */
const char *plant_import_exports(const struct plant_import *import);
/* Returns the path of matches.csv, which `plantcast match` writes; valid as long as `import`. */
const char *plant_import_matches(const struct plant_import *import);
/* Returns the path of the report of `plantcast import`; the file may not exist. Valid as long as `import`. */
const char *plant_import_report(const struct plant_import *import);
/* Returns the name (static text) of the file in the exports folder with decisions on which tag belongs to which asset, as
   applied by orders with `decides`. */
const char *plant_import_decisions(void);
/* Accepts an import order. Returns false while another order is in progress. */
bool plant_import_order(struct plant_import *import, const struct import_order *order);
/* Cancels the import order in progress and undoes the changes that it has made so far. */
void plant_import_cancel(struct plant_import *import);
bool plant_import_busy(struct plant_import *import);
/* Returns the progress of the import, units and axis of the current models, and the plant's data source as JSON; free with mem_free(). */
char *plant_import_text(struct plant_import *import, const struct import_source *source);
/* Returns true if units, axis, encoding and data source of an import order are valid. */
bool import_order_good(const struct import_order *order);

/* --- functions that the reload thread calls */

/* Returns true if an import order is waiting, and copies it to *order. */
bool plant_import_next(struct plant_import *import, struct import_order *order);
void plant_import_set_phase(struct plant_import *import, enum import_phase phase);
/* Appends an import program's output to the messages that engineers can read on the page. */
void plant_import_say(struct plant_import *import, const char *text);
bool plant_import_cancelled(struct plant_import *import);
/* Finishes the import job. in_force: true if the daemon now uses the resulting plant. why: one line that says why the job
   failed; NULL: it succeeded. */
void plant_import_end(struct plant_import *import, bool in_force, const char *why);

#endif
