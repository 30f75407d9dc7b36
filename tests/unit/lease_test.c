/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lease, by which one node leads: two nodes must never lead at once. Simulates three nodes and a database with random
   faults: lost connections, delayed messages, clocks that drift apart, and nodes that are killed, paused for seconds or
   restarted. Nodes may also shut down in good order and then give up the lease. */
#include "tests/support/test.h"

#include "corelink/lease.h"

#define MS INT64_C(1000000)
#define S (1000 * MS)
enum { NODES = 3, FLIGHTS = 512, STEP_MS = 10 };
#define PATIENCE_NS S /* time after which a node gives up waiting for an answer of the database */

enum what { LOOK, BID, RENEW, GIVE, ROW, DONE, ASK, PROMISE };
struct flight { /* a message on its way */
    int64_t at_ns; /* simulation time at which the message arrives; 0: this entry of the array is unused */
    enum what what;
    int from, to;  /* index of the sending and of the receiving node; NODES: the database */
    /* id of the process that sends or receives the message: a restarted node is a new process and must not get old answers */
    uint64_t life;
    struct lease_row row; /* database row that an answer contains, or that a request expects to find */
    char standby[LEASE_NODE_BYTES];
    bool good;
    int64_t sent_ns; /* time of sending on the node's clock */
};

struct lease_node {
    struct lease lease;
    uint64_t life;       /* id of the node's current process, a new one after each restart; 0: no process */
    int64_t starts_ns, wakes_ns, next_ns, asked_ns; /* of the world */
    int64_t ahead_ns, sent_ns; /* sent: on its own clock */
    double rate;
    bool waits;
    bool alone; /* true: the standby of this node is in maintenance, so the leader needs no promise from it */
    int64_t waits_since_ns;
    /* simulation time at which a node ends that is shutting down and tries to give up its lease; 0: it is not shutting down */
    int64_t ends_ns;
    int times_led;
};

struct lease_world {
    int64_t now_ns;
    struct lease_row row;
    struct lease_node nodes[NODES];
    bool cut[NODES + 1][NODES + 1];
    int64_t frozen_ns; /* the database answers again then */
    struct flight flights[FLIGHTS];
    uint64_t lives;
    unsigned seed;
    bool calm;
    int most;      /* largest number of nodes that led at the same time; must not exceed 1 */
    int takes;     /* number of nodes that became leader within LEASE_NS after another gave up its lease */
    int64_t given_ns; /* simulation time when a leader last gave up its lease */
};

static int chance(struct lease_world *world, int n)
{
    world->seed = world->seed * 1664525u + 1013904223u;
    return (int)((world->seed >> 8) % (unsigned)n);
}

static int64_t clock_of(const struct lease_world *world, const struct lease_node *node)
{
    return node->ahead_ns + (int64_t)((double)world->now_ns * node->rate);
}

static struct flight *send(struct lease_world *world, enum what what, int from, int to)
{
    if (world->cut[from][to] || world->cut[to][from])
        return NULL;
    for (int i = 0; i < FLIGHTS; i++) {
        struct flight *flight = &world->flights[i];
        if (flight->at_ns)
            continue;
        int64_t late_ns = world->calm || chance(world, 20) ? chance(world, 40) * MS : chance(world, 9000) * MS;
        *flight = (struct flight){ .at_ns = world->now_ns + late_ns + 1, .what = what, .from = from, .to = to };
        flight->life = world->nodes[from < NODES ? from : to].life;
        return flight;
    }
    return NULL;
}

static void start(struct lease_world *world, int i)
{
    struct lease_node *node = &world->nodes[i];
    char name[2] = { (char)('a' + i), 0 };
    node->life = ++world->lives;
    node->waits = false;
    node->ends_ns = 0;
    node->rate = 1 + (chance(world, 400) - 200) / 10000.0; /* the node's clock is up to 2 % fast or slow */
    node->ahead_ns = chance(world, 1000000) * MS;
    lease_init(&node->lease, name, (int64_t)node->life);
}

static void end(struct lease_world *world, struct lease_node *node)
{
    node->life = 0;
    node->starts_ns = world->now_ns + (100 + chance(world, 4000)) * MS;
}

