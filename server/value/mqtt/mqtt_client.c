/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wraps libmosquitto, with a poll() loop of our own instead of the library's select() loop, which cannot handle descriptors above 1023. */
#include "value/mqtt/mqtt_client.h"

#include <errno.h>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <netdb.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/login_file.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/mqtt/sparkplug_payload.h"

enum { TOPICS_AT_ONCE = 8 };         /* maximum number of topics in one subscribe request; some brokers refuse more */
enum { SESSION_KEPT_S = 7 * 86400 }; /* time in seconds for which the broker keeps a persistent session after a disconnection */
static const char SYSTEM_CERTIFICATES[] = "/etc/ssl/certs";
/* interval at which libmosquitto is called to send keep-alive messages when they are due */
static const int64_t CHORES_NS = 500 * NS_PER_MS;

struct mqtt_client {
    struct mosquitto *library;
    const struct plant_source *source;
    const struct mqtt_client_events *events;
    char *host; /* copies of the host's name and settings for the connecting thread, because that thread may outlive the source */
    int port, keepalive_s;
    int address; /* selects one of the host's IP addresses, by this index modulo their number; 0: all, in turn */
    mosquitto_property *properties;
    int done_fd; /* eventfd that becomes readable once the attempt to connect has succeeded or failed */
    _Atomic int users;
    _Atomic int status; /* status: result code of the attempt to connect; errno_then: errno at that time */
    int errno_then;
    char said[160]; /* text of the last error that libmosquitto logged */
    /* --- below: members that only the thread that calls mqtt_client_serve() uses */
    int refusal; /* reason code of the broker's refusal of the connection; 0: none */
    char *const *topics;
    size_t topic_count, acknowledged;
    /* message ids of the subscribe requests, each for up to TOPICS_AT_ONCE topics; 0: the broker has acknowledged the request */
    int *requests;
};

static void client_unref(struct mqtt_client *client)
{
    if (atomic_fetch_sub(&client->users, 1) != 1)
        return;
    if (client->library)
        mosquitto_destroy(client->library);
    if (client->done_fd >= 0)
        close(client->done_fd);
    mosquitto_property_free_all(&client->properties);
    mem_free(client->host);
    mem_free(client->requests);
    mem_free(client);
}

/* --- library callbacks ------------------------------------------------------------------------------------------------------ */

static void on_log(struct mosquitto *library, void *arg, int level, const char *line)
{
    struct mqtt_client *client = arg;
    (void)library;
    if (level == MOSQ_LOG_ERR)
        snprintf(client->said, sizeof(client->said), "%s", line);
}

static void on_connect(struct mosquitto *library, void *arg, int refusal, int flags, const mosquitto_property *properties)
{
    struct mqtt_client *client = arg;
    (void)library;
    (void)properties;
    client->refusal = refusal;
    if (refusal == 0)
        client->events->connected(client->events->arg, flags & 1);
}

static void on_message(struct mosquitto *library, void *arg, const struct mosquitto_message *message, const mosquitto_property *properties)
{
    struct mqtt_client *client = arg;
    const struct mqtt_message ours = { .topic = message->topic,
                                       .payload = message->payload,
                                       .count = message->payloadlen > 0 ? (size_t)message->payloadlen : 0,
                                       .is_retained = message->retain };
    (void)library;
    (void)properties;
    client->events->message(client->events->arg, &ours);
}

static void on_subscribe(struct mosquitto *library, void *arg, int id, int count, const int *granted, const mosquitto_property *properties)
{
    struct mqtt_client *client = arg;
    size_t request = 0, requests = (client->topic_count + TOPICS_AT_ONCE - 1) / TOPICS_AT_ONCE;
    (void)library;
    (void)properties;
    while (request < requests && client->requests[request] != id)
        request++;
    if (request == requests)
        return;
    client->requests[request] = 0; /* 0 marks the request as acknowledged, because libmosquitto never uses the message id 0 */
    for (size_t i = 0, topic = request * TOPICS_AT_ONCE; i < TOPICS_AT_ONCE && topic < client->topic_count; i++, topic++) {
        client->acknowledged++;
        if ((int)i >= count || granted[i] >= 128)
            client->events->topic_refused(client->events->arg, client->topics[topic]);
    }
    if (client->acknowledged == client->topic_count)
        client->events->subscribed(client->events->arg);
}

