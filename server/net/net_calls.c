/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs functions in the event loop on behalf of other threads, which wait meanwhile. */
#include <pthread.h>

#include "net/net.h"
#include "net/net_impl.h"

void net_calls_init(struct net *net)
{
    pthread_mutex_init(&net->call.turn, NULL);
    pthread_mutex_init(&net->call.lock, NULL);
    pthread_cond_init(&net->call.done, NULL);
}

void net_calls_finish(struct net *net)
{
    pthread_cond_destroy(&net->call.done);
    pthread_mutex_destroy(&net->call.lock);
    pthread_mutex_destroy(&net->call.turn);
}

bool net_call(struct net *net, void (*what)(void *arg), void *arg)
{
    pthread_mutex_lock(&net->call.turn);
    pthread_mutex_lock(&net->call.lock);
    bool open = !net->call.closed;
    net->call.what = what;
    net->call.arg = arg;
    net_wake(net);
    while (net->call.what && !net->call.closed)
        pthread_cond_wait(&net->call.done, &net->call.lock);
    open = open && !net->call.what;
    net->call.what = NULL;
    pthread_mutex_unlock(&net->call.lock);
    pthread_mutex_unlock(&net->call.turn);
    return open;
}

void net_calls_run(struct net *net)
{
    pthread_mutex_lock(&net->call.lock);
    void (*what)(void *arg) = net->call.what;
    void *arg = net->call.arg;
    pthread_mutex_unlock(&net->call.lock);
    if (!what)
        return;
    /* Calls the function without holding the lock. net->call cannot be overwritten meanwhile: the thread that requested the
       call waits until the function has run. */
    what(arg);
    pthread_mutex_lock(&net->call.lock);
    net->call.what = NULL;
    pthread_cond_signal(&net->call.done);
    pthread_mutex_unlock(&net->call.lock);
}

void net_calls_close(struct net *net)
{
    pthread_mutex_lock(&net->call.lock);
    net->call.closed = true;
    pthread_cond_signal(&net->call.done);
    pthread_mutex_unlock(&net->call.lock);
}

void net_wake(struct net *net)
{
    lws_cancel_service(net->server.lws);
}