/* --- the database --------------------------------------------------------------------------------------------------------------- */

static bool expects(const struct lease_row *a, const struct lease_row *b)
{
    return a->epoch == b->epoch && a->beat == b->beat;
}

static void change(struct lease_world *world, struct flight *flight)
{
    struct lease_row *row = &world->row;
    flight->good = expects(row, &flight->row);
    if (flight->what == RENEW || flight->what == GIVE)
        flight->good &= row->instance == flight->row.instance;
    if (!flight->good)
        return;
    row->beat++;
    switch (flight->what) {
    case BID:
        world->takes += !row->leader[0] && row->epoch && world->now_ns - world->given_ns < LEASE_NS / 2;
        row->epoch++;
        row->instance = flight->row.instance;
        snprintf(row->leader, sizeof(row->leader), "%c", 'a' + flight->from);
        row->standby[0] = 0;
        break;
    case RENEW: memcpy(row->standby, flight->standby, sizeof(row->standby)); break;
    default:
        row->leader[0] = 0;
        memcpy(row->standby, flight->standby, sizeof(row->standby));
        world->given_ns = world->now_ns;
        break;
    }
}

static void on_database(struct lease_world *world, struct flight *flight)
{
    struct flight asked = *flight;
    if (world->now_ns < world->frozen_ns) { /* a frozen database handles messages only after it wakes up */
        flight->at_ns = world->frozen_ns + 1;
        return;
    }
    flight->at_ns = 0;
    if (asked.what != LOOK)
        change(world, &asked);
    struct flight *answer = send(world, asked.what == LOOK ? ROW : DONE, NODES, asked.from);
    if (!answer)
        return;
    answer->life = asked.life;
    answer->row = world->row;
    answer->good = asked.good;
    answer->sent_ns = asked.sent_ns;
    memcpy(answer->standby, asked.standby, sizeof(answer->standby));
    answer->from = asked.what; /* type of the request that this message answers */
}

/* --- a node --------------------------------------------------------------------------------------------------------------------- */

static void on_node(struct lease_world *world, struct lease_node *node, int i, const struct flight *flight)
{
    int64_t now_ns = clock_of(world, node);
    switch (flight->what) {
    case ROW:
        if (flight->sent_ns == node->sent_ns && node->waits) {
            node->waits = false;
            lease_saw(&node->lease, &flight->row, now_ns);
        }
        break;
    case DONE:
        if (flight->sent_ns != node->sent_ns || !node->waits)
            break;
        node->waits = false;
        if (!flight->good) {
            lease_saw(&node->lease, &flight->row, now_ns);
        } else if (flight->from == BID) {
            lease_won(&node->lease, flight->sent_ns);
            node->times_led++;
        } else if (flight->from == RENEW) {
            lease_renewed(&node->lease, flight->standby, flight->sent_ns);
        } else {
            end(world, node);
        }
        break;
    case ASK:
        if (!lease_promise(&node->lease, now_ns))
            break;
        struct flight *promise = send(world, PROMISE, i, flight->from);
        if (promise) {
            promise->sent_ns = flight->sent_ns;
            promise->life = flight->life; /* id of the process that requested the promise */
        }
        break;
    case PROMISE: {
        const char name[2] = { (char)('a' + flight->from), 0 };
        lease_promised(&node->lease, name, flight->sent_ns);
        break;
    }
    default: break;
    }
}

/* Returns the first node that leader i can reach, which serves as its standby, or -1 if there is none. */
static int follower_of(const struct lease_world *world, int i)
{
    for (int k = 0; k < NODES; k++)
        if (k != i && world->nodes[k].life && !world->cut[i][k] && !world->cut[k][i])
            return k;
    return -1;
}

static void ask_database(struct lease_world *world, struct lease_node *node, int i, enum what what, const char *standby)
{
    struct flight *flight = send(world, what, i, NODES);
    node->waits = true;
    node->waits_since_ns = world->now_ns;
    /* adds a few nanoseconds that depend on the process, so that requests of different processes of a node have different times
       */
    node->sent_ns = clock_of(world, node) + (int64_t)node->life % 7;
    if (!flight)
        return;
    flight->row = node->lease.row;
    flight->row.instance = node->lease.instance;
    flight->sent_ns = node->sent_ns;
    snprintf(flight->standby, sizeof(flight->standby), "%s", standby);
}

