/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes points to PostgreSQL. A batch is first copied to temporary tables, so that a point sent twice is stored once. */
#include "history/postgres/postgres_tables.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"

static const char make[] =
    "CREATE SCHEMA IF NOT EXISTS \"%1$s\";"
    "CREATE TABLE version(version int NOT NULL); INSERT INTO version VALUES(%2$d);"
    "CREATE TABLE plant(id serial PRIMARY KEY, name text NOT NULL UNIQUE);"
    "CREATE TABLE tag(id serial PRIMARY KEY, plant int NOT NULL REFERENCES plant, name text NOT NULL, unit text NOT NULL,"
    " step boolean NOT NULL, UNIQUE(plant, name, unit));"
    "CREATE TABLE sample(tag int NOT NULL, t timestamptz NOT NULL, v double precision, q bigint NOT NULL, PRIMARY KEY(tag, t));"
    "CREATE TABLE newest(tag int PRIMARY KEY, t timestamptz NOT NULL, v double precision, q bigint NOT NULL) WITH (fillfactor = 50);"
    "CREATE TABLE event(plant int NOT NULL REFERENCES plant, t timestamptz NOT NULL, kind text NOT NULL, text text NOT NULL,"
    " PRIMARY KEY(plant, t, kind));"
    "CREATE VIEW history AS SELECT p.name AS plant, g.name AS tag, s.t AS time, s.v AS value, g.unit,"
    " '0x' || upper(lpad(to_hex(s.q), 8, '0')) AS quality, s.q >> 30 = 0 AS good"
    " FROM (SELECT * FROM sample UNION ALL SELECT * FROM newest n"
    " WHERE n.t > ALL (SELECT t FROM (SELECT t FROM sample WHERE tag = n.tag ORDER BY t DESC LIMIT 1) last)) s"
    " JOIN tag g ON g.id = s.tag JOIN plant p ON p.id = g.plant;";
static const char make_temporary[] =
    "CREATE TEMP TABLE incoming(n int, tag int, t timestamptz, v double precision, q bigint) ON COMMIT DELETE ROWS;"
    "CREATE TEMP TABLE incoming_newest(n int, tag int, t timestamptz, v double precision, q bigint) ON COMMIT DELETE ROWS;"
    "CREATE TEMP TABLE incoming_tag(local int, name text, unit text, step boolean) ON COMMIT DELETE ROWS;"
    "CREATE TEMP TABLE incoming_event(t timestamptz, kind text, text text) ON COMMIT DELETE ROWS;";

/* --- opening ------------------------------------------------------------------------------------------------------------------ */

/* Runs a query that returns a number, and returns that number; -1 if the server fails. */
static int64_t ask_number(struct postgres_link *link, const char *sql, const char *parameter)
{
    PGresult *result = postgres_link_ask(link, sql, parameter != NULL, &parameter);
    int64_t number = !result ? -1 : PQntuples(result) ? postgres_int64(result, 0, 0) : 0;
    PQclear(result);
    return number;
}

/* Creates the tables. With TimescaleDB, the table `sample` is partitioned by week. */
static bool make_tables(struct postgres_link *link, const char *schema)
{
    int64_t timescale = ask_number(link, "SELECT count(*) FROM pg_extension WHERE extname = 'timescaledb'", NULL);
    return timescale >= 0 && postgres_link_runf(link, make, schema, POSTGRES_VERSION) &&
           (!timescale || postgres_link_run(link, "SELECT create_hypertable('sample', 't', chunk_time_interval => interval '7 days')"));
}

/* Checks the version of the tables. A schema with only the table `lease`, which a core may have created first, counts as empty:
   the missing tables are created. */
static bool check_version(struct postgres_link *link, const char *schema, char why[POSTGRES_WHY_BYTES])
{
    int64_t there = ask_number(link, "SELECT count(*) FROM pg_tables WHERE schemaname = $1 AND tablename = 'version'", schema);
    int64_t others = ask_number(link, "SELECT count(*) FROM pg_tables WHERE schemaname = $1 AND tablename <> 'lease'", schema);
    if (there < 0 || others < 0)
        return false;
    if (!there && !others)
        return make_tables(link, schema);
    int64_t version = there ? ask_number(link, "SELECT coalesce(max(version), 0)::bigint FROM version", NULL) : 0;
    if (version != POSTGRES_VERSION && version >= 0)
        snprintf(why, POSTGRES_WHY_BYTES,
                 "the tables in schema %s have version %lld, which is %s than version %d of this program; the tables are not used", schema,
                 (long long)version, version < POSTGRES_VERSION ? "older" : "newer", POSTGRES_VERSION);
    return version == POSTGRES_VERSION;
}