/* --- creating a client ------------------------------------------------------------------------------------------------------ */

static void init_library(void)
{
    mosquitto_lib_init();
}

static mosquitto_property *connect_properties(const struct plant_mqtt *mqtt)
{
    mosquitto_property *properties = NULL;
    if (mqtt->protocol != 5)
        return NULL;
    mosquitto_property_add_int32(&properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, MQTT_MAX_PAYLOAD + 65536 + 64);
    if (mqtt->persistent)
        mosquitto_property_add_int32(&properties, MQTT_PROP_SESSION_EXPIRY_INTERVAL, SESSION_KEPT_S);
    return properties;
}

int mqtt_client_next_address(int address, int status)
{
    return status == 0 ? address : status == -ETIMEDOUT ? address + 1 : 0;
}

/* Writes the selected IP address of the host. Returns false if all addresses of the host's name shall be tried. */
static bool select_address(const struct mqtt_client *client, char address[NI_MAXHOST])
{
    const struct addrinfo hints = { .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM };
    struct addrinfo *found;
    int count = 0;
    if (client->address == 0 || getaddrinfo(client->host, NULL, &hints, &found) != 0)
        return false;
    for (const struct addrinfo *at = found; at; at = at->ai_next)
        count++;
    const struct addrinfo *at = found;
    for (int i = 0; i < client->address % count; i++)
        at = at->ai_next;
    bool good = at != found && getnameinfo(at->ai_addr, at->ai_addrlen, address, NI_MAXHOST, NULL, 0, NI_NUMERICHOST) == 0;
    freeaddrinfo(found);
    return good;
}

static void *connect_main(void *arg)
{
    struct mqtt_client *client = arg;
    char address[NI_MAXHOST];
    const char *to = select_address(client, address) ? address : client->host;
    int status = mosquitto_connect_bind_v5(client->library, to, client->port, client->keepalive_s, NULL, client->properties);
    client->errno_then = errno;
    client->status = status;
    eventfd_write(client->done_fd, 1);
    client_unref(client);
    return NULL;
}

/* Callback of OpenSSL that must supply the passphrase of an encrypted key. Fails, because nobody is present to type one. */
static int no_passphrase(char *out, int bytes, int for_writing, void *arg)
{
    (void)out;
    (void)bytes;
    (void)for_writing;
    (void)arg;
    return 0;
}

static bool use_tls(struct mqtt_client *client, char why[200])
{
    const struct plant_mqtt *mqtt = &client->source->mqtt;
    if (!mqtt->has_tls)
        return true;
    int status =
        mosquitto_tls_set(client->library, mqtt->ca, mqtt->ca ? NULL : SYSTEM_CERTIFICATES, mqtt->certificate, mqtt->key, no_passphrase);
    if (status != MOSQ_ERR_SUCCESS)
        snprintf(why, 200, "tls: the certificate or key files cannot be used: %s", mosquitto_strerror(status));
    return status == MOSQ_ERR_SUCCESS;
}

/* Sets user name and password for the broker. Reads the login file again for each connection, because the password may have changed.
   Returns false with the reason in `why`. */
static bool log_in(struct mqtt_client *client, char why[200])
{
    const char *file = client->source->login;
    struct login_file login;
    if (!file)
        return true;
    if (!login_file_read(file, &login, why))
        return false;
    bool good = mosquitto_username_pw_set(client->library, login.user, login.password) == MOSQ_ERR_SUCCESS;
    if (!good)
        snprintf(why, 200, "%.100s: the user name or password is not valid UTF-8, or memory ran out", file);
    login_file_forget(&login);
    return good;
}