static void lead(struct lease_world *world, struct lease_node *node, int i)
{
    int follower = follower_of(world, i);
    const char own[2] = { (char)('a' + i), 0 }, other[2] = { follower < 0 ? 0 : (char)('a' + follower), 0 };
    const char *name = node->alone ? own : other;
    lease_promised(&node->lease, own, clock_of(world, node));
    /* Now and then the node reads the row instead of renewing, because it may have lost the answer to its last request. */
    if (!node->waits && chance(world, 10) == 0 && node->sent_ns && !world->calm) {
        ask_database(world, node, i, LOOK, "");
    } else if (!node->waits) {
        lease_renew(&node->lease, name);
        ask_database(world, node, i, RENEW, name);
    }
    struct flight *question = follower >= 0 ? send(world, ASK, i, follower) : NULL;
    if (question) {
        question->sent_ns = clock_of(world, node);
        question->life = node->life;
    }
}

static void follow(struct lease_world *world, struct lease_node *node, int i)
{
    if (node->waits)
        return;
    if (lease_may_bid(&node->lease, clock_of(world, node))) {
        lease_bid(&node->lease);
        ask_database(world, node, i, BID, "");
    } else {
        ask_database(world, node, i, LOOK, "");
    }
}

/* Lets a node that shuts down give its lease to a standby that it can reach, or else to any node. Half of the attempts only
   read the row, so that the node can try again after a failed attempt. */
static void give(struct lease_world *world, struct lease_node *node, int i)
{
    int follower = follower_of(world, i);
    const char other[2] = { follower < 0 ? 0 : (char)('a' + follower), 0 };
    bool reads = chance(world, 2);
    lease_give(&node->lease);
    if (!node->waits)
        ask_database(world, node, i, reads ? LOOK : GIVE, other);
}

static void run_node(struct lease_world *world, int i)
{
    struct lease_node *node = &world->nodes[i];
    if (!node->life && world->now_ns >= node->starts_ns)
        start(world, i);
    if (!node->life)
        return;
    /* Ends a leader whose lease has expired, and a node that has found another leader in the row, as the daemon does. */
    if (node->lease.lost || (node->lease.leads && !lease_acts(&node->lease, clock_of(world, node)) && node->lease.until_ns)) {
        end(world, node);
        return;
    }
    if (node->ends_ns && world->now_ns >= node->ends_ns) {
        end(world, node);
        return;
    }
    if (world->now_ns < node->wakes_ns || world->now_ns < node->next_ns)
        return;
    node->next_ns = world->now_ns + (node->lease.leads ? LEASE_RENEW_NS : LEASE_LOOK_NS);
    if (node->waits && world->now_ns - node->waits_since_ns > PATIENCE_NS) {
        node->waits = false;
        ask_database(world, node, i, LOOK, "");
    }
    if (node->ends_ns)
        give(world, node, i);
    else if (node->lease.leads)
        lead(world, node, i);
    else
        follow(world, node, i);
}

static void deliver(struct lease_world *world, struct flight *flight)
{
    struct lease_node *node = flight->to < NODES ? &world->nodes[flight->to] : NULL;
    if (!node) {
        on_database(world, flight);
        return;
    }
    /* requests for a promise are answered by the node's present process, even if the node was restarted meanwhile; other
       messages only reach the process that they were sent to */
    bool asks = flight->what == ASK;
    if (node->life && world->now_ns < node->wakes_ns) {
        flight->at_ns = node->wakes_ns + 1;
        return;
    }
    struct flight came = *flight;
    flight->at_ns = 0;
    if (node->life && (asks || node->life == came.life))
        on_node(world, node, came.to, &came);
}