static bool find_plant(struct postgres_tables *tables, const char *name)
{
    struct postgres_link *link = tables->link;
    PGresult *added = postgres_link_ask(link, "INSERT INTO plant(name) VALUES($1) ON CONFLICT DO NOTHING", 1, &name);
    int64_t id = added ? ask_number(link, "SELECT id::bigint FROM plant WHERE name = $1", name) : -1;
    PQclear(added);
    tables->plant = (int)id;
    return id > 0;
}

bool postgres_tables_open(struct postgres_tables *tables, struct postgres_link *link, const struct plant *plant, bool alone,
                          char why[POSTGRES_WHY_BYTES])
{
    const char *schema = plant->history.postgres.schema;
    *tables = (struct postgres_tables){ .link = link, .month = -1 };
    *why = 0;
    if (!postgres_link_runf(link, "SET search_path = \"%s\", public", schema) ||
        !postgres_link_runf(link, "BEGIN; SELECT pg_advisory_xact_lock(hashtext('plantcast.%s'))", schema) ||
        !check_version(link, schema, why) || !find_plant(tables, plant->name) || !postgres_link_run(link, "COMMIT") ||
        !postgres_link_run(link, make_temporary))
        return false;
    if (!alone)
        return true;
    char *lock = mem_printf("SELECT pg_try_advisory_lock(hashtext('plantcast.%s'), %d)::int::bigint", schema, tables->plant);
    int64_t locked = ask_number(link, lock, NULL);
    mem_free(lock);
    if (locked == 0)
        snprintf(why, POSTGRES_WHY_BYTES, "another daemon already writes plant '%s' to this database", plant->name);
    return locked > 0;
}

static void forget_tags(struct postgres_tables *tables)
{
    for (size_t i = 0; i < tables->tag_capacity; i++)
        mem_free(tables->tags[i].unit);
    mem_free(tables->tags);
    tables->tags = NULL;
    tables->tag_capacity = 0;
}

void postgres_tables_finish(struct postgres_tables *tables)
{
    forget_tags(tables);
    *tables = (struct postgres_tables){ 0 };
}

/* --- writing ------------------------------------------------------------------------------------------------------------------ */

static bool knows_tags(const struct postgres_tables *tables, int month, const struct month_outbox_batch *batch)
{
    bool known = tables->month == month;
    for (size_t i = 0; i < batch->tag_count && known; i++) {
        const struct month_outbox_tag *tag = &batch->tags[i];
        const struct postgres_tag *there = (size_t)tag->id < tables->tag_capacity ? &tables->tags[tag->id] : NULL;
        known = there && there->id && !strcmp(there->unit, tag->unit);
    }
    return known;
}

static bool copy_tags(struct postgres_link *link, const struct month_outbox_batch *batch)
{
    if (!postgres_copy_begin(link, "incoming_tag"))
        return false;
    for (size_t i = 0; i < batch->tag_count; i++) {
        postgres_copy_row(link, 4);
        postgres_copy_int32(link, (int32_t)batch->tags[i].id);
        postgres_copy_text(link, batch->tags[i].name);
        postgres_copy_text(link, batch->tags[i].unit);
        postgres_copy_bool(link, batch->tags[i].step);
    }
    return postgres_copy_end(link);
}

static void note_tags(struct postgres_tables *tables, const struct month_outbox_batch *batch, const PGresult *ids)
{
    for (size_t i = 0; i < batch->tag_count; i++) {
        const struct month_outbox_tag *tag = &batch->tags[i];
        mem_grow(&tables->tags, &tables->tag_capacity, (size_t)tag->id + 1, sizeof(*tables->tags));
        tables->tags[tag->id].unit = mem_strdup(tag->unit);
    }
    for (int row = 0; row < PQntuples(ids); row++)
        tables->tags[postgres_int32(ids, row, 0)].id = postgres_int32(ids, row, 1);
}

