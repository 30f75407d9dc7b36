/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to an MQTT broker through libmosquitto, which no other file includes. Each connection needs a new client. Call
   from one thread only. Connecting runs on a thread of its own inside this module, because neither the resolver nor
   libmosquitto has a timeout for it. */
#ifndef VALUE_MQTT_CLIENT_H
#define VALUE_MQTT_CLIENT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

/* limit in bytes of a received message's payload; announced to MQTT 5 brokers as part of Maximum Packet Size */
enum { MQTT_MAX_PAYLOAD = 4 << 20 };

struct mqtt_client;

struct mqtt_message {
    const char *topic;
    const void *payload;
    size_t count;
    bool is_retained; /* true: the broker had stored the message before our subscription (MQTT's retained flag), so it may be old */
};

/* Functions that mqtt_client_serve() calls. */
struct mqtt_client_events {
    void *arg;
    void (*connected)(void *arg, bool session_present);
    /* called when the broker has acknowledged the subscription to all topics, including topics that it refused */
    void (*subscribed)(void *arg);
    void (*topic_refused)(void *arg, const char *topic);
    void (*message)(void *arg, const struct mqtt_message *message);
};

/* Starts connecting to one of the source's hosts (`host`: its index). address: the host's state, see mqtt_client_next_address().
   Returns NULL with the reason in `why` if the attempt could not be started. `source` and `events` must outlive the client. */
struct mqtt_client *mqtt_client_start(const struct plant_source *source, int host, int address, const char *id,
                                      const struct mqtt_client_events *events, char why[200]);
/* Returns which of a host's IP addresses the next client must use; status: result of mqtt_client_wait(). 0, the first value: all
   in turn, as libmosquitto does. libmosquitto waits two minutes for an address that does not answer, longer than its callers. Each
   timeout therefore selects the next address, which is then used alone until a connection to it fails. With TLS, libmosquitto
   checks the certificate for the name that it connects to, so it always tries all in turn. */
int mqtt_client_next_address(int address, int status);
/* Closes the connection and frees the client, without waiting for the broker; sets *client to NULL. *client may be NULL. */
void mqtt_client_destroy(struct mqtt_client **client);
/* Waits until the connection is made, at most until the deadline. Returns 0; -ECANCELED if stop_fd became readable; -ETIMEDOUT; another
   negative code with the reason in `why`. */
int mqtt_client_wait(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Waits for input, at most until the deadline; then receives and sends, and calls the callbacks in `events`. Returns 0;
   -ECANCELED if stop_fd became readable; another negative code with the reason in `why` when the connection has ended. */
int mqtt_client_serve(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Subscribes to topics, which must outlive the client; may be called once per client. Returns false if the request cannot be sent:
 * mqtt_client_serve() then reports the reason. */
bool mqtt_client_subscribe(struct mqtt_client *client, char *const *topics, size_t count);

/* Publishes a text with the retained flag, only to topics that begin with plantcast/, to which no device subscribes. Returns 0,
   or -ENOTCONN if the connection has ended (mqtt_client_serve() reports the reason). Another negative code means that
   libmosquitto refuses the message, for example because the text is too long for the broker. */
int mqtt_client_publish(struct mqtt_client *client, const char *topic, const char *text);
/* Returns true if all published messages have been passed to the operating system. */
bool mqtt_client_has_sent(const struct mqtt_client *client);
/* Asks a Sparkplug node for its birth certificate. This is the only message that can be published outside plantcast/. */
void mqtt_client_ask_rebirth(struct mqtt_client *client, const char *group, const char *node);

#endif
