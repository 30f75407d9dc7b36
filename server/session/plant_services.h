/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The services of one loaded plant. The plant runtime owns them; the event loop and the sessions use them. A reload replaces them all. */
#ifndef SESSION_PLANT_SERVICES_H
#define SESSION_PLANT_SERVICES_H

struct plant_services {
    struct scene *scene;
    struct store *store;
    struct plant_clock *clock; /* clock that timestamps readings, alarms, notes and actions; NULL: this machine's UTC clock */
    struct render_service *render_service;
    struct baselines *baselines;
    /* cache of readings of past instants; the event loop's copy of this struct has NULL here if nothing is recorded */
    struct snapshot_cache *snapshot_cache;
    struct alarm_service *alarm_service; /* service that evaluates alarms; NULL: there are no alarms */
    struct placing *placing;             /* computes distances of sensors that users move; NULL: sensors cannot be placed */
    struct named_views *named_views;
    struct short_links *short_links;
    struct notes *notes;
    struct wall_remote *wall_remote;
    struct pairings *pairings;
    struct other_plants *other_plants; /* pictures of other plants; NULL: the plant file names no other plants */
    /* on a renderer (daemon that draws for a core) or a standby core: link to the core; NULL: this daemon reads its devices itself */
    struct core_link *core_link;
    struct historian *historian;     /* records history; NULL: nothing is recorded */
    struct notifier *notifier;       /* service that sends alarm notifications; NULL: none are sent */
    struct loop_checks *loop_checks; /* results of loop checks, on a renderer those of the core; NULL: the plant records no history */
    char *tag_list;                  /* text of the active tag list; NULL: it could not be read */
    char *history_folder;            /* folder of the recorded history; NULL: nothing is recorded */
};

#endif