/* Writes the tags of a batch. A tag whose unit has changed becomes a new tag in the database. */
static bool write_tags(struct postgres_tables *tables, int month, const struct month_outbox_batch *batch)
{
    if (knows_tags(tables, month, batch))
        return true;
    forget_tags(tables);
    struct postgres_link *link = tables->link;
    if (!copy_tags(link, batch) ||
        !postgres_link_runf(link,
                            "INSERT INTO tag(plant, name, unit, step) SELECT %1$d, name, unit, step FROM incoming_tag i WHERE NOT EXISTS"
                            " (SELECT 1 FROM tag g WHERE g.plant = %1$d AND g.name = i.name AND g.unit = i.unit);"
                            "UPDATE tag g SET step = i.step FROM incoming_tag i WHERE g.plant = %1$d AND g.name = i.name"
                            " AND g.unit = i.unit AND g.step <> i.step",
                            tables->plant))
        return false;
    char plant[16];
    snprintf(plant, sizeof(plant), "%d", tables->plant);
    PGresult *ids = postgres_link_ask(link,
                                      "SELECT i.local, g.id FROM incoming_tag i JOIN tag g ON g.plant = $1::int AND g.name = i.name"
                                      " AND g.unit = i.unit",
                                      1, (const char *[]){ plant });
    if (ids)
        note_tags(tables, batch, ids);
    tables->month = ids ? month : -1;
    PQclear(ids);
    return ids;
}

static bool copy_points(struct postgres_tables *tables, const char *table, const struct month_outbox_row *rows, size_t count)
{
    struct postgres_link *link = tables->link;
    if (!postgres_copy_begin(link, table))
        return false;
    for (size_t i = 0; i < count; i++) {
        const struct month_outbox_row *row = &rows[i];
        if (row->tag < 0 || (size_t)row->tag >= tables->tag_capacity || !tables->tags[row->tag].id)
            continue; /* skips the row, because the month's file does not list its tag */
        postgres_copy_row(link, 5);
        postgres_copy_int32(link, (int32_t)i);
        postgres_copy_int32(link, tables->tags[row->tag].id);
        postgres_copy_time(link, row->point.t_us);
        postgres_copy_double(link, row->point.value);
        postgres_copy_int64(link, row->point.quality);
    }
    return postgres_copy_end(link);
}

static bool write_points(struct postgres_tables *tables, const struct month_outbox_batch *batch)
{
    return !batch->row_count ||
           (copy_points(tables, "incoming", batch->rows, batch->row_count) &&
            postgres_link_run(tables->link, "INSERT INTO sample SELECT DISTINCT ON (tag, t) tag, t, v, q FROM incoming"
                                            " ORDER BY tag, t, n DESC ON CONFLICT (tag, t) DO UPDATE SET v = EXCLUDED.v, q = EXCLUDED.q"));
}

static bool write_newest(struct postgres_tables *tables, const struct month_outbox_batch *batch)
{
    struct postgres_link *link = tables->link;
    if (!copy_points(tables, "incoming_newest", batch->held, batch->held_count) ||
        !postgres_link_run(link, "INSERT INTO newest SELECT tag, t, v, q FROM incoming_newest ON CONFLICT (tag) DO UPDATE"
                                 " SET t = EXCLUDED.t, v = EXCLUDED.v, q = EXCLUDED.q WHERE newest.t <> EXCLUDED.t") ||
        !postgres_copy_begin(link, "incoming_event"))
        return false;
    for (size_t i = 0; i < batch->event_count; i++) {
        postgres_copy_row(link, 3);
        postgres_copy_time(link, batch->events[i].t_us);
        postgres_copy_text(link, batch->events[i].kind);
        postgres_copy_text(link, batch->events[i].text);
    }
    return postgres_copy_end(link) &&
           postgres_link_runf(link, "INSERT INTO event SELECT %d, t, kind, text FROM incoming_event ON CONFLICT DO NOTHING", tables->plant);
}

bool postgres_tables_write(struct postgres_tables *tables, int month, const struct month_outbox_batch *batch, bool newest)
{
    return postgres_link_run(tables->link, "BEGIN") && write_tags(tables, month, batch) && write_points(tables, batch) &&
           (!newest || write_newest(tables, batch)) && postgres_link_run(tables->link, "COMMIT");
}
