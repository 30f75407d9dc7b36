/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Appends loop checks (tests that a value forced at a transmitter arrives as the tag's value) to a file, and keeps the newest
   check of each tag in memory. */
#include "loopcheck/loop_checks.h"

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

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/utf8.h"
#include "plant/parse/csv.h"
#include "plant/plant_folder.h"
#include "plant/sources/mqtt_address.h"

const char *const loop_check_state_names[] = {
    [LOOP_CHECK_NONE] = "none", [LOOP_CHECK_PASSED] = "pass", [LOOP_CHECK_FAILED] = "fail", [LOOP_CHECK_CHANGED] = "changed"
};
static const char head[] = "Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By,Remark,Fingerprint\n";

struct loop_checks {
    struct log *log;
    const struct plant *plant;
    struct file_writer *writer;
    char *folder, *path;
    struct loop_check *at; /* [tag]: newest loop check */
    uint64_t *numbers;     /* [tag]: sequence number (loop_checks_number()) of the tag's newest loop check */
    uint64_t number, replaced_number;
    bool begun;
    /* [tag]: true if pictures mark the tag as unproven, because it has no passed loop check (test with a value forced at the
       transmitter); read by the render threads */
    atomic_bool *unproven;
};

/* --- fingerprint of a tag's configuration ----------------------------------------------------------------------------------- */

/* Adds where the tag's source finds the value: like the address, but including what the source's keys `unit`, `topic` and `value`
   contribute. */
static void add_resolved_address(struct text *text, const struct plant *plant, const struct plant_tag *tag)
{
    const struct tag_signal *signal = &tag->signal;
    text_add(text, "|%d|%s|%s|%d", plant_tag_modbus_unit(plant, tag), signal->topic ? signal->topic : "", mqtt_address_path(plant, tag),
             signal->element);
}

/* resolved: false computes the hash that older versions recorded, which lacks the resolved address. */
static uint64_t hash_settings(const struct plant *plant, int index, bool resolved)
{
    const struct plant_tag *tag = &plant->tags[index];
    const struct tag_signal *signal = &tag->signal;
    const struct tag_scale *scale = &tag->scale;
    const double *at_m = tag->place.position_m;
    struct text text = { 0 };
    text_add(&text, "%s|%s|%d|%d|%d|%d|%d|%d|", tag->source >= 0 ? plant->sources[tag->source].id : "",
             signal->address ? signal->address : "", signal->modbus_unit, (int)signal->table, signal->register_index, signal->bit,
             (int)signal->type, (int)signal->byte_order);
    text_add(&text, "%d|%.17g|%.17g|%.17g|%.17g|%d|", (int)scale->kind, scale->raw_low, scale->raw_high, scale->scaled_low,
             scale->scaled_high, scale->negate);
    text_add(&text, "%s|%s|%.17g|%.17g|%.17g", tag->asset >= 0 ? plant->assets[tag->asset].id : "", tag->place.node ? tag->place.node : "",
             at_m[0], at_m[1], at_m[2]);
    if (scale->change.converts)
        text_add(&text, "|%.17g|%.17g", scale->change.factor, scale->change.offset);
    /* appended only if set: loop checks of tags without these settings keep the fingerprint that older versions recorded */
    if (scale->ne43)
        text_add(&text, "|ne43");
    for (int i = 0; i < scale->sentinel_count; i++) {
        const struct plant_sentinel *sentinel = &scale->sentinels[i];
        if (sentinel->is_bits)
            text_add(&text, "|0x%" PRIx64, sentinel->bits);
        else
            text_add(&text, "|open %.17g", sentinel->number);
    }
    if (resolved && tag->source >= 0)
        add_resolved_address(&text, plant, tag);
    uint64_t hash = XXH3_64bits(text.at, text.length);
    text_finish(&text);
    return hash;
}

uint64_t loop_check_fingerprint(const struct plant *plant, int tag)
{
    return hash_settings(plant, tag, true);
}

/* Returns whether a recorded fingerprint belongs to the tag's present settings. */
static bool is_current(const struct plant *plant, int tag, uint64_t fingerprint)
{
    return fingerprint == hash_settings(plant, tag, true) || fingerprint == hash_settings(plant, tag, false);
}

/* Removes an incomplete last character, which shortened texts may have, because JSON and the file must not contain it. */
static void complete_texts(struct loop_check *check)
{
    utf8_drop_invalid(check->unit);
    utf8_drop_invalid(check->who);
    utf8_drop_invalid(check->remark);
}

/* Stores the tag's present unit and fingerprint in a loop check. */
static void stamp(const struct plant *plant, int tag, struct loop_check *check)
{
    snprintf(check->unit, sizeof(check->unit), "%s", plant->tags[tag].unit ? plant->tags[tag].unit : "");
    check->fingerprint = loop_check_fingerprint(plant, tag);
    complete_texts(check);
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

static void add_row(struct text *out, const char *name, const struct loop_check *check)
{
    char when[32] = "";
    time_t seconds = (time_t)(check->time_us / 1000000);
    struct tm utc;
    if (check->time_us > 0 && gmtime_r(&seconds, &utc))
        strftime(when, sizeof(when), "%Y-%m-%dT%H:%M:%SZ", &utc);
    text_add(out, "%s", when);
    add_text(out, name);
    text_add(out, ",%s", loop_check_state_names[check->state]);
    add_number(out, check->value);
    add_text(out, check->unit);
    add_number(out, check->expected);
    add_number(out, check->tolerance);
    add_text(out, check->who);
    add_text(out, check->remark);
    text_add(out, ",%016" PRIx64 "\n", check->fingerprint);
}

static double number_of(const struct csv *csv, int column)
{
    const char *text = csv_text(csv, column);
    char *end;
    double number = strtod(text, &end);
    return *text && !*end ? number : NAN;
}

/* Parses the timestamp of a row. Returns microseconds UTC; 0: the text is not a timestamp. */
static int64_t time_of(const char *text)
{
    struct tm utc = { 0 };
    char *end = strptime(text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return end && !*end ? (int64_t)timegm(&utc) * 1000000 : 0;
}

static void read_row(struct loop_checks *loop_checks, const struct csv *csv)
{
    enum { TIME, NAME, RESULT, VALUE, UNIT, EXPECTED, TOLERANCE, BY, REMARK, FINGERPRINT };
    int tag = plant_find_tag(loop_checks->plant, text_cell_read(csv_text(csv, NAME)));
    const char *fingerprint_text = csv_text(csv, FINGERPRINT), *result = csv_text(csv, RESULT);
    bool passed = !strcmp(result, loop_check_state_names[LOOP_CHECK_PASSED]);
    if (strlen(fingerprint_text) != 16 ||
        /* skips an incomplete row, which remains if the daemon was interrupted while writing it */
        (!passed && strcmp(result, loop_check_state_names[LOOP_CHECK_FAILED]) != 0))
        return;
    loop_checks->begun = true;
    if (tag < 0)
        return;
    struct loop_check *check = &loop_checks->at[tag];
    uint64_t fingerprint = strtoull(fingerprint_text, NULL, 16);
    bool current = is_current(loop_checks->plant, tag, fingerprint);
    *check = (struct loop_check){ .state = !current ? LOOP_CHECK_CHANGED
                                           : passed ? LOOP_CHECK_PASSED
                                                    : LOOP_CHECK_FAILED,
                                  .time_us = time_of(csv_text(csv, TIME)),
                                  .value = number_of(csv, VALUE),
                                  .expected = number_of(csv, EXPECTED),
                                  .tolerance = number_of(csv, TOLERANCE),
                                  .fingerprint = fingerprint };
    snprintf(check->unit, sizeof(check->unit), "%s", text_cell_read(csv_text(csv, UNIT)));
    snprintf(check->who, sizeof(check->who), "%s", text_cell_read(csv_text(csv, BY)));
    snprintf(check->remark, sizeof(check->remark), "%s", text_cell_read(csv_text(csv, REMARK)));
    complete_texts(check);
}

static void mark_unproven(struct loop_checks *loop_checks)
{
    for (size_t i = 0; i < loop_checks->plant->tag_count; i++)
        atomic_store(&loop_checks->unproven[i],
                     loop_checks->begun && loop_checks->plant->tags[i].source >= 0 && loop_checks->at[i].state != LOOP_CHECK_PASSED);
}

static void read_all(struct loop_checks *loop_checks)
{
    struct diag diag = { 0 };
    struct csv csv;
    if (csv_open(&csv, loop_checks->path, &diag)) {
        while (csv_next(&csv))
            read_row(loop_checks, &csv);
        csv_close(&csv);
    }
    for (size_t i = 0; i < diag.count; i++)
        log_warn(loop_checks->log, "%s:%d: %s", diag.items[i].file, diag.items[i].line, diag.items[i].text);
    diag_finish(&diag);
}

static void forget_all(struct loop_checks *loop_checks)
{
    for (size_t i = 0; i < loop_checks->plant->tag_count; i++)
        loop_checks->at[i] = (struct loop_check){ .value = NAN, .expected = NAN, .tolerance = NAN };
}

struct loop_checks *loop_checks_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer)
{
    struct loop_checks *loop_checks = mem_new(sizeof(*loop_checks));
    loop_checks->log = log;
    loop_checks->plant = plant;
    loop_checks->writer = writer;
    loop_checks->folder = folder ? mem_strdup(folder) : NULL;
    loop_checks->path = folder ? mem_printf("%s/" LOOP_CHECKS_FILE, folder) : NULL;
    loop_checks->at = mem_array(plant->tag_count, sizeof(*loop_checks->at));
    loop_checks->numbers = mem_array(plant->tag_count, sizeof(*loop_checks->numbers));
    forget_all(loop_checks);
    loop_checks->unproven = mem_array(plant->tag_count, sizeof(*loop_checks->unproven));
    if (folder && access(loop_checks->path, F_OK) == 0)
        read_all(loop_checks);
    mark_unproven(loop_checks);
    return loop_checks;
}

void loop_checks_close(struct loop_checks **pointer)
{
    struct loop_checks *loop_checks = *pointer;
    if (!loop_checks)
        return;
    file_writer_forget(loop_checks->writer, loop_checks);
    mem_free(loop_checks->folder);
    mem_free(loop_checks->path);
    mem_free(loop_checks->at);
    mem_free(loop_checks->numbers);
    mem_free(loop_checks->unproven);
    mem_free(loop_checks);
    *pointer = NULL;
}

struct row_job {
    /* job for the thread that writes files; must be the first member, because that thread passes a pointer to it. job.owner is
       the struct loop_checks, or NULL after that was closed */
    struct file_job job;
    struct loop_checks *loop_checks;
    struct log *log;
    char *folder, *path;
    struct text row;
    int tag;
    struct loop_check check;
};

/* Ends the last line of the file, which is incomplete. If the line breaks off inside a quoted cell, closes the cell too, because the
   newline would otherwise belong to it. Rows contain no newlines of their own (add_text()). */
static bool end_line(FILE *file)
{
    bool quoted = false;
    rewind(file);
    for (int byte; (byte = fgetc(file)) != EOF;)
        quoted = byte != '\n' && quoted != (byte == '"');
    return !ferror(file) && fseek(file, 0, SEEK_END) == 0 && fputs(quoted ? "\"\n" : "\n", file) >= 0;
}

/* Appends a row to the file. If the file ends in an incomplete line, for example after a power failure, ends that line first.
   Creates the folder if needed, because the historian's thread, which also creates it, may not have run yet. */
static int append(struct file_job *job)
{
    const struct row_job *own = (const struct row_job *)job;
    const struct text *row = &own->row;
    mkdir(own->folder, 0777); /* ignores the result: if the folder cannot be created, opening the file reports the reason */
    FILE *file = fopen(own->path, "a+b");
    if (!file)
        return -errno;
    bool good = fseek(file, 0, SEEK_END) == 0;
    long size = good ? ftell(file) : -1;
    if (size == 0)
        good = fputs(head, file) >= 0;
    else if (good && size > 0 && fseek(file, -1, SEEK_END) == 0 && fgetc(file) != '\n')
        good = end_line(file);
    good = good && fwrite(row->at, 1, row->length, file) == row->length && fflush(file) == 0 && fsync(fileno(file)) == 0;
    int error = good ? 0 : -errno;
    /* removes an incomplete row after a write error, because the caller reports the check as not stored */
    if (!good && size >= 0 && ftruncate(fileno(file), size) != 0)
        log_err(own->log, "%s: %s", own->path, strerror(errno));
    fclose(file);
    return good && size == 0 ? plant_folder_sync(own->folder) : error;
}

static void finish_row(struct file_job *job, int error)
{
    struct row_job *own = (struct row_job *)job;
    struct loop_checks *loop_checks = job->owner ? own->loop_checks : NULL;
    if (loop_checks && error) {
        log_err(own->log, "%s: %s: %s", own->path, loop_checks->plant->tags[own->tag].name, strerror(-error));
    } else if (loop_checks) {
        loop_checks->at[own->tag] = own->check;
        loop_checks->numbers[own->tag] = ++loop_checks->number;
        loop_checks->begun = true;
        mark_unproven(loop_checks);
    }
    mem_free(own->folder);
    mem_free(own->path);
    text_finish(&own->row);
    mem_free(own);
}

enum refusal_code loop_checks_add(struct loop_checks *loop_checks, int tag, const struct loop_check *check)
{
    struct row_job *own = mem_new(sizeof(*own));
    *own = (struct row_job){ .job = { .write = append, .finish = finish_row, .owner = loop_checks },
                             .loop_checks = loop_checks,
                             .log = loop_checks->log,
                             .folder = mem_strdup(loop_checks->folder),
                             .path = mem_strdup(loop_checks->path),
                             .tag = tag,
                             .check = *check };
    stamp(loop_checks->plant, tag, &own->check);
    add_row(&own->row, loop_checks->plant->tags[tag].name, &own->check);
    return atomic_file_not_kept(file_writer_queue(loop_checks->writer, &own->job));
}

void loop_checks_mirror(struct loop_checks *loop_checks, const struct loop_check_row *rows, size_t count, bool all, bool begun)
{
    loop_checks->begun = begun;
    loop_checks->number++;
    if (all) {
        forget_all(loop_checks);
        loop_checks->replaced_number = loop_checks->number;
    }
    for (size_t i = 0; i < count; i++) {
        loop_checks->at[rows[i].tag] = rows[i].check;
        loop_checks->numbers[rows[i].tag] = loop_checks->number;
    }
    mark_unproven(loop_checks);
}

/* --- queries ---------------------------------------------------------------------------------------------------------------- */

bool loop_checks_are_mirrored(const struct loop_checks *loop_checks)
{
    return !loop_checks->folder;
}

enum refusal_code loop_checks_refusal(const struct loop_checks *loop_checks)
{
    return !loop_checks ? REFUSAL_UNRECORDED : loop_checks_are_mirrored(loop_checks) ? REFUSAL_CORE_CHECKS : REFUSAL_NONE;
}

const struct loop_check *loop_checks_of(const struct loop_checks *loop_checks, int tag)
{
    return &loop_checks->at[tag];
}

bool loop_checks_begun(const struct loop_checks *loop_checks)
{
    return loop_checks->begun;
}

bool loop_checks_unproven(const struct loop_checks *loop_checks, int tag)
{
    return atomic_load(&loop_checks->unproven[tag]);
}

uint64_t loop_checks_number(const struct loop_checks *loop_checks)
{
    return loop_checks->number;
}

uint64_t loop_checks_replaced_number(const struct loop_checks *loop_checks)
{
    return loop_checks->replaced_number;
}

uint64_t loop_checks_number_of(const struct loop_checks *loop_checks, int tag)
{
    return loop_checks->numbers[tag];
}

void loop_checks_print(const struct loop_checks *loop_checks, struct text *out)
{
    text_add(out, "%s", head);
    for (size_t i = 0; i < loop_checks->plant->tag_count; i++) {
        struct loop_check check = loop_checks->at[i];
        if (check.state == LOOP_CHECK_NONE)
            stamp(loop_checks->plant, (int)i, &check);
        if (loop_checks->plant->tags[i].source >= 0)
            add_row(out, loop_checks->plant->tags[i].name, &check);
    }
}
