/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queues of requests to the identity provider that wait to be sent by a thread. */

#include "access/openid/openid_impl.h"
#include "base/files/secret.h"
#include "base/mem.h"

void openid_free_job(struct openid_job *job)
{
    secret_forget(job->code);
    secret_forget(job->revoke);
    mem_free(job->from);
    mem_free(job);
}

void openid_free_jobs(struct openid_jobs *jobs)
{
    for (struct openid_job *job = jobs->first, *next; job; job = next) {
        next = job->next;
        openid_free_job(job);
    }
    *jobs = (struct openid_jobs){ .last = &jobs->first };
}

void openid_add_job(struct openid *openid, struct openid_jobs *jobs, const struct openid_job *job)
{
    struct openid_job *copy = mem_new(sizeof(*copy));
    *copy = *job;
    *jobs->last = copy;
    jobs->last = &copy->next;
    jobs->count++;
    pthread_cond_broadcast(&openid->wake);
}

struct openid_job *openid_take_job(struct openid_jobs *jobs)
{
    struct openid_job *job = jobs->first;
    jobs->first = job->next;
    if (!jobs->first)
        jobs->last = &jobs->first;
    jobs->count--;
    return job;
}

/* Queues a token that the provider shall revoke. If the provider accepts no revocations and the queue is full, drops the oldest
   token in the queue; that token stays valid until it expires. */
void openid_revoke_later(struct openid *openid, const char *refresh_token)
{
    if (!refresh_token || !json_object_get(openid->metadata, "revocation_endpoint"))
        return;
    if (openid->revocations.count >= PEOPLE) {
        openid_free_job(openid_take_job(&openid->revocations));
        log_warn(openid->params.log,
                 "openid: more than %d refresh tokens wait for revocation at the provider; the oldest token is not revoked and stays valid "
                 "until its expiry",
                 PEOPLE);
    }
    openid_add_job(openid, &openid->revocations, &(struct openid_job){ .revoke = mem_strdup(refresh_token) });
}