static void disturb(struct lease_world *world)
{
    if (world->calm || chance(world, 40))
        return;
    int i = chance(world, NODES + 1), k = chance(world, NODES + 1);
    switch (chance(world, 8)) {
    case 7:
        for (i = 0; i < NODES; i++)
            if (world->nodes[i].life && world->nodes[i].lease.leads && !world->nodes[i].ends_ns)
                world->nodes[i].ends_ns = world->now_ns + (100 + chance(world, 3000)) * MS;
        break;
    case 0:
    case 1: world->cut[i][k] ^= i != k; break;
    case 2: memset(world->cut, 0, sizeof(world->cut)); break;
    case 3:
        if (i < NODES && world->nodes[i].life)
            end(world, &world->nodes[i]);
        break;
    case 4:
        if (i < NODES)
            world->nodes[i].wakes_ns = world->now_ns + chance(world, 10000) * MS;
        break;
    case 5:
        if (i < NODES)
            world->nodes[i].alone ^= true;
        break;
    default: world->frozen_ns = world->now_ns + chance(world, 8000) * MS; break;
    }
}

static int leaders(const struct lease_world *world)
{
    int count = 0;
    for (int i = 0; i < NODES; i++)
        count += world->nodes[i].life && lease_acts(&world->nodes[i].lease, clock_of(world, &world->nodes[i]));
    return count;
}

static void run(struct lease_world *world, int64_t ns)
{
    for (int64_t end_ns = world->now_ns + ns; world->now_ns < end_ns; world->now_ns += STEP_MS * MS) {
        disturb(world);
        for (int i = 0; i < FLIGHTS; i++)
            if (world->flights[i].at_ns && world->flights[i].at_ns <= world->now_ns)
                deliver(world, &world->flights[i]);
        for (int i = 0; i < NODES; i++)
            run_node(world, i);
        int count = leaders(world);
        world->most = count > world->most ? count : world->most;
    }
}

TEST(never_two_and_one_in_the_end)
{
    unsigned seed = (unsigned)sweep_seed();
    int terms = 0, takes = 0;
    struct lease_world *world = malloc(sizeof(*world));
    for (int round = 0; round < sweep(4000, 150); round++) {
        memset(world, 0, sizeof(*world));
        world->seed = seed + (unsigned)round;
        world->now_ns = S;
        run(world, 120 * S);
        world->calm = true;
        memset(world->cut, 0, sizeof(world->cut));
        world->frozen_ns = 0;
        for (int i = 0; i < NODES; i++)
            world->nodes[i].alone = false;
        run(world, 30 * S);
        if (leaders(world) != 1)
            fail_msg("round %d of seed %u: %d lead after half a minute of calm", round, seed, leaders(world));
        if (world->most > 1)
            fail_msg("round %d of seed %u: two lead", round, seed);
        for (int i = 0; i < NODES; i++)
            terms += world->nodes[i].times_led;
        takes += world->takes;
    }
    free(world);
    printf("# %d terms, %d of them by a node that the lease was given to\n", terms, takes);
    assert_true(terms > 150);
    assert_true(takes > 20);
}

/* --- the rules of the lease, one by one ----------------------------------------------------------------------------------------- */

static struct lease follower(const char *node, const struct lease_row *row, int64_t now_ns)
{
    struct lease lease;
    lease_init(&lease, node, 7);
    lease_saw(&lease, row, now_ns);
    return lease;
}

/* Returns node a, which leads: it won the lease of an empty database at 1 s. */
static struct lease leader_a(void)
{
    const struct lease_row none = { 0 };
    struct lease a = follower("a", &none, S);
    lease_bid(&a);
    lease_won(&a, S);
    return a;
}

