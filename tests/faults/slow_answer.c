/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LD_PRELOAD: GStreamer gets no further with an answer of WebRTC as long as there is the file SLOW_ANSWER, as on a busy machine; but
   never longer than for 30 s. */
#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

#define GST_USE_UNSTABLE_API
#include <gst/webrtc/webrtc.h>

#define EXPORTED __attribute__((visibility("default")))
typedef GstWebRTCSessionDescription *make(GstWebRTCSDPType type, GstSDPMessage *sdp);

EXPORTED GstWebRTCSessionDescription *gst_webrtc_session_description_new(GstWebRTCSDPType type, GstSDPMessage *sdp)
{
    static make *real;
    const char *file = getenv("SLOW_ANSWER");
    if (!real)
        *(void **)&real = dlsym(RTLD_NEXT, "gst_webrtc_session_description_new");
    for (int i = 0; i < 600 && type == GST_WEBRTC_SDP_TYPE_ANSWER && file && access(file, F_OK) == 0; i++)
        usleep(50000);
    return real(type, sdp);
}
