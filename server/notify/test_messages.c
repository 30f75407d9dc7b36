/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends test messages to the recipients of alarm messages. */
#include "notify/test_messages.h"

#include <math.h>

#include "base/clock.h"
#include "base/mem.h"
#include "notify/delivery.h"
#include "notify/notify_text.h"

struct test_run {
    const struct plant *plant;
    FILE *out;
    int waiting, failed; /* waiting: number of messages that are being sent; failed: number of messages that were not accepted */
    int refused;         /* number of mailboxes that mail servers refused */
};

/* Prints the result of one message. why: NULL if the recipient's server accepted the message, else the reason. */
static void print_result(struct test_run *run, int recipient, const char *why)
{
    const char *id = run->plant->notify->recipients[recipient].id;
    if (why)
        fprintf(run->out, "%s: not delivered: %s\n", id, why);
    else
        fprintf(run->out, "%s: the server accepted the test message\n", id);
    run->failed += why != NULL;
}

static void on_end(void *arg, int recipient, const char *why, bool is_refused, int refused_mailboxes)
{
    struct test_run *run = arg;
    (void)is_refused;
    print_result(run, recipient, why);
    run->refused += refused_mailboxes;
    run->waiting--;
}

int test_messages_send(struct log *log, const struct plant *plant, FILE *out)
{
    const struct plant_notify *notify = plant->notify;
    struct test_run run = { .plant = plant, .out = out };
    struct delivery *delivery = delivery_create(log, notify);
    if (!delivery)
        return -1;
    int64_t now_us = clock_utc_ns() / 1000;
    const struct outbox_item item = { .name = "TEST", .tag = -1, .kind = ALARM_ON, .priority = 1, .status = ALARM_ACTIVE,
                                      .value = NAN, .limit = NAN, .raised_us = now_us };
    struct outbox_message message = { .items = &item, .count = 1, .made_us = now_us, .is_test = true };
    snprintf(message.id, sizeof(message.id), "test-%lld", (long long)now_us);
    for (int i = 0; i < (int)notify->recipient_count; i++) {
        size_t bytes;
        char *body = notify_text(plant, &notify->recipients[i], &message, now_us, &bytes);
        char *why = delivery_start(delivery, i, body, bytes);
        if (why)
            print_result(&run, i, why);
        run.waiting += !why;
        mem_free(why);
    }
    while (run.waiting > 0)
        delivery_wait(delivery, 1000, on_end, &run);
    if (run.refused > 0)
        fprintf(out, "mail servers refused %d mailbox%s: the warnings name each\n", run.refused, run.refused == 1 ? "" : "es");
    delivery_destroy(&delivery);
    return run.failed + run.refused;
}
