/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By GStreamer's webrtcbin. It gets H.264 as the reader asked for it, from the key frame after the connection stands. */
#include "whep_session.h"

#include <stdio.h>
#include <string.h>

#define GST_USE_UNSTABLE_API
#include <gst/sdp/sdp.h>
#include <gst/webrtc/webrtc.h>

/* Of ways to get here those that were found by GATHER_US are enough. A busy machine may not even have made its key by then. */
static const gint64 GATHER_US = 3 * G_USEC_PER_SEC, ANSWER_US = 12 * G_USEC_PER_SEC;
static const gint64 CONNECT_US = 15 * G_USEC_PER_SEC, SILENT_US = 20 * G_USEC_PER_SEC;
enum { FAILED = 1, BAD_OFFER = 2 };

struct whep_session { /* counted: the connection's threads hold it, too */
    GstElement *pipeline, *rtc;
    struct outputs *outputs;
    void (*answered)(struct whep_session *session, const char *sdp, enum whep_fault fault, void *data);
    void *data;
    gint64 begun_us;                     /* the answer; once there is one, the connection */
    guint source;                        /* SSRC of the stream */
    bool added;                          /* to the outputs */
    gint described, gathered, connected; /* atomic */
    gint failed;                         /* atomic: 0, or what came first of FAILED, BAD_OFFER */
    gint heard_s;                        /* atomic: when a report of the reader came last */
    gint ended;                          /* atomic: destroyed */
};

static struct whep_session *hold(struct whep_session *session)
{
    return g_atomic_rc_box_acquire(session);
}

static void release(gpointer session)
{
    g_atomic_rc_box_release(session);
}

static void release_closure(gpointer session, GClosure *closure)
{
    (void)closure;
    release(session);
}

static gint now_s(void)
{
    return (gint)(g_get_monotonic_time() / G_USEC_PER_SEC);
}

/* --- the offer ----------------------------------------------------------------------------------------------------------------- */

/* How well a format suits what we encode, constrained baseline in fragments; 0: not at all. How its profile is told depends on the version
   of GStreamer. */
static int suits(const GstStructure *format)
{
    const char *id = gst_structure_get_string(format, "profile-level-id"), *name = gst_structure_get_string(format, "profile");
    if (g_strcmp0(gst_structure_get_string(format, "encoding-name"), "H264") != 0 ||
        g_strcmp0(gst_structure_get_string(format, "packetization-mode"), "1") != 0)
        return 0;
    if (!g_strcmp0(name, "constrained-baseline") || (id && !g_ascii_strncasecmp(id, "42e0", 4)))
        return 3;
    return !g_strcmp0(name, "baseline") || (id && !g_ascii_strncasecmp(id, "42", 2)) ? 2 : 1;
}

static gboolean is_kept(GQuark field, GValue *value, gpointer data)
{
    static const char *const kept[] = { "media",   "payload", "clock-rate", "encoding-name", "packetization-mode", "profile-level-id",
                                        "profile", NULL };
    (void)value;
    (void)data;
    return g_strv_contains(kept, g_quark_to_string(field));
}

/* The format of H.264 that suits best, as caps of RTP; NULL: none does. */
static GstCaps *caps_of(const GstSDPMessage *offer)
{
    GstStructure *best = NULL;
    for (guint m = 0; m < gst_sdp_message_medias_len(offer); m++) {
        const GstSDPMedia *media = gst_sdp_message_get_media(offer, m);
        for (guint f = 0; !g_strcmp0(gst_sdp_media_get_media(media), "video") && f < gst_sdp_media_formats_len(media); f++) {
            int type = (int)g_ascii_strtoll(gst_sdp_media_get_format(media, f), NULL, 10);
            GstCaps *caps = gst_sdp_media_get_caps_from_media(media, type);
            const GstStructure *format = caps && gst_caps_get_size(caps) > 0 ? gst_caps_get_structure(caps, 0) : NULL;
            if (format && suits(format) > (best ? suits(best) : 0)) {
                g_clear_pointer(&best, gst_structure_free);
                best = gst_structure_copy(format);
            }
            gst_clear_caps(&caps);
        }
    }
    if (!best)
        return NULL;
    gst_structure_set_name(best, "application/x-rtp");
    gst_structure_filter_and_map_in_place(best, is_kept, NULL);
    return gst_caps_new_full(best, NULL);
}

/* --- what comes from its threads --------------------------------------------------------------------------------------------------- */

static void fail(struct whep_session *session, gint how)
{
    g_atomic_int_compare_and_exchange(&session->failed, 0, how);
}

