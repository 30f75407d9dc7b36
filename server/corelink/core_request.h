/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests from a renderer or standby to its core: the settings and error texts of queries for recorded data and of the
   transfer of the tag list. Use each request in one thread only. */
#ifndef CORELINK_CORE_REQUEST_H
#define CORELINK_CORE_REQUEST_H
#include "base/system/http_request.h"
#include "corelink/core_link.h"

/* Creates a request that gives up if a core cannot be reached within 4 s, or sends nothing for 10 s. Returns false when out of
   memory. End with http_request_finish(). */
bool core_request_make(struct http_request *request);
/* Sets the core and the path of the next request. */
void core_request_address(struct http_request *request, const struct core_peer *peer, const char *path);
/* Sends the request and waits for the answer, which is appended to request->answer. Returns NULL if the HTTP status is 200; otherwise
   the reason (mem_free), with the first line of the core's answer. */
char *core_request_send(struct http_request *request);

#endif
