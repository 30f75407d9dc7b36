/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growing file of what was proven, and the last word on each tag. */
#include "proving/proofs.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "plant/csv.h"

const char *const proof_names[] = {
    [PROOF_NONE] = "none", [PROOF_PASSED] = "pass", [PROOF_FAILED] = "fail", [PROOF_CHANGED] = "changed"
};
static const char head[] = "Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By,Remark,Fingerprint\n";

struct proofs {
    struct log *log;
    const struct plant *plant;
    char *folder, *path;
    struct proof *at;  /* by tag */
    uint64_t *numbers; /* likewise */
    uint64_t number;
    bool begun;
    atomic_bool *unproven; /* by tag */
};

/* --- what a proof is of ------------------------------------------------------------------------------------------------------- */

uint64_t proof_fingerprint(const struct plant *plant, int index)
{
    const struct plant_tag *tag = &plant->tags[index];
    struct text text = { 0 };
    text_add(&text, "%s|%s|%d|%d|%d|%d|%d|%d|", tag->source >= 0 ? plant->sources[tag->source].id : "", tag->address ? tag->address : "",
             tag->modbus_unit, (int)tag->table, tag->register_index, tag->bit, (int)tag->type, (int)tag->byte_order);
    text_add(&text, "%d|%.17g|%.17g|%.17g|%.17g|%d|", (int)tag->scaling, tag->raw_low, tag->raw_high, tag->scaled_low, tag->scaled_high,
             tag->negate);
    text_add(&text, "%s|%s|%.17g|%.17g|%.17g", tag->asset >= 0 ? plant->assets[tag->asset].id : "", tag->node ? tag->node : "",
             tag->position_m[0], tag->position_m[1], tag->position_m[2]);
    if (tag->change.converts)
        text_add(&text, "|%.17g|%.17g", tag->change.factor, tag->change.offset);
    uint64_t hash = XXH3_64bits(text.at, text.length);
    text_finish(&text);
    return hash;
}

/* --- the file ------------------------------------------------------------------------------------------------------------------ */

static void add_text(struct text *out, const char *text)
{
    text_add(out, text_is_formula(text) ? ",\"'" : ",\"");
    for (; *text; text++)
        text_add(out, *text == '"' ? "\"\"" : "%c", (unsigned char)*text < 32 ? ' ' : *text);
    text_add(out, "\"");
}

static void add_number(struct text *out, double number)
{
    if (isfinite(number))
        text_add(out, ",%.9g", number);
    else
        text_add(out, ",");
}

static void add_row(struct text *out, const struct plant *plant, int index, const struct proof *proof)
{
    const struct plant_tag *tag = &plant->tags[index];
    char when[32] = "";
    time_t seconds = (time_t)(proof->time_us / 1000000);
    struct tm utc;
    if (proof->time_us > 0 && gmtime_r(&seconds, &utc))
        strftime(when, sizeof(when), "%Y-%m-%dT%H:%M:%SZ", &utc);
    text_add(out, "%s", when);
    add_text(out, tag->name);
    text_add(out, ",%s", proof_names[proof->state]);
    add_number(out, proof->value);
    add_text(out, tag->unit ? tag->unit : "");
    add_number(out, proof->expected);
    add_number(out, proof->tolerance);
    add_text(out, proof->who);
    add_text(out, proof->remark);
    text_add(out, ",%016" PRIx64 "\n", proof_fingerprint(plant, index));
}

static double number_of(const struct csv *csv, int column)
{
    const char *text = csv_text(csv, column);
    char *end;
    double number = strtod(text, &end);
    return *text && !*end ? number : NAN;
}