/* Whether it is what the reader sent that is wrong, or what became of it here: memory, threads, an end meanwhile. */
static gint fault_of(struct whep_session *session, const GstStructure *reply)
{
    GError *error = NULL;
    gint how = FAILED;
    if (reply)
        gst_structure_get(reply, "error", G_TYPE_ERROR, &error, NULL);
    if (g_error_matches(error, GST_WEBRTC_ERROR, GST_WEBRTC_ERROR_SDP_SYNTAX_ERROR) ||
        g_error_matches(error, GST_WEBRTC_ERROR, GST_WEBRTC_ERROR_FINGERPRINT_FAILURE) ||
        g_error_matches(error, GST_WEBRTC_ERROR, GST_WEBRTC_ERROR_TYPE_ERROR) ||
        g_error_matches(error, GST_WEBRTC_ERROR, GST_WEBRTC_ERROR_INVALID_MODIFICATION))
        how = BAD_OFFER;
    else if (!g_atomic_int_get(&session->ended))
        fprintf(stderr, "plantcast-video: WHEP: %s\n", error ? error->message : "an answer was given up");
    g_clear_error(&error);
    return how;
}

static void on_gathering(GstElement *rtc, GParamSpec *property, struct whep_session *session)
{
    GstWebRTCICEGatheringState state;
    (void)property;
    g_object_get(rtc, "ice-gathering-state", &state, NULL);
    if (state == GST_WEBRTC_ICE_GATHERING_STATE_COMPLETE)
        g_atomic_int_set(&session->gathered, 1);
    g_main_context_wakeup(NULL);
}

static void on_connection(GstElement *rtc, GParamSpec *property, struct whep_session *session)
{
    GstWebRTCPeerConnectionState state;
    (void)property;
    g_object_get(rtc, "connection-state", &state, NULL);
    if (state == GST_WEBRTC_PEER_CONNECTION_STATE_CONNECTED)
        g_atomic_int_set(&session->connected, 1);
    if (state == GST_WEBRTC_PEER_CONNECTION_STATE_FAILED || state == GST_WEBRTC_PEER_CONNECTION_STATE_CLOSED)
        fail(session, FAILED);
}

static void on_report(GstElement *rtpbin, guint number, guint ssrc, struct whep_session *session)
{
    (void)rtpbin;
    (void)number;
    (void)ssrc;
    g_atomic_int_set(&session->heard_s, now_s());
}

static void on_described(GstPromise *promise, gpointer data)
{
    struct whep_session *session = data;
    const GstStructure *reply = gst_promise_wait(promise) == GST_PROMISE_RESULT_REPLIED ? gst_promise_get_reply(promise) : NULL;
    if (reply && gst_structure_has_field(reply, "error"))
        fail(session, fault_of(session, reply));
    else
        g_atomic_int_set(&session->described, 1);
    gst_promise_unref(promise);
}

static void on_answer(GstPromise *promise, gpointer data)
{
    struct whep_session *session = data;
    const GstStructure *reply = gst_promise_wait(promise) == GST_PROMISE_RESULT_REPLIED ? gst_promise_get_reply(promise) : NULL;
    GstWebRTCSessionDescription *answer = NULL;
    if (reply)
        gst_structure_get(reply, "answer", GST_TYPE_WEBRTC_SESSION_DESCRIPTION, &answer, NULL);
    if (answer) {
        g_signal_emit_by_name(session->rtc, "set-local-description", answer,
                              gst_promise_new_with_change_func(on_described, hold(session), release));
        gst_webrtc_session_description_free(answer);
    } else {
        fail(session, fault_of(session, reply));
    }
    gst_promise_unref(promise);
}

static void on_offer(GstPromise *promise, gpointer data)
{
    struct whep_session *session = data;
    const GstStructure *reply = gst_promise_wait(promise) == GST_PROMISE_RESULT_REPLIED ? gst_promise_get_reply(promise) : NULL;
    if (g_atomic_int_get(&session->ended))
        fail(session, FAILED);
    else if (reply && gst_structure_has_field(reply, "error"))
        fail(session, fault_of(session, reply));
    else
        g_signal_emit_by_name(session->rtc, "create-answer", NULL, gst_promise_new_with_change_func(on_answer, hold(session), release));
    gst_promise_unref(promise);
}

/* --- its life ---------------------------------------------------------------------------------------------------------------------- */

