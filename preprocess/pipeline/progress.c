/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes and prints progress and remaining time while a plant is prepared. */
#include "preprocess/pipeline/progress.h"

#include <unistd.h>

#include "base/clock.h"

void progress_begin(struct progress *progress, FILE *out, size_t total, size_t there, int64_t now_ns)
{
    *progress = (struct progress){ .out = out, .terminal = out && isatty(fileno(out)), .total = total, .there = there };
    progress->began_ns = progress->said_ns = now_ns;
    if (out && there < total)
        fprintf(out, "preparing %zu of %zu assets%s\n", total - there, total, there ? "; all other assets are up to date" : "");
}

void progress_expect(struct progress *progress, double work)
{
    progress->known++;
    progress->work_known += work;
}

double progress_left_s(const struct progress *progress, int64_t now_ns)
{
    size_t all = progress->total - progress->there;
    if (progress->work_done <= 0 || progress->known == 0)
        return -1;
    double unknown = (double)(all - progress->known) * progress->work_known / (double)progress->known;
    double left = progress->work_known - progress->work_done + unknown;
    return (left > 0 ? left : 0) / progress->work_done * (double)(now_ns - progress->began_ns) / NS_PER_S;
}

static void say(const struct progress *progress, int64_t now_ns)
{
    char left[40] = "";
    double left_s = progress_left_s(progress, now_ns), passed_s = (double)(now_ns - progress->began_ns) / NS_PER_S;
    size_t all = progress->total - progress->there;
    long s = (long)(left_s + 0.5);
    if (s >= 3600)
        snprintf(left, sizeof(left), "%ld h %02ld min", s / 3600, s / 60 % 60);
    else if (s >= 60)
        snprintf(left, sizeof(left), "%ld min %02ld s", s / 60, s % 60);
    else
        snprintf(left, sizeof(left), "%ld s", s);
    fprintf(progress->out, "%s%zu of %zu assets prepared, %.1f a second, about %s left%s", progress->terminal ? "\r" : "",
            progress->there + progress->done, progress->total, passed_s > 0 ? (double)progress->done / passed_s : 0.0,
            progress->done < all ? left : "0 s", progress->terminal ? "\033[K" : "\n");
    fflush(progress->out);
}

void progress_step(struct progress *progress, double work, int64_t now_ns)
{
    progress->done++;
    progress->work_done += work;
    if (!progress->out || now_ns - progress->said_ns < (progress->terminal ? PROGRESS_TERMINAL_NS : PROGRESS_LINE_NS))
        return;
    progress->said_ns = now_ns;
    say(progress, now_ns);
}

void progress_end(struct progress *progress)
{
    if (progress->out && progress->terminal)
        fprintf(progress->out, "\r\033[K");
}