TEST(a_follower_waits_for_what_binds_it)
{
    const struct lease_row free_row = { 0 }, led = { .epoch = 3, .beat = 9, .instance = 5, .leader = "a", .standby = "b" };
    struct lease b = follower("b", &free_row, S);
    /* The row names no leader: the leader has given up the lease, or the database is new and empty. Node b cannot tell which,
       so it must wait 3 s before it may bid. */
    assert_false(lease_may_bid(&b, 4 * S - 1));
    assert_true(lease_may_bid(&b, 4 * S));
    b = follower("b", &led, 10 * S);
    assert_false(lease_may_bid(&b, 13 * S - 1));
    assert_true(lease_may_bid(&b, 13 * S));
    assert_true(lease_promise(&b, 12 * S));
    assert_false(lease_may_bid(&b, 15 * S - 1));
    assert_true(lease_may_bid(&b, 15 * S));
    struct lease_row renewed = led;
    renewed.beat++;
    lease_saw(&b, &renewed, 14 * S);
    assert_false(lease_may_bid(&b, 17 * S - 1));
    lease_bid(&b);
    assert_false(lease_promise(&b, 17 * S));
    struct lease c = follower("c", &led, 10 * S);
    assert_false(lease_may_bid(&c, 1000 * S)); /* b may have promised */
    struct lease a = follower("a", &led, 10 * S);
    assert_true(lease_may_bid(&a, 13 * S)); /* a restarted process of node a may bid for the lease that a had */
}

/* A node knows when it last heard from another leader: its own lead, and a row that it reads for the first time, do not count. */
TEST(a_node_knows_when_it_last_heard_from_another_leader)
{
    struct lease_row row = { .epoch = 3, .beat = 9, .instance = 5, .leader = "a", .standby = "b" };
    struct lease b = follower("b", &row, 10 * S);
    assert_int_equal(b.heard_ns, 0); /* the row may be years old */
    assert_true(lease_promise(&b, 12 * S));
    assert_int_equal(b.heard_ns, 12 * S);
    lease_saw(&b, &row, 13 * S);
    assert_int_equal(b.heard_ns, 12 * S);
    row.beat++;
    lease_saw(&b, &row, 14 * S);
    assert_int_equal(b.heard_ns, 14 * S);
    lease_bid(&b);
    assert_false(lease_promise(&b, 16 * S)); /* no promise, but the leader lives */
    assert_int_equal(b.heard_ns, 16 * S);
    lease_won(&b, 19 * S);
    row = b.row;
    row.beat++;
    lease_saw(&b, &row, 20 * S);
    assert_false(lease_promise(&b, 21 * S));
    assert_int_equal(b.heard_ns, 16 * S);
}

TEST(a_leader_counts_the_standby_that_the_row_names)
{
    struct lease a = leader_a();
    assert_true(lease_acts(&a, 3 * S - 1));
    assert_false(lease_acts(&a, 3 * S));
    lease_promised(&a, "b", 2 * S);
    assert_false(lease_acts(&a, 3 * S));
    lease_renew(&a, "b");
    lease_renewed(&a, "b", 2 * S);
    lease_promised(&a, "b", 3 * S);
    assert_true(lease_acts(&a, 5 * S - 1));
    lease_renew(&a, "");
    /* b's promise must not extend the lease: the renewal under way removes b as the standby from the row, perhaps already done
       */
    lease_promised(&a, "b", 4 * S);
    assert_false(lease_acts(&a, 5 * S));
    struct lease_row other = a.row;
    other.epoch++;
    other.instance = 99;
    lease_saw(&a, &other, 4 * S);
    assert_true(a.lost);
    assert_false(lease_acts(&a, 4 * S));
}

TEST(a_given_lease_is_taken_at_once_by_the_node_that_saw_its_leader)
{
    const struct lease_row none = { 0 };
    struct lease a = leader_a();
    lease_renew(&a, "b");
    lease_renewed(&a, "b", 2 * S);
    struct lease b = follower("b", &a.row, 2 * S), c = follower("c", &a.row, 2 * S);
    assert_true(lease_promise(&b, 2 * S));
    lease_give(&a);
    assert_false(lease_acts(&a, 2 * S));
    lease_promised(&a, "b", 2 * S);
    assert_false(lease_acts(&a, 2 * S));
    struct lease_row given = a.row;
    given.beat++;
    given.leader[0] = 0;
    lease_saw(&b, &given, 2 * S + 1);
    /* b may bid at once: its promise was valid only while a had the lease, and a has given it up */
    assert_true(lease_may_bid(&b, 2 * S + 1));
    lease_saw(&c, &given, 2 * S + 1);
    assert_false(lease_may_bid(&c, 5 * S));
    assert_true(lease_may_bid(&c, 5 * S + 1)); /* b may have ended */
    lease_saw(&a, &given, 2 * S + 1);
    assert_false(a.lost);
    assert_false(lease_may_bid(&a, 100 * S)); /* a ends */
    struct lease late = follower("b", &given, 3 * S), other = follower("b", &none, 3 * S);
    /* `late` has seen no other row, so this one may be an old row of a restored database, and `late` must wait */
    assert_false(lease_may_bid(&late, 3 * S));
    lease_saw(&other, &given, 3 * S);
    assert_false(lease_may_bid(&other, 3 * S));
    assert_true(lease_may_bid(&other, 6 * S));
    given.beat++; /* the row after c has become leader; b must not bid any more */
    given.epoch++;
    memcpy(given.leader, "c", 2);
    lease_saw(&b, &given, 4 * S);
    assert_false(lease_may_bid(&b, 4 * S));
}

