/* SPDX-License-Identifier: GPL-3.0-or-later */
/* RTSP by gst-rtsp-server. */
#include "rtsp.h"

#include <gst/rtsp-server/rtsp-server.h>
#include <stdio.h>

enum { SESSION_S = 60, LOOK_S = 5 };
static const char PATH[] = "/plantcast", READER[] = "reader";

struct rtsp {
    GstRTSPServer *server;
    GstRTSPSessionPool *sessions;
    struct outputs *outputs;
    guint attached, looking;
};

static void on_unprepared(GstRTSPMedia *media, struct outputs *outputs)
{
    GstElement *element = gst_rtsp_media_get_element(media), *in = gst_bin_get_by_name(GST_BIN(element), "in");
    if (in)
        outputs_remove(outputs, GST_APP_SRC(in));
    gst_clear_object(&in);
    gst_object_unref(element);
}

static void on_media(GstRTSPMediaFactory *factory, GstRTSPMedia *media, struct rtsp *rtsp)
{
    (void)factory;
    GstElement *element = gst_rtsp_media_get_element(media), *in = gst_bin_get_by_name(GST_BIN(element), "in");
    gst_rtsp_media_set_reusable(media, FALSE);
    outputs_add(rtsp->outputs, GST_APP_SRC(in));
    g_signal_connect(media, "unprepared", G_CALLBACK(on_unprepared), rtsp->outputs);
    gst_object_unref(in);
    gst_object_unref(element);
}

static gboolean forget_gone(gpointer data)
{
    gst_rtsp_session_pool_cleanup(((struct rtsp *)data)->sessions);
    return G_SOURCE_CONTINUE;
}

static GstRTSPMediaFactory *factory_create(struct rtsp *rtsp, bool closed)
{
    GstRTSPMediaFactory *factory = gst_rtsp_media_factory_new();
    gst_rtsp_media_factory_set_launch(factory, "( " OUTPUTS_SOURCE " ! rtph264pay name=pay0 pt=96 config-interval=-1 )");
    gst_rtsp_media_factory_set_shared(factory, TRUE);
    g_signal_connect(factory, "media-configure", G_CALLBACK(on_media), rtsp);
    if (closed)
        gst_rtsp_media_factory_add_role(factory, READER, GST_RTSP_PERM_MEDIA_FACTORY_ACCESS, G_TYPE_BOOLEAN, TRUE,
                                        GST_RTSP_PERM_MEDIA_FACTORY_CONSTRUCT, G_TYPE_BOOLEAN, TRUE, NULL);
    return factory;
}

/* Allows only clients with the configured login to read the stream, by digest authentication, so that the password does not cross the
   network in clear text. */
static void set_reader(GstRTSPServer *server, const struct video_options *options)
{
    GstRTSPAuth *auth = gst_rtsp_auth_new();
    GstRTSPToken *token = gst_rtsp_token_new(GST_RTSP_TOKEN_MEDIA_FACTORY_ROLE, G_TYPE_STRING, READER, NULL);
    gst_rtsp_auth_set_supported_methods(auth, GST_RTSP_AUTH_DIGEST);
    gst_rtsp_auth_add_digest(auth, options->user, options->password, token);
    gst_rtsp_server_set_auth(server, auth);
    gst_rtsp_token_unref(token);
    g_object_unref(auth);
}

struct rtsp *rtsp_create(const struct video_options *options, struct outputs *outputs)
{
    struct rtsp *rtsp = g_new0(struct rtsp, 1);
    char *port = g_strdup_printf("%d", options->rtsp_port);
    GError *error = NULL;
    rtsp->outputs = outputs;
    rtsp->server = gst_rtsp_server_new();
    gst_rtsp_server_set_address(rtsp->server, options->listen);
    gst_rtsp_server_set_service(rtsp->server, port);
    g_free(port);
    rtsp->sessions = gst_rtsp_server_get_session_pool(rtsp->server);
    gst_rtsp_session_pool_set_max_sessions(rtsp->sessions, (guint)options->most_readers);
    GstRTSPMountPoints *mounts = gst_rtsp_server_get_mount_points(rtsp->server);
    gst_rtsp_mount_points_add_factory(mounts, PATH, factory_create(rtsp, options->user != NULL));
    g_object_unref(mounts);
    if (options->user)
        set_reader(rtsp->server, options);
    GSource *source = gst_rtsp_server_create_source(rtsp->server, NULL, &error);
    if (!source) {
        fprintf(stderr, "plantcast-video: --rtsp %d: %s\n", options->rtsp_port, error->message);
        g_error_free(error);
        rtsp_destroy(&rtsp);
        return NULL;
    }
    g_source_set_callback(source, G_SOURCE_FUNC(gst_rtsp_server_io_func), g_object_ref(rtsp->server), g_object_unref);
    rtsp->attached = g_source_attach(source, NULL);
    g_source_unref(source);
    rtsp->looking = g_timeout_add_seconds(LOOK_S, forget_gone, rtsp);
    return rtsp;
}

static GstRTSPFilterResult remove_client(GstRTSPServer *server, GstRTSPClient *client, gpointer data)
{
    (void)server;
    (void)client;
    (void)data;
    return GST_RTSP_FILTER_REMOVE;
}

void rtsp_destroy(struct rtsp **pointer)
{
    struct rtsp *rtsp = *pointer;
    if (!rtsp)
        return;
    if (rtsp->attached)
        g_source_remove(rtsp->attached);
    if (rtsp->looking)
        g_source_remove(rtsp->looking);
    gst_rtsp_server_client_filter(rtsp->server, remove_client, NULL);
    g_object_unref(rtsp->sessions);
    g_object_unref(rtsp->server);
    g_free(rtsp);
    *pointer = NULL;
}

guint rtsp_readers(const struct rtsp *rtsp)
{
    return rtsp ? gst_rtsp_session_pool_get_n_sessions(rtsp->sessions) : 0;
}
