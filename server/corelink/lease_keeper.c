/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that reads and changes the database row that says which core holds the lease, that is, leads (lease.h). The
   standby's promises not to bid for the lease arrive on other threads. */
#include "corelink/lease_keeper.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/thread.h"
#include "history/postgres/postgres_link.h"

enum { ASKED = 32, NUMBER_BYTES = 24 };
static const int64_t MAX_TIMEOUT_NS = NS_PER_S, MIN_TIMEOUT_NS = 50 * NS_PER_MS;
/* how long the lease's database row still names a standby after its connection to the leader ended: during a reload, the
   standby reconnects within this time */
static const int64_t STANDBY_GRACE_NS = 10 * NS_PER_S;
/* time in which a daemon that has lost the lease, or is about to, must log the reason and shut down in order; then the kernel
   kills it */
static const int64_t SHUTDOWN_NS = 300 * NS_PER_MS;

struct lease_keeper {
    struct lease_keeper_params params;
    struct plant_postgres postgres;
    char *plant, *node;
    int stop_fd;
    timer_t timer; /* kernel timer that kills the process when the lease expires */
    bool has_timer;
    struct {
        counter *active, *here, *epoch, *age, *database, *standby, *differs, *maintenance;
    } counters;
    /* --- below: members that only the keeper's thread uses */
    struct postgres_link *link; /* connection to the database that has the lease's row; NULL: not connected */
    bool looks;                 /* true: the present content of the lease's database row is unknown, so the row must be read */
    /* true: the last change of the lease's database row failed, so reading the row successfully does not prove that the
       database works again */
    bool refuses_changes;
    bool told_won, told_lost, told_alone, told_barred;
    char said[POSTGRES_WHY_BYTES], led_by[LEASE_NODE_BYTES];
    /* `beat` (version number) that the lease's database row had when the row first named another core with this core's name;
       -1: the row has changed since, so that other core is alive (already logged); 0: no such core was seen */
    int64_t namesake_beat;
    struct thread thread;
    /* --- below: under thread.lock */
    struct lease lease;
    char standby[LEASE_NODE_BYTES]; /* name of the standby core that is connected to this leader, or was until gone_ns */
    int64_t gone_ns;                /* time when the standby core disconnected from this leader; 0: it is connected */
    bool follows;                   /* true: the standby has the same version and configuration as this core */
    char *refusal;                  /* why the leader refused this node as its standby; NULL: not refused */
    /* true: this leader has yet to change the lease's database row so that it gives the lease to `standby` */
    bool gives;
    uint64_t asked;
    struct {
        uint64_t number;
        int64_t sent_ns;
    } questions[ASKED];
};