static bool leave_will(struct mqtt_client *client, char why[200])
{
    static const char OFFLINE[] = "offline";
    const char *topic = client->source->mqtt.will;
    bool stays = client->source->mqtt.will_stays;
    int status = topic ? mosquitto_will_set(client->library, topic, (int)strlen(OFFLINE), OFFLINE, 1, stays) : MOSQ_ERR_SUCCESS;
    if (status != MOSQ_ERR_SUCCESS)
        snprintf(why, 200, "will: %s", mosquitto_strerror(status));
    return status == MOSQ_ERR_SUCCESS;
}

static bool prepare(struct mqtt_client *client, const char *id, char why[200])
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    const struct plant_mqtt *mqtt = &client->source->mqtt;
    pthread_once(&once, init_library);
    client->library = mosquitto_new(id, !mqtt->persistent, client);
    if (!client->library) {
        snprintf(why, 200, "the client id '%.60s' cannot be used: %s", id, strerror(errno));
        return false;
    }
    mosquitto_int_option(client->library, MOSQ_OPT_PROTOCOL_VERSION, mqtt->protocol);
    mosquitto_log_callback_set(client->library, on_log);
    mosquitto_connect_v5_callback_set(client->library, on_connect);
    mosquitto_message_v5_callback_set(client->library, on_message);
    mosquitto_subscribe_v5_callback_set(client->library, on_subscribe);
    return use_tls(client, why) && log_in(client, why) && leave_will(client, why);
}

struct mqtt_client *mqtt_client_start(const struct plant_source *source, int host, int address, const char *id,
                                      const struct mqtt_client_events *events, char why[200])
{
    pthread_t thread;
    struct mqtt_client *client = mem_new(sizeof(*client));
    *client = (struct mqtt_client){ .source = source,
                                    .events = events,
                                    .host = mem_strdup(source->hosts[host]),
                                    .port = source->port,
                                    .address = source->mqtt.has_tls ? 0 : address,
                                    .keepalive_s = source->mqtt.keepalive_s,
                                    .properties = connect_properties(&source->mqtt),
                                    .users = 1 };
    client->done_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    bool good = client->done_fd >= 0;
    if (!good)
        snprintf(why, 200, "eventfd: %s", strerror(errno));
    good = good && prepare(client, id, why);
    if (good) {
        client->users = 2;
        good = pthread_create(&thread, NULL, connect_main, client) == 0;
        if (!good) {
            client->users = 1;
            snprintf(why, 200, "a thread cannot be started");
        }
    }
    if (good)
        pthread_detach(thread);
    else
        mqtt_client_destroy(&client);
    return client;
}

void mqtt_client_destroy(struct mqtt_client **client)
{
    struct mqtt_client *gone = *client;
    *client = NULL;
    if (!gone)
        return;
    if (gone->done_fd >= 0 && wait_for(gone->done_fd, POLLIN, -1, 0) == 0)
        mosquitto_disconnect(gone->library); /* the connecting thread has ended by now, so it no longer uses the libmosquitto object */
    client_unref(gone);
}

/* --- serving ---------------------------------------------------------------------------------------------------------------- */

/* Writes the reason why a connection to the broker ended to `why`. Returns the code that mqtt_client_serve() must return. */
static int explain(const struct mqtt_client *client, int status, int errno_then, char why[200])
{
    bool is_5 = client->source->mqtt.protocol == 5;
    if (client->refusal)
        snprintf(why, 200, "the broker refused the connection: %s%s",
                 is_5 ? mosquitto_reason_string(client->refusal) : mosquitto_connack_string(client->refusal),
                 is_5 && (client->refusal == MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION || client->refusal == 1) ? "; try protocol: 3.1.1" : "");
    else if (*client->said)
        snprintf(why, 200, "%s", client->said);
    else
        snprintf(why, 200, "%s", status == MOSQ_ERR_ERRNO && errno_then ? strerror(errno_then) : mosquitto_strerror(status));
    return -ECONNRESET;
}