/* 0: no time. */
static int64_t time_of(const char *text)
{
    struct tm utc = { 0 };
    char *end = strptime(text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return end && !*end ? (int64_t)timegm(&utc) * 1000000 : 0;
}

static void read_row(struct proofs *proofs, const struct csv *csv)
{
    enum { TIME, NAME, RESULT, VALUE, UNIT, EXPECTED, TOLERANCE, BY, REMARK, FINGERPRINT };
    int tag = plant_find_tag(proofs->plant, text_cell_read(csv_text(csv, NAME)));
    const char *fingerprint = csv_text(csv, FINGERPRINT), *result = csv_text(csv, RESULT);
    bool passed = !strcmp(result, proof_names[PROOF_PASSED]);
    if (strlen(fingerprint) != 16 || (!passed && strcmp(result, proof_names[PROOF_FAILED]) != 0)) /* cut off as it was written */
        return;
    proofs->begun = true;
    if (tag < 0)
        return;
    struct proof *proof = &proofs->at[tag];
    bool same = strtoull(fingerprint, NULL, 16) == proof_fingerprint(proofs->plant, tag);
    *proof = (struct proof){ .state = !same    ? PROOF_CHANGED
                                      : passed ? PROOF_PASSED
                                               : PROOF_FAILED,
                             .time_us = time_of(csv_text(csv, TIME)),
                             .value = number_of(csv, VALUE),
                             .expected = number_of(csv, EXPECTED),
                             .tolerance = number_of(csv, TOLERANCE) };
    snprintf(proof->who, sizeof(proof->who), "%s", text_cell_read(csv_text(csv, BY)));
    snprintf(proof->remark, sizeof(proof->remark), "%s", text_cell_read(csv_text(csv, REMARK)));
}

static void mark_unproven(struct proofs *proofs)
{
    for (size_t i = 0; i < proofs->plant->tag_count; i++)
        atomic_store(&proofs->unproven[i], proofs->begun && proofs->plant->tags[i].source >= 0 && proofs->at[i].state != PROOF_PASSED);
}

static void read_all(struct proofs *proofs)
{
    struct diag diag = { 0 };
    struct csv csv;
    if (csv_open(&csv, proofs->path, &diag)) {
        while (csv_next(&csv))
            read_row(proofs, &csv);
        csv_close(&csv);
    }
    for (size_t i = 0; i < diag.count; i++)
        log_warn(proofs->log, "%s:%d: %s", diag.items[i].file, diag.items[i].line, diag.items[i].text);
    diag_finish(&diag);
}

struct proofs *proofs_open(struct log *log, const struct plant *plant, const char *folder)
{
    struct proofs *proofs = mem_new(sizeof(*proofs));
    proofs->log = log;
    proofs->plant = plant;
    proofs->folder = mem_strdup(folder);
    proofs->path = mem_printf("%s/" PROOFS_FILE, folder);
    proofs->at = mem_array(plant->tag_count, sizeof(*proofs->at));
    proofs->numbers = mem_array(plant->tag_count, sizeof(*proofs->numbers));
    for (size_t i = 0; i < plant->tag_count; i++)
        proofs->at[i] = (struct proof){ .value = NAN, .expected = NAN, .tolerance = NAN };
    proofs->unproven = mem_array(plant->tag_count, sizeof(*proofs->unproven));
    if (access(proofs->path, F_OK) == 0)
        read_all(proofs);
    mark_unproven(proofs);
    return proofs;
}

void proofs_close(struct proofs **pointer)
{
    struct proofs *proofs = *pointer;
    if (!proofs)
        return;
    mem_free(proofs->folder);
    mem_free(proofs->path);
    mem_free(proofs->at);
    mem_free(proofs->numbers);
    mem_free(proofs->unproven);
    mem_free(proofs);
    *pointer = NULL;
}

/* A line that was cut off, by a power cut say, is ended first. The historian makes the folder too, on a thread of its own, and may not
 * have come to it yet. */
static bool append(const char *folder, const char *path, const struct text *row)
{
    mkdir(folder, 0777); /* where it cannot be made, opening says why */
    FILE *file = fopen(path, "a+b");
    if (!file)
        return false;
    bool good = fseek(file, 0, SEEK_END) == 0;
    long size = good ? ftell(file) : -1;
    if (size == 0)
        good = fputs(head, file) >= 0;
    else if (good && size > 0 && fseek(file, -1, SEEK_END) == 0 && fgetc(file) != '\n')
        good = fseek(file, 0, SEEK_END) == 0 && fputc('\n', file) != EOF;
    good = good && fwrite(row->at, 1, row->length, file) == row->length && fflush(file) == 0 && fsync(fileno(file)) == 0;
    int error = errno;
    fclose(file);
    errno = error;
    return good;
}

const char *proofs_add(struct proofs *proofs, int tag, const struct proof *proof)
{
    struct text row = { 0 };
    add_row(&row, proofs->plant, tag, proof);
    bool good = append(proofs->folder, proofs->path, &row);
    text_finish(&row);
    if (!good) {
        log_err(proofs->log, "%s: %s: %s", proofs->path, proofs->plant->tags[tag].name, strerror(errno));
        return "it could not be kept on disk; the log says why";
    }
    proofs->at[tag] = *proof;
    proofs->numbers[tag] = ++proofs->number;
    proofs->begun = true;
    mark_unproven(proofs);
    return NULL;
}

/* --- what there is ---------------------------------------------------------------------------------------------------------------- */

const struct proof *proofs_of(const struct proofs *proofs, int tag)
{
    return &proofs->at[tag];
}

bool proofs_begun(const struct proofs *proofs)
{
    return proofs->begun;
}

bool proofs_unproven(const struct proofs *proofs, int tag)
{
    return atomic_load(&proofs->unproven[tag]);
}

uint64_t proofs_number(const struct proofs *proofs)
{
    return proofs->number;
}

uint64_t proofs_number_of(const struct proofs *proofs, int tag)
{
    return proofs->numbers[tag];
}

void proofs_print(const struct proofs *proofs, struct text *out)
{
    text_add(out, "%s", head);
    for (size_t i = 0; i < proofs->plant->tag_count; i++)
        if (proofs->plant->tags[i].source >= 0)
            add_row(out, proofs->plant, (int)i, &proofs->at[i]);
}