/* Returns the time on the clock by which leases end: it keeps running while the machine sleeps, and nobody can set it. */
static int64_t now_of_lease(void)
{
    struct timespec now;
    clock_gettime(CLOCK_BOOTTIME, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* Sets the kernel timer that kills this process when its lease ends, even if the process is stopped, swapped out or in an
   endless loop then. Call with the lock held. */
static void set_timer(struct lease_keeper *keeper)
{
    const struct lease *lease = &keeper->lease;
    int64_t until_ns = lease->until_ns, soon_ns = now_of_lease() + SHUTDOWN_NS;
    if (lease->lost && soon_ns < until_ns)
        until_ns = soon_ns;
    if (!lease->leads || !until_ns)
        return;
    const struct itimerspec when = { .it_value = { until_ns / NS_PER_S, until_ns % NS_PER_S } };
    timer_settime(keeper->timer, TIMER_ABSTIME, &when, NULL);
}

/* --- the database --------------------------------------------------------------------------------------------------------------- */

static void give_up(struct lease_keeper *keeper, const char *why)
{
    char cause[POSTGRES_WHY_BYTES];
    snprintf(cause, sizeof(cause), "%.*s", (int)strcspn(why, "\n"), why);
    if (!*keeper->said)
        log_warn(keeper->params.log, "lease: PostgreSQL does not answer (%s)", cause);
    memcpy(keeper->said, cause, sizeof(cause));
    postgres_link_close(&keeper->link);
    counter_set(keeper->counters.database, 0);
    keeper->looks = true;
}

static void set_well(struct lease_keeper *keeper)
{
    if (*keeper->said)
        log_info(keeper->params.log, "lease: PostgreSQL answers again");
    *keeper->said = 0;
    counter_set(keeper->counters.database, 1);
}

/* Returns the timeout for requests to the database: for a leader its remaining lease time, in any case at least MIN_TIMEOUT_NS
   and at most MAX_TIMEOUT_NS. */
static int64_t request_timeout_ns(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool leads = keeper->lease.leads && keeper->lease.until_ns;
    int64_t left_ns = keeper->lease.until_ns - SHUTDOWN_NS - now_of_lease();
    pthread_mutex_unlock(&keeper->thread.lock);
    return !leads || left_ns > MAX_TIMEOUT_NS ? MAX_TIMEOUT_NS : left_ns > MIN_TIMEOUT_NS ? left_ns : MIN_TIMEOUT_NS;
}

static bool make_table(struct lease_keeper *keeper)
{
    const char *schema = keeper->postgres.schema;
    if (!postgres_link_runf(keeper->link,
                            "BEGIN; SELECT pg_advisory_xact_lock(hashtext('plantcast.%s'));"
                            "CREATE SCHEMA IF NOT EXISTS \"%s\"; SET LOCAL search_path = \"%s\";"
                            "CREATE TABLE IF NOT EXISTS lease(plant text PRIMARY KEY, epoch bigint NOT NULL,"
                            " beat bigint NOT NULL, leader text NOT NULL, instance bigint NOT NULL, standby text NOT NULL,"
                            " renewed timestamptz NOT NULL); COMMIT; SET search_path = \"%s\"",
                            schema, schema, schema, schema))
        return false;
    PGresult *added =
        postgres_link_ask(keeper->link, "INSERT INTO lease VALUES ($1, 0, 0, '', 0, '', now()) ON CONFLICT (plant) DO NOTHING", 1,
                          (const char *[]){ keeper->plant });
    PQclear(added);
    return added;
}

static bool connect_now(struct lease_keeper *keeper)
{
    char why[POSTGRES_WHY_BYTES];
    if (keeper->link)
        return true;
    if (!(keeper->link = postgres_link_open_within(&keeper->postgres, keeper->stop_fd, request_timeout_ns(keeper), why))) {
        give_up(keeper, why);
        return false;
    }
    if (make_table(keeper))
        return true;
    give_up(keeper, postgres_link_why(keeper->link));
    return false;
}

static void copy_name(char out[LEASE_NODE_BYTES], const PGresult *rows, int column)
{
    snprintf(out, LEASE_NODE_BYTES, "%s", PQgetvalue(rows, 0, column));
}

static bool read_row(struct lease_keeper *keeper, struct lease_row *row)
{
    PGresult *rows = postgres_link_ask(keeper->link, "SELECT epoch, beat, instance, leader, standby FROM lease WHERE plant = $1", 1,
                                       (const char *[]){ keeper->plant });
    bool there = rows && PQntuples(rows) == 1;
    if (!rows)
        give_up(keeper, postgres_link_why(keeper->link));
    else if (!there)
        give_up(keeper, "this plant's row was deleted from the PostgreSQL table `lease`");
    if (there) {
        *row = (struct lease_row){ postgres_int64(rows, 0, 0), postgres_int64(rows, 0, 1), postgres_int64(rows, 0, 2), "", "" };
        copy_name(row->leader, rows, 3);
        copy_name(row->standby, rows, 4);
    }
    PQclear(rows);
    if (there && !keeper->refuses_changes)
        set_well(keeper);
    return there;
}

/* Changes the lease's row in the database with the statement `sql`, if the row still equals `seen`. Returns 1 if it was
   changed, 0 if the row differs, -1 if the outcome is unknown. */
static int change_row(struct lease_keeper *keeper, const char *sql, const struct lease_row *seen, const char *name, int64_t instance)
{
    char epoch[NUMBER_BYTES], beat[NUMBER_BYTES], own[NUMBER_BYTES];
    snprintf(epoch, sizeof(epoch), "%lld", (long long)seen->epoch);
    snprintf(beat, sizeof(beat), "%lld", (long long)seen->beat);
    snprintf(own, sizeof(own), "%lld", (long long)instance);
    postgres_link_set_patience(keeper->link, request_timeout_ns(keeper));
    PGresult *rows = postgres_link_ask(keeper->link, sql, 5, (const char *[]){ keeper->plant, epoch, beat, own, name });
    int changed = rows ? PQntuples(rows) : -1;
    PQclear(rows);
    keeper->refuses_changes = changed < 0;
    if (changed < 0)
        give_up(keeper, postgres_link_why(keeper->link));
    else
        set_well(keeper);
    return changed;
}

#define SEEN " WHERE plant = $1 AND epoch = $2::bigint AND beat = $3::bigint"
static const char sql_bid[] = "UPDATE lease SET epoch = epoch + 1, beat = beat + 1, instance = $4::bigint, leader = $5, standby = '',"
                              " renewed = now()" SEEN " RETURNING 1";
static const char sql_renew[] =
    "UPDATE lease SET beat = beat + 1, standby = $5, renewed = now()" SEEN " AND instance = $4::bigint RETURNING 1";
static const char sql_give[] =
    "UPDATE lease SET beat = beat + 1, leader = '', standby = $5, renewed = now()" SEEN " AND instance = $4::bigint RETURNING 1";

/* --- detects other cores with this node's name ---------------------------------------------------------------------------------- */

bool lease_name(char out[LEASE_NODE_BYTES], const char *node, const char *id)
{
    return snprintf(out, LEASE_NODE_BYTES, "%s %s", node, id) < LEASE_NODE_BYTES;
}

static int name_bytes(const char *node)
{
    const char *id = strrchr(node, ' ');
    return id ? (int)(id - node) : (int)strlen(node);
}

/* Logs an error if another core with this node's name is alive. A dead one (perhaps this node before its disk was replaced) no
   longer changes the lease's database row and is not reported. */
static void look_for_namesake(struct lease_keeper *keeper, const struct lease_row *row)
{
    int own = name_bytes(keeper->node), bytes = name_bytes(row->leader);
    bool same = own == bytes && !strncmp(row->leader, keeper->node, (size_t)own) && strcmp(row->leader, keeper->node) != 0;
    if (!same || !keeper->namesake_beat) {
        keeper->namesake_beat = same ? row->beat : 0;
    } else if (keeper->namesake_beat > 0 && row->beat != keeper->namesake_beat) {
        log_err(keeper->params.log,
                "lease: the leading core has the same name as this core (%.*s), so this core stays on standby; give each core its own "
                "name with --node",
                own, keeper->node);
        keeper->namesake_beat = -1;
    }
}

/* --- periodic work -------------------------------------------------------------------------------------------------------------- */

static void look(struct lease_keeper *keeper)
{
    struct lease_row row;
    postgres_link_set_patience(keeper->link, request_timeout_ns(keeper));
    if (!read_row(keeper, &row))
        return;
    pthread_mutex_lock(&keeper->thread.lock);
    lease_saw(&keeper->lease, &row, now_of_lease());
    bool leads = keeper->lease.leads, gave = keeper->lease.gave;
    keeper->gives &= row.instance == keeper->lease.instance;
    keeper->refuses_changes &= leads || lease_may_bid(&keeper->lease, now_of_lease());
    pthread_mutex_unlock(&keeper->thread.lock);
    keeper->looks = false;
    counter_set(keeper->counters.epoch, row.epoch);
    if (!leads && strcmp(keeper->led_by, row.leader) != 0 && row.leader[0])
        log_info(keeper->params.log, "lease: %.*s leads, epoch %lld%s", name_bytes(row.leader), row.leader, (long long)row.epoch,
                 gave ? "" : "; this core stands by");
    if (!leads)
        look_for_namesake(keeper, &row);
    memcpy(keeper->led_by, row.leader, sizeof(keeper->led_by));
}

/* Logs once that this node does not take the lead, although no core leads, because the last leader refused this node as its
   standby. */
static void tell_barred(struct lease_keeper *keeper, bool barred, char *refusal)
{
    if (barred && !keeper->told_barred)
        log_err(keeper->params.log,
                "lease: no core leads, and this core does not take over, because the last leader refused this core (%s). To let this core "
                "lead, copy the leader's plant file and tag list to this machine, and reload this core",
                refusal);
    keeper->told_barred = barred;
    mem_free(refusal);
}

static void bid(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool may = lease_may_bid(&keeper->lease, now_of_lease()), barred = lease_is_barred(&keeper->lease, now_of_lease());
    char *refusal = barred ? mem_strdup(keeper->refusal) : NULL;
    struct lease_row seen = keeper->lease.row;
    if (may)
        lease_bid(&keeper->lease);
    pthread_mutex_unlock(&keeper->thread.lock);
    tell_barred(keeper, barred, refusal);
    if (!may)
        return;
    int64_t sent_ns = now_of_lease();
    int changed = change_row(keeper, sql_bid, &seen, keeper->node, keeper->lease.instance);
    if (changed == 1) {
        pthread_mutex_lock(&keeper->thread.lock);
        lease_won(&keeper->lease, sent_ns);
        set_timer(keeper);
        pthread_mutex_unlock(&keeper->thread.lock);
        counter_set(keeper->counters.epoch, seen.epoch + 1);
    } else if (changed == 0) {
        look(keeper);
    }
}

/* Extends this leader's lease without the database, while the lease's database row names this core as its own standby
   (maintenance): only the standby named in the row may bid for the lease, so no other core can take it. */
static void promise_itself(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    lease_promised(&keeper->lease, keeper->node, now_of_lease());
    set_timer(keeper);
    pthread_mutex_unlock(&keeper->thread.lock);
}

static void tell_maintenance(struct lease_keeper *keeper, bool alone)
{
    if (alone && !keeper->told_alone)
        log_warn(keeper->params.log, "lease: maintenance began: this core leads alone, even without PostgreSQL; no other core takes over");
    if (!alone && keeper->told_alone)
        log_info(keeper->params.log, "lease: maintenance ended: a standby core that follows this core may take over again");
    keeper->told_alone = alone;
}

/* Renews the lease in its database row, and names `standby` there as the standby core. Returns true if the database confirmed
   it. */
static bool renew_for(struct lease_keeper *keeper, const char *standby)
{
    pthread_mutex_lock(&keeper->thread.lock);
    lease_renew(&keeper->lease, standby);
    struct lease_row seen = keeper->lease.row;
    pthread_mutex_unlock(&keeper->thread.lock);
    int64_t sent_ns = now_of_lease();
    int changed = change_row(keeper, sql_renew, &seen, standby, keeper->lease.instance);
    if (changed == 1) {
        pthread_mutex_lock(&keeper->thread.lock);
        lease_renewed(&keeper->lease, standby, sent_ns);
        set_timer(keeper);
        pthread_mutex_unlock(&keeper->thread.lock);
    } else if (changed == 0) {
        look(keeper);
    }
    return changed == 1;
}

static void renew(struct lease_keeper *keeper)
{
    char standby[LEASE_NODE_BYTES], counts[LEASE_NODE_BYTES];
    bool alone = keeper->params.maintenance_path && access(keeper->params.maintenance_path, F_OK) == 0;
    pthread_mutex_lock(&keeper->thread.lock);
    if (keeper->gone_ns && now_of_lease() - keeper->gone_ns >= STANDBY_GRACE_NS)
        keeper->standby[0] = 0;
    bool is_there = keeper->standby[0] && !keeper->gone_ns, follows = is_there && keeper->follows;
    snprintf(standby, sizeof(standby), "%s", alone ? keeper->node : keeper->standby);
    memcpy(counts, keeper->lease.counts, sizeof(counts));
    pthread_mutex_unlock(&keeper->thread.lock);
    /* While the lease's row is being changed to name another standby, no standby's promise can extend the lease. So first
       renews the lease with the old standby in the row, and changes the standby only if the database confirmed that. Otherwise
       the leader could lose its lease, and so its lead, because an operator ended maintenance while the database refused
       changes. */
    if (counts[0] && strcmp(counts, standby) != 0 && !renew_for(keeper, counts))
        return;
    if (!renew_for(keeper, standby))
        return;
    counter_set(keeper->counters.standby, follows);
    counter_set(keeper->counters.differs, is_there && !follows);
    tell_maintenance(keeper, alone);
}

/* Changes the lease's database row to give the lease to another core. If that fails, the next turn reads the row and tries
   again, because a renewal whose answer was lost may have changed the row. */
static void give(struct lease_keeper *keeper)
{
    char standby[LEASE_NODE_BYTES];
    pthread_mutex_lock(&keeper->thread.lock);
    struct lease_row seen = keeper->lease.row;
    memcpy(standby, keeper->standby, sizeof(standby));
    pthread_mutex_unlock(&keeper->thread.lock);
    if (change_row(keeper, sql_give, &seen, standby, keeper->lease.instance) != 1)
        return;
    pthread_mutex_lock(&keeper->thread.lock);
    keeper->gives = false;
    pthread_mutex_unlock(&keeper->thread.lock);
    if (*standby)
        log_info(keeper->params.log, "lease: this core handed the lead over to %.*s", name_bytes(standby), standby);
    else
        log_info(keeper->params.log, "lease: released");
}

/* Reports the changes after one turn of the keeper's thread: updates metrics, writes log lines, and calls won() and lost(). */
static void tell(struct lease_keeper *keeper)
{
    int64_t now_ns = now_of_lease();
    pthread_mutex_lock(&keeper->thread.lock);
    const struct lease *lease = &keeper->lease;
    bool acts = lease_acts(lease, now_ns), lost = lease->lost, leads = lease->leads && lease->until_ns;
    bool alone = acts && !strcmp(lease->counts, keeper->node);
    bool ends = lost || (leads && now_ns > lease->until_ns - SHUTDOWN_NS);
    int64_t until_ns = lease->until_ns;
    if (lost)
        set_timer(keeper);
    pthread_mutex_unlock(&keeper->thread.lock);
    counter_set(keeper->counters.age, leads ? (now_ns + LEASE_HOLD_NS - until_ns) / 1000 : 0);
    counter_set(keeper->counters.active, acts);
    counter_set(keeper->counters.here, acts);
    counter_set(keeper->counters.maintenance, alone);
    if (acts && !keeper->told_won) {
        keeper->told_won = true;
        log_info(keeper->params.log, "lease: this core leads, epoch %lld", (long long)lease->row.epoch);
        keeper->params.won(keeper->params.arg);
    }
    if (ends && !keeper->told_lost) {
        keeper->told_lost = true;
        log_err(keeper->params.log, "lease: this core lost the lead (%s); it stops polling and exits",
                lost ? "another core leads, or this plant's row in the PostgreSQL table `lease` was edited"
                     : "neither PostgreSQL nor a standby has confirmed the lease");
        keeper->params.lost(keeper->params.arg);
    }
}

static bool gives(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool gives = keeper->gives;
    pthread_mutex_unlock(&keeper->thread.lock);
    return gives;
}

/* Runs one turn of the keeper's work: connects to the database, reads the lease's row, and renews the lease or bids for it.
   Returns the time of the next turn. */
static int64_t take_turn(struct lease_keeper *keeper)
{
    int64_t began_ns = now_of_lease();
    pthread_mutex_lock(&keeper->thread.lock);
    bool leads = keeper->lease.leads;
    pthread_mutex_unlock(&keeper->thread.lock);
    promise_itself(keeper);
    if (!keeper->told_lost && connect_now(keeper)) {
        if (keeper->looks || !leads)
            look(keeper);
        if (keeper->link && leads && !keeper->looks)
            renew(keeper);
        else if (keeper->link && gives(keeper))
            give(keeper);
        else if (keeper->link && !leads)
            bid(keeper);
    }
    promise_itself(keeper); /* extends the lease again in this turn, because connecting to the database may have taken a second */
    tell(keeper);
    pthread_mutex_lock(&keeper->thread.lock);
    int64_t next_ns = began_ns + (leads ? LEASE_RENEW_NS : LEASE_LOOK_NS), last_ns = keeper->lease.until_ns - SHUTDOWN_NS + 1;
    pthread_mutex_unlock(&keeper->thread.lock);
    /* a leader wakes no later than the end of its lease, because it must report that it lost the lease */
    return leads && !keeper->told_lost && last_ns > began_ns && last_ns < next_ns ? last_ns : next_ns;
}

static void *lease_keeper_main(void *arg)
{
    struct lease_keeper *keeper = arg;
    bool stopping = false, gave = false;
    while (!stopping) {
        int64_t next_ns = take_turn(keeper), wait_ns;
        pthread_mutex_lock(&keeper->thread.lock);
        do {
            wait_ns = keeper->lease.gave == gave ? next_ns - now_of_lease() : 0;
            if (wait_ns > 0)
                clock_cond_wait(&keeper->thread.wake, &keeper->thread.lock, clock_mono_ns() + wait_ns);
            stopping = keeper->thread.stopping;
        } while (!stopping && wait_ns > 0 && next_ns > now_of_lease());
        gave = keeper->lease.gave;
        pthread_mutex_unlock(&keeper->thread.lock);
    }
    return NULL;
}

/* --- functions that other threads call ------------------------------------------------------------------------------------------ */

bool lease_keeper_leads(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool acts = lease_acts(&keeper->lease, now_of_lease());
    pthread_mutex_unlock(&keeper->thread.lock);
    return acts;
}

void lease_keeper_set_standby(struct lease_keeper *keeper, const char *node, bool follows)
{
    pthread_mutex_lock(&keeper->thread.lock);
    keeper->follows = follows;
    keeper->gone_ns = *node ? 0 : now_of_lease();
    if (*node && !keeper->lease.gave)
        snprintf(keeper->standby, sizeof(keeper->standby), "%s", node);
    pthread_mutex_unlock(&keeper->thread.lock);
}

uint64_t lease_keeper_ask(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    uint64_t number = ++keeper->asked;
    keeper->questions[number % ASKED].number = number;
    keeper->questions[number % ASKED].sent_ns = now_of_lease();
    pthread_mutex_unlock(&keeper->thread.lock);
    return number;
}

void lease_keeper_promised(struct lease_keeper *keeper, const char *node, uint64_t number)
{
    pthread_mutex_lock(&keeper->thread.lock);
    if (number && keeper->questions[number % ASKED].number == number && !keeper->thread.stopping) {
        lease_promised(&keeper->lease, node, keeper->questions[number % ASKED].sent_ns);
        set_timer(keeper);
    }
    pthread_mutex_unlock(&keeper->thread.lock);
}

void lease_keeper_give(struct lease_keeper *keeper, const char *standby)
{
    const struct itimerspec never = { 0 };
    pthread_mutex_lock(&keeper->thread.lock);
    if (keeper->lease.leads && !keeper->lease.lost) {
        keeper->gives = true;
        snprintf(keeper->standby, sizeof(keeper->standby), "%s", standby);
        lease_give(&keeper->lease);
        timer_settime(keeper->timer, 0, &never, NULL);
        pthread_cond_signal(&keeper->thread.wake);
    }
    pthread_mutex_unlock(&keeper->thread.lock);
}

bool lease_keeper_is_taken(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    const struct lease *lease = &keeper->lease;
    bool taken = lease->gave && lease->row.leader[0] && lease->row.instance != lease->instance;
    pthread_mutex_unlock(&keeper->thread.lock);
    return taken;
}

int64_t lease_keeper_confirmed_age_ns(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    int64_t age_ns = now_of_lease() + LEASE_HOLD_NS - keeper->lease.until_ns;
    pthread_mutex_unlock(&keeper->thread.lock);
    return age_ns;
}

bool lease_keeper_is_alone(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool alone = lease_acts(&keeper->lease, now_of_lease()) && !strcmp(keeper->lease.counts, keeper->node);
    pthread_mutex_unlock(&keeper->thread.lock);
    return alone;
}

const char *lease_keeper_id(const struct lease_keeper *keeper)
{
    return keeper->node + name_bytes(keeper->node) + 1;
}

void lease_keeper_set_refused(struct lease_keeper *keeper, const char *why)
{
    pthread_mutex_lock(&keeper->thread.lock);
    mem_free(keeper->refusal);
    keeper->refusal = why ? mem_strdup(why) : NULL;
    keeper->lease.refused = why;
    pthread_mutex_unlock(&keeper->thread.lock);
}

int64_t lease_keeper_heard_age_ns(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    int64_t heard_ns = keeper->lease.heard_ns;
    pthread_mutex_unlock(&keeper->thread.lock);
    return heard_ns ? now_of_lease() - heard_ns : -1;
}

bool lease_keeper_promise(struct lease_keeper *keeper)
{
    pthread_mutex_lock(&keeper->thread.lock);
    bool good = lease_promise(&keeper->lease, now_of_lease());
    pthread_mutex_unlock(&keeper->thread.lock);
    return good;
}

/* --- start and stop ------------------------------------------------------------------------------------------------------------- */

static void add_counters(struct lease_keeper *keeper)
{
    struct counters *c = keeper->params.counters;
    keeper->counters.active =
        counters_add(c, "plantcast_core_active", "gauge",
                     "1 while this daemon is the plant's leading core, which polls the devices and evaluates the alarms.");
    keeper->counters.here = counters_add(c, "plantcast_core_up{core=\"this\"}", "gauge", CORE_UP_HELP);
    keeper->counters.epoch = counters_add(c, "plantcast_core_epoch", "gauge",
                                          "Epoch of the lead: increases each time another core takes over the lead of the plant.");
    keeper->counters.age =
        counters_add_seconds(c, "plantcast_core_lease_age_seconds", "gauge",
                             "Seconds since the last confirmed renewal of the lease, the permission of one core to lead the plant.");
    keeper->counters.database =
        counters_add(c, "plantcast_core_lease_database_up", "gauge",
                     "1 while PostgreSQL answers this core's requests for the lease, the permission to lead the plant.");
    keeper->counters.standby =
        counters_add(c, "plantcast_core_standby", "gauge", "1 while a standby core follows this leading core and may take over.");
    keeper->counters.differs =
        counters_add(c, "plantcast_core_standby_differs", "gauge",
                     "1 while the other core differs in version or configuration, so that it cannot be the standby.");
    keeper->counters.maintenance =
        counters_add(c, "plantcast_core_standby_maintenance", "gauge",
                     "1 during maintenance (plantcast standby): this core leads alone, and no other core may take over.");
}

static bool make_timer(struct lease_keeper *keeper)
{
    struct sigevent event = { .sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGKILL };
    keeper->has_timer = timer_create(CLOCK_BOOTTIME, &event, &keeper->timer) == 0;
    if (!keeper->has_timer)
        log_err(keeper->params.log,
                "lease: this core cannot lead, because the timer that stops a leader without lease cannot be created: %s", strerror(errno));
    return keeper->has_timer;
}

struct lease_keeper *lease_keeper_create(const struct lease_keeper_params *params)
{
    struct lease_keeper *keeper = mem_new(sizeof(*keeper));
    const struct plant_postgres *postgres = params->postgres;
    int64_t instance = 0;
    keeper->params = *params;
    keeper->params.maintenance_path = params->maintenance_path ? mem_strdup(params->maintenance_path) : NULL;
    keeper->postgres.url = mem_strdup(postgres->url);
    keeper->postgres.schema = mem_strdup(postgres->schema);
    keeper->postgres.login = postgres->login ? mem_strdup(postgres->login) : NULL;
    keeper->plant = mem_strdup(params->plant);
    keeper->node = mem_strdup(params->node);
    keeper->stop_fd = eventfd(0, EFD_CLOEXEC);
    keeper->looks = true;
    thread_init(&keeper->thread);
    bool random = getrandom(&instance, sizeof(instance), 0) == sizeof(instance);
    lease_init(&keeper->lease, params->node, instance);
    add_counters(keeper);
    if (keeper->stop_fd < 0 || !random)
        log_err(params->log, "lease: %s", strerror(errno));
    if (keeper->stop_fd < 0 || !random || !make_timer(keeper))
        lease_keeper_destroy(&keeper);
    return keeper;
}

bool lease_keeper_start(struct lease_keeper *keeper)
{
    return thread_start(&keeper->thread, keeper->params.log, "lease", lease_keeper_main, keeper);
}

static void give_back(struct lease_keeper *keeper)
{
    if (!keeper->link || !lease_keeper_leads(keeper))
        return;
    keeper->standby[0] = 0;
    give(keeper);
}

void lease_keeper_destroy(struct lease_keeper **pointer)
{
    struct lease_keeper *keeper = *pointer;
    if (!keeper)
        return;
    thread_stop(&keeper->thread);
    give_back(keeper);
    if (keeper->has_timer)
        timer_delete(keeper->timer);
    postgres_link_close(&keeper->link);
    if (keeper->stop_fd >= 0)
        close(keeper->stop_fd);
    thread_finish(&keeper->thread);
    mem_free((char *)keeper->params.maintenance_path);
    mem_free(keeper->refusal);
    mem_free(keeper->postgres.url);
    mem_free(keeper->postgres.schema);
    mem_free(keeper->postgres.login);
    mem_free(keeper->plant);
    mem_free(keeper->node);
    mem_free(keeper);
    *pointer = NULL;
}