int mqtt_client_wait(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    int status = wait_for(client->done_fd, POLLIN, stop_fd, deadline_mono_ns);
    if (status == -ETIMEDOUT)
        snprintf(why, 200, "%s", strerror(ETIMEDOUT));
    if (status)
        return status;
    return client->status == MOSQ_ERR_SUCCESS ? 0 : explain(client, client->status, client->errno_then, why);
}

/* Returns true if the TLS layer holds bytes that it has received and decrypted already; poll() on the socket does not report these. */
static bool holds_more(struct mqtt_client *client)
{
    SSL *tls = mosquitto_ssl_get(client->library);
    return tls && SSL_pending(tls) > 0;
}

static int receive(struct mqtt_client *client)
{
    int status;
    do
        status = mosquitto_loop_read(client->library, 1);
    while (status == MOSQ_ERR_SUCCESS && mosquitto_socket(client->library) >= 0 && holds_more(client));
    return status;
}

int mqtt_client_serve(struct mqtt_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    int fd = mosquitto_socket(client->library);
    if (fd < 0)
        return explain(client, MOSQ_ERR_CONN_LOST, 0, why);
    int64_t chores_ns = clock_mono_ns() + CHORES_NS;
    int ready = wait_for(fd, (short)(POLLIN | (mosquitto_want_write(client->library) ? POLLOUT : 0)), stop_fd,
                         chores_ns < deadline_mono_ns ? chores_ns : deadline_mono_ns);
    if (ready == -ECANCELED)
        return ready;
    int status = MOSQ_ERR_SUCCESS;
    errno = 0;
    if (ready == 0)
        status = receive(client);
    if (status == MOSQ_ERR_SUCCESS && mosquitto_want_write(client->library))
        status = mosquitto_loop_write(client->library, 1);
    if (status == MOSQ_ERR_SUCCESS)
        status = mosquitto_loop_misc(client->library);
    return status == MOSQ_ERR_SUCCESS ? 0 : explain(client, status, errno, why);
}

bool mqtt_client_subscribe(struct mqtt_client *client, char *const *topics, size_t count)
{
    int status = MOSQ_ERR_SUCCESS;
    client->topics = topics;
    client->topic_count = count;
    client->requests = mem_array(count / TOPICS_AT_ONCE + 1, sizeof(*client->requests));
    for (size_t first = 0; first < count && status == MOSQ_ERR_SUCCESS; first += TOPICS_AT_ONCE) {
        int some = count - first < TOPICS_AT_ONCE ? (int)(count - first) : TOPICS_AT_ONCE;
        status = mosquitto_subscribe_multiple(client->library, &client->requests[first / TOPICS_AT_ONCE], some, topics + first,
                                              client->source->mqtt.qos, 0, NULL);
    }
    return status == MOSQ_ERR_SUCCESS;
}

int mqtt_client_publish(struct mqtt_client *client, const char *topic, const char *text)
{
    static const char OURS[] = "plantcast/";
    if (strncmp(topic, OURS, strlen(OURS)) != 0)
        return -EPERM;
    switch (mosquitto_publish(client->library, NULL, topic, (int)strlen(text), text, 0, true)) {
    case MOSQ_ERR_SUCCESS: return 0;
    case MOSQ_ERR_NO_CONN:
    case MOSQ_ERR_CONN_LOST:
    case MOSQ_ERR_ERRNO: return -ENOTCONN;
    default: return -EINVAL;
    }
}

bool mqtt_client_has_sent(const struct mqtt_client *client)
{
    return !mosquitto_want_write(client->library);
}

void mqtt_client_ask_rebirth(struct mqtt_client *client, const char *group, const char *node)
{
    uint8_t payload[SPARKPLUG_REBIRTH_BYTES];
    size_t count = sparkplug_rebirth_write(payload, clock_utc_ns());
    char *topic = mem_printf("spBv1.0/%s/NCMD/%s", group, node);
    mosquitto_publish(client->library, NULL, topic, (int)count, payload, 0, false);
    mem_free(topic);
}
