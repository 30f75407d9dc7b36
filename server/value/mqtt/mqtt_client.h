/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to an MQTT broker, by libmosquitto, which no other file includes. A client is made for each connection, and gone with it.
   Thread: one; only connecting has a thread of its own, because the resolver and the library have no timeout there. */
#ifndef VALUE_MQTT_CLIENT_H
#define VALUE_MQTT_CLIENT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

enum { MQTT_MAX_PAYLOAD = 4 << 20 }; /* bytes; brokers that speak MQTT 5 are told so */

struct mqtt_client;

struct mqtt_message {
    const char *topic;
    const void *payload;
    size_t count;
    bool is_retained; /* the broker kept it since before we subscribed */
};

/* What is called from mqtt_client_serve(). */
struct mqtt_client_events {
    void *arg;
    void (*connected)(void *arg, bool session_present);
    void (*subscribed)(void *arg);                        /* all topics are acknowledged, also those that were refused */
    void (*topic_refused)(void *arg, const char *topic);
    void (*message)(void *arg, const struct mqtt_message *message);
};

/* Starts connecting to one of the source's hosts. Returns NULL if that cannot even be tried, and says in why what is wrong. source and
   events must outlive the client. */
struct mqtt_client *mqtt_client_start(const struct plant_source *source, int host, const char *id, const struct mqtt_client_events *events,
                                      char why[200]);
/* Ends the connection, without waiting for anybody. &NULL is fine; leaves NULL. */
void mqtt_client_destroy(struct mqtt_client **client);
/* Waits for the connection until the deadline. Returns 0; -ECANCELED if stop_fd became readable; -ETIMEDOUT; other < 0, and why. */
int mqtt_client_wait(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Sends and receives until the deadline or one message, calling events. Returns 0; -ECANCELED likewise; other < 0: the connection has
   ended, and why. */
int mqtt_client_serve(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Asks for topics, which must outlive the client; once for a client. Returns false if it cannot be sent: serve says why. */
bool mqtt_client_subscribe(struct mqtt_client *client, char *const *topics, size_t count);

/* Publishes a text that the broker keeps for those who subscribe later; only to topics that begin with plantcast/, where no device listens.
   Returns 0; -ENOTCONN if the connection has ended: serve says why; else < 0: it is refused, being too long for the broker, say. */
int mqtt_client_publish(struct mqtt_client *client, const char *topic, const char *text);
/* Returns whether all that was published has been handed to the system. */
bool mqtt_client_has_sent(const struct mqtt_client *client);
/* Asks a Sparkplug node for its birth certificate: nothing else can be published elsewhere. */
void mqtt_client_ask_rebirth(struct mqtt_client *client, const char *group, const char *node);

#endif
