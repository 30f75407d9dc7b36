/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A listening socket that the service manager (systemd) has opened. Connections wait in it while the daemon restarts, so none is
   refused. */
#ifndef NET_HANDED_SOCKET_H
#define NET_HANDED_SOCKET_H
#include "net/net_impl.h"

enum { HANDED_ADDRESS_BYTES = 64 };
/* Finds the numeric address and the port on which the socket listens. Returns false if it is not a listening TCP socket. Any thread. */
bool handed_socket_find(int fd, char address[HANDED_ADDRESS_BYTES], int *port);
/* Makes the event loop accept connections from server.params.socket_fd. Logs and returns false if it cannot. Call in the event
   loop's thread, before the loop runs. */
bool handed_socket_listen(struct net *net);
/* libwebsockets callback for events of the systemd listening socket */
int handed_socket_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);

#endif