/* GStreamer 1.22 names the stream of what is sent again, and not that of which it is: "FID 0 N". A browser then plays nothing. */
static char *name_source(const struct whep_session *session, char *sdp)
{
    static const char unnamed[] = "a=ssrc-group:FID 0 ";
    char **lines = g_strsplit(sdp, "\r\n", -1), *again = NULL;
    GString *out = g_string_new("");
    g_free(sdp);
    for (char **line = lines; *line; line++) {
        bool is_group = g_str_has_prefix(*line, unnamed);
        if (is_group) {
            again = g_strdup_printf("a=ssrc:%s ", *line + strlen(unnamed));
            g_string_append_printf(out, "a=ssrc-group:FID %u %s", session->source, *line + strlen(unnamed));
        } else {
            if (again && g_str_has_prefix(*line, again))
                g_string_append_printf(out, "a=ssrc:%u %s\r\n", session->source, *line + strlen(again));
            g_string_append(out, *line);
        }
        if (line[1])
            g_string_append(out, "\r\n");
    }
    g_free(again);
    g_strfreev(lines);
    return g_string_free(out, FALSE);
}

static char *answer_of(struct whep_session *session)
{
    GstWebRTCSessionDescription *local = NULL;
    g_object_get(session->rtc, "local-description", &local, NULL);
    char *text = local ? gst_sdp_message_as_text(local->sdp) : NULL;
    if (local)
        gst_webrtc_session_description_free(local);
    return text ? name_source(session, text) : NULL;
}

/* Asks webrtcbin only for what it has: while it works at a description it holds a lock for which each question waits. */
static gboolean look_for_answer(gpointer data)
{
    struct whep_session *session = data;
    gint64 waited_us = g_get_monotonic_time() - session->begun_us;
    gint failed = g_atomic_int_get(&session->failed);
    bool gathered = g_atomic_int_get(&session->gathered), late = waited_us > ANSWER_US;
    if (g_atomic_int_get(&session->ended))
        return G_SOURCE_REMOVE;
    bool described = g_atomic_int_get(&session->described);
    char *text = described && !failed && (gathered || waited_us > GATHER_US) ? answer_of(session) : NULL;
    if (text && !gathered && !late && !strstr(text, "\r\na=candidate:"))
        g_clear_pointer(&text, g_free);
    if (!text && !failed && !late)
        return G_SOURCE_CONTINUE;
    if (!text && !failed)
        fprintf(stderr, "plantcast-video: WHEP: no answer after %d s, this machine is busy\n", (int)(waited_us / G_USEC_PER_SEC));
    if (!text)
        fail(session, FAILED);
    session->begun_us = g_get_monotonic_time();
    session->answered(session, text, failed == BAD_OFFER ? WHEP_BAD_OFFER : WHEP_BUSY, session->data);
    g_free(text);
    return G_SOURCE_REMOVE;
}

/* Only where outputs listen. */
static void set_address(GstElement *rtc, const char *listen)
{
    GObject *agent = NULL;
    gboolean good;
    if (!strcmp(listen, "0.0.0.0") || !strcmp(listen, "::"))
        return;
    g_object_get(rtc, "ice-agent", &agent, NULL);
    if (agent)
        g_signal_emit_by_name(agent, "add-local-ip-address", listen, &good);
    g_clear_object(&agent);
}

static void send_only(GstElement *rtc)
{
    GArray *list = NULL;
    g_signal_emit_by_name(rtc, "get-transceivers", &list);
    for (guint i = 0; list && i < list->len; i++)
        g_object_set(g_array_index(list, GstWebRTCRTPTransceiver *, i), "direction", GST_WEBRTC_RTP_TRANSCEIVER_DIRECTION_SENDONLY,
                     "do-nack", TRUE, NULL);
    if (list)
        g_array_unref(list);
}

static void watch(struct whep_session *session)
{
    GstElement *rtpbin = gst_bin_get_by_name(GST_BIN(session->rtc), "rtpbin");
    g_signal_connect_data(session->rtc, "notify::ice-gathering-state", G_CALLBACK(on_gathering), hold(session), release_closure, 0);
    g_signal_connect_data(session->rtc, "notify::connection-state", G_CALLBACK(on_connection), hold(session), release_closure, 0);
    if (rtpbin)
        g_signal_connect_data(rtpbin, "on-ssrc-active", G_CALLBACK(on_report), hold(session), release_closure, 0);
    gst_clear_object(&rtpbin);
}