TEST(a_node_that_the_leader_refused_does_not_bid)
{
    const struct lease_row led = { .epoch = 3, .beat = 9, .instance = 5, .leader = "a", .standby = "b" };
    struct lease b = follower("b", &led, 10 * S);
    assert_false(lease_is_barred(&b, 13 * S));
    b.refused = true;
    assert_false(lease_is_barred(&b, 13 * S - 1));
    assert_true(lease_is_barred(&b, 13 * S));
    assert_false(lease_may_bid(&b, 13 * S));
    struct lease_row released = led;
    released.beat++;
    released.leader[0] = released.standby[0] = 0;
    lease_saw(&b, &released, 14 * S);
    assert_false(lease_may_bid(&b, 100 * S));
    b.refused = false;
    assert_false(lease_is_barred(&b, 17 * S));
    assert_true(lease_may_bid(&b, 17 * S));
}

TEST(in_maintenance_a_leader_promises_itself_and_no_other_may_bid)
{
    struct lease a = leader_a();
    lease_promised(&a, "a", 2 * S);
    /* during maintenance a is its own standby, but the row in the database does not say so yet, so a's promise to itself does
       not count */
    assert_false(lease_acts(&a, 3 * S));
    lease_renew(&a, "a");
    lease_renewed(&a, "a", 2 * S);
    /* now the row names a as its own standby: its promise to itself extends the lease even if the database cannot be reached */
    lease_promised(&a, "a", 100 * S);
    assert_true(lease_acts(&a, 102 * S - 1));
    assert_false(lease_acts(&a, 102 * S)); /* the lease expires if the promise is not repeated, as by a process that hangs */
    struct lease b = follower("b", &a.row, 10 * S), restarted = follower("a", &a.row, 10 * S);
    assert_false(lease_may_bid(&b, 1000 * S));
    assert_true(lease_may_bid(&restarted, 13 * S));
    /* maintenance ends: from this request on the row may name b as standby, so a's promise to itself no longer counts */
    lease_renew(&a, "b");
    lease_promised(&a, "a", 101 * S);
    assert_false(lease_acts(&a, 102 * S));
}

/* The database was restored from a backup and has an earlier row of the same leader. Another node may take the lease on the
   basis of that row, so the leader must stop leading. */
TEST(a_leader_whose_row_is_of_another_epoch_has_lost_it)
{
    struct lease a = leader_a();
    struct lease_row restored = a.row;
    lease_saw(&a, &restored, 2 * S);
    assert_false(a.lost);
    restored.epoch--;
    lease_saw(&a, &restored, 2 * S);
    assert_true(a.lost);
    assert_false(lease_acts(&a, 2 * S));
}

TEST(a_bid_whose_answer_is_lost_is_found_in_the_row)
{
    const struct lease_row none = { 0 };
    struct lease a = follower("a", &none, S);
    lease_bid(&a);
    struct lease_row won = { .epoch = 1, .beat = 1, .instance = 7, .leader = "a" };
    lease_saw(&a, &won, 2 * S);
    assert_true(a.leads);
    /* a does not know when the database accepted its bid, so it must not lead before it has renewed the lease */
    assert_false(lease_acts(&a, 2 * S));
    lease_renewed(&a, "", 2 * S);
    assert_true(lease_acts(&a, 2 * S));
}
