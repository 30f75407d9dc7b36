/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Imports plants, one order at a time: the loop accepts orders and reports progress, the reload thread carries them out. */
#ifndef IMPORTING_PLANT_IMPORT_H
#define IMPORTING_PLANT_IMPORT_H
#include <stdbool.h>
#include <stddef.h>

#include "importing/import_source.h"

enum { IMPORT_CHOICE_BYTES = 4, IMPORT_ENCODING_BYTES = 24 };

struct import_order {
    bool models;                          /* true: read the models again, and match the tags to assets; false: only match the tags */
    bool anew;                            /* create plant file and tag list from scratch instead of updating them */
    bool decides;                         /* without `models`: apply the uploaded match decisions */
    char units[IMPORT_CHOICE_BYTES];      /* unit of models that do not state one: m, mm, cm, in, ft; "": the reader's default */
    char up[IMPORT_CHOICE_BYTES];         /* upward axis of such models: y or z; "": the reader's default */
    char mesh_units[IMPORT_CHOICE_BYTES]; /* like `units`, for OBJ, STL, PLY and 3DS only */
    char encoding[IMPORT_ENCODING_BYTES]; /* encoding of tag list and models; "": stated in the file or detected */
    struct import_source source;          /* source of the tags; without a host: unchanged */
};

enum import_phase {
    IMPORT_IDLE,
    IMPORT_READING,   /* plantcast import is running */
    IMPORT_MATCHING,  /* plantcast match is running */
    IMPORT_PREPARING, /* plantcast-prep is running */
    IMPORT_LOADING    /* the new plant is being loaded */
};

struct plant_import;
/* Creates the state. plant_path: path of the plant file; the folder of exports is created next to it if needed. Returns NULL with errno
   on failure. */
struct plant_import *plant_import_create(const char *plant_path);
void plant_import_destroy(struct plant_import **import); /* Frees the state. &NULL is fine; leaves NULL. */

/* --- called from the loop */

/* Returns the path of the exports folder, valid as long as `import`. */
const char *plant_import_exports(const struct plant_import *import);
/* Returns the path of matches.csv, which plantcast match writes; valid as long as `import`. */
const char *plant_import_matches(const struct plant_import *import);
/* Returns the path of the report that plantcast import writes; the file may be absent. Valid as long as `import`. */
const char *plant_import_report(const struct plant_import *import);
/* Returns the name, in the exports folder, of the file with match decisions, which an order with `models` false applies; static. */
const char *plant_import_decisions(void);
/* Accepts an order. Returns false while another one is in progress. */
bool plant_import_order(struct plant_import *import, const struct import_order *order);
/* Cancels the order in progress; its changes are undone. */
void plant_import_cancel(struct plant_import *import);
bool plant_import_busy(struct plant_import *import);
/* Returns the progress, the units and axis of the models in use, and the plant's source, as JSON; free with mem_free(). */
char *plant_import_text(struct plant_import *import, const struct import_source *source);
/* Returns whether units, axis, encoding and source of an order have valid values. */
bool import_order_good(const struct import_order *order);

/* --- functions that the reload thread calls */

/* Returns whether an order waits to be carried out, and copies it. */
bool plant_import_next(struct plant_import *import, struct import_order *order);
void plant_import_set_phase(struct plant_import *import, enum import_phase phase);
/* Appends the output of a program, which engineers can read. */
void plant_import_say(struct plant_import *import, const char *text);
bool plant_import_cancelled(struct plant_import *import);
/* Ends the order. in_force: true if the plant that the order made is in use now. why: one line about the error; NULL: no error. */
void plant_import_end(struct plant_import *import, bool in_force, const char *why);

#endif