/* The payloader would write its own level into the caps, and webrtcbin compare it with the reader's letter by letter. */
static bool make_pipeline(struct whep_session *session, GstCaps *caps)
{
    GError *error = NULL;
    int payload = 0;
    gst_structure_get_int(gst_caps_get_structure(caps, 0), "payload", &payload);
    session->source = (guint)g_random_int_range(1, G_MAXINT32);
    char *text = g_strdup_printf(OUTPUTS_SOURCE " ! rtph264pay pt=%d ssrc=%u config-interval=-1 aggregate-mode=zero-latency ! "
                                                "capssetter name=setter join=false replace=true ! capsfilter name=filter ! "
                                                "webrtcbin name=rtc bundle-policy=max-bundle latency=0",
                                 payload, session->source);
    session->pipeline = gst_parse_launch(text, &error);
    g_free(text);
    if (error) {
        fprintf(stderr, "plantcast-video: WHEP: %s (packages gstreamer1.0-plugins-bad, gstreamer1.0-nice)\n", error->message);
        g_error_free(error);
        return false;
    }
    for (int i = 0; i < 2; i++) {
        GstElement *element = gst_bin_get_by_name(GST_BIN(session->pipeline), i ? "filter" : "setter");
        g_object_set(element, "caps", caps, NULL);
        gst_object_unref(element);
    }
    session->rtc = gst_bin_get_by_name(GST_BIN(session->pipeline), "rtc");
    return true;
}

static bool begin(struct whep_session *session, const struct options *options, GstCaps *caps, GstSDPMessage *offer)
{
    GstWebRTCSessionDescription *description = gst_webrtc_session_description_new(GST_WEBRTC_SDP_TYPE_OFFER, offer);
    bool good = make_pipeline(session, caps);
    if (good) {
        set_address(session->rtc, options->listen);
        send_only(session->rtc);
        watch(session);
        gst_element_set_state(session->pipeline, GST_STATE_PLAYING);
        g_signal_emit_by_name(session->rtc, "set-remote-description", description,
                              gst_promise_new_with_change_func(on_offer, hold(session), release));
        g_timeout_add_full(G_PRIORITY_DEFAULT, 20, look_for_answer, hold(session), release);
    }
    gst_webrtc_session_description_free(description);
    return good;
}

struct whep_session *whep_session_create(const struct options *options, struct outputs *outputs, const char *offer,
                                         void (*answered)(struct whep_session *session, const char *sdp, enum whep_fault fault, void *data),
                                         void *data, enum whep_fault *fault, const char **why)
{
    GstSDPMessage *message = NULL;
    bool good = gst_sdp_message_new_from_text(offer, &message) == GST_SDP_OK && gst_sdp_message_medias_len(message) > 0;
    GstCaps *caps = good ? caps_of(message) : NULL;
    struct whep_session *session = NULL;
    *fault = WHEP_BAD_OFFER;
    *why = !good ? "an offer in SDP with a video is expected" : "the offer has no H.264 with packetization-mode=1";
    if (!caps) {
        if (message)
            gst_sdp_message_free(message);
        return NULL;
    }
    session = g_atomic_rc_box_new0(struct whep_session);
    session->outputs = outputs;
    session->answered = answered;
    session->data = data;
    session->begun_us = g_get_monotonic_time();
    session->heard_s = now_s();
    if (!begin(session, options, caps, message)) {
        *fault = WHEP_UNABLE;
        *why = "WebRTC is not installed here";
        whep_session_destroy(&session);
    }
    gst_caps_unref(caps);
    return session;
}

void whep_session_leave(struct whep_session *session)
{
    g_atomic_int_set(&session->ended, 1);
    if (session->added) {
        GstElement *in = gst_bin_get_by_name(GST_BIN(session->pipeline), "in");
        outputs_remove(session->outputs, GST_APP_SRC(in));
        gst_object_unref(in);
        session->added = false;
    }
}

/* To end, webrtcbin waits for the lock that it holds while it works at a description. */
void whep_session_destroy(struct whep_session **pointer)
{
    struct whep_session *session = *pointer;
    if (!session)
        return;
    if (session->pipeline)
        gst_element_set_state(session->pipeline, GST_STATE_NULL);
    gst_clear_object(&session->rtc);
    gst_clear_object(&session->pipeline);
    release(session);
    *pointer = NULL;
}

bool whep_session_is_alive(struct whep_session *session)
{
    bool connected = g_atomic_int_get(&session->connected);
    if (g_atomic_int_get(&session->failed))
        return false;
    if (!connected)
        return g_get_monotonic_time() - session->begun_us < CONNECT_US;
    if (!session->added) {
        GstElement *in = gst_bin_get_by_name(GST_BIN(session->pipeline), "in");
        outputs_add(session->outputs, GST_APP_SRC(in));
        gst_object_unref(in);
        session->added = true;
        g_atomic_int_set(&session->heard_s, now_s());
    }
    return now_s() - g_atomic_int_get(&session->heard_s) < SILENT_US / G_USEC_PER_SEC;
}
